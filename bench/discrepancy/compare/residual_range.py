"""What recorded ranges differ by from simulated ones, where a grid rounds both.

A rounded simulated range is off by a whole step or not at all, which no mean and no robust fit
takes for a shift. So what rounds acts by its mean alone: its error stays with the recorded range,
as scatter of step / sqrt(12) (the pseudo-quantisation noise of Widrow and Kollar 2008, ch. 4).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE

Floats = NDArray[np.float64]


def residual_range(
    comparison: Comparison, view: View, added: Added, members: int
) -> tuple[Ensemble, Floats] | None:
    """Return the ensemble with what is `added`, and recorded minus simulated range [n] in metres.

    None where ranges are not on both sides.
    """
    whole = comparison.ensemble(view, added, members)
    if RANGE not in whole.names:
        return None
    smooth = tuple(effect for effect in added if not type(effect).marked)
    if len(smooth) == len(added) or view.waveform:
        return whole, whole.residual_of(RANGE)
    bare = comparison.ensemble(view, smooth, members)
    rounded = whole.simulated_of(RANGE) - bare.simulated_of(RANGE)
    return whole, np.asarray(bare.residual_of(RANGE) - np.nanmean(rounded))
