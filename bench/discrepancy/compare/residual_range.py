"""What recorded ranges differ by from simulated ones, where a grid rounds both.

A rounded simulated range is off by a whole step or not at all, which no mean and no robust fit
takes for a shift. So what rounds acts by its mean alone, that of rows that it cuts down alike: its
error stays with the recorded range, as scatter of step / sqrt(12) (the pseudo-quantisation noise of
Widrow and Kollar 2008, ch. 4).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import RANGE
from bench.physics.effect import Effect

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
    rounded = np.nanmean(whole.simulated_of(RANGE) - bare.simulated_of(RANGE))
    leant = np.sum([effect.leant_m(view.scene) for effect in added], axis=0)
    return whole, np.asarray(bare.residual_of(RANGE) - rounded - (leant - np.nanmean(leant)))


def moved_m(
    comparison: Comparison, view: View, added: Added, effect: Effect, members: int
) -> Floats:
    """Return what one of the effects `added` does to the range of every row [n], in metres.

    Zeros where ranges are not on both sides.
    """
    whole, bare = (
        comparison.ensemble(view, some, members) for some in (added, without(added, effect))
    )
    if RANGE not in whole.names or RANGE not in bare.names:
        return np.zeros(len(view.rows))
    change = (whole.simulated_of(RANGE) - bare.simulated_of(RANGE)).mean(axis=0)
    return np.asarray(np.nan_to_num(change), np.float64)
