"""Where nothing stands out, what rounds ranges is put in before scatter of rows is asked for."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select import last_round as rounds
from bench.discrepancy.select.last_round import last_round
from bench.discrepancy.select.scatter_alone import scatter_beside
from bench.discrepancy.select.state import Round, Search, State
from bench.physics.effect import Effect
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

STEPS_M = (0.07, 0.0425)  # of two makes of devices
KINDS: dict[str, type[Effect]] = {
    "range-rounding": RangeRounding,
    "timestamp-jitter": TimestampJitter,
}


def finished(rounded: bool, late_m: float = 0.0, scatter_m: float = 0.036) -> State:
    """Return the state after a last round, of one simulated row for each recorded one.

    `late_m`: by how much ranges of every other device are longer, and of the rest shorter.
    `scatter_m`: of recorded ranges; that of simulated ones is 0.02 m.
    """
    rng, link = np.random.default_rng(3), np.repeat(np.arange(80), 4)
    make = link % 6
    true, step = rng.uniform(3, 20, len(link)), np.array(STEPS_M)[make % 2]

    def measured(noise_m: float, to_grid: bool) -> pd.DataFrame:
        range_m = true + noise_m * rng.normal(size=len(link))
        range_m = np.rint(range_m / step) * step if to_grid else range_m
        own = {"link": [f"l{i}" for i in link], "rx": [f"a{i}" for i in make], "true_range_m": true}
        return pd.DataFrame({**own, "range_m": range_m, "error_m": range_m - true})

    noise_m = 0.02 if rounded or late_m else scatter_m
    recorded, simulated = measured(noise_m, rounded), measured(0.02, False)
    for column in ("range_m", "error_m"):
        recorded[column] += np.where(make % 2, late_m, -late_m)
    rows = view(recorded, link_codes(recorded), np.arange(len(link)), Window(), None, False)
    search = Search(TableComparison(simulated, Window()), rows, rows, KINDS, 0, work=rows)
    return last_round(State(search), Located((), 1.0, 0.0, 1.0, 1, {}), Journal())


def test_rounding_is_put_in_before_scatter_is_asked_for() -> None:
    state = finished(rounded=True)
    assert [effect.name for effect in state.added] == ["range-rounding"]
    assert not state.finished


def test_scatter_of_rows_that_bear_no_mark_is_said() -> None:
    state = finished(rounded=False)
    assert state.finished
    assert [turn.strike.effect.name for turn in state.rounds if turn.strike] == ["timestamp-jitter"]


def test_scatter_alone_that_chance_may_make_is_not_named(monkeypatch: pytest.MonkeyPatch) -> None:
    """Six nats are enough beside other names; alone it must be as sure as any name is there."""
    asked: list[float] = []

    def found(*given: Any) -> Round | None:
        turn = scatter_beside(*given)
        asked.extend([turn.strike.evidence.value] if turn and turn.strike else [])
        return turn

    monkeypatch.setattr(rounds, "scatter_beside", found)
    state = finished(rounded=False, scatter_m=0.0262)
    assert len(asked) == 1
    assert asked[0] < 12
    assert state.finished
    assert not any(turn.strike for turn in state.rounds)


def test_causes_that_ranges_speak_for_beyond_doubt_need_no_place_that_stands_out() -> None:
    state = finished(rounded=False, late_m=0.03)
    assert [effect.physics for effect in state.added] == ["antenna-delay"]
    assert not state.finished
