"""`bench diagnose`: name and model what a simulator leaves out."""

from __future__ import annotations

import gc
import json
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import say
from bench.text import named

if TYPE_CHECKING:
    from bench.discrepancy import Diagnosis

COLLECTED_AFTER = 10_000, 50, 10  # objects more, before Python looks for cycles: few are made

EPILOG = """\b
Examples:
  bench diagnose --recorded mine.parquet --simulated my_simulator.toml -o diagnosis
  bench diagnose --recorded mine.parquet --simulated other_simulator.parquet
  bench diagnose --recorded ghent --hide clock_offset_ppm --json
  bench diagnose --recorded mine.parquet --simulated rooms --jobs 4
"""


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.option("--recorded", required=True, metavar="NAME|PATH", help="Recordings to explain.")
@click.option(
    "--simulated",
    metavar="SIM.toml|TABLE.parquet|NAME",
    help="A simulator file, a simulated table or a plug-in; default: the base simulator alone.",
)
@click.option("--hide", default="", metavar="COLUMN,..", help="Columns the diagnosis must not see.")
@click.option(
    "--measured", default="", metavar="COLUMN,..",
    help="Columns of your own that are measured with the range: never searched over.",
)  # fmt: skip
@click.option(
    "--known", default="", metavar="COLUMN,..",
    help="Columns of your own that are known before it; else a rule guesses, and says so.",
)  # fmt: skip
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
    type=click.Path(),
    help="Folder for report, TOML and figures. A diagnosis that was stopped resumes from it.",
)
@click.option("--jobs", default=1, show_default=True, metavar="N", help="Processes for the fits.")
@click.option("--scheduler", metavar="tcp://..", help="A Dask scheduler for the fits instead.")
@click.option("--json", "as_json", is_flag=True, help="Print the diagnosis as JSON, nothing else.")
def command(
    recorded: str,
    simulated: str | None,
    hide: str,
    measured: str,
    known: str,
    observe: str,
    paths_only: bool,
    environment: str | None,
    seed: int,
    out: str | None,
    jobs: int,
    scheduler: str | None,
    as_json: bool,
) -> None:
    """Find, name, model and remove what a simulator leaves out.

    The simulator is run again at each recorded row's own geometry and settings (or its table is
    compared); differences are located, every known effect is fitted on some links and scored on
    others, and what is found is written down: as a new simulator, or as effects with their values
    where a table was compared. Lengths in metres, delays in ns, levels in dB. With -o, a diagnosis
    that was stopped goes on where it was when the same command is run again.
    """
    gc.set_threshold(*COLLECTED_AFTER)  # by default this takes as long as a library's import
    from bench.cli.status_view import StatusView
    from bench.discrepancy.report.document import summary
    from bench.runner.diagnosis import diagnose

    with StatusView("diagnosing ...") as view:
        found = diagnose(
            recorded, simulated, hide=hide, measured=measured, known=known, observe=observe,
            environment=environment,
            paths_only=paths_only, seed=seed, out=out, jobs=jobs,
            scheduler=scheduler, observer=view,
        )  # fmt: skip
    if as_json:
        say(json.dumps(summary(found), indent=1))
    else:
        _print(found, kept=out is not None)
        _print_next(found, Path(out) if out is not None else None)


def _print_next(diagnosis: Diagnosis, out: Path | None) -> None:
    """Print the commands that go on from here."""
    if out is None:
        return
    kinds = {type(verdict).__name__ for verdict in diagnosis.selection.verdicts}
    if kinds & {"Ambiguous", "Unknown"}:
        say(f"what to measure next: bench plan --diagnosis {named(out)}")
    if diagnosis.recommended and diagnosis.simulator is not None:
        say(f"what it is worth to a correction: bench worth --diagnosis {named(out)}")


def _print(diagnosis: Diagnosis, kept: bool) -> None:
    """Print the verdicts and the confirm figures; what a report that is `kept` has is cut."""
    from bench.discrepancy.compare.calibration import auc_doubt
    from bench.discrepancy.report.document import measured_lines
    from bench.discrepancy.report.found_lines import found_lines, left_lines, nameless_lines
    from bench.discrepancy.report.parameters import skipped_line, skipped_lines

    say(named(diagnosis.headline))
    said = [line for told in found_lines(diagnosis) for line in told]
    for line in (*said, *nameless_lines(diagnosis), *left_lines(diagnosis)):
        say(named(line.replace("**", "")))
    seen = diagnosis.confirmed
    for line in diagnosis.counted:
        say(line)
    if diagnosis.uncovered:
        say(f"{diagnosis.uncovered:.0%} of the recorded rows have no simulated counterpart")
    say(
        f"confirm links ({seen.links}): |recorded - simulated| mean {seen.mae_before_m} -> "
        f"{seen.mae_after_m}, median {seen.median_before_m} -> {seen.median_after_m}, "
        f"90th percentile {seen.high_before_m} -> {seen.high_after_m}; "
        f"AUC {seen.auc_before:.3f} -> {seen.auc_after:.3f}{auc_doubt(seen.links)}"
    )
    for line in measured_lines(diagnosis):
        say(line)
    skipped = diagnosis.selection.skipped
    for line in [skipped_line(skipped)] if kept and skipped else skipped_lines(skipped):
        say(line)
