"""Small geometries for the tests of the simulator."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bench.physics import Base, Outcome, Simulator
from bench.physics.effect import Effect
from bench.physics.scene import scene


def line(n: int = 512, far_m: float = 10.0, **columns: Any) -> pd.DataFrame:
    """Return rows of true range 1 .. `far_m` metres, four rows per link."""
    frame = pd.DataFrame({"true_range_m": np.linspace(1.0, far_m, n)})
    frame["link"] = [f"link-{row // 4}" for row in range(n)]
    return frame.assign(**columns)


def room(n: int = 512, size: tuple[float, float, float] = (5.0, 4.0, 2.8)) -> pd.DataFrame:
    """Return rows at random positions in a room."""
    rng = np.random.default_rng(5)
    frame = pd.DataFrame({"link": [f"link-{row // 4}" for row in range(n)]})
    for end in ("tx", "rx"):
        for axis, extent in zip("xyz", size, strict=True):
            frame[f"{end}_{axis}_m"] = rng.uniform(0.3, extent - 0.3, n)
    for axis, extent in zip("xyz", size, strict=True):
        frame[f"room_{axis}_m"] = extent
    ends = [frame[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy() for end in ("tx", "rx")]
    frame["true_range_m"] = np.linalg.norm(ends[0] - ends[1], axis=1)
    return frame[frame["true_range_m"] > 0.5].reset_index(drop=True)


def seen(frame: pd.DataFrame, *effects: Effect, base: Base | None = None, **how: Any) -> Outcome:
    """Return what a simulator with these effects reports for the rows."""
    return Simulator(base or Base(), effects, seed=1).observe(scene(frame), **how)


def change(frame: pd.DataFrame, *effects: Effect, **how: Any) -> tuple[Outcome, Outcome]:
    """Return the outcome with and without the last effect, on common random numbers."""
    return seen(frame, *effects, **how), seen(frame, *effects[:-1], **how)
