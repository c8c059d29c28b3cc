"""`bench export`: a fitted model as C for a microcontroller, or as ONNX."""

from __future__ import annotations

import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, Literal

import click

from bench.errors import BenchError
from bench.text import named

if TYPE_CHECKING:
    from bench.export import Chosen, Exported
    from bench.runner.counting import Counted

EPILOG = """\b
Examples:
  bench export --model remnet --backend int8 --to c -o firmware
  bench export --run 3f2a91 --to c -o firmware
  bench export --model mlp --backend fp32 --data mine.parquet --to onnx -o out
"""


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
    from bench.cli.run_view import RunView
    from bench.export import check_folder, export
    from bench.runner.plan import resolve

    if run is None and (model is None or backend is None):
        raise BenchError("name a --model and a --backend, or a finished --run")
    if run is not None and (model or backend):
        raise BenchError("--run says which model and backend: leave --model and --backend out")
    check_folder(out)
    parts = [one.load() for one in resolve("devices", device)] if device else []
    with tempfile.TemporaryDirectory() as scratch, RunView(quiet=as_json) as view:
        chosen = _choose(model, backend, data, run, results, Path(scratch), view)
        view.stage("writing C and comparing it with ONNX Runtime")
        exported = export(chosen, to, out, requantise, parts)
    _show(chosen, exported, as_json)


def _choose(
    model: str | None,
    backend: str | None,
    data: str | None,
    run: str | None,
    results: Path,
    scratch: Path,
    view: Any,
) -> Chosen:
    from bench.export import from_fit, from_run

    if run is not None:
        view.stage("reading the run")
        return from_run(run, results, data)
    return from_fit(str(model), str(backend), data or "rooms", results, scratch, view.stage)


def _show(chosen: Chosen, exported: Exported, as_json: bool) -> None:
    from bench.cli.console import print_json, say
    from bench.export.agreement import at_most

    found = exported.agreement
    if as_json:
        told = found and {"rows": found.rows, "equal": found.equal, "largest_m": found.largest_m}
        names = {"folder": str(exported.folder), "files": list(exported.files)}
        counted = [_facts(one) for one in exported.counted]
        print_json(
            {**names, "arena_bytes": exported.arena_bytes, "agreement": told, "counted": counted}
        )
        return
    say(f"{chosen.model} on {chosen.backend}, trained on {named(chosen.data)}")
    say(f"{named(exported.folder)}: {', '.join(exported.files)}")
    if exported.arena_bytes is not None:
        say(f"RAM for activations: {exported.arena_bytes} bytes")
    if found:
        same = f", {100 * found.equal:.2f} % equal bit by bit" if _integer(chosen) else ""
        gap = at_most(found.largest_m)
        say(f"{found.rows} held-out rows: {gap} from ONNX Runtime{same}")
    elif exported.arena_bytes is not None:
        from bench.export.report import NOT_CHECKED

        say(f"agreement with ONNX Runtime {NOT_CHECKED}")
    for one in exported.counted:
        facts = _facts(one)
        say(
            f"{facts['device']}, counted: {facts['cycles']:,} cycles, "
            f"{facts['latency_ms']:.3g} ms; {facts['fits']}"
        )


def _facts(one: Counted) -> dict[str, Any]:
    """Return what a part takes for a call: its cycles with wait states, ms, whether it fits."""
    figure = one.figure
    return {
        "device": figure.device,
        "cycles": round(figure.cycles.value),
        "latency_ms": figure.latency_us.value / 1e3,
        "fits": figure.fits,
    }


def _integer(chosen: Chosen) -> bool:
    return chosen.artifact.precision == "int8"
