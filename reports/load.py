"""Reading a folder of result files into plain structures; a bad file is counted, never fatal.

Layout: `runs/*.json` (what data, split, model, backend and seed determine) and `timings/*.json`
(what artifact and machine determine). Units stand in the names.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, TypeVar

import msgspec

from reports.believe import believed, digest
from reports.errors import ReportError

T = TypeVar("T")


@dataclass(frozen=True)
class Interval:
    """A figure with its 95 % interval, or with the low and high of an estimate."""

    value: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Score:
    """Accuracy on one set of test rows, after mitigation and (`raw_`) before; metres."""

    rows: int
    links: int
    mae_m: Interval
    r2: Interval
    sigma_m: Interval
    bias_m: float
    raw_mae_m: float
    raw_sigma_m: float


@dataclass(frozen=True)
class Key:
    """What determines a run."""

    model: str
    backend: str
    data: str
    data_fingerprint: str
    split: str
    seed: int
    code_hash: str
    versions: dict[str, str]
    simulated: bool = False
    model_target: str = ""
    backend_target: str = ""
    declared: dict[str, str] = field(default_factory=dict)
    threads: int | None = None


@dataclass(frozen=True)
class Size:
    """Bytes on disk, bytes of weights, parameters and multiply-adds of an artifact."""

    file_bytes: float
    weight_bytes: float
    parameters: float
    macs: float


@dataclass(frozen=True)
class Layer:
    """One kernel of one inference of a single row."""

    kind: str
    macs: int
    outputs: int
    dtype: str
    reads: int = 0


@dataclass(frozen=True)
class Cost:
    """What every estimate for a device is made from: kernels in order, bytes of weights."""

    layers: tuple[Layer, ...]
    weight_bytes: int
    inputs: int = 0


@dataclass(frozen=True)
class Estimate:
    """Latency and energy of one inference on a device, or the `reason` for neither.

    `how` they were obtained: "estimated" or "counted"; `fits` what of flash and RAM is taken.
    """

    device: str
    latency_us: Interval | None
    energy_mj: Interval | None
    reason: str | None = None
    how: str = "estimated"
    fits: str | None = None


@dataclass(frozen=True)
class Run:
    """One model on one backend, data set, split and seed; skipped runs carry a `reason`.

    `estimates` stand in no file: whoever reads the folder makes them.
    """

    key: Key
    status: Literal["ok", "skipped"]
    simulated: bool
    reason: str | None = None
    nlos: Score | None = None
    los: Score | None = None
    size: Size | None = None
    cost: Cost | None = None
    precision: str | None = None
    integer_kernels: str | None = None
    note: str = ""
    floor: bool = False
    artifact_sha256: str | None = None
    estimates: list[Estimate] = field(default_factory=list)
    host: dict[str, Any] = field(default_factory=dict)
    created_utc: str = ""
    file: str = ""
    """Name of its file without the ending: that of its predictions too."""


@dataclass(frozen=True)
class Latency:
    """Microseconds for one call with `batch` rows: median, its 95 % interval, percentiles."""

    batch: int
    median_us: float
    low_us: float
    high_us: float
    p95_us: float
    p99_us: float
    unstable: bool
    reference_ratio: float | None = None


@dataclass(frozen=True)
class Timing:
    """Measured speed and memory of one artifact on one machine; `withheld`: why no speed is."""

    model: str
    backend: str
    data: str
    artifact_sha256: str
    machine: dict[str, Any]
    latency: list[Latency]
    throughput_rows_per_s: float | None
    peak_memory_bytes: int
    energy_mj: Interval | None
    energy_how: str
    withheld: str | None = None
    created_utc: str = ""


@dataclass(frozen=True)
class Unreadable:
    """A file that was left out, and why."""

    path: str
    reason: str


@dataclass(frozen=True)
class Results:
    """Everything a result folder holds, in the order of the file names."""

    folder: Path
    runs: list[Run]
    timings: list[Timing]
    unreadable: list[Unreadable]

    def left_out(self) -> list[str]:
        """Return the files that were not believed, each with its reason."""
        return [f"{self.folder / one.path}: {one.reason}" for one in self.unreadable]


Estimator = Callable[[Run], list[Estimate]]


def read_results(folder: Path, estimator: Estimator | None = None) -> Results:
    """Read `folder`. Raises ReportError where it does not exist or holds no readable run.

    `estimator` gives a run's estimates for devices, from the device profiles as they are now.
    """
    if not folder.is_dir():
        raise ReportError(f"no results folder {folder}: `bench run --out {folder}` makes one")
    unreadable: list[Unreadable] = []
    runs = list(_records(folder, "runs", Run, unreadable))
    if estimator is not None:
        runs = [replace(run, estimates=estimator(run)) for run in runs]
    timings = list(_records(folder, "timings", Timing, unreadable))
    if not runs:
        raise ReportError(_nothing_found(folder, unreadable))
    return Results(folder, runs, timings, unreadable)


def _nothing_found(folder: Path, unreadable: list[Unreadable]) -> str:
    text = f"no results in {folder}: expected runs/*.json, as `bench run` writes them"
    if unreadable:
        first = unreadable[0]
        text += f" ({len(unreadable)} unreadable, the first {first.path}: {first.reason})"
    return text


def _records(folder: Path, part: str, kind: type[T], bad: list[Unreadable]) -> Iterator[T]:
    """Yield the records of one sub-folder; files that are none are appended to `bad`."""
    # A name with a leading dot is a file still being written.
    for path in sorted(folder.glob(f"{part}/[!.]*.json")):
        try:
            yield _record(path, kind)
        except (OSError, ValueError, RecursionError) as problem:
            reason = str(problem).split("\n")[0] or type(problem).__name__
            bad.append(Unreadable(f"{part}/{path.name}", reason))


def _record(path: Path, kind: type[T]) -> T:
    """Return one record. Raises ValueError (msgspec's errors are ValueErrors) where it is none."""
    content = believed(path)
    expected = kind.__name__.lower()
    if content.get("kind") != expected:
        raise ValueError(f"kind {content.get('kind')!r}, expected {expected!r}")
    content["estimates"], content["file"] = [], path.stem
    record = msgspec.convert(content, kind)
    if path.stem != (belongs := _name_of(content)):
        raise ValueError(f"it was renamed: what it holds is written as {belongs}.json")
    return record


def _name_of(content: dict[str, Any]) -> str:
    """Return the name a record's file must have: the hash of what determines it."""
    if content["kind"] == "run":
        return digest(content["key"])[:20]
    of = [content[name] for name in ("model", "backend", "data", "artifact_sha256")]
    return digest([*of, content["machine"].get("id", content["machine"])])[:20]
