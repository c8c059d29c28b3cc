"""Leading-edge detection on the accumulator's magnitude.

As the DW1000 does it (user manual 7.2.47 and application note APS006 part 1): the first rising edge
above a multiple of the noise; the first-path index sits at half of that edge's peak, in 1/64 of a
sample.
"""

from __future__ import annotations

from functools import lru_cache

import numpy as np

from bench.physics.loops import compiled, edge_rows
from bench.physics.pulse import HALF_WIDTH, shape
from bench.physics.units import Floats, Reals

HALF = 0.5  # of the peak of an edge, where the chip times it
MOST_OF_PEAK = 0.75  # a detector that asks more of the highest sample hears nothing in weak rows
_CLIMB = 4  # samples from the first crossing to the peak of its edge, at most


def first_path(
    magnitude: Reals,
    threshold: Floats,
    timed: Floats | None = None,
    begin: Floats | None = None,
    part: float = HALF,
) -> Floats:
    """Return the first-path index [n] in samples of `magnitude` [n, S], `threshold` [n] counts.

    Where nothing exceeds the threshold, the strongest sample's edge is taken. An edge is timed at
    a `part` of its peak, but not below `timed` [n] counts. Resolved to 1/64. Nothing is found
    before sample `begin` [n].
    """
    found = np.empty(len(magnitude))
    first = np.zeros(len(found), np.intp) if begin is None else np.asarray(begin, np.intp)
    limit = np.asarray(threshold, np.float64)
    least = np.zeros(len(found)) if timed is None else np.asarray(timed, np.float64)
    compiled(edge_rows)(found, np.asarray(magnitude, np.float32), limit, least, first, _CLIMB, part)
    return np.rint(found * 64) / 64


def crossed_level(loud: Floats, highest: Reals | Floats, of_peak: float) -> Floats:
    """Return the level [n] at which a detector that times edges where they cross one does so.

    `loud` [n] is so many times the noise, asked of no more than most of the `highest` sample [n];
    and not below a part `of_peak` of that.
    """
    return np.maximum(np.minimum(loud, MOST_OF_PEAK * highest), of_peak * highest)


@lru_cache(maxsize=32)
def edge_offset(fwhm_samples: float) -> float:
    """Return how far a clean pulse's centre lies behind its first-path index, in samples.

    Averaged over alignments: what the chip's calibrated antenna delay contains.
    """
    centre = 2 * HALF_WIDTH + np.arange(64)[:, None] / 64
    offsets = np.arange(4 * HALF_WIDTH)[None, :] - centre
    clean = np.asarray(np.abs(shape(offsets, fwhm_samples)), np.float32)
    found = first_path(clean, np.full(64, 0.3))
    return float(np.mean(centre[:, 0] - found))
