"""Where effects that strike links at random would put the offsets of links."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray
from scipy.stats import gaussian_kde

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.settings import IDLE_SHARE
from bench.discrepancy.select.within_links import link_medians
from bench.discrepancy.settings import (
    BEND_M,
    OFFSET_FIRST,
    OFFSET_MEMBERS,
    SMALLEST_STRIKE,
    STRIKE_SIZES,
)
from bench.physics.effect import Effect, Parameter

if TYPE_CHECKING:
    from bench.discrepancy.select.link_mixture import Offsets

Floats = NDArray[np.float64]


def share_and_size(kind: type[Effect]) -> tuple[Parameter, Parameter]:
    """Return the parameters of an effect for the share of links it strikes and for how hard."""
    assert kind.strikes is not None
    known = {p.name: p for p in kind.parameters()}
    return known[kind.strikes[0]], known[kind.strikes[1]]


def striking(kind: type[Effect], share: float, size: float) -> Effect:
    """Return the effect that strikes a share of the links so hard."""
    names = [p.name for p in share_and_size(kind)]
    return kind.from_values(dict(zip(names, (share, size), strict=True)))


def sizes_of(kind: type[Effect]) -> list[float]:
    """Return the sizes that are tried."""
    high = share_and_size(kind)[1].high
    return [float(s) for s in np.geomspace(SMALLEST_STRIKE * high, high, STRIKE_SIZES)]


def struck_m(
    comparison: Comparison,
    view: View,
    added: Added,
    kind: type[Effect],
    size: float,
    seen: Offsets,
    bare: Ensemble,
) -> Floats:
    """Return the density of the recorded offsets if every link were struck, [L] per metre.

    `bare` is the ensemble of the same replicates with `added` alone. Where ranges of a user's own
    simulator do not follow its paths, links are late by the law of detours.
    """
    effect = striking(kind, 1.0, size)
    with_it = comparison.ensemble(view, (*added, effect), OFFSET_MEMBERS // 2, OFFSET_FIRST)
    shift, own = (_shift(one, bare)[:, ~seen.inert].ravel() for one in (with_it, bare))
    if not len(shift):
        return np.zeros(len(seen.links))
    if np.nanmean(shift) < IDLE_SHARE * size:
        shift = own + np.random.default_rng(0).exponential(size, len(own))
    smooth = gaussian_kde(np.arcsinh(shift[np.isfinite(shift)] / BEND_M))
    slope = 1 / np.hypot(seen.offset_m, BEND_M)
    return np.where(seen.inert, 0.0, smooth(np.arcsinh(seen.offset_m / BEND_M)) * slope)


def _shift(with_it: Ensemble, bare: Ensemble) -> Floats:
    """Return how far every link of every replicate lies from the simulator without it, [m, L]."""
    code = np.unique(bare.links, return_inverse=True)[1]
    middle = bare.simulated_of(RANGE).mean(axis=0)
    return link_medians(with_it.simulated_of(RANGE) - middle, code)
