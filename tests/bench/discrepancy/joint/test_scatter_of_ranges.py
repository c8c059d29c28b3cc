"""Scatter of ranges that rows of links show beside waveforms, where no score falls by it."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.joint import turn
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Explanation
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.state import Round, State
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

ONE = Estimate(1, 0.5, 1.5)
LEFT = Located((), 0.002, 9.0, 3.0, 1, {})


def nothing_found() -> Explanation:
    tally = Tally(("error_m",), np.ones((4, 1)), np.ones((4, 1)))
    return Explanation((), tally, ONE, tally, {}, {})


def strike(effect: Effect) -> Strike:
    return Strike(effect, ONE, (), np.empty(0, np.intp))


def asked(monkeypatch: pytest.MonkeyPatch, found: Strike | None) -> State:
    monkeypatch.setattr(turn, "scatter_alone", lambda *_: found)
    search = SimpleNamespace(both=None, work=None)
    monkeypatch.setattr(turn, "replace", lambda one, **_: one)
    return turn._with_rows_scatter(State(search), nothing_found(), LEFT)  # type: ignore[arg-type]


def test_what_rows_of_links_show_is_a_round_of_its_own(monkeypatch: pytest.MonkeyPatch) -> None:
    made = asked(monkeypatch, strike(TimestampJitter()))
    assert [one.strike is not None for one in made.rounds] == [True]
    assert turn._scattered(made) == (TimestampJitter(),)
    assert asked(monkeypatch, None).rounds == ()


def test_what_strikes_some_links_is_no_scatter_of_all() -> None:
    blocked = Round(LEFT, nothing_found(), BlockedPath(), strike(BlockedPath()))
    assert turn._scattered(State(None, rounds=(blocked,))) == ()  # type: ignore[arg-type]


def test_scatter_is_said_beside_what_could_not_be_tried(monkeypatch: pytest.MonkeyPatch) -> None:
    said = LeftOut(TimestampJitter(), (), ONE, 1.0, Control("", None))
    monkeypatch.setattr(turn, "struck_out", lambda *_: said)
    monkeypatch.setattr(turn, "with_untried", lambda _, added, some: (*some, added)[:1])
    unlisted = replace(said, note="unlisted")
    monkeypatch.setattr(turn, "with_unlisted", lambda *_: unlisted)
    found = strike(TimestampJitter())
    state = State(None, rounds=(Round(LEFT, None, found.effect, found),))  # type: ignore[arg-type]
    assert turn._struck(state, state.rounds[0], found) is said
    other = strike(BlockedPath())
    state = replace(state, rounds=(Round(LEFT, None, other.effect, other),))
    assert turn._struck(state, state.rounds[0], other) is unlisted


def test_all_working_rows_are_asked_where_no_effect_is_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Half the rows may not show a scatter of ranges that all of them do."""
    shown = replace(LEFT, p=0.001)
    monkeypatch.setattr(turn, "locate_left", lambda *_: LEFT)
    monkeypatch.setattr(turn, "_in_all_rows", lambda *_: shown)
    journal = SimpleNamespace(kept=lambda step: step)
    assert turn._left_beside(None, (), 0, journal) is shown  # type: ignore[arg-type]
    named = (TimestampJitter(),)
    assert turn._left_beside(None, named, 0, journal) is LEFT  # type: ignore[arg-type]
