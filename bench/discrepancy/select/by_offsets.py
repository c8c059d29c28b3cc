"""Causes that offsets of links speak for, though a mean over all rows hardly sees them."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.link_mixture import offsets, unstruck
from bench.discrepancy.settings import LEAD_NATS, STRIKE_NATS
from bench.physics.effect import Effect


def witnessed(
    comparison: Comparison, view: View, added: Added, effects: tuple[Effect, ...]
) -> Effect | None:
    """Return the effect that the offsets of links speak for, None where they do for none alone.

    For causes so rare (a few walls, one device) that a mean over all links hardly sees them. Each
    effect pays for its parameters (Schwarz 1978) and must be ahead of the others.
    """
    if RANGE not in view.recorded.names:
        return None
    able = [e for e in effects if not (type(e).per_link or type(e).independent)]
    nats = [_alone(comparison, view, (*added, e)) - _cost(e, view) for e in able]
    ranked = sorted(range(len(able)), key=lambda i: -nats[i])
    if not ranked or nats[ranked[0]] - _alone(comparison, view, added) < STRIKE_NATS:
        return None
    if len(ranked) > 1 and nats[ranked[0]] - nats[ranked[1]] < LEAD_NATS:
        return None
    return able[ranked[0]]


def _alone(comparison: Comparison, view: View, added: Added) -> float:
    """Return the log likelihood of the offsets with some effects, in nats."""
    return unstruck(offsets(comparison, view, added, None)).nats


def _cost(effect: Effect, view: View) -> float:
    """Return what the parameters, or values per device or level, of an effect cost in nats."""
    return 0.5 * effect.freed * float(np.log(len(np.unique(view.links))))
