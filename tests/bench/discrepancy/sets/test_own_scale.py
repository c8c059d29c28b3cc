"""A scale that differs by device passes for delays of devices, and delays for none."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choose import Contest, _contest
from bench.discrepancy.sets.own_scale import scales_for_delays, without_scales
from tests.bench.discrepancy.numpy_tables import Hidden
from tests.bench.discrepancy.sets.test_sets import both, search_of

DELAY, SCALE = "antenna-delay", "range-scale"


def of_devices(frame: pd.DataFrame) -> np.ndarray:
    """Return the sum of what both devices of every row have of their own [n], about 1."""
    sizes = np.random.default_rng(7).normal(size=11)
    own = dict(zip([f"d{i}" for i in range(11)], sizes, strict=True))
    return frame["tx"].map(own).to_numpy(float) + frame["rx"].map(own).to_numpy(float)


def own_scales(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return 4 mm per metre, and of every device as much of its own, in metres."""
    return (0.004 + 0.003 * of_devices(frame)) * frame["true_range_m"].to_numpy()


def delays(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return a delay of every device, and one of all, in metres."""
    return 0.05 + 0.06 * of_devices(frame)


def contest_of(hidden: Hidden) -> Contest:
    """Return the contest of all causes on tables that differ by what is hidden."""
    made = _contest(search_of(hidden, 4), ())
    assert made is not None
    return made[0]


@pytest.mark.parametrize(("hidden", "others"), [(own_scales, (SCALE,)), (delays, ())])
def test_a_scale_that_differs_by_device_is_a_rival_of_delays(
    hidden: Hidden, others: tuple[str, ...]
) -> None:
    assert scales_for_delays(contest_of(hidden), (DELAY,)) == others


@pytest.mark.parametrize(("hidden", "left"), [(own_scales, (SCALE,)), (both, (DELAY, SCALE))])
def test_delays_beside_a_scale_are_more_than_devices_may_differ_by(
    hidden: Hidden, left: tuple[str, ...]
) -> None:
    assert without_scales(contest_of(hidden), (DELAY, SCALE)) == left
