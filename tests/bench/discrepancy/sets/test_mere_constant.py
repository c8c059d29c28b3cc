"""A small constant of all ranges has no name; devices that differ, and large constants, have."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choice import MERE, Choice
from bench.discrepancy.sets.choose import chosen
from tests.bench.discrepancy.sets.test_sets import search_of

LATE_M = 0.03


def alike(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return the same few centimetres in all ranges."""
    return np.full(len(frame), LATE_M)


def large(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return more than covers and detectors make."""
    return np.full(len(frame), 5 * LATE_M)


def apart(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Return the same in the mean, of devices that differ."""
    own = dict(zip([f"d{i}" for i in range(11)], rng.normal(0.0, 0.03, 11), strict=True))
    return LATE_M + (frame["tx"].map(own) + frame["rx"].map(own)).to_numpy(float)


@pytest.mark.parametrize(
    ("hidden", "names", "others"),
    [
        (alike, (), (MERE,)),
        (large, ("antenna-delay",), ()),
        (apart, ("antenna-delay",), ()),
    ],
)
def test_a_small_constant_of_all_devices_has_no_name(
    hidden: object, names: tuple[str, ...], others: tuple[str, ...]
) -> None:
    found = chosen(search_of(hidden, 4), ())  # type: ignore[arg-type]
    assert (found.names, found.others) == (names, others)


def test_beside_a_constant_scatter_is_asked_beside_a_law_it_is_not() -> None:
    assert Choice(others=(MERE,)).scattering == ()
    assert Choice(others=("a law of time_s", MERE)).scattering == ("a law of time_s",)
