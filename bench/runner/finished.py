"""Artifacts of finished runs, taken as they are: nothing is fitted or built."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path
from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.files import read_json
from bench.plugins import find
from bench.provenance import file_sha256
from bench.results import RunRecord, from_json
from zoo.inputs import Input, blocks_of

if TYPE_CHECKING:
    from backends.base import Artifact
    from bench.runner.material import Material

Tell = Callable[[str], None]


def finished_runs(results: Path, tell: Tell = lambda _: None) -> list[RunRecord]:
    """Return the runs of a result folder, those skipped too, the newest first.

    A record that cannot be read is left out; `tell` is given its name and why. Raises BenchError
    where none has figures.
    """
    paths = sorted((results / "runs").glob("[!.]*.json"))
    found = [record for path in paths if (record := _readable(path, tell)) is not None]
    if not any(record.status == "ok" for record in found):
        raise BenchError(f"{results}: no finished runs here")
    return sorted(found, key=lambda record: record.created_utc, reverse=True)


def _readable(path: Path, tell: Tell) -> RunRecord | None:
    try:
        return from_json(RunRecord, read_json(path))
    except (BenchError, ValueError) as problem:
        said = str(problem).removeprefix(f"{path}: ")
        tell(f"{path}: left out, it cannot be read ({said})")
        return None


def artifact_of(record: RunRecord, results: Path) -> Artifact:
    """Return a run's first fold's file. Raises BenchError where it is not what the record says."""
    from backends.base import Artifact

    path = results / "artifacts" / f"{record.digest()}-0.onnx"
    if not path.is_file() or file_sha256(path) != record.artifact_sha256:
        raise BenchError(f"{path}: missing or damaged; run the benchmark again")
    opener = find("backends", record.key.backend).load().opener
    return Artifact(path, record.precision, opener)  # type: ignore[arg-type]


def newest(runs: list[RunRecord], model: str, backend: str, material: Material) -> RunRecord:
    """Return the newest run of a model on a backend, on these recordings and this split.

    Raises BenchError where there is none, or saying why it was skipped.
    """
    wanted = (model, backend, material.fingerprint, material.split.name)
    for record in runs:
        key = record.key
        if (key.model, key.backend, key.data_fingerprint, key.split) != wanted:
            continue
        if record.status == "ok":
            return record
        raise BenchError(record.reason or "it was skipped")
    raise BenchError(f"no finished run of {model} on {backend} with these recordings and split")


def inputs_of(artifact: Artifact) -> tuple[Input, ...]:
    """Return the inputs of a model file. Raises BenchError where it is no model of the bench."""
    from backends.graph_file import load_graph
    from backends.inputs import graph_inputs

    try:
        found = graph_inputs(load_graph(artifact.path))
        blocks_of([one.name for one in found])
    except IndexError:
        raise BenchError(f"{artifact.path}: an input is not [n, width]") from None
    except ValueError as problem:
        said = str(problem).removeprefix(f"{artifact.path}: ")
        raise BenchError(f"{artifact.path}: no model of the bench: {said}") from problem
    return found


def check_width(artifact: Artifact, inputs: Iterable[Input], width: int) -> None:
    """Raise BenchError where a file takes other rows than these recordings have."""
    takes = sum(one.width for one in inputs)
    if takes != width:
        raise BenchError(
            f"{artifact.path}: takes {takes} values a row, the recordings have {width}"
        )
