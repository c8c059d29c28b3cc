"""Periods of hundreds within the rows are found, of what comes at any time."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.material import material
from bench.discrepancy.law.search import propose

LINKS = np.repeat(np.arange(80), 8)


def swinging(seed: int, times: np.ndarray) -> tuple[pd.DataFrame, np.ndarray]:
    """Return rows at these times, and errors of a pendulum of 37.3 s in metres."""
    rng = np.random.default_rng(seed)
    frame = pd.DataFrame({"time_s": times, "true_range_m": rng.uniform(2, 20, len(times))})
    frame["error_m"] = 0.0
    swing = 0.05 * np.sin(2 * np.pi * times / 37.3)
    return frame, swing + rng.normal(0, 0.02, len(times))


def test_a_pendulum_over_hours_is_found() -> None:
    times = np.sort(np.random.default_rng(1).uniform(0, 4 * 3600, len(LINKS)))
    frame, error = swinging(2, times)
    found = propose(material(frame, error, LINKS), 0)
    assert found is not None
    assert (found.best.structure.form, found.best.structure.columns) == ("periodic", ("time_s",))
    constants = {one.name: one for one in found.constants}
    assert constants["period"].value == pytest.approx(37.3, rel=1e-3)
    assert constants["a"].value == pytest.approx(0.05, rel=0.1)


def test_rows_at_even_times_show_no_period_below_two_of_their_steps() -> None:
    frame, error = swinging(3, 30.0 * np.arange(len(LINKS)))
    found = propose(material(frame, error, LINKS), 0)
    periods = [one.value for one in found.constants if one.name == "period"] if found else []
    assert all(period > 60 for period in periods)


def test_noise_has_no_short_period() -> None:
    rng = np.random.default_rng(4)
    frame, _ = swinging(4, np.sort(rng.uniform(0, 4 * 3600, len(LINKS))))
    assert propose(material(frame, rng.normal(0, 0.03, len(LINKS)), LINKS), 0) is None
