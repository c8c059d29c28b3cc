"""Laws in the place of names: where one does better than all that was named, or undoes it."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.law.gather import gathered, proposed
from bench.discrepancy.law.likelihood import linear, unmoved
from bench.discrepancy.law.likeness import has_form
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.search import Proposal
from bench.discrepancy.law.settings import LAW_INSTEAD_NATS, LAW_TIED_NATS, LAW_VALUE_NATS
from bench.discrepancy.select.link_mixture import left_far, strike
from bench.discrepancy.select.refute import swapped_for
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Ambiguous, LeftOut, Unknown
from bench.discrepancy.sets.settings import EXPLAINED_STRAYS
from bench.physics.effect import Effect
from bench.physics.effects.ranging.law import Law, with_constants
from bench.physics.effects.ranging.range_scale import RangeScale


def undone(
    search: Search,
    found: Selection,
    views: tuple[View, ...],
    rest: Material,
    after: Proposal | None,
) -> tuple[Selection, Proposal] | None:
    """Return the selection without names that leave something and a law does without, and that.

    These were weighed against laws as a set's free curves are. `after` is the law of the `rest`
    that they leave, if there is one: where another does as well without them, it only takes back
    what they do. Not one of their own form; nor for a constant, that a calibration took off.
    """
    named = (e for e in found.added if _shifts(e) and not type(e).strikes)
    able = tuple(effect for effect in named if effect.physics in found.together)
    for gone in (able, *((one,) for one in able if len(able) > 1)):
        kept = tuple(effect for effect in found.added if effect not in gone)
        alone = proposed(search, gathered(search.comparison, views, kept)) if gone else None
        if alone is None or does_the_same(search, gone, alone):
            continue
        if leads(alone, rest if after else _about_constant(rest), after, gone):
            return without_names(found, kept), alone
    return None


def _about_constant(rest: Material) -> Material:
    """Return rows whose ranges are as far off as simulated in the median."""
    return replace(rest, residual_m=rest.residual_m - np.median(rest.residual_m))


def _shifts(effect: Effect) -> bool:
    """Return whether an effect shifts ranges: one of the range, or what strikes links.

    Scatter shifts nothing: a law leaves it to the scale. Nor does a grid that ranges lie on.
    """
    kind = type(effect)
    able = effect.stage == "ranging" or bool(kind.strikes)
    return able and not (kind.independent or kind.marked)


def narrowed(
    search: Search, found: Selection, alone: Proposal, views: tuple[View, ...]
) -> Selection | None:
    """Return the selection with a class cut down to members that the law does not beat.

    None where the law beats every other member of every class too: a constant law is an antenna
    delay, though the class was led by an effect that only comes near one.
    """
    for verdict in (one for one in found.verdicts if isinstance(one, Ambiguous)):
        first, *others = verdict.options
        if first.effect.name not in {effect.name for effect in shifting(found)}:
            continue
        held = [o for o in others if _stands(search, found, alone, views, first, o)]
        if held:
            left = held[0] if len(held) == 1 else replace(verdict, options=tuple(held))
            said = tuple(left if one is verdict else one for one in found.verdicts)
            added = swapped_for(found.added, first.effect, held[0].effect)
            return replace(found, verdicts=said, added=added)
    return None


def _stands(
    search: Search,
    found: Selection,
    alone: Proposal,
    views: tuple[View, ...],
    first: LeftOut,
    option: LeftOut,
) -> bool:
    """Return whether the law does not beat the names with `option` in the place of `first`."""
    swapped = replace(found, added=swapped_for(found.added, first.effect, option.effect))
    rest = gathered(search.comparison, views, swapped.added)
    return rest is not None and not leads(alone, rest, None, shifting(swapped))


def shifting(found: Selection) -> Added:
    """Return the named effects that shift ranges.

    What else was named has other evidence, and what was named `together` was weighed against laws.
    """
    return tuple(e for e in found.added if _shifts(e) and e.physics not in found.together)


def calms(search: Search, kept: Added, alone: Proposal) -> bool:
    """Return whether no link is struck any more where a law is in place, as it says which were.

    Nobody can predict what is struck at random: where a law over known covariates does, it is none.
    One that hits a few of them, and others beside, only leaves so much that nothing is made of it.
    """
    if search.work is None or alone.best.nats < LAW_INSTEAD_NATS:
        return False
    added = (*kept, effect_of(alone))
    comparison, rows, kinds = search.comparison, search.work, search.kinds
    if strike(comparison, rows, added, added, kinds) is not None:
        return False
    before = strike(comparison, rows, kept, kept, kinds)
    if before is None:
        return True
    return left_far(comparison, rows, kept, added, before.struck) <= EXPLAINED_STRAYS


def effect_of(proposal: Proposal) -> Law:
    """Return a proposed law as an effect of the simulator."""
    return with_constants(proposal.best.structure.expression, proposal.best.fitted.constants)


def leads(alone: Proposal, rest: Material, after: Proposal | None, named: Added) -> bool:
    """Return whether a law alone beats the named effects, and them with a law of what they leave.

    The law pays for its form among all and for its constants; a library effect only what its
    values gain from noise, so that one that is the truth is not beaten. One law goes before names
    and a law that do about as well. A scale may be every device's own (see `sets.own_scale`).
    """
    before = unmoved(alone.given.residual_m).likelihood
    scales = any(isinstance(effect, RangeScale) for effect in named)
    library = max(_left(alone, rest), _own_scales(alone, rest) if scales else -np.inf)
    library -= alone.share * before + LAW_VALUE_NATS * sum(effect.freed for effect in named)
    lead = alone.best.nats - library
    both = lead - (max(after.best.nats, 0.0) if after else 0.0)
    return lead >= LAW_INSTEAD_NATS and both >= -LAW_TIED_NATS


def _left(alone: Proposal, rest: Material) -> float:
    """Return how likely what names leave is, in nats of as many rows as `alone` counts."""
    return alone.share * unmoved(rest.residual_m).likelihood


def _own_scales(alone: Proposal, rest: Material) -> float:
    """Return how likely it is beside a share of the range of every device's own, which pays."""
    ends = rest.devices.values()
    own = [rest.true_range_m * (names == one) for names in ends for one in np.unique(names)]
    if not own:
        return -np.inf
    design = np.stack(own, axis=1)
    free = int(np.linalg.matrix_rank(design)) - 1  # one is the share of all, which has a name
    return alone.share * linear(design, rest.residual_m).likelihood - LAW_VALUE_NATS * free


def does_the_same(search: Search, named: Added, alone: Proposal) -> bool:
    """Return whether a law is one that a named effect has itself: a constant of one device, say.

    Fewer constants are then no other physics: the values of the others are about nothing.
    """
    kinds = (search.kinds.get(effect.physics, type(effect)) for effect in named)
    return any(has_form(kind, search.discover, alone) for kind in kinds)


def without_names(found: Selection, kept: Added) -> Selection:
    """Return the selection with all names taken back but those of `kept` effects."""
    first = next(turn for turn in found.rounds if turn.explanation)
    assert first.explanation is not None
    physics = {effect.physics for effect in kept}
    stay = tuple(v for v in found.verdicts if physics & set(v.names))
    gone = [v.names for v in found.verdicts if v.names and v not in stay]
    if not gone:  # only effects go that no verdict names
        return replace(found, added=kept)
    names = " and ".join(" or ".join(group) for group in gone)
    tried = {c.name: c.gain.value for c in first.explanation.contenders}
    note = f"a law does better than {names}"
    unknown = Unknown(first.located.findings, first.explanation.removable, tried, note)
    return replace(found, verdicts=(*stay, unknown), added=kept)
