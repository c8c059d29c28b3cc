"""What one device does to levels is seen by the levels of all working rows; SIMULATED rows."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import LEVEL, RANGE, window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint import turn
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select import all_rows, stepwise
from bench.discrepancy.select.all_rows import with_levels, with_ranges, with_waveforms
from bench.discrepancy.select.settings import WAVES_SHARE
from bench.discrepancy.select.state import Round, State
from bench.discrepancy.select.stepwise import locate_left
from bench.discrepancy.settings import FAMILY_WISE
from bench.physics.base import Base
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 60


def _search(weaker_db: float, scatter_db: float = 1.5) -> Any:
    """Return a search over links of six devices, of which one reads weaker."""
    rng = np.random.default_rng(2)
    frame = pd.DataFrame({"link": [f"l{i}" for i in range(LINKS)], "tx": "t"})
    frame["rx"] = [f"a{i % 6}" for i in range(LINKS)]
    frame["true_range_m"] = rng.uniform(2, 15, LINKS)
    made = Simulator(Base(), (), 5, "test").observe(scene(frame), 5, 77).table(frame)
    made[LEVEL] += rng.normal(0, scatter_db, LINKS) - weaker_db * (made["rx"] == "a4")
    window = window_of(made)
    rows = view(made, link_codes(made), np.arange(LINKS), window)
    comparison = Resimulation(Simulator(Base(), (), 11, "test"), window)
    return SimpleNamespace(both=rows, comparison=comparison, seed=1)


def _found(search: Any) -> Located:
    return with_levels(search, Located((), 1.0, 0.0, 3.0, 9, {LEVEL: 2.0}))


def test_a_weak_antenna_is_seen_where_waveforms_show_nothing() -> None:
    found = _found(_search(7.0))
    assert found.significant
    assert found.findings[0].cell.observable == LEVEL
    assert found.detectable == {LEVEL: 2.0}  # as the search of waveforms says it


@pytest.mark.parametrize(("weaker_db", "seen"), [(0.06, False), (0.6, True)])
def test_less_than_readings_tell_is_nothing(weaker_db: float, seen: bool) -> None:
    """However surely it would be seen, where levels hardly scatter."""
    search = _search(weaker_db, scatter_db=0.005)
    every = all_rows._of_all_rows(search, (LEVEL,))
    assert every is not None
    assert every.significant is seen
    assert _found(search).significant is seen


def test_waveforms_that_half_of_the_links_hide_are_seen_by_all() -> None:
    """Everything but ranges and levels; what half of the rows showed already stays."""
    search, found = _search(0.0), Located((), 1.0, 0.0, 3.0, 9, {})
    assert with_waveforms(search, found) is found
    ringing = Simulator(Base(), (PulseRinging(ring_db=-3.0),), 5, "test")
    made = ringing.observe(scene(search.both.frame), 5, 77).table(search.both.frame)
    search.both = view(made, link_codes(made), np.arange(LINKS), window_of(made))
    seen = with_waveforms(search, found)
    assert seen.significant
    assert not {one.cell.observable for one in seen.findings} & {RANGE, LEVEL}
    assert with_waveforms(search, seen) is seen


def test_what_was_found_stays() -> None:
    before = _found(_search(7.0))
    assert with_levels(_search(0.0), before) is before


def test_searches_of_waveforms_ranges_and_levels_share_one_error(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    asked: list[float] = []

    def heard(*given: Any) -> Located:
        asked.append(given[-1])
        return Located((), 1.0, 0.0, 3.0, 9, {})

    for module in (all_rows, stepwise):
        monkeypatch.setattr(module, "located_in", heard)
    search = _search(0.0)
    search.searched = search.both
    found = locate_left(search, (), 0, WAVES_SHARE)
    for step in (with_waveforms, with_ranges, with_levels):
        found = step(search, found)
    assert len(asked) == 4
    assert sum(asked) == pytest.approx(FAMILY_WISE)


def test_what_ranges_show_is_still_there_where_nothing_was_named(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The last search is that of the first: else 'nothing found' would stand beside a finding."""
    nothing = Located((), 0.14, 0.0, 3.0, 9, {})
    ranges = replace(nothing, findings=(SimpleNamespace(cell=SimpleNamespace(observable=RANGE)),))
    for name, made in (("locate_left", nothing), ("with_ranges", ranges), ("left_by", None)):
        monkeypatch.setattr(turn, name, lambda *_, made=made: made)
    monkeypatch.setattr(turn, "with_levels", lambda _, found: found)
    monkeypatch.setattr(turn, "_scattered", lambda _: ())
    state = State(_search(0.0), (), (Round(ranges, None, None),))
    last = turn._with_last(state, SimpleNamespace(kept=lambda made: made)).rounds[-1]  # type: ignore[arg-type]
    assert last.located is ranges
