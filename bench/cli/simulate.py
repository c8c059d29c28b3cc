"""`bench simulate`: a simulator's TOML and a geometry -> recordings Parquet."""

from __future__ import annotations

import json
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.errors import BenchError

if TYPE_CHECKING:
    import pandas as pd

    from bench.physics import Simulator
    from bench.physics.stream import Tally

_PATH = click.Path(path_type=Path)


@click.command(epilog="Example: bench simulate rooms --rooms -n 100000 -o rooms.parquet")
@click.argument("simulator", metavar="SIM.toml|NAME")
@click.option("--geometry", type=_PATH, help="Simulate at every row of this recordings Parquet.")
@click.option("--rooms", is_flag=True, help="Simulate in the rooms of the default data.")
@click.option("-n", "rows", type=int, help="With --rooms: how many rows (default 55000).")
@click.option("-o", "--out", type=_PATH, required=True, help="Recordings Parquet to write.")
@click.option("--seed", type=int, help="Instead of the seed in the TOML.")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON summary.")
def command(
    simulator: str,
    geometry: Path | None,
    rooms: bool,
    rows: int | None,
    out: Path,
    seed: int | None,
    as_json: bool,
) -> None:
    """Simulate UWB ranges with CIRs: range in metres, powers in dBm, CIR in counts.

    SIM.toml holds a base, ordered effects and a seed; `rooms` is the simulator of the default
    data. The same simulator, geometry and seed always give the same numbers.
    """
    from bench.physics.stream import simulate_to

    chosen = _simulator(simulator, seed)
    _check_out(out, geometry)
    frames, total = _frames(chosen, geometry, rooms, rows)
    started = time.monotonic()
    with _progress(total, quiet=as_json) as progress:
        tally = simulate_to(chosen, frames, out, progress, str(geometry or "rooms"))
    _report(chosen, tally, out, time.monotonic() - started, as_json)


def _simulator(name_or_path: str, seed: int | None) -> Simulator:
    """Return the simulator of a TOML file, or a named one."""
    from bench.physics.toml_file import read_toml
    from bench.plugins import load

    if seed is not None and seed < 0:
        raise BenchError(f"--seed {seed}: expected a whole number of 0 or more")
    if name_or_path.endswith(".toml") or Path(name_or_path).is_file():
        found = read_toml(Path(name_or_path))
    else:
        plugin = load("simulators", name_or_path)()
        if not hasattr(plugin, "simulator"):
            raise BenchError(f"simulator {name_or_path!r} is not made of effects: it has no TOML")
        found = plugin.simulator
    return found if seed is None else replace(found, seed=seed)


def _check_out(out: Path, geometry: Path | None) -> None:
    """Raise BenchError where the output is no Parquet name or would replace its own input."""
    if out.suffix not in (".parquet", ".pq"):
        raise BenchError(f"{out}: recordings are written as Parquet; expected a .parquet name")
    if geometry is not None and out.resolve() == geometry.resolve():
        raise BenchError(f"{out}: would replace the geometry it is simulated from")


def _frames(
    simulator: Simulator, geometry: Path | None, rooms: bool, rows: int | None
) -> tuple[Iterator[pd.DataFrame], int]:
    """Return the geometry in frames and its number of rows."""
    from bench.physics import stream
    from bench.physics.room_plan import ROW_TOTAL

    if (geometry is None) == (not rooms):
        raise BenchError("say where to simulate: either --geometry RECORDINGS.parquet or --rooms")
    if geometry is not None:
        if rows is not None:
            raise BenchError("-n goes with --rooms; with --geometry every row is simulated")
        return stream.geometry_of(geometry), stream.row_count(geometry)
    count = ROW_TOTAL if rows is None else rows
    if count < 1:
        raise BenchError(f"-n {count}: expected at least 1 row")
    return stream.rooms(count, simulator.seed), count


@contextmanager
def _progress(total: int, quiet: bool) -> Iterator[Callable[[int], None]]:
    """Yield a function that shows how many rows are done; silent for short runs and JSON."""
    from rich.console import Console
    from rich.progress import BarColumn, MofNCompleteColumn, Progress, TimeRemainingColumn

    columns = "simulating", BarColumn(), MofNCompleteColumn(), TimeRemainingColumn()
    shown = Progress(*columns, console=Console(stderr=True), disable=quiet, transient=True)
    started = time.monotonic()
    task = shown.add_task("rows", total=total)

    def show(done: int) -> None:
        shown.update(task, completed=done)
        if time.monotonic() - started > 1 and not shown.live.is_started:
            shown.start()

    try:
        yield show
    finally:
        if shown.live.is_started:
            shown.stop()


def _report(simulator: Simulator, tally: Tally, out: Path, seconds: float, as_json: bool) -> None:
    """Print what was written."""
    facts = {
        "file": str(out),
        "rows": tally.rows,
        "simulated": True,
        "simulator": simulator.name,
        "effects": [effect.name for effect in simulator.effects],
        "seed": simulator.seed,
        "mean_error_m": tally.mean_m,
        "mae_m": tally.mae_m,
        "seconds": seconds,
        "rows_per_s": tally.rows / max(seconds, 1e-9),
    }
    if as_json:
        click.echo(json.dumps(facts, indent=1))
        return
    click.echo(
        f"{out}: {tally.rows} SIMULATED rows by {simulator.name!r}, seed {simulator.seed}; error "
        f"{tally.mean_m:+.3f} m in the mean, MAE {tally.mae_m:.3f} m; {facts['rows_per_s']:.0f} "
        f"rows/s"
    )
