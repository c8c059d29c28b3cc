"""Sets without the amplitudes that they do not need.

A fit follows means and scatter, and takes another form of an effect for scatter where that is at
hand: a path loss of two slopes for one slope and shadowing. The evidence, which lets forms differ,
tells whether it is needed (automatic Occam's razor: MacKay 1992).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

from bench.discrepancy.compare.view import Added
from bench.discrepancy.fit.starts import free_parameters
from bench.discrepancy.joint.polish import Fit, fitted
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.effect import Effect


def plainer(given: Statistics, fit: Fit, evidence: Callable[[Fit], float]) -> Fit:
    """Return a set with all but its members' first amplitudes off, as far as `evidence` grows."""
    best = fit
    for place, effect in enumerate(fit.effects):
        for item in [p for p in free_parameters(type(effect)) if p.null is not None][1:]:
            other = replace(best.effects[place], **{item.name: item.null})
            made = fitted(given, _with(best.effects, place, other))
            if made and evidence(made) > evidence(best):
                best = made
    return best


def _with(effects: Added, place: int, other: Effect) -> Added:
    return (*effects[:place], other, *effects[place + 1 :])
