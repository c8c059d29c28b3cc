"""Simulators by name: the one thing that a plug-in of the group `bench.simulators` is asked for.

A third party writes

    class Hall(SimulatorPlugin):
        '''A hall with steel walls.'''

        simulator = Simulator(effects=(DiffuseTail(),), name="hall")

and registers it. A plain `Simulator` will do as well, and so will a function without arguments
that gives either.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import pandas as pd

from bench.errors import BenchError
from bench.physics.simulator import Simulator
from bench.physics.toml_file import read_toml
from bench.plugins import find


class SimulatorPlugin:
    """A simulator under a name, and perhaps rows of its own to simulate at.

    `simulator` is run by `bench diagnose` at recorded rows and by `bench simulate` at any. `rows`
    is how many rows `geometry` gives where none are asked for; 0 where it has none of its own.
    """

    simulator: Simulator
    rows: int = 0

    def geometry(self, rows: int, seed: int) -> Iterator[pd.DataFrame]:
        """Yield `rows` rows to simulate at, in frames, the same from the same seed.

        Raises BenchError where the simulator has no geometry of its own.
        """
        raise BenchError(f"simulator {self.simulator.name!r} has no rows of its own to simulate at")


class _Plain(SimulatorPlugin):
    """A simulator without rows of its own."""

    def __init__(self, simulator: Simulator) -> None:
        self.simulator = simulator


def open_simulator(name: str) -> SimulatorPlugin:
    """Return the simulator registered under `name`.

    Raises BenchError for an unknown name (with a did-you-mean), one that fails, or no simulator.
    """
    plugin = find("simulators", name)
    made = plugin.make()
    if isinstance(made, Simulator):
        return _Plain(made)
    if not isinstance(made, SimulatorPlugin) or not isinstance(made.simulator, Simulator):
        raise BenchError(
            f"simulator {name!r} of {plugin.distribution}: expected a bench.physics Simulator or "
            f"SimulatorPlugin, got {type(made).__name__}"
        )
    return made


def read_simulator(which: str | Path | Simulator) -> Simulator:
    """Return a simulator: itself, a TOML file's, or that of a plug-in. Raises BenchError."""
    if isinstance(which, Simulator):
        return which
    which = str(which)
    toml = which.endswith(".toml") or Path(which).is_file()
    if toml and not which.endswith(".py"):
        return read_toml(Path(which))
    if which.endswith(".py"):
        raise BenchError(
            f"{which}: a Python file cannot be run as a simulator; expected a .toml of base and "
            "effects, a simulated table (.parquet, .csv) or the name of a plug-in, which "
            "`bench plugin new NAME --kind simulator` writes to put the code in"
        )
    return replace(open_simulator(which).simulator, name=which)  # as the user knows it
