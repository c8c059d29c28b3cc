"""Links struck by metres beside walls that delay every link behind them by a little."""

from __future__ import annotations

import numpy as np
import pandas as pd

import bench
from bench.recordings.table import Recordings

LINKS, EACH = 110, 4


def _tables(seed: int) -> tuple[Recordings, Recordings]:
    """Return ranges behind brick in 45 of 110 links, half of these struck; own numpy, SIMULATED."""
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(LINKS), EACH)
    walled = rng.permutation(LINKS) < 45
    far = rng.uniform(3, 40, LINKS)[link]
    frame = pd.DataFrame({"link": [f"l{i}" for i in link], "true_range_m": far})
    frame["tx"], frame["rx"] = [f"a{i % 11}" for i in link], [f"t{i // 11}" for i in link]
    frame["obstacles"] = [["brick"] if walled[i] else [] for i in link]
    frame["los"] = ~walled[link]
    frame["reply_time_s"] = rng.choice([3e-4, 9e-4], len(link))
    detour = np.where(walled & (rng.random(LINKS) < 0.5), 0.6 + rng.exponential(3.5, LINKS), 0.0)
    hidden = (0.14 * walled + detour)[link] + 0.008 * far

    def made(more: np.ndarray) -> pd.DataFrame:
        error = more + rng.normal(0, 0.03, len(link))
        return frame.assign(error_m=error, range_m=far + error)

    simulated = pd.concat([made(0 * hidden) for _ in range(4)], ignore_index=True)
    return Recordings(made(hidden), "own"), Recordings(simulated, "other", simulator="own")


def test_walls_blocked_paths_and_a_scale_are_named_without_levels() -> None:
    found = bench.diagnose(*_tables(3))
    assert sorted(found.selection.names) == [
        ("blocked-path",),
        ("material-delay",),
        ("range-scale",),
    ]
    assert "needs rx_power_dbm" in found.selection.skipped["power-bias"]  # a curve over distance
    assert "needs rx_power_dbm" in found.selection.skipped["path-loss"]
