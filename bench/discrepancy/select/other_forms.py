"""What ranges differ by beside names may be no more than other forms of these do.

An effect of the library has one form of few values; a cause has any. Of two short tapes each makes
a scale of its own, and a plan that is printed too small leaves heights alone: beside one scale that
leaves something, which a search finds. It has no name of its own where it is little of what the
names gain, or where a smooth deformation of what they do makes it: a second cause does more.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.residual_range import moved_m
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.range_part import receiver_forms
from bench.discrepancy.select.state import Round, Search
from bench.discrepancy.select.stepwise import ranges_left
from bench.discrepancy.sets.blocks import Blocks, deformed, of_laws, off_by
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.set_up import of_setup
from bench.discrepancy.sets.settings import LAW_NATS, LAW_SIZE, LEFT_SHARE
from bench.discrepancy.sets.shifted import Shifted
from bench.discrepancy.settings import RESIDUAL_MEMBERS, SCORE_FIRST, SCORE_MEMBERS
from bench.physics.effect import Effect
from bench.physics.units import Floats

FORMS = "other forms of the names"


def made_by_forms(search: Search, added: Added, last: Round) -> bool:
    """Return whether what ranges differ by beside named effects is what other forms of them make.

    `last` is the round that found it. Where ranges speak for a cause without a name, it must be
    worth no more than other forms are beside these.
    """
    if search.choice.others:
        return not _others_needed(search, added) and not _beyond_deformed(search, added)
    return _is_little(search, added, last) or not _beyond_deformed(search, added)


def _others_needed(search: Search, added: Added) -> bool:
    """Return whether causes without a name are worth their price beside other forms of names."""
    rows, others = search.both, search.choice.others
    every = of_laws(search.kinds, rows) | of_setup(rows)
    if not set(others) <= set(every):
        return True
    evidence, _ = _beside(search, rows, added, {one: every[one] for one in others})
    evidence.widest |= dict.fromkeys(others, LAW_SIZE)
    with_them, without = (evidence.of(some).nats for some in ((FORMS, *others), (FORMS,)))
    brought = (with_them - without) / search.comparison.crowding(rows) ** 2
    return brought >= LAW_NATS * len(others)


def _is_little(search: Search, added: Added, last: Round) -> bool:
    """Return whether what a regression removes of ranges is little of what names gain there."""
    if last.explanation is None:
        return False
    before, after = (
        tally(search.comparison.ensemble(search.discover, some, SCORE_MEMBERS, SCORE_FIRST))
        for some in (without_ranging(added), added)
    )
    gained = gain_interval(before, after, search.seed, (RANGE,)).value
    return last.explanation.removable.value < LEFT_SHARE * gained


def without_ranging(added: Added) -> Added:
    """Return the effects but those that act on ranges alone."""
    return tuple(effect for effect in added if effect.stage != "ranging")


def _beyond_deformed(search: Search, added: Added) -> bool:
    """Return whether ranges of all working rows differ where named effects may be deformed."""
    rows = search.both
    shift_m = _deformation(search, rows, added)
    known = replace(search, work=rows, comparison=Shifted(search.comparison, shift_m))
    return ranges_left(known, added).significant


def _deformation(search: Search, rows: View, added: Added) -> Floats:
    """Return what the likeliest deformation of named effects does to the range of rows [n].

    Of what changes waveforms, what a detector nobody knows may make of it.
    """
    evidence, known = _beside(search, rows, added)
    shift_m = np.zeros(len(rows.rows))
    shift_m[known] = evidence.response(evidence.of((FORMS,)), FORMS)
    return shift_m


def _beside(
    search: Search, rows: View, added: Added, more: Blocks | None = None
) -> tuple[Evidence, NDArray[np.intp]]:
    """Return the evidence of what named effects leave: of their forms, and `more`; and its rows.

    A form may be as large as is typical, and no larger. Rows weigh as they do beside forms.
    """
    ensemble = search.comparison.ensemble(rows, added, RESIDUAL_MEMBERS)
    left = ensemble.residual_of(RANGE)
    known = np.flatnonzero(np.isfinite(left))
    parts = [part for effect in added for part in _parts(search, rows, added, effect)]
    parts += [receiver_forms(search, rows, ensemble, added, False), np.zeros((len(left), 1))]
    blocks = {FORMS: tuple(part for part in parts if part.shape[1]), **(more or {})}
    blocks = {name: tuple(part[known] for part in block) for name, block in blocks.items()}
    evidence = Evidence(left[known], rows.links[known], blocks, {FORMS: 1.0})
    evidence.reweigh((FORMS,))
    return evidence, known


def _parts(search: Search, rows: View, added: Added, effect: Effect) -> tuple[Floats, ...]:
    """Return what else an effect may do to the ranges of rows, [n, k] each.

    What it can do to first order, and for one of ranges alone smooth deformations of what it does.
    """
    ways = type(effect).ways(rows.scene) or ()
    if effect.stage != "ranging" or type(effect).independent:
        return ways
    response = moved_m(search.comparison, rows, added, effect, RESIDUAL_MEMBERS)
    kind = type(effect)
    return (*ways, deformed(response, rows, kind), off_by(response, rows, kind))
