"""Successive halving towards a front: which candidates are worth more training.

Jamieson and Talwalkar, "Non-stochastic best arm identification and hyperparameter optimization",
AISTATS 2016; with several axes the survivors are the outermost fronts (Deb et al. 2002).
"""

from __future__ import annotations

from collections.abc import Sequence

from reports.pareto import pareto_front

Point = tuple[float, ...]


def survivors(points: Sequence[Point], keep: int) -> list[int]:
    """Return the positions of `keep` points, lower being better on every axis.

    The front is kept, then the front of what is left, and so on; of the last that does not fit
    those spread evenly along the first axis.
    """
    left, kept = list(range(len(points))), list[int]()
    while left and len(kept) < keep:
        front = [left[at] for at in pareto_front([points[at] for at in left])]
        kept += _spread(front, keep - len(kept))
        left = [at for at in left if at not in front]
    return sorted(kept)


def _spread(front: Sequence[int], most: int) -> list[int]:
    """Return at most `most` of a front, evenly spaced, both ends among them."""
    if len(front) <= most:
        return list(front)
    step = (len(front) - 1) / max(most - 1, 1)
    return [front[round(number * step)] for number in range(most)]


def rungs(epochs: int, levels: int, factor: int = 3) -> list[int]:
    """Return the epochs of each level, the last in full: 30 in three levels are 3, 10, 30."""
    return [max(1, round(epochs / factor ** (levels - 1 - level))) for level in range(levels)]
