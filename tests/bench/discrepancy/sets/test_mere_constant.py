"""A small constant of all ranges has no name; devices that differ, and large constants, have."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choice import MERE, Choice
from bench.discrepancy.sets.choose import chosen
from bench.discrepancy.sets.mere_constant import as_mere
from bench.recordings.table import Recordings
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


def heading(frame: pd.DataFrame) -> np.ndarray:
    """Return a heading that is any, and known from the distance."""
    return np.asarray(frame["true_range_m"].to_numpy(float) * 7919 % 360 - 180)


def headed(one: Recordings) -> Recordings:
    """Return a table with headings."""
    return replace(one, frame=one.frame.assign(azimuth_deg=heading(one.frame)))


def chest(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return a body behind a tag: right where it faces, 0.2 m late where it turns its back."""
    return 0.1 * (1 - np.cos(np.radians(heading(frame))))


def chest_and_delay(frame: pd.DataFrame, rng: np.random.Generator) -> np.ndarray:
    """Return the same beside a delay that is more than the pattern's mean."""
    return chest(frame, rng) + 0.25


@pytest.mark.parametrize(
    ("hidden", "names", "others"),
    [
        (alike, (), (MERE,)),
        (large, ("antenna-delay",), ()),
        (apart, ("antenna-delay",), ()),
        (chest, ("antenna-pattern",), (MERE,)),
        (chest_and_delay, ("antenna-delay", "antenna-pattern"), ()),
    ],
)
def test_a_small_constant_of_all_devices_has_no_name(
    hidden: object, names: tuple[str, ...], others: tuple[str, ...]
) -> None:
    turned = headed if hidden in (chest, chest_and_delay) else lambda one: one
    found = chosen(search_of(hidden, 4, turned), ())  # type: ignore[arg-type]
    assert (tuple(sorted(found.names)), found.others) == (names, others)


def test_beside_a_constant_scatter_is_asked_beside_a_law_it_is_not() -> None:
    assert Choice(others=(MERE,)).scattering == ()
    assert Choice(others=("a law of time_s", MERE)).scattering == ("a law of time_s",)


@pytest.mark.parametrize(
    ("fitted_m", "named"),
    [
        (0.014, False),
        (-0.014, False),
        (0.15, True),
        (0.0, True),
        ([0.01, 0.03, np.nan], True),
        ([-0.024, np.nan, -0.025], False),
        ([np.nan] * 3, True),
    ],
)
def test_a_name_that_comes_out_as_a_small_constant_is_none(
    fitted_m: float | list[float], named: bool
) -> None:
    """Beside late detection ranges spoke for 6 cm of delay, and 1.4 cm were left of it."""
    shifts_m = {"antenna-delay": np.full(3, 0.06), "temperature-drift": np.arange(3.0)}
    names = ("antenna-delay", "temperature-drift")
    before = Choice(names=names, shifts_m=shifts_m)
    fitted = {names[0]: np.broadcast_to(fitted_m, 3), names[1]: shifts_m[names[1]]}
    choice = as_mere(before, fitted)
    assert (choice.names, choice.others) == ((names, ()) if named else (names[1:], (MERE,)))
    assert set(choice.shifts_m) == {*choice.names, *choice.others}


def test_what_a_set_had_as_no_constant_leaves_none() -> None:
    """Of walls nobody listed a set made a ripple, and a user read of a constant everywhere."""
    before = Choice(
        names=("ground-bounce",), shifts_m={"ground-bounce": np.array([-0.1, 0.1, 0.2])}
    )
    choice = as_mere(before, {"ground-bounce": np.full(3, 0.01)})
    assert (choice.names, choice.others, dict(choice.shifts_m)) == ((), (), {})
