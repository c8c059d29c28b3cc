"""Where another simulator's detector begins to look for a first path.

Its index need not be that of the base's detector: it may be deafer, may climb over the side lobes
of its pulse, and may count from another part of the edge. What it passes over in its own records
is no first path in those that an effect changed either: else a level that falls by some decibels
would hide side lobes from the base's detector, and move paths that stay where they are.
"""

from __future__ import annotations

import numpy as np

from bench.physics.detection import first_path
from bench.physics.units import Floats, Reals

STRONG = 0.5  # of the highest sample: its own edge, which in most rows is the first one
EARLIER = 1.0  # samples, from where on an edge is another one than that of the index
PASSED_SHARE = 0.01  # of the rows, from where on a table's detector passes over what the base's
# takes for a path: that of noise alone is less


def begins(magnitude: Reals, threshold: Floats, index: Floats) -> Floats:
    """Return from which sample on paths are looked for [n]: 0 where the base's detector agrees.

    `magnitude` [n, K] as in the table, `threshold` [n] counts, `index` [n] the table's. 0 too in
    rows that are found nearer to the index without: of an index that scatters this tells nothing.
    """
    apart = first_path(magnitude, threshold) - index
    strongest = first_path(magnitude, STRONG * magnitude.max(axis=1)) - index
    usual = most_often(strongest, apart)
    if np.mean(apart < usual - EARLIER) <= PASSED_SHARE:
        return np.zeros(len(index))
    begin = np.maximum(np.floor(np.nan_to_num(index + usual)), 0)
    then = first_path(magnitude, threshold, begin=begin) - index
    return np.where(np.abs(then - usual) <= np.abs(apart - usual), begin, 0.0)


def most_often(*ways: Floats) -> float:
    """Return where most of some values lie, of the ways [n] in which most do; 0 of none.

    That is the middle of the narrowest stretch that holds half of them (the half-sample mode's
    first step: Bickel and Fruehwirth 2006).
    """
    known = [one[np.isfinite(one)] for one in ways]
    every = [(_middle(one), one) for one in known if len(one)]
    often = [int(np.sum(np.abs(one - at) <= EARLIER / 2)) for at, one in every]
    return every[int(np.argmax(often))][0] if every else 0.0


def _middle(values: Floats) -> float:
    """Return the middle of the narrowest stretch that holds half of the values."""
    every, half = np.sort(values), (len(values) + 1) // 2
    first = int(np.argmin(every[half - 1 :] - every[: len(every) - half + 1]))
    return float(np.median(every[first : first + half]))
