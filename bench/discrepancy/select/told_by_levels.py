"""Losses, which levels and waveforms tell, and ranges alone do not."""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import REPORTED_LEVELS
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.state import Search
from bench.physics.effect import Effect

Told = tuple[ParameterEstimate, ...]


def told_by_levels(search: Search, _: Added, effect: Effect, fitted: Told) -> Told:
    """Return the intervals of an effect: of a loss none where no level is known.

    What a loss does to ranges hangs on a detector, and nothing shows which that is.
    """
    seen = set(search.fit.recorded.names) & {*REPORTED_LEVELS}
    if search.fit.waveform or seen or not type(effect).of_levels:
        return fitted
    losses = type(effect).of_levels
    return tuple(replace(o, determined=False) if o.name in losses else o for o in fitted)
