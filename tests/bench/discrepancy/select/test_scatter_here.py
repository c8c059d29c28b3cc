"""Simulated scatter is compared at recorded levels, and rows count as often as they are free."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.own_draws import free_of, free_share
from bench.discrepancy.select.scatter_alone import of_forms
from bench.discrepancy.select.scatter_size import as_here, beside_simulated, variances
from bench.discrepancy.select.state import Search
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.units import Floats

LINK = np.repeat(np.arange(100), 4)


def test_weak_rows_scatter_as_simulated_ones_of_their_level_do() -> None:
    rng = np.random.default_rng(3)
    level = rng.uniform(-95, -75, (2, 4000))
    level[0] -= 3  # recorded rows are weaker
    wide = 0.02 * np.sqrt(1 + 10 ** ((-88 - level) / 10))
    made = as_here(wide[1:] * rng.normal(size=(1, 4000)), level)
    inside = level[0] > -95  # weaker than any simulated row nothing is known
    assert made[0, inside].std() == pytest.approx(np.sqrt((wide[0, inside] ** 2).mean()), rel=0.05)
    even = 0.02 * rng.normal(size=(1, 4000))
    assert as_here(even, level).std() == pytest.approx(0.02, rel=0.05)
    unknown = np.full((2, 4000), np.nan)
    np.testing.assert_array_equal(as_here(even, unknown), even)


def table(rng: np.random.Generator, name: str, weaker_db: float) -> pd.DataFrame:
    """Return rows of which weak ones scatter more."""
    level = rng.uniform(-92, -78, 100)[LINK] - weaker_db
    wide = 0.02 * np.sqrt(1 + 10 ** ((-82 - level) / 10))
    return pd.DataFrame(
        {
            "link": [f"{name}{i}" for i in LINK],
            "true_range_m": rng.uniform(3, 20, 100)[LINK] + rng.uniform(-0.3, 0.3, len(LINK)),
            "error_m": wide * rng.normal(size=len(LINK)),
            "rx_power_dbm": level,
        }
    )


def searched(recorded: pd.DataFrame, simulated: pd.DataFrame) -> Search:
    seen = seen_rows(recorded)
    kinds = {TimestampJitter.name: TimestampJitter}
    return Search(TableComparison(simulated, Window()), seen, seen, kinds, 0, work=seen)


def seen_rows(recorded: pd.DataFrame) -> View:
    return view(recorded, link_codes(recorded), np.arange(len(recorded)), Window(), None, False)


def test_weaker_recordings_scatter_by_no_more_than_simulated_ones() -> None:
    rng = np.random.default_rng(5)
    search = searched(table(rng, "l", 3.0), table(rng, "o", 0.0))
    _, recorded, simulated = beside_simulated(search, ())
    spread, extra = variances(recorded, simulated)
    assert abs(extra) < 0.4 * spread


def test_rows_of_a_link_are_free_but_for_its_mean() -> None:
    known = np.ones(len(LINK), bool)
    assert free_share(LINK, known).sum() == pytest.approx(300)
    known[::4] = False
    shares: Floats = free_share(LINK, known)
    assert shares.sum() == pytest.approx(200)
    assert not shares[~known].any()


def test_a_simulated_row_that_stands_for_many_is_one() -> None:
    rng = np.random.default_rng(6)
    recorded, simulated = table(rng, "l", 0.0), table(rng, "o", 0.0).iloc[:80]
    made = searched(recorded, simulated)
    assert made.work is not None
    every = np.zeros((8, len(LINK)))
    assert free_of(made.comparison, made.work, every) <= 60


def test_causes_of_another_form_scatter_by_a_share_of_what_they_do_within_links() -> None:
    """Rows of a link are metres apart, and a scale may be off by a third of what it does."""
    rng = np.random.default_rng(7)
    table_m = table(rng, "l", 0.0)
    table_m["true_range_m"] = rng.uniform(8, 20, 100)[LINK] + rng.uniform(-3, 3, len(LINK))
    search = searched(table_m, table_m)
    wide_m2 = of_forms(search, (RangeScale(scale=0.05),))
    assert wide_m2 == pytest.approx((0.3 * 0.05) ** 2 * 3, rel=0.2)
    assert of_forms(search, (AntennaDelay(delay_ns=0.5),)) == pytest.approx(0, abs=1e-9)
