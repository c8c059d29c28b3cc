"""What is exported: a finished run's artifact where there is one, else one made now."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from backends.base import Artifact
from bench.errors import BenchError
from bench.export.built import builder_of, kept_built
from bench.files import read_json
from bench.plugins import Plugin, find
from bench.results import RunKey, RunRecord, from_json
from bench.runner.finished import artifact_of, check_width, inputs_of
from bench.runner.folder import ResultFolder
from bench.runner.held_out import held_out, keep_held_out, kept_held_out
from bench.runner.keys import Head, head_of, run_key
from bench.runner.repeated import question_of, recalled, remember

if TYPE_CHECKING:
    from bench.runner.material import Material

Tell = Callable[[str], None]
ACROSS = "trained-on"  # the kind of split of a run across data sets (bench.recordings.draws)


@dataclass(frozen=True)
class Chosen:
    """An artifact, where it came from, and held-out rows [n, width] to check it on."""

    artifact: Artifact
    model: str
    backend: str
    data: str
    simulated: bool
    cirs: NDArray[np.float32]
    split: str = ""
    seed: int = 0

    @property
    def origin(self) -> str:
        """What it was trained on, in words."""
        name = f"{self.data} (SIMULATED)" if self.simulated else self.data
        kind, _, others = self.split.partition(":")
        return f"trained on {others}, tested on {name}" if kind == ACROSS else f"trained on {name}"


@dataclass(frozen=True)
class Asked:
    """A model and a backend to export; `results` of finished runs, a `scratch` folder for files."""

    model: Plugin
    backend: Plugin
    results: Path
    scratch: Path
    note: Tell = lambda _: None

    @property
    def file(self) -> Path:
        """Where the model's file is put when it is made."""
        return self.scratch / "model.onnx"


def from_run(run: str, results: Path, data: str | None = None) -> Chosen:
    """Return the first fold's artifact of a finished run, named by its id or the start of it.

    Raises BenchError where no run, or more than one, begins so, or its files are not what its
    record says.
    """
    record = _record(run, results)
    artifact, key = artifact_of(record, results), record.key
    head = Head(key.data, key.data_fingerprint, key.split, record.simulated)
    found = None if data is not None else _unread(artifact, key.model, key.backend, head)
    if found is None:
        found = _chosen(artifact, key.model, key.backend, _material(key, data))
    return replace(found, seed=key.seed)


def _material(key: RunKey, data: str | None) -> Material:
    """Read a run's recordings. Raises BenchError where several data sets were put together."""
    from bench.runner.material import load_material

    if key.split.partition(":")[0] == ACROSS:
        raise BenchError(
            f"{key.model}, {key.split}: the rows that were held out of several data sets are not "
            "in the cache; run it again on this machine into an empty folder"
        )
    return load_material(data or key.data, key.split)


def _record(run: str, results: Path) -> RunRecord:
    if not run.isalnum():
        raise BenchError(f"--run {run!r}: expected the hexadecimal id of a run")
    found = sorted((results / "runs").glob(f"{run}*.json"))
    if len(found) != 1:
        raise BenchError(f"--run {run}: {len(found)} runs under {results} begin so, expected one")
    record = from_json(RunRecord, read_json(found[0]))
    if record.digest() != found[0].stem or record.status != "ok":
        raise BenchError(f"{found[0]}: not a finished run of that id")
    return record


def from_fit(
    model: str,
    backend: str,
    data: str,
    results: Path,
    scratch: Path,
    tell: Tell,
    note: Tell = lambda _: None,
) -> Chosen:
    """Return a model's artifact on a backend: of a finished run under `results`, else made now.

    Trained on the first fold of the data's own split, seed 0, as `bench run` does; `scratch` is a
    folder for what is made, `note` is told of a record that cannot be read.
    Raises BenchError for unknown names and what the backend declines.
    """
    asked = Asked(find("models", model), find("backends", backend), results, scratch, note)
    head = recalled(question_of(data, None))
    artifact = None if head is None else _there(asked, head)
    if head and artifact and (found := _unread(artifact, model, backend, head)):
        return found
    material = _read(data, tell)
    artifact = _there(asked, head_of(material)) or _made(asked, material, tell)
    return _chosen(artifact, model, backend, material)


def _read(data: str, tell: Tell) -> Material:
    """Read recordings, and keep what they are so that the next export need not."""
    from bench.runner.material import load_material

    tell(f"reading {data}")
    question = question_of(data, None)
    material = load_material(data, None)
    remember(question or question_of(data, None), data, None, head_of(material))
    return material


def _there(asked: Asked, head: Head) -> Artifact | None:
    """Return the artifact of a finished run, or what an earlier export built; None without one."""
    key = run_key(asked.model, asked.backend, head, 0)
    record = ResultFolder(asked.results).find_run(key, asked.note)
    if record is not None and record.status == "ok":
        return artifact_of(record, asked.results)
    return kept_built(key, asked.file, builder_of(asked.backend).load().opener)


def _made(asked: Asked, material: Material, tell: Tell) -> Artifact:
    from bench.export.making import made

    return made(asked.model, asked.backend, material, asked.file, tell)


def _unread(artifact: Artifact, model: str, backend: str, head: Head) -> Chosen | None:
    """Return the choice with the rows that were kept of these recordings, None without them."""
    inputs = inputs_of(artifact)
    rows = kept_held_out(head, [one.name for one in inputs])
    if rows is None:
        return None
    check_width(artifact, inputs, rows.shape[1])
    return Chosen(artifact, model, backend, head.name, head.simulated, rows, head.split)


def _chosen(artifact: Artifact, model: str, backend: str, material: Material) -> Chosen:
    inputs = inputs_of(artifact)
    reads = [one.name for one in inputs]
    keep_held_out(material, reads, again=True)
    rows = held_out(material, reads)
    check_width(artifact, inputs, rows.shape[1])
    head = head_of(material)
    return Chosen(artifact, model, backend, head.name, bool(head.simulated), rows, head.split)
