"""What several names of a set do to levels, each beside the others.

A set is of ranges, where all names were fitted at once. Of levels each would take alone what the
others take as well.
"""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.fit.headings import gain_over
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.settings import LEVEL_TURNS
from bench.discrepancy.settings import RESIDUAL_MEMBERS
from bench.physics.effect import Effect
from bench.physics.effects.fitted.ground_ray import GroundRay
from bench.physics.effects.fitted.pattern_curve import PatternCurve


def in_turn(search: Search, added: Added) -> Added:
    """Return the effects; a reflection and a gain over the heading share levels between them."""
    both = [one for one in added if isinstance(one, GroundRay | PatternCurve)]
    if len({type(one) for one in both}) < 2 or search.sharpest.waveform:
        return added
    if LEVEL not in search.sharpest.recorded.names:
        return added
    places = [added.index(one) for one in both]
    bare = tuple(_silent(one) if at in places else one for at, one in enumerate(added))
    for _ in range(LEVEL_TURNS):
        for place in places:
            again = _again(search, without(bare, bare[place]), bare[place])
            bare = (*bare[:place], again, *bare[place + 1 :])
    return bare


def _silent(effect: Effect) -> Effect:
    """Return an effect that does nothing to levels."""
    if isinstance(effect, GroundRay):
        return replace(effect, level_size=0.0, louder=())
    return replace(effect, gain_db=()) if isinstance(effect, PatternCurve) else effect


def _again(search: Search, others: Added, effect: Effect) -> Effect:
    """Return an effect with what levels show of it beside others."""
    rows = search.sharpest
    if isinstance(effect, GroundRay):
        whole = search.comparison.ensemble(rows, (*others, _silent(effect)), RESIDUAL_MEMBERS)
        return effect.with_level(rows.frame, whole.residual_of(LEVEL))
    if isinstance(effect, PatternCurve):
        return replace(effect, gain_db=gain_over(search.comparison, rows, others))
    return effect
