"""The simulated default data: three rooms, an open place and a wall, out of physics alone.

The simulator is `rooms.toml` beside this file; the plan of rooms and obstacles is in `room_plan`.
docs/rooms.md says what it takes from real recordings and why; `IdealRooms` is what it was before.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path
from typing import ClassVar

import pandas as pd

from bench.physics.room_plan import LICENCE, ROW_TOTAL, Plan, ideal_plan, plan
from bench.physics.simulator import Simulator
from bench.physics.simulators import SimulatorPlugin
from bench.physics.stream import rooms as room_rows
from bench.physics.toml_file import read_toml, to_toml
from bench.provenance import json_digest, package_version, packages_code_hash
from bench.recordings.table import Recordings


class Rooms(SimulatorPlugin):
    """The `rooms` simulator with a geometry of its own; SIMULATED, reproducible from a seed."""

    rows = ROW_TOTAL
    file: ClassVar[str] = "rooms.toml"

    def __init__(self, seed: int | None = None) -> None:
        read = read_toml(Path(__file__).parent / self.file)
        self.simulator: Simulator = read if seed is None else replace(read, seed=seed)

    def plan(self) -> Plan:
        """Return the rooms and obstacles that rows are drawn from."""
        return plan()

    def geometry(self, rows: int, seed: int) -> Iterator[pd.DataFrame]:
        """Yield rows in the rooms; beyond 55 000, in further campaigns of measurement."""
        return room_rows(rows, seed, self.plan())

    def generate(self, rows: int = ROW_TOTAL) -> Recordings:
        """Return 55 000 simulated recordings, or `rows` of the same mixture."""
        frames = list(self.geometry(rows, self.simulator.seed))
        whole = frames[0] if len(frames) == 1 else pd.concat(frames, ignore_index=True)
        return replace(self.simulator.simulate(whole), licence=LICENCE)

    def key(self) -> str:
        """Return 20 hex digits that change with simulator, seed, code and numerical libraries."""
        versions = {library: package_version(library) for library in ("numpy", "scipy", "pandas")}
        code = packages_code_hash("bench/physics")
        return json_digest([to_toml(self.simulator), code, versions])


class IdealRooms(Rooms):
    """`rooms` as it was before docs/rooms.md: the same numbers to the last bit; SIMULATED."""

    file = "rooms_ideal.toml"

    def plan(self) -> Plan:
        """Return the plan with nothing unlisted behind the obstacles."""
        return ideal_plan()


def simulator() -> Simulator:
    """Return the `rooms` simulator, to be run on any geometry."""
    return Rooms().simulator
