"""At what level another simulator's detector times its first paths, as its own table tells.

The base's detector times an edge at half of its peak, wherever it crossed the threshold. Many
simulators time it where it crosses: of a number of times the noise, or of a part of the highest
sample. Weaker rows are late by then, and so they must be where an effect made them weaker: with
the base's detector what is left of that looks like a detector that answers late, or an error over
the level.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import chain

import numpy as np
from numpy.typing import NDArray

from bench.physics.detection import crossed_level, first_path
from bench.physics.units import Floats, Reals

OF_NOISE = tuple(np.geomspace(3.0, 40.0, 24).tolist())  # standard deviations of magnitudes
OF_PEAK = tuple(np.linspace(0.1, 0.9, 17).tolist())
FINER = (0.025, 0.0125, 0.00625)  # steps of the same about the best: edges of 2 ns move by 0.01 ns
LEAST = OF_NOISE[0]  # times the noise: less is noise in every row
QUIET = 6.5  # times the noise, that one sample of noise in 10 000 reaches: no detector that works
# asks for less of its own accord
BETTER = 0.6  # of what is left of the base's detector, at most: else it is that one [convention]
FARTHEST = 3.0  # samples, that an edge counts as far: another one [convention]
MOST_ROWS = 2000  # of a table that tell [cost]


@dataclass(frozen=True)
class Crossing:
    """Times an edge where it rises above so many times the noise, and that part of the highest."""

    of_noise: float
    of_peak: float

    def found(self, magnitude: Reals, noise: Floats) -> Floats:
        """Return the index [n] of the first path in `magnitude` [n, K], of `noise` [n]."""
        level = crossed_level(self.of_noise * noise, magnitude.max(axis=1), self.of_peak)
        return first_path(magnitude, level, level, part=0.0)


def crossing(magnitude: Reals, noise: Floats, index: Floats, usual: Floats) -> Crossing | None:
    """Return where a table's detector times edges, None where the base's does as well.

    `magnitude` [n, K] and `index` [n] as in the table, `noise` [n] the standard deviation of
    magnitudes of noise alone, `usual` [n] the first paths that the base's detector finds there.
    """
    told = telling(len(index))
    size, own, quiet = magnitude[told], index[told], noise[told]

    def off(one: Crossing) -> float:
        return _off(one.found(size, quiet) - own)

    best = _as_deaf(_finer(min(_tries(), key=off), off), off)
    return best if off(best) < BETTER * _off(usual[told] - own) else None


def telling(rows: int) -> NDArray[np.intp]:
    """Return which of so many rows of a table tell how edges are timed."""
    return np.unique(np.linspace(0, rows - 1, MOST_ROWS).astype(np.intp))


def _tries() -> Iterator[Crossing]:
    """Yield the levels at which an edge may be timed."""
    return chain((Crossing(k, 0.0) for k in OF_NOISE), (Crossing(LEAST, p) for p in OF_PEAK))


def _finer(best: Crossing, off: Callable[[Crossing], float]) -> Crossing:
    """Return the best part of the highest sample about the best that was tried."""
    for step in FINER if best.of_peak else ():
        parts = (best.of_peak, best.of_peak - step, best.of_peak + step)
        best = min((replace(best, of_peak=part) for part in parts), key=off)
    return best


def _as_deaf(best: Crossing, off: Callable[[Crossing], float]) -> Crossing:
    """Return a detector of a part of the highest sample with what it asks for beside the noise.

    Rows that are louder do not tell that: then it is no more than what noise hardly reaches.
    """
    if not best.of_peak:
        return best
    usual = [times for times in reversed(OF_NOISE) if times <= QUIET]
    deafer = [times for times in OF_NOISE if times > QUIET]
    return min((replace(best, of_noise=times) for times in (*usual, *deafer)), key=off)


def _off(apart: Floats) -> float:
    """Return how far indices lie from their median place in the mean [samples]; 0 of none."""
    known = apart[np.isfinite(apart)]
    if not len(known):
        return 0.0
    return float(np.mean(np.minimum(np.abs(known - np.median(known)), FARTHEST)))
