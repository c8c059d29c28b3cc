"""Names of what levels do where distances are wrong: a fault of the set-up says what made them.

Levels are simulated at the distances that a table gives. Where two anchors are exchanged these are
wrong by metres, and so are the levels: another path loss then gains, though none is there.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import without
from bench.discrepancy.law.likeness import shift_m
from bench.discrepancy.law.search import Proposal
from bench.discrepancy.law.settings import LAW_SAME_PLACE_M
from bench.discrepancy.select.state import Search, Selection
from bench.discrepancy.select.verdict import Unknown, Verdict
from bench.discrepancy.settings import SCORE_FIRST, SCORE_MEMBERS
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.level_control import LevelControl

OF_LEVELS = (PathLoss, LevelControl)


def at_right_distances(search: Search, found: Selection, fault: Proposal) -> Selection:
    """Return the selection without names of levels that gain only where a fault moves devices."""
    able = (effect for effect in found.added if isinstance(effect, OF_LEVELS))
    gone = {effect.physics for effect in able if not _gains(search, found, fault, effect)}
    if not gone:
        return found
    said = tuple(_not_beside(v, gone) for v in found.verdicts if not gone & {*v.names[:1]})
    added = tuple(effect for effect in found.added if effect.physics not in gone)
    return replace(found, verdicts=said, added=added)


def _not_beside(said: Verdict, gone: set[str]) -> Verdict:
    """Return a verdict; what has no name is not told beside names that went."""
    if not isinstance(said, Unknown):
        return said
    return replace(said, beside=tuple(one for one in said.beside if one not in gone))


def _gains(search: Search, found: Selection, fault: Proposal, effect: Effect) -> bool:
    """Return whether an effect likely gains in links whose distances are as the table gives them.

    True where there is no such link.
    """
    rows = search.both
    moved = np.abs(shift_m(rows, fault)) > LAW_SAME_PLACE_M
    if moved.all():
        return True
    rest = rows.leaving(np.unique(rows.links[moved]))
    before, after = (
        tally(search.comparison.ensemble(rest, added, SCORE_MEMBERS, SCORE_FIRST))
        for added in (without(found.added, effect), found.added)
    )
    return gain_interval(before, after, search.seed).likely_above_zero
