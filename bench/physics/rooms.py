"""The simulated default data: three rooms, an open place and a wall, out of physics alone.

The simulator is `rooms.toml` beside this file; the plan of rooms and obstacles is in `room_plan`.
"""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from bench.physics.room_geometry import room_geometry
from bench.physics.room_plan import ROW_TOTAL
from bench.physics.simulator import Simulator
from bench.physics.toml_file import read_toml, to_toml
from bench.provenance import json_digest, package_version, packages_code_hash
from bench.recordings.table import Recordings

_HERE = Path(__file__).parent
LICENCE = "Apache-2.0 (simulated by uwb-bench)"


class Rooms:
    """The `rooms` simulator with a geometry of its own; SIMULATED, reproducible from a seed."""

    def __init__(self, seed: int | None = None) -> None:
        read = read_toml(_HERE / "rooms.toml")
        self.simulator: Simulator = read if seed is None else replace(read, seed=seed)

    def generate(self, rows: int = ROW_TOTAL) -> Recordings:
        """Return 55 000 simulated recordings, or `rows` of the same mixture."""
        geometry = room_geometry(np.random.default_rng(self.simulator.seed), rows)
        return replace(self.simulator.simulate(geometry), licence=LICENCE)

    def key(self) -> str:
        """Return 20 hex digits that change with simulator, seed, code and numerical libraries."""
        versions = {library: package_version(library) for library in ("numpy", "scipy", "pandas")}
        code = packages_code_hash("bench/physics")
        return json_digest([to_toml(self.simulator), code, versions])


def simulator() -> Simulator:
    """Return the `rooms` simulator, to be run on any geometry."""
    return Rooms().simulator
