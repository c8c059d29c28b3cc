"""Which points no other point beats on every axis."""

from __future__ import annotations

from collections.abc import Sequence


def pareto_front(points: Sequence[tuple[float, ...]]) -> list[int]:
    """Return the positions of the points no other beats on all axes (lower is better).

    In order of the first axis; of equal points only the first is kept.
    """
    order = sorted(range(len(points)), key=lambda i: (*points[i], i))
    front: list[int] = []
    for index in order:  # whatever beats a point comes before it in this order
        if not any(_covers(points[kept], points[index]) for kept in front):
            front.append(index)
    return front


def _covers(one: tuple[float, ...], other: tuple[float, ...]) -> bool:
    return all(a <= b for a, b in zip(one, other, strict=True))
