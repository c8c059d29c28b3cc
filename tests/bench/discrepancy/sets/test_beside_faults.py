"""Delays are fitted beside a device that stands elsewhere, not instead of it."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench

CORNERS_M = np.array([[0.0, 0, 2.6], [14.0, 0, 2.5], [14.0, 9, 2.4], [0.0, 9, 2.7], [7.0, 0, 2.6]])


def hall(
    seed: int, each: int, moved_m: tuple[float, float] = (0, 0), late_m: float = 0
) -> pd.DataFrame:
    """Return ranges of two tags to five corners: A3 hangs elsewhere, A0 is late; SIMULATED."""
    places = np.random.default_rng(5).uniform([1, 1, 1.0], [13, 8, 1.4], (40, 3))
    rng, really = np.random.default_rng(seed), CORNERS_M.copy()
    really[3, :2] += moved_m
    place, corner = (one.ravel() for one in np.meshgrid(np.arange(40), np.arange(5)))
    place, corner = np.repeat(place, each), np.repeat(corner, each)
    true_m, is_m = (
        np.linalg.norm(places[place] - of[corner], axis=1) for of in (CORNERS_M, really)
    )
    ends = {"tx": places[place], "rx": CORNERS_M[corner]}
    at = {f"{end}_{axis}_m": ends[end][:, i] for end in ends for i, axis in enumerate("xyz")}
    return pd.DataFrame(
        {"link": [f"A{c}-P{p}" for c, p in zip(corner, place, strict=True)],
         "tx": [f"T{p % 2}" for p in place], "rx": [f"A{c}" for c in corner],
         "range_m": is_m + late_m * (corner == 0) + rng.normal(0, 0.025, len(true_m)),
         "true_range_m": true_m, **at}
    )  # fmt: skip


@pytest.mark.filterwarnings("ignore")
def test_a_late_device_beside_one_that_stands_elsewhere() -> None:
    """The last fit had given that one a delay of its own, and a sine was said of what that left.

    And as far off as that its links had taken no part, from the moment they were asked of as such.
    """
    found = bench.diagnose(hall(1, 4, (0.35, -0.25), 0.1), hall(2, 8))
    assert found.setup_fault is not None
    assert found.setup_fault.devices == ("A3",)
    assert found.selection.names == (("antenna-delay",),)
    (late,) = (one for one in found.added if one.physics == "antenna-delay")
    assert late.values()["delay_ns[A0]"] == pytest.approx(0.1 / 0.15, abs=0.2)
    assert late.values()["delay_ns[A3]"] == pytest.approx(0.0, abs=0.5)
