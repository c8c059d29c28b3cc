"""What effects may do in one of two ways that no search along a parameter leads to."""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.joint.settings import WIDER
from bench.physics.effect import Effect
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.pulse_ringing import PulseRinging


def other_log(effect: Effect) -> Effect:
    """Return a tone that a table logs in the other way; other effects as they are."""
    if not isinstance(effect, NarrowbandInterference):
        return effect
    return replace(effect, power_logged=1.0 - effect.power_logged)


def as_high(effect: Effect) -> Effect:
    """Return a wider pulse that has its energy in the other way; other effects as they are."""
    if not isinstance(effect, PulseRinging) or effect.widening < WIDER:
        return effect
    return replace(effect, as_high=1.0 - effect.as_high)
