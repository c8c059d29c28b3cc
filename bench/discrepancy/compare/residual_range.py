"""What recorded ranges differ by from simulated ones, where a grid rounds both.

A rounded simulated range is off by a whole step or not at all, which no mean and no robust fit
takes for a shift. So what rounds acts by its mean alone, that of rows that it cuts down alike: its
error stays with the recorded range, as scatter of step / sqrt(12) (the pseudo-quantisation noise of
Widrow and Kollar 2008, ch. 4).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.beside_level import beside_level
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.settings import FEW_VERSIONS
from bench.physics.effect import Effect

Floats = NDArray[np.float64]


def residual_range(
    comparison: Comparison, view: View, added: Added, members: int, alike: bool = False
) -> tuple[Ensemble, Floats] | None:
    """Return the ensemble with what is `added`, and recorded minus simulated range [n] in metres.

    Beside the mean of the simulated rows of its own link alone, where it has enough of these (see
    `crowded`); with `alike` of those of similar links, too. Less what ranges of a link go with its
    levels as simulated (see `beside_level`). None where ranges are not on both sides.
    """
    count = None if alike else own_versions(comparison, view)
    whole = comparison.ensemble(view, added, members)
    if RANGE not in whole.names:
        return None
    smooth = tuple(effect for effect in added if not type(effect).marked)
    if len(smooth) == len(added) or view.waveform:
        near = _first(whole, count)
        return whole, beside_level(view, near, near.residual_of(RANGE))
    bare = _first(comparison.ensemble(view, smooth, members), count)
    rounded = _first(whole, count).simulated_of(RANGE) - bare.simulated_of(RANGE)
    leant = np.sum([effect.leant_m(view.scene) for effect in added], axis=0)
    leant = leant - np.nanmean(leant)
    return whole, np.asarray(bare.residual_of(RANGE) - np.nanmean(rounded) - leant)


def crowded(comparison: Comparison, view: View) -> float:
    """Return as how many independent ones a residual of `residual_range` counts once.

    Where each link is held beside simulated rows that no other link shares, its residual is off by
    what these have by chance and no other's is: that is in the scatter that residuals show.
    """
    return comparison.crowding(view) ** 2 if own_versions(comparison, view) is None else 1.0


def own_versions(comparison: Comparison, view: View) -> int | None:
    """Return how many simulated versions, the first, are of the rows' own links alone.

    None where these are too few to need no others. Beside waveforms sets of their own are weighed
    (see `bench.discrepancy.joint`).
    """
    count = comparison.distinct(view)
    enough = count >= FEW_VERSIONS and not view.waveform and comparison.paired(view)
    return count if enough else None


def _first(made: Ensemble, count: int | None) -> Ensemble:
    """Return an ensemble of its first simulated versions alone, of all where None are counted."""
    return made if count is None else made.first(count)


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
