"""`bench simulate`: a simulator and a geometry -> recordings Parquet."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import say
from bench.errors import BenchError
from bench.text import named

if TYPE_CHECKING:
    from bench.runner.simulation import Simulation

EPILOG = """\b
Examples:
  bench simulate rooms --rooms -n 100000 -o rooms.parquet
  bench simulate my_simulator.toml --geometry mine.parquet -o simulated.parquet
"""
_PATH = click.Path(path_type=Path)


@click.command(epilog=EPILOG)
@click.argument("simulator", metavar="SIM.toml|NAME")
@click.option(
    "--geometry",
    metavar="NAME|PATH",
    help="Simulate at every row of these recordings, or at the rows of a simulator of that name.",
)
@click.option("--rooms", is_flag=True, help="Simulate in the rooms of the default data.")
@click.option("-n", "rows", type=int, help="With --rooms: how many rows (default 55000).")
@click.option("-o", "--out", type=_PATH, required=True, help="Recordings Parquet to write.")
@click.option("--seed", type=int, help="Instead of the seed in the TOML.")
@click.option("--json", "as_json", is_flag=True, help="Print a JSON summary.")
def command(
    simulator: str,
    geometry: str | None,
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
    from bench.cli.run_view import RunView
    from bench.runner.simulation import simulate

    if rooms and geometry is not None:
        raise BenchError("say where to simulate: either --geometry RECORDINGS.parquet or --rooms")
    places = "rooms" if rooms else geometry
    with RunView(quiet=as_json) as view:
        made = simulate(simulator, places, rows=rows, seed=seed, out=out, observer=view)
    _report(made, as_json)


def _report(made: Simulation, as_json: bool) -> None:
    """Print what was written."""
    facts = {
        "file": str(made.file),
        "rows": made.rows,
        "simulated": True,
        "simulator": made.simulator.name,
        "effects": [effect.name for effect in made.simulator.effects],
        "seed": made.simulator.seed,
        "mean_error_m": made.mean_error_m,
        "mae_m": made.mae_m,
        "seconds": made.seconds,
        "rows_per_s": made.rows / max(made.seconds, 1e-9),
    }
    if as_json:
        say(json.dumps(facts, indent=1))
        return
    say(
        f"{named(made.file)}: {made.rows} SIMULATED rows by {made.simulator.name!r}, seed "
        f"{made.simulator.seed}; error {made.mean_error_m:+.3f} m in the mean, MAE "
        f"{made.mae_m:.3f} m; {facts['rows_per_s']:.0f} rows/s"
    )
