"""Faults of the set-up act in every row of a device, whichever end it is recorded at."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pandas as pd

from bench.discrepancy.sets.set_up import PLACE, PLACES, UNIT, of_setup
from bench.discrepancy.sets.settings import LAW_M, LAW_SCALE

MASTS_M = {"A": (0.0, 0.0, 3.0), "B": (20.0, 0.0, 3.0), "C": (0.0, 15.0, 3.0)}
ROWS = 360


def made(moved: str = "") -> pd.DataFrame:
    """Return rows of masts that range with a tag, at either end, and with each other.

    The mast `moved` has a place of its own where it is at rx.
    """
    rng = np.random.default_rng(3)
    tag = np.column_stack([rng.uniform(2, 18, ROWS), rng.uniform(2, 13, ROWS), np.full(ROWS, 1.0)])
    ends: dict[str, Any] = {"tx": [], "rx": []}
    for i in range(ROWS):
        mast, other = rng.choice([*MASTS_M], 2, replace=False)
        pair = [("tag", tag[i]), (mast, MASTS_M[mast])]
        if i % 6 == 0:
            pair = [(other, MASTS_M[other]), (mast, MASTS_M[mast])]
        for end, (name, place) in zip(ends, pair if i % 2 else pair[::-1], strict=True):
            far = np.array([9.0, 0, 0]) if name == moved and end == "rx" else 0.0
            ends[end].append((name, *(np.array(place) + far)))
    columns = {end: np.array(some, object) for end, some in ends.items()}
    frame = pd.DataFrame({end: some[:, 0] for end, some in columns.items()})
    for end, some in columns.items():
        for at, axis in enumerate("xyz", 1):
            frame[f"{end}_{axis}_m"] = some[:, at].astype(float)
    return frame


def true_m(frame: pd.DataFrame) -> np.ndarray[Any, np.dtype[np.float64]]:
    """Return the distance between both ends of rows, in metres."""
    ends = (frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy() for end in ("tx", "rx"))
    return np.asarray(np.linalg.norm(np.subtract(*ends), axis=1))


def blocks(frame: pd.DataFrame) -> dict[str, tuple[Any, ...]]:
    """Return the faults of rows."""
    view: Any = SimpleNamespace(frame=frame, scene=SimpleNamespace(true_range_m=true_m(frame)))
    return of_setup(view)


def test_a_device_that_stands_elsewhere_does_so_at_both_ends() -> None:
    frame, step = made(), np.array([0.01, -0.02, 0.0])
    elsewhere = frame.copy()
    for end in ("tx", "rx"):
        for axis, by in zip("xyz", step, strict=True):
            elsewhere[f"{end}_{axis}_m"] += by * (frame[end] == "B")
    way = blocks(frame)[f"{PLACE}B"][0] / LAW_M
    np.testing.assert_allclose(way @ step, true_m(elsewhere) - true_m(frame), atol=1e-4)
    own = blocks(frame)[f"{UNIT}B"][0][:, 0] / LAW_SCALE
    both = (frame["tx"] == "B") | (frame["rx"] == "B")
    np.testing.assert_allclose(own, true_m(frame) * both)


def test_two_devices_are_swapped_at_both_ends_and_as_far_apart() -> None:
    frame = made()
    swapped = frame.copy()
    for end in ("tx", "rx"):
        for one, other in (("A", "B"), ("B", "A")):
            for axis, place in zip("xyz", MASTS_M[other], strict=True):
                swapped.loc[frame[end] == one, f"{end}_{axis}_m"] = place
    key = next(one for one in blocks(frame) if one in (f"{PLACES}A and B", f"{PLACES}B and A"))
    shift_m = blocks(frame)[key][0][:, 0]
    np.testing.assert_allclose(shift_m, true_m(swapped) - true_m(frame), atol=1e-9)
    between = (frame["tx"].isin(["A", "B"])) & (frame["rx"].isin(["A", "B"]))
    assert between.any()
    assert not shift_m[between].any()


def test_a_name_that_stands_in_two_places_is_two_devices() -> None:
    frame = made("C")
    way = blocks(frame)[f"{PLACE}C"][0]
    assert not way[(frame["tx"] == "C").to_numpy()].any()
    assert way[(frame["rx"] == "C").to_numpy()].any()
