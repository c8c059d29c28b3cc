"""What goes round has harmonics; a tilt that never does has steps and lines like any number."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.material import material
from bench.discrepancy.law.meaning import looks_like
from bench.discrepancy.law.screen import promising

ROWS = 240
PLACES = [f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xyz"]


@pytest.mark.parametrize(
    ("column", "low", "high", "round_"),
    [
        ("flap_deg", 0.0, 80.0, False),
        ("tilt_rad", -0.4, 0.9, False),
        ("turn_deg", 0.0, 300.0, True),
        ("azimuth_deg", 0.0, 80.0, True),
    ],
)
def test_angles_of_less_than_half_a_turn_do_not_go_round(
    column: str, low: float, high: float, round_: bool
) -> None:
    rng = np.random.default_rng(0)
    value = rng.uniform(low, high, ROWS)
    left_m = 0.1 * (value > (low + high) / 2) + rng.normal(0, 0.02, ROWS)
    every = material(pd.DataFrame({column: value}), left_m, np.arange(ROWS) // 5)
    laws = promising(every, float(ROWS))
    best = max(laws, key=lambda law: law.fitted(every).fit.likelihood)
    assert ("sin(" in best.expression) is round_
    assert best.expression.startswith(f"a * ({column} > x0)") is not round_


def _headed(bearing_off_rad: np.ndarray | None) -> pd.DataFrame:
    """Return rows of antennas anywhere in a plane that head anywhere, or as far off the other."""
    rng = np.random.default_rng(4)
    frame = pd.DataFrame(rng.uniform(0, 9, (ROWS, 6)), columns=PLACES)
    gap = frame[["rx_y_m", "rx_x_m"]].to_numpy() - frame[["tx_y_m", "tx_x_m"]].to_numpy()
    heading = rng.uniform(0, 360, ROWS)
    if bearing_off_rad is not None:
        heading = np.degrees(np.arctan2(gap[:, 0], gap[:, 1]) + bearing_off_rad) % 360
    return frame.assign(azimuth_deg=heading)


def test_an_antenna_off_the_centre_that_turns_follows_heading_and_bearing() -> None:
    frame = _headed(None)
    gap = frame[["rx_y_m", "rx_x_m"]].to_numpy() - frame[["tx_y_m", "tx_x_m"]].to_numpy()
    off = np.radians(frame["azimuth_deg"]) - np.arctan2(gap[:, 0], gap[:, 1])
    left_m = -0.15 * np.cos(off).to_numpy() + np.random.default_rng(1).normal(0, 0.02, ROWS)
    every = material(frame, left_m, np.arange(ROWS) // 5)
    best = max(promising(every, float(ROWS)), key=lambda law: law.fitted(every).fit.likelihood)
    assert "azimuth_deg - atan2(rx_y_m - tx_y_m, rx_x_m - tx_x_m)" in best.expression
    assert "lever arm" in looks_like(best)


def test_headings_that_are_bearings_are_no_other_covariate() -> None:
    noise = np.random.default_rng(2).normal(0, 0.05, ROWS)
    for off, asked in ((None, True), (noise, False), (noise + 1.2, False)):
        every = material(_headed(off), noise, np.arange(ROWS) // 5)
        assert any("heading off" in one.words for one in every.columns) is asked


@pytest.mark.parametrize(("places", "asked"), [(3, False), (7, False), (60, True)])
def test_few_times_show_no_period(places: int, asked: bool) -> None:
    rng = np.random.default_rng(3)
    frame = pd.DataFrame({"reply_time_s": rng.choice(np.linspace(1e-3, 4e-3, places), ROWS)})
    every = material(frame, rng.normal(0, 0.02, ROWS), np.arange(ROWS) // 5)
    laws = promising(every, float(ROWS))
    assert any("sin(" in law.expression for law in laws) is asked
