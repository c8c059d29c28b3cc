"""Blind cases: the simulator under diagnosis, its recordings with something hidden, and the way."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.generator.conceal import Concealed, Hidden, conceal, draw_case
from bench.challenge.generator.geometry import geometry
from bench.physics.base import Base
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.units import C_M_PER_NS
from bench.recordings.table import SAMPLE_PERIOD_NS, Recordings

Floats = NDArray[np.float64]
Way = Literal["resimulated", "paired table", "unpaired table"]
WAYS: tuple[Way, ...] = ("resimulated", "paired table", "resimulated", "unpaired table")
REPLICAS = 16  # of every row in a simulated table
SEARCHED_SHARE = 0.75  # of the links where ranges alone are compared: all but the confirm links
# A test that knows the shape of the effect but pays for a search needs about 4 + 1.3 standard
# deviations for 90 % power; the search's cells are not the shape, which costs about a third.
LIMIT_Z = 8.0


@dataclass(frozen=True)
class Case:
    """One case: what is hidden, the recorded table, the simulated side, the truth."""

    number: int
    hidden: Hidden
    way: Way
    recorded: Recordings
    simulated: Simulator | Recordings
    concealed: Concealed

    @property
    def strength_z(self) -> float:
        """Matched-filter signal-to-noise ratio of the weakest hidden effect on the searched links.

        Of a test that knows the exact shape of each effect, with the other one projected out.
        0 where nothing is hidden.
        """
        if not self.hidden.names:
            return 0.0
        error = self.recorded.frame["error_m"].to_numpy(np.float64)
        ones = [np.ones(len(error))] if self.hidden.conceal == "aggregate" else []
        design = np.stack([*self.concealed.shifts_m, *ones], axis=1)
        found = np.linalg.lstsq(design, error, rcond=None)[0]
        noise = float(np.std(error - design @ found))
        alone = np.linalg.inv(design.T @ design + 1e-12 * np.eye(design.shape[1]))
        z = np.abs(found) / (noise * np.sqrt(np.diag(alone)))
        return float(z[: len(self.hidden.names)].min() * np.sqrt(SEARCHED_SHARE))

    @property
    def above_limit(self) -> bool:
        """True where the weakest hidden effect is above the detection limit."""
        return self.strength_z >= LIMIT_Z


def simulator_of(hidden: Hidden, seed: int) -> Simulator:
    """Return the simulator under diagnosis: the base with its jitter."""
    samples = hidden.jitter_m / (C_M_PER_NS * SAMPLE_PERIOD_NS)
    return Simulator(Base(), (TimestampJitter(jitter_samples=samples),), seed, "challenge")


def make_case(number: int, seed: int) -> Case:
    """Return case `number` of a challenge; deterministic from both."""
    hidden = draw_case(number, seed)
    way = WAYS[(number // 3) % len(WAYS)]
    base = simulator_of(hidden, 7)
    own = seed * 10_000 + number
    frame = geometry(own, hidden.rare)
    concealed = conceal(_simulated(base, frame, 1000 + number), hidden, own)
    recorded = Recordings(
        concealed.table.drop(columns="clock_offset_ppm", errors="ignore"), f"case {number}"
    )
    simulated = base if way == "resimulated" else _table(base, frame, hidden, way, number, own)
    return Case(number, hidden, way, recorded, simulated, concealed)


def _table(
    base: Simulator, frame: pd.DataFrame, hidden: Hidden, way: Way, number: int, own: int
) -> Recordings:
    """Return the simulated table: of the same links, or of other links that share no name."""
    rows = frame if way == "paired table" else geometry(own + 5000, hidden.rare)
    made = pd.concat([_simulated(base, rows, 2000 + number + i) for i in range(REPLICAS)])
    if way == "unpaired table":
        made["link"] = "other " + made["link"].astype(str)
    shown = made.drop(columns="_rare").reset_index(drop=True)
    return Recordings(shown, "simulated", simulator="challenge")


def _simulated(base: Simulator, frame: pd.DataFrame, seed: int) -> pd.DataFrame:
    """Return the frame with simulated ranges, from the paths alone."""
    return base.observe(scene(frame), seed, cir=False).table(frame)
