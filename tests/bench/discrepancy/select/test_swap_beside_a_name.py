"""Swapped anchors beside a cause of the library are said, whatever scores make of them."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

import bench

ANCHORS_M = np.array([[1.0, 1, 8], [1, 16, 7.8], [30, 1, 7.5], [30, 16, 8], [15, 8, 7.9]])
SWAPPED = np.array([0, 1, 2, 4, 3])


def walks(seed: int, lag_s: float, swapped: bool) -> pd.DataFrame:
    """Return ranges of a tag that walks 40 lines before five anchors at 1.5 m/s; SIMULATED."""
    draw = np.random.default_rng(8)
    begin, heading = draw.uniform([3, 3], [27, 13], (40, 2)), draw.uniform(0, 2 * np.pi, 40)
    rng = np.random.default_rng(seed)
    line, at, anchor = (
        g.ravel() for g in np.meshgrid(range(40), range(5), range(5), indexing="ij")
    )
    time_s = 20.0 * line + 0.2 * at
    way = np.stack([np.cos(heading), np.sin(heading)], axis=1)[line]

    def tag(time_s: np.ndarray) -> np.ndarray:
        flat = begin[line] + 1.5 * (time_s - 20.0 * line)[:, None] * way
        return np.column_stack([flat, np.full(len(flat), 1.2)])

    def away(time_s: np.ndarray, anchor: np.ndarray) -> np.ndarray:
        return np.linalg.norm(tag(time_s) - ANCHORS_M[anchor], axis=1)

    really = SWAPPED[anchor] if swapped else anchor
    range_m = away(time_s + lag_s, really) + rng.normal(0, 0.03, len(line))
    ends = {"tx": tag(time_s), "rx": ANCHORS_M[anchor]}
    places = {f"{end}_{x}_m": ends[end][:, i] for end in ends for i, x in enumerate("xyz")}
    return pd.DataFrame(
        {"link": [f"{n}-A{a}" for n, a in zip(line, anchor, strict=True)], "tx": "tag",
         "rx": [f"A{a}" for a in anchor], "time_s": time_s, "range_m": range_m,
         "true_range_m": away(time_s, anchor), **places}
    )  # fmt: skip


@pytest.mark.filterwarnings("ignore")
def test_swapped_anchors_are_said_beside_a_lag() -> None:
    found = bench.diagnose(walks(1, 0.1, True), walks(2, 0.0, False))
    assert "time-lag" in found.headline
    assert "A3 and A4" in found.headline
