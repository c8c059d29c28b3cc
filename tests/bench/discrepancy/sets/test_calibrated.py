"""A constant that makes the mean of ranges nothing is a calibration's, no delay of antennas."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench
from bench.discrepancy.sets.calibrated import TAKEN_OFF
from bench.discrepancy.sets.choose import chosen
from tests.bench.discrepancy.numpy_tables import tables
from tests.bench.discrepancy.sets.test_sets import search_of


def scaled(frame: pd.DataFrame) -> np.ndarray:
    return 0.01 * frame["true_range_m"].to_numpy(float)


def calibrated(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Devices that count too long, of whose ranges the mean error was taken off."""
    return scaled(frame) - scaled(frame).mean()


def late(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    return scaled(frame) - 2 * scaled(frame).mean()


@pytest.mark.parametrize(
    ("hidden", "names", "others"),
    [
        (calibrated, ("range-scale",), (TAKEN_OFF,)),
        (late, ("antenna-delay", "range-scale"), ()),
    ],
)
def test_the_mean_that_was_taken_off_is_no_delay(
    hidden: object, names: tuple[str, ...], others: tuple[str, ...]
) -> None:
    found = chosen(search_of(hidden, 5), ())  # type: ignore[arg-type]
    assert (found.names, found.others) == (names, others)


@pytest.mark.filterwarnings("ignore")
def test_a_scale_is_named_though_ranges_are_farther_off_with_it_alone() -> None:
    """Held-out ranges were judged without the constant, so that the scale made them worse."""
    found = bench.diagnose(*tables(5, calibrated))
    assert found.selection.names == (("range-scale",),)
