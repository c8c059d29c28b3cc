"""Where nothing stands out, what rounds ranges is put in before scatter of rows is asked for."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.locate.permutation_test import Located
from bench.discrepancy.select.last_round import last_round
from bench.discrepancy.select.state import Search, State
from bench.physics.effect import Effect
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

STEPS_M = (0.07, 0.0425)  # of two makes of devices
KINDS: dict[str, type[Effect]] = {
    "range-rounding": RangeRounding,
    "timestamp-jitter": TimestampJitter,
}


def finished(rounded: bool) -> State:
    """Return the state after a last round, of one simulated row for each recorded one."""
    rng, link = np.random.default_rng(3), np.repeat(np.arange(80), 4)
    make = link % 6
    true, step = rng.uniform(3, 20, len(link)), np.array(STEPS_M)[make % 2]

    def measured(noise_m: float, to_grid: bool) -> pd.DataFrame:
        range_m = true + noise_m * rng.normal(size=len(link))
        range_m = np.rint(range_m / step) * step if to_grid else range_m
        own = {"link": [f"l{i}" for i in link], "rx": [f"a{i}" for i in make], "true_range_m": true}
        return pd.DataFrame({**own, "range_m": range_m, "error_m": range_m - true})

    recorded, simulated = measured(0.02 if rounded else 0.036, rounded), measured(0.02, False)
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
