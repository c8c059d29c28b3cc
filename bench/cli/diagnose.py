"""`bench diagnose`: name and model what a simulator leaves out."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.errors import BenchError

if TYPE_CHECKING:
    from bench.checkpoint.journal import Kept
    from bench.discrepancy.method import Diagnosis, Options
    from bench.physics.simulator import Simulator
    from bench.recordings.table import Recordings

EPILOG = """\b
Examples:
  bench diagnose --recorded mine.parquet --simulated my_simulator.toml -o diagnosis
  bench diagnose --recorded mine.parquet --simulated other_simulator.parquet
  bench diagnose --recorded ghent --hide clock_offset_ppm --json
"""


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.option("--recorded", required=True, metavar="NAME|PATH", help="Recordings to explain.")
@click.option(
    "--simulated",
    metavar="SIM.toml|TABLE.parquet|NAME",
    help="A simulator file, a simulated table or a plug-in; default: the base simulator alone.",
)
@click.option("--hide", default="", metavar="COLUMN,..", help="Columns the diagnosis must not see.")
@click.option("--observe", default="", metavar="NAME,..", help="Compare only these observables.")
@click.option(
    "--paths-only",
    is_flag=True,
    help="Compare no waveforms even where both sides have them: range and level only.",
)
@click.option("--environment", metavar="NAME", help="Only the rows of this environment.")
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed.")
@click.option(
    "-o",
    "--out",
    type=click.Path(path_type=Path),
    help="Folder for report, TOML and figures. A diagnosis that was stopped resumes from it.",
)
@click.option("--json", "as_json", is_flag=True, help="Print the diagnosis as JSON, nothing else.")
def command(
    recorded: str,
    simulated: str | None,
    hide: str,
    observe: str,
    paths_only: bool,
    environment: str | None,
    seed: int,
    out: Path | None,
    as_json: bool,
) -> None:
    """Find, name, model and remove what a simulator leaves out.

    The simulator is run again at each recorded row's own geometry and settings (or its table is
    compared); differences are located, every known effect is fitted on some links and scored on
    others, and a new simulator is written. Lengths in metres, delays in ns, levels in dB. With
    -o, a diagnosis that was stopped goes on where it was when the same command is run again.
    """
    from bench.discrepancy.method import Options
    from bench.discrepancy.report.document import summary, write_report

    seen = _names(observe) or None
    options = Options(
        seed, hide=_names(hide), observables=seen, waveform=False if paths_only else None
    )
    table, against = _recorded(recorded, environment, options.hide), _simulated(simulated)
    kept = None if out is None else _kept(out, table, against, options)
    diagnosis = _run(table, against, options, kept)
    if out is not None:
        path = write_report(diagnosis, out)
        click.echo(f"report: {path}", err=True)
    if kept is not None:
        kept.clear()
    if as_json:
        import json

        click.echo(json.dumps(summary(diagnosis), indent=1))
    else:
        _print(diagnosis)


def _names(text: str) -> tuple[str, ...]:
    return tuple(name.strip() for name in text.split(",") if name.strip())


def _recorded(name: str, environment: str | None, hide: tuple[str, ...]) -> Recordings:
    """Return the recorded table. Raises BenchError where a name is not there."""
    import numpy as np

    from bench.recordings.open import open_recordings

    table, _ = open_recordings(name)
    table.require(*hide)
    if environment is None:
        return table
    table.require("environment")
    rows = np.asarray(table.frame["environment"] == environment, bool)
    if not rows.any():
        have = ", ".join(sorted(map(str, table.frame["environment"].dropna().unique())))
        raise BenchError(f"{name}: no environment {environment!r} (it has: {have})")
    return table.select(rows)


def _simulated(name: str | None) -> Simulator | Recordings:
    """Return the simulator or simulated table of that name."""
    from bench.physics.base import Base
    from bench.physics.simulator import Simulator
    from bench.physics.toml_file import read_toml

    if name is None:
        return Simulator(Base(), name="base")
    if name.endswith(".toml"):
        return read_toml(Path(name))
    if Path(name).suffix in (".parquet", ".csv") or "/" in name:
        from bench.recordings.open import open_recordings

        return open_recordings(name)[0]
    from bench.plugins import load

    made = load("simulators", name)
    found = made() if callable(made) else made
    if not isinstance(found, Simulator):
        raise BenchError(f"simulator {name!r}: expected a bench.physics Simulator")
    return found


def _kept(
    out: Path, recorded: Recordings, simulated: Simulator | Recordings, options: Options
) -> Kept:
    """Return what an earlier run left in the folder, and say so where there is something."""
    from bench.checkpoint.journal import Kept
    from bench.runner.diagnosis import fingerprint

    kept = Kept(out, fingerprint(recorded, simulated, options))
    if kept.started:
        click.echo(f"resuming after round {kept.finished}", err=True)
    return kept


def _run(
    recorded: Recordings, simulated: Simulator | Recordings, options: Options, kept: Kept | None
) -> Diagnosis:
    """Run the diagnosis with a progress line on stderr."""
    from rich.console import Console

    from bench.discrepancy.method import diagnose

    console = Console(stderr=True)
    with console.status("diagnosing ...") as status:
        return diagnose(recorded, simulated, options, status.update, journal=kept)


def _print(diagnosis: Diagnosis) -> None:
    """Print the verdicts and the confirm figures."""
    from bench.discrepancy.report.document import describe

    for verdict in diagnosis.selection.verdicts:
        for line in describe(verdict):
            click.echo(line.replace("**", ""))
    seen = diagnosis.confirmed
    click.echo(
        f"confirm links ({seen.links}): mean abs. range mismatch {seen.mae_before_m} -> "
        f"{seen.mae_after_m}; AUC {seen.auc_before:.3f} -> {seen.auc_after:.3f}"
    )
    for name, reason in diagnosis.selection.skipped.items():
        click.echo(f"skipped {name}: {reason}")
