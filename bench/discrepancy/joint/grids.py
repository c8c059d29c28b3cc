"""Ranges that lie on a grid, beside waveforms: the grid itself shows it, and no score has to.

As of ranges alone (see `bench.discrepancy.select.marks`). Waveforms know nothing of how firmware
prints a range, so it stands beside whatever these say, before scatter of ranges is asked for.
"""

from __future__ import annotations

from dataclasses import replace

from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.select.marks import grids, likeliest
from bench.discrepancy.select.refute import announced
from bench.discrepancy.select.state import Round, State


def with_grids(state: State) -> State:
    """Return the state with what rounds ranges in it, none where recorded ranges show no grid."""
    whole, located = replace(state.search, work=state.search.both), state.rounds[0].located
    have = {effect.name for effect in state.added}
    for seen in grids(whole, state.added):
        if seen.name not in have:
            effect = likeliest(whole, seen, state.added)
            added = (*state.added, effect)
            turn = announced(whole, Round(located, None, None), added, effect)
            state = replace(state.after(turn), added=added)
    return state


def marked_by_grids(choice: WaveChoice, state: State) -> WaveChoice:
    """Return what waveforms say, with the effects of a state that a grid shows as marked ones."""
    mine = (type(effect).name for effect in state.added if type(effect).marked)
    return replace(choice, marked=tuple(dict.fromkeys((*choice.marked, *mine))))
