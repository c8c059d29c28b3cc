"""`bench.simulate`: rows simulated at any geometry, in memory or into a file."""

from __future__ import annotations

import os
from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from time import monotonic

import pandas as pd

from bench.errors import BenchError
from bench.files import check_output
from bench.physics import stream
from bench.physics.simulator import Simulator
from bench.physics.simulators import SimulatorPlugin, open_simulator, read_simulator
from bench.plugins import plugins
from bench.recordings.io import PARQUET_SUFFIXES, read_recordings
from bench.recordings.open import Table, read
from bench.recordings.table import Recordings
from bench.runner.observer import Observer

MOST_ROWS = 1_000_000_000  # about a terabyte; more is a slip of the finger, not a wish


@dataclass(frozen=True)
class Simulation:
    """SIMULATED rows and how they were made.

    `mean_error_m` and `mae_m` are over all rows, in metres; `file` is None where they were kept in
    memory.
    """

    simulator: Simulator
    rows: int
    mean_error_m: float
    mae_m: float
    seconds: float
    file: Path | None = None
    kept: Recordings | None = None

    @cached_property
    def recordings(self) -> Recordings:
        """The rows, read back from the file where they went to one."""
        if self.kept is not None:
            return self.kept
        assert self.file is not None
        return read_recordings(self.file)


@dataclass(frozen=True)
class Places:
    """Where to simulate: rows in frames, how many there are, and what they are called."""

    frames: Iterator[pd.DataFrame]
    count: int
    name: str


def simulate(
    simulator: str | Path | Simulator,
    geometry: Table | None = None,
    *,
    rows: int | None = None,
    seed: int | None = None,
    out: str | Path | None = None,
    observer: Observer | None = None,
) -> Simulation:
    """Simulate UWB ranges with CIRs: range in metres, powers in dBm, CIR in counts.

    `simulator`: a plug-in's name, a TOML file or a `Simulator`. `geometry`: recordings (a name, a
    Parquet file, a frame), simulated at every row of; or the name of a simulator with rows of its
    own, such as "rooms", of which `rows` are made. `seed` goes before the simulator's own. With
    `out` the rows go to that Parquet file, chunk by chunk, so there may be any number of them.
    The same simulator, geometry and seed always give the same numbers. Raises BenchError on bad
    input, before anything is written.

    >>> import pandas as pd
    >>> made = simulate("rooms", pd.DataFrame({"true_range_m": [2.0, 5.0]}))
    >>> made.rows, made.recordings.label
    (2, 'rooms (SIMULATED)')
    """
    chosen = seeded(read_simulator(simulator), seed)
    target = None if out is None else _target(Path(out), geometry)
    places = _places(chosen, geometry, rows)
    started, watch = monotonic(), observer or Observer()

    def show(done: int) -> None:
        watch.progress("simulating", done / max(places.count, 1))

    if target is None:
        return _in_memory(chosen, places, started)
    tally = stream.simulate_to(chosen, places.frames, target, show, places.name, places.count)
    figures = tally.rows, tally.mean_m, tally.mae_m
    return Simulation(chosen, *figures, monotonic() - started, target)


def seeded(simulator: Simulator, seed: int | None) -> Simulator:
    """Return the simulator with another seed. Raises BenchError where that is no seed."""
    if seed is None:
        return simulator
    if seed < 0:
        raise BenchError(f"--seed {seed}: expected a whole number of 0 or more")
    return replace(simulator, seed=seed)


def _in_memory(simulator: Simulator, places: Places, started: float) -> Simulation:
    """Return the rows simulated at once."""
    frames = list(places.frames)
    if not any(map(len, frames)):
        raise BenchError(f"{places.name}: no rows to simulate at")
    whole = frames[0] if len(frames) == 1 else pd.concat(frames, ignore_index=True)
    made = simulator.simulate(Recordings(whole, places.name))
    tally = stream.Tally()
    tally.add(made.errors_m())
    figures = tally.rows, tally.mean_m, tally.mae_m
    return Simulation(simulator, *figures, monotonic() - started, kept=made)


def _target(out: Path, geometry: Table | None) -> Path:
    """Return the output. Raises BenchError where it is no Parquet or would replace its input."""
    if out.suffix not in PARQUET_SUFFIXES:
        raise BenchError(f"{out}: recordings are written as Parquet; expected a .parquet name")
    check_output(out)
    if isinstance(geometry, str | Path) and os.path.realpath(out) == os.path.realpath(geometry):
        raise BenchError(f"{out}: would replace the geometry it is simulated from")
    return out


def _places(simulator: Simulator, geometry: Table | None, rows: int | None) -> Places:
    """Return where to simulate. Raises BenchError where that is not said, or not to be had."""
    if geometry is None:
        raise BenchError(
            "say where to simulate: either --geometry RECORDINGS.parquet or --rooms "
            "(or --geometry NAME: a data set, or a simulator with rows of its own)"
        )
    if isinstance(geometry, str) and geometry in [one.name for one in plugins("simulators")]:
        return _own(open_simulator(geometry), simulator.seed, geometry, rows)
    if rows is not None:
        raise BenchError("-n goes with --rooms; with --geometry every row is simulated")
    if isinstance(geometry, str | Path) and Path(geometry).suffix in PARQUET_SUFFIXES:
        path = Path(geometry)
        return Places(stream.geometry_of(path), stream.row_count(path), str(path))
    if isinstance(geometry, pd.DataFrame):
        return Places(iter([geometry]), len(geometry), "the geometry given")
    table = read(geometry)
    return Places(iter([table.frame]), len(table), table.source)


def _own(plugin: SimulatorPlugin, seed: int, name: str, rows: int | None) -> Places:
    """Return rows of a simulator's own."""
    count = plugin.rows if rows is None else rows
    if rows is not None and not 1 <= rows <= MOST_ROWS:
        raise BenchError(f"-n {str(rows)[:40]}: expected 1 to {MOST_ROWS} rows")
    return Places(plugin.geometry(count, seed), count, name)
