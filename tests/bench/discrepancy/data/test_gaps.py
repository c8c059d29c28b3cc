"""What is not known in some rows is no value, and no reason to stop."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.data.gaps import gap_words, with_temperatures


def table(seed: int, slope_m_per_c: float = 0.0) -> pd.DataFrame:
    """Return ranges of 60 links through a day that warms up; SIMULATED."""
    rng = np.random.default_rng(seed)
    rows = np.repeat(np.arange(60), 5)
    time_s = np.arange(300) * 10.0
    warm_c = 15 + 10 * np.sin(time_s / 1000) + rng.normal(0, 0.1, 300)
    true_m = rng.uniform(3, 18, 60)[rows]
    range_m = true_m + slope_m_per_c * (warm_c - 20) + rng.normal(0, 0.03, 300)
    return pd.DataFrame(
        {"link": [f"L{n}" for n in rows], "time_s": time_s, "temperature_c": warm_c,
         "true_range_m": true_m, "range_m": range_m}
    )  # fmt: skip


def with_gaps(frame: pd.DataFrame) -> pd.DataFrame:
    """Return the table without a third of its temperatures."""
    lost = np.random.default_rng(5).random(len(frame)) < 0.3
    return frame.assign(temperature_c=frame["temperature_c"].mask(lost))


def test_a_temperature_is_that_of_the_rows_before_and_after() -> None:
    frame = table(1)
    filled = with_temperatures(with_gaps(frame))["temperature_c"]
    assert np.abs(filled - frame["temperature_c"]).max() < 0.6
    assert "taken from the rows before and after" in gap_words(with_gaps(frame))[0]
    assert not gap_words(frame)


def test_a_temperature_that_time_does_not_tell_stays_unknown() -> None:
    frame = table(1).assign(temperature_c=np.random.default_rng(2).uniform(0, 40, 300))
    assert with_temperatures(with_gaps(frame))["temperature_c"].isna().any()
    assert "25 degrees" in gap_words(with_gaps(frame))[0]


@pytest.mark.filterwarnings("ignore")
def test_a_drift_is_found_though_a_third_of_the_temperatures_lack() -> None:
    found = bench.diagnose(with_gaps(table(1, 0.01)), table(2))
    assert found.headline.startswith("Left out: temperature-drift.")
    assert any("temperature_c is not known" in line for line in found.counted)


@pytest.mark.filterwarnings("ignore")
def test_a_sight_that_is_not_known_of_some_rows_is_no_category() -> None:
    ours, theirs = table(1), table(2)
    ours["los"] = pd.array([True, False, None] * 100, "boolean")
    assert not bench.diagnose(ours, theirs.assign(los=True, link=theirs["link"] + "s")).law


@pytest.mark.filterwarnings("ignore")
def test_copies_of_rows_are_counted() -> None:
    ours = table(1)
    doubled = pd.concat([ours, ours.iloc[:12]]).sort_values("time_s", ignore_index=True)
    assert any(
        "12 recorded rows are copies" in line for line in bench.diagnose(doubled, table(2)).counted
    )
