"""`bench export`: a fitted model as C for a microcontroller, or as ONNX."""

from __future__ import annotations

import tempfile
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Literal

import click

from bench.errors import BenchError

if TYPE_CHECKING:
    from bench.export import Chosen
    from bench.measure.profile import Profile
    from bench.runner.observer import Observer

EPILOG = """\b
Examples:
  bench export --model remnet --backend int8 --to c -o firmware
  bench export --run 3f2a91 --to c -o firmware
  bench export --model mlp --backend fp32 --data mine.parquet --to onnx -o out
"""


@dataclass(frozen=True)
class Wanted:
    """What the command line asks for."""

    model: str | None
    backend: str | None
    data: str | None
    run: str | None
    results: Path
    to: Literal["c", "onnx"]
    requantise: Literal["float", "fixed"]
    device: str | None

    def check(self) -> None:
        """Raise BenchError where options are missing, or contradict each other."""
        if self.run is None and (self.model is None or self.backend is None):
            raise BenchError("name a --model and a --backend, or a finished --run")
        if self.run is not None and (self.model or self.backend):
            raise BenchError("--run says which model and backend: leave --model and --backend out")
        if self.to == "onnx" and self.device is not None:
            raise BenchError("--device counts C: leave it out with --to onnx")
        if self.to == "onnx" and self.requantise == "fixed":
            raise BenchError("--requantise is of C: leave it out with --to onnx")

    def parts(self) -> tuple[Profile, ...]:
        """Return the parts to count on. Raises BenchError like `countable`."""
        if self.device is None:
            return ()
        from bench.runner.parts import countable

        return countable(self.device)


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.option("--model", metavar="NAME", help="See `bench models`.")
@click.option("--backend", metavar="NAME", help="fp32, fp16, int8, qat; see `bench backends`.")
@click.option("--data", metavar="NAME|PATH", help="Data to train on.  [default: rooms]")
@click.option("--run", metavar="ID", help="A finished run instead: its id, or the start of it.")
@click.option(
    "--results",
    default="results",
    show_default=True,
    type=click.Path(path_type=Path),
    help="Folder of finished runs, reused where nothing has changed.",
)
@click.option("--to", "to", default="c", show_default=True, type=click.Choice(["c", "onnx"]))
@click.option(
    "--requantise",
    default="float",
    show_default=True,
    type=click.Choice(["float", "fixed"]),
    help="How 8-bit layers round: float, or integers alone (no FPU needed).",
)
@click.option(
    "-o", "--out", required=True, type=click.Path(path_type=Path), help="Folder to write into."
)
@click.option("--device", metavar="NAME[,..]", help="Parts to count code and cycles for, emulated.")
@click.option("--json", "as_json", is_flag=True, help="Print JSON and nothing else.")
def command(
    model: str | None,
    backend: str | None,
    data: str | None,
    run: str | None,
    results: Path,
    to: Literal["c", "onnx"],
    requantise: Literal["float", "fixed"],
    out: Path,
    device: str | None,
    as_json: bool,
) -> None:
    """Write a fitted model as C99 for a microcontroller, or as ONNX.

    The C is one function: CIR magnitudes in counts in, the range error in metres out; one static
    arena, no library but memcpy. With it come a self-test of ten recorded rows, a Makefile and
    REPORT.md: agreement with ONNX Runtime (mm), flash and RAM (bytes), how to call it.
    """
    _export(Wanted(model, backend, data, run, results, to, requantise, device), out, as_json)


def _export(wanted: Wanted, out: Path, as_json: bool) -> None:
    """Check everything that can be before any work, then choose, write and show."""
    from bench.cli.export_view import as_json as shown_as_json
    from bench.cli.export_view import show
    from bench.cli.run_view import RunView
    from bench.export import check_folder, export

    wanted.check()
    check_folder(out)
    parts = wanted.parts()
    with tempfile.TemporaryDirectory() as scratch, RunView(quiet=as_json) as view:
        chosen = _choose(wanted, Path(scratch), view)
        view.stage(_writing(wanted))
        exported = export(chosen, wanted.to, out, wanted.requantise, parts)
    (shown_as_json if as_json else show)(chosen, exported)


def _writing(wanted: Wanted) -> str:
    if wanted.to == "onnx":
        return "writing the ONNX file"
    counting = f", counting it on {wanted.device}" if wanted.device else ""
    return f"writing C and comparing it with ONNX Runtime{counting}"


def _choose(wanted: Wanted, scratch: Path, view: Observer) -> Chosen:
    from bench.export import from_fit, from_run

    if wanted.run is not None:
        view.stage("reading the run")
        return from_run(wanted.run, wanted.results, wanted.data)
    model, backend, data = str(wanted.model), str(wanted.backend), wanted.data or "rooms"
    return from_fit(model, backend, data, wanted.results, scratch, view.stage, view.note)
