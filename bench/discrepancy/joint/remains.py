"""Whether much is left beside a set: something without a form, or links far off.

Noise has a colour, which is how alike its neighbouring samples are. A simulator that is run again
has noise of a colour of its own, so the figures of weak samples scatter otherwise than recorded
ones, whatever is hidden. That is no cause that a receiver logs, and so it has no name; but what a
set leaves is asked beside noise of the recorded colour, where that is likelier.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

from bench.discrepancy.joint.chance import off
from bench.discrepancy.joint.curve import with_own_curve
from bench.discrepancy.joint.form import scatters_more
from bench.discrepancy.joint.growth import Fits
from bench.discrepancy.joint.likelihood import left_free
from bench.discrepancy.joint.polish import Fit, fitted
from bench.discrepancy.joint.settings import LEFT_NATS, LEFT_SHARE, NAME_NATS, SCATTERED_SHARE
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.effects.receiver.noise_floor import NoiseFloor


@dataclass(frozen=True)
class Remains:
    """The nats that something without a form brings beside a set, and whether much is left."""

    nats: float
    much: bool


def remains(given: Statistics, fit: Fit, none: Fit, start: Fit, explained: float) -> Remains:
    """Return what is left beside a set that explains so many nats; the `start` need not be near."""
    free = left_free(given, with_own_curve(fit), fit.responses, fit.parameters)
    left = max(free)
    much = left > max(LEFT_NATS, LEFT_SHARE * (max(explained, 0) + left))
    least = max(LEFT_NATS, SCATTERED_SHARE * explained)
    much = much or (scatters_more(fit, none) and free[1] > least)
    return Remains(left, much or (fit.names != start.names and off(given, fit, none)))


def coloured(
    given: Statistics, fit: Fit, known: Fits, evidence: Callable[[Fit], float]
) -> Fit | None:
    """Return a set beside noise of a colour that `known` sets found, None where not likelier.

    Of a simulator that is run again: samples of a table have the noise that they have.
    """
    name = NoiseFloor.name
    heard = [one for one in known.values() if name in one.names]
    if not given.by_rows or not heard or name in fit.names:
        return None
    likeliest = max(heard, key=lambda one: one.nats)
    made = fitted(given, (*fit.effects, colour_of(likeliest)))
    return made if made and evidence(made) >= evidence(fit) + NAME_NATS else None


def colour_of(fit: Fit) -> NoiseFloor:
    """Return noise that is as loud as without a set, of the colour that its noise floor has."""
    floor = fit.effects[fit.names.index(NoiseFloor.name)]
    assert isinstance(floor, NoiseFloor)
    return NoiseFloor(0.0, 0.0, floor.lag_1, floor.lag_2, floor.lag_3)
