"""`bench count`: what a network takes on a microcontroller, counted in an emulator."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from bench.errors import BenchError
from bench.files import check_output

if TYPE_CHECKING:
    from collections.abc import Iterator

    from bench.measure.counting.measured import Measured
    from bench.measure.profile import Profile
    from bench.runner.count_models import CountPlan, CountRow
    from bench.runner.observer import Observer

EPILOG = """\b
Examples:
  bench count --model remnet --backend c-int8 --device nrf52832
  bench count --model all --backend c-fp32,c-int8 --device all --markdown counted.md
  bench count --model all --backend c-fp32 --device nrf52832 --results results
  bench count --model remnet --backend c-int8 --device nrf52832 --measured board.txt
"""


@dataclass(frozen=True)
class Wanted:
    """What the command line asks to be counted, and on which rows."""

    model: str
    backend: str
    device: str
    compiler: Literal["auto", "gcc", "zig"]
    rows: int
    data: str
    results: Path | None
    split: str | None
    measured: Path | None


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.option("--model", required=True, metavar="NAME[,..]|all", help="See `bench models`.")
@click.option("--backend", required=True, metavar="NAME[,..]|all", help="See `bench backends`.")
@click.option(
    "--device",
    required=True,
    metavar="NAME[,..]|FILE.toml|all",
    help="Parts with a core (`bench devices`), or a profile file of your own.",
)
@click.option(
    "--data",
    default="rooms",
    show_default=True,
    metavar="NAME|PATH",
    help="Recordings to fit on and to take the rows from (SIMULATED by default).",
)
@click.option(
    "--results",
    metavar="FOLDER",
    type=click.Path(path_type=Path),
    help="Count the files of finished runs in this folder; nothing is fitted.",
)
@click.option("--split", metavar="SPLIT", help="As `bench run`; the first fold is used.")
@click.option("--rows", default=32, show_default=True, metavar="N", help="Recorded rows to run.")
@click.option(
    "--compiler",
    type=click.Choice(["auto", "gcc", "zig"]),
    default="auto",
    show_default=True,
    help="auto: gcc where installed, else zig cc.",
)
@click.option(
    "--measured",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="A self-test's output from a board: its cycles beside the count.",
)
@click.option(
    "--profile-out",
    metavar="FILE.toml",
    type=click.Path(path_type=Path),
    help="With --measured: write the part's profile, recalibrated.",
)
@click.option(
    "--markdown",
    metavar="FILE",
    type=click.Path(path_type=Path),
    help="Write the table as Markdown too: between the marks of a page that has them.",
)
@click.option("--json", "as_json", is_flag=True, help="Print JSON and nothing else.")
def command(
    model: str,
    backend: str,
    device: str,
    data: str,
    results: Path | None,
    split: str | None,
    rows: int,
    compiler: Literal["auto", "gcc", "zig"],
    measured: Path | None,
    profile_out: Path | None,
    markdown: Path | None,
    as_json: bool,
) -> None:
    """Count instructions and cycles of a network's C on a part's core, in an emulator.

    The C is compiled for the core, run on recorded rows and checked against this machine.
    Reports cycles, latency (ms), energy (mJ), flash and RAM (KB) with low and high ends. Counts
    are kept in the cache: a command that was stopped goes on when it is given again.
    """
    for target in (markdown, profile_out):
        if target is not None:
            check_output(target)
    wanted = Wanted(model, backend, device, compiler, rows, data, results, split, measured)
    found, board = _counted(wanted, profile_out, as_json)
    _written(found, board, markdown, as_json)
    if not any(row.counted for row in found):
        raise BenchError(f"nothing was counted: {found[0].reason}")


def _counted(
    wanted: Wanted, profile_out: Path | None, quiet: bool
) -> tuple[list[CountRow], Measured | None]:
    """Return every row and what a board measured; the part's profile is written if asked for."""
    from bench.cli.run_view import RunView

    board = _board(wanted.measured, profile_out)
    with RunView(quiet=quiet) as view:
        plan = _plan(wanted, board)
        found = list(_rows(plan, wanted, view))
    if board is not None and profile_out is not None:
        _write_profile(found[0], plan.profiles[0], board, profile_out)
    return found, board


def _plan(wanted: Wanted, board: Measured | None) -> CountPlan:
    """Return what is to be counted. Raises BenchError where a board's figures would be of many."""
    from bench.runner.count_models import make_count_plan

    plan = make_count_plan(
        wanted.model, wanted.backend, wanted.device, wanted.compiler, wanted.rows
    )
    sizes = {len(plan.models), len(plan.backends), len(plan.profiles)}
    if board is not None and sizes != {1}:
        raise BenchError("--measured is of one model, one backend and one part: name one each")
    return plan


def _rows(plan: CountPlan, wanted: Wanted, watch: Observer) -> Iterator[CountRow]:
    from bench.runner.count_models import count_finished, count_models

    if wanted.results is None:
        return count_models(plan, wanted.data, wanted.split, watch)
    return count_finished(plan, wanted.results, wanted.data, wanted.split, watch)


def _written(
    found: list[CountRow], board: Measured | None, markdown: Path | None, as_json: bool
) -> None:
    from bench.cli.count_table import markdown_table, write_markdown
    from bench.cli.count_view import print_rows, rows_as_json

    if markdown is not None:
        write_markdown(markdown, markdown_table(found, board))
    (rows_as_json if as_json else print_rows)(found, board)


def _board(measured: Path | None, profile_out: Path | None) -> Measured | None:
    from bench.measure.counting.measured import read_measured

    if measured is None and profile_out is not None:
        raise BenchError("--profile-out needs --measured: nothing to recalibrate with")
    return None if measured is None else read_measured(measured)


def _write_profile(row: CountRow, profile: Profile, board: Measured, path: Path) -> None:
    from bench.measure.counting.measured import recalibrated, write_profile

    if row.counted is None:
        raise BenchError(f"nothing to recalibrate: {row.reason}")
    write_profile(recalibrated(profile, row.counted.count, board), path)
