"""Delays are constants: what a device has in other sizes in every link is none."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choose import chosen
from bench.discrepancy.sets.steady import CHANGING
from tests.bench.discrepancy.sets.test_sets import search_of


def delays(frame: pd.DataFrame) -> np.ndarray:
    """Return a delay of every receiver [n], in metres, of either sign."""
    sizes_m = (0.4, -0.03, 0.3, -0.35, 0.02, -0.12)
    own = dict(zip([f"d{i}" for i in range(5, 11)], sizes_m, strict=True))
    return frame["rx"].map(own).to_numpy(float)


def by_link(frame: pd.DataFrame, values: np.ndarray) -> np.ndarray:
    """Return values of links as values of rows [n]."""
    return values[pd.factorize(frame["link"])[0]]


def constant_delays(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Delays, and beside them offsets that links keep, whatever their devices."""
    return delays(frame) + by_link(frame, rng.normal(0, 0.09, len(frame)))


def since_set(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Clocks that are off by the more the longer ago they were set right, links at any time."""
    return 1.4 * delays(frame) * by_link(frame, rng.uniform(0, 1, len(frame)))


@pytest.mark.parametrize(
    ("hidden", "names", "others"),
    [
        (lambda frame, _: delays(frame), ("antenna-delay",), ()),
        (constant_delays, ("antenna-delay",), ()),
        (since_set, (), (CHANGING,)),
    ],
)
def test_delays_that_change_from_link_to_link_are_none(
    hidden: object, names: tuple[str, ...], others: tuple[str, ...]
) -> None:
    found = chosen(search_of(hidden, 5), ())  # type: ignore[arg-type]
    assert (found.names, found.others) == (names, others)
