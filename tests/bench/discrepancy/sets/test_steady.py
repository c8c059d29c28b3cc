"""Delays are constants: what a device has in other sizes in every link is none."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.sets.choose import chosen
from bench.discrepancy.sets.steady import CHANGING
from bench.recordings.table import Recordings
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


def with_detours(given: Recordings) -> Recordings:
    """Return a table of which a third of the links, out of sight, are longer by ways of their own.

    On either side of a comparison by another length.
    """
    codes = pd.factorize(given.frame["link"])[0]
    cut = np.random.default_rng(1).random(codes.max() + 1) < 0.3
    way = np.random.default_rng(len(given.frame)).exponential(0.3, len(cut))
    longer = np.where(cut, way, 0.0)[codes]
    frame = given.frame.assign(los=~cut[codes], error_m=given.frame["error_m"] + longer)
    frame = frame.assign(range_m=frame["range_m"] + longer)
    return Recordings(frame, given.source, simulator=given.simulator)


@pytest.mark.parametrize("seed", [1, 5])
def test_links_out_of_sight_do_not_say_that_delays_change(seed: int) -> None:
    """Some happen to be off by as much more as their devices are late."""

    def late(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
        return frame["rx"].map({"d5": 0.12, "d8": -0.08}).fillna(0.0).to_numpy(float)

    found = chosen(search_of(late, seed, with_detours), ())
    assert found.names == ("antenna-delay",)
    assert CHANGING not in found.others


def test_what_constant_delays_do_is_no_change_from_link_to_link() -> None:
    """Beside delays that each link has more or less of, either may say what both can."""
    devices, rng = np.arange(60) % 3, np.random.default_rng(3)
    constant = (devices[:, None] == np.arange(3)).astype(float)
    by_links = 0.002 * rng.normal(size=60)
    left = rest_of(constant @ [0.4, -0.2, 0.1] + by_links, constant)
    assert np.abs(left - by_links).max() < 0.002
    assert np.allclose(left @ constant, 0.0)
