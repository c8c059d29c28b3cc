"""What a run gives: records with units, written as one JSON file each.

A `RunRecord` holds what the data, split, model, backend and seed determine; a `TimingRecord` what
the artifact and the machine determine. Leaderboards are rebuilt from these files alone.
"""

from __future__ import annotations

import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field
from typing import Any, Literal, TypeVar

from bench.provenance import SEAL, is_sealed, json_digest, sealed

T = TypeVar("T")

SCHEMA_VERSION = 2
Status = Literal["ok", "skipped"]
How = Literal["measured", "counted", "estimated", "published"]


@dataclass(frozen=True)
class Interval:
    """A figure with its 95 % interval (None where it could not be estimated)."""

    value: float
    low: float | None = None
    high: float | None = None


@dataclass(frozen=True)
class Score:
    """Accuracy of corrected ranges on one set of rows; intervals by bootstrap over links.

    Residual = error - predicted error. `mae_m` its mean magnitude, `sigma_m` its standard
    deviation, `bias_m` its mean (metres); `r2` = 1 - sum residual^2 / sum (error - mean error)^2.
    `raw_mae_m` and `raw_sigma_m` are the same before mitigation.
    """

    rows: int
    links: int
    mae_m: Interval
    r2: Interval
    sigma_m: Interval
    bias_m: float
    raw_mae_m: float
    raw_sigma_m: float


@dataclass(frozen=True)
class RunKey:
    """All that determines a run. Its hash is the record's file name.

    `model_target` and `backend_target` are what the registered names lead to, `declared` what the
    two plug-ins say they read besides. `threads` is None where their number changes no bit.
    """

    model: str
    backend: str
    data: str
    data_fingerprint: str
    split: str
    seed: int
    code_hash: str
    versions: Mapping[str, str]
    simulated: bool = False
    model_target: str = ""
    backend_target: str = ""
    declared: Mapping[str, str] = field(default_factory=dict)
    threads: int | None = None

    def digest(self) -> str:
        """Return 20 hex digits that stand for this key."""
        return json_digest(asdict(self))


@dataclass(frozen=True)
class Size:
    """What the artifact takes: bytes on disk, bytes of weights, parameters, multiply-adds."""

    file_bytes: int
    weight_bytes: int
    parameters: int
    macs: int


@dataclass(frozen=True)
class Layer:
    """One kernel of one inference of a single row, as `backends.cost.LayerCost` counts it.

    `reads` is 0 in records that are older than it.
    """

    kind: str
    macs: int
    outputs: int
    dtype: str
    reads: int = 0


@dataclass(frozen=True)
class Cost:
    """What every estimate for a device is made from: kernels in order, bytes of weights.

    `inputs`: values a row holds; 0 in records that are older than it.
    """

    layers: tuple[Layer, ...]
    weight_bytes: int
    inputs: int = 0


@dataclass(frozen=True)
class Training:
    """How one fold's model was trained: by which engine, how often over its rows, how fast."""

    engine: str | None = None
    epochs: int | None = None
    rows_per_s: float | None = None


@dataclass(frozen=True)
class Estimate:
    """Latency and energy of one inference (batch 1) on a device that is not here.

    `how` says where they come from: "estimated" from its profile, or "counted" (emulated), then
    `fits` says what of its flash and RAM that takes. `reason` is set, and the figures None, where
    the device cannot run the network. Estimates are made when a result is shown, and never kept:
    profiles change, runs do not.
    """

    device: str
    latency_us: Interval | None
    energy_mj: Interval | None
    reason: str | None = None
    how: How = "estimated"
    fits: str | None = None


@dataclass(frozen=True)
class Cycles:
    """Cycles of one call by a core's table: low, typical, high; no wait states of memory."""

    low: float
    typical: float
    high: float


@dataclass(frozen=True)
class CountRecord:
    """What one call of an artifact takes on a core, COUNTED in an emulator.

    `outputs_equal` of `rows` answers were this machine's bit by bit, `largest_m` is the most that
    any was off, in metres. `ram_bytes`: variables and stack.
    """

    artifact_sha256: str
    core: str
    compiler: str
    rows: int
    outputs_equal: int
    largest_m: float
    instructions: float
    cycles: Cycles
    flash_reads: int
    flash_bytes: int
    ram_bytes: int
    created_utc: str = ""
    schema_version: int = SCHEMA_VERSION
    kind: str = "count"

    def digest(self) -> str:
        """Return the name of the record's file, without its ending."""
        return json_digest([self.artifact_sha256, self.core])


@dataclass(frozen=True)
class RunRecord:
    """One model on one backend on one data set, split and seed.

    `nlos` and `los` are None where the test rows hold none of that kind (or no label at all: then
    every row is scored under `nlos` and `note` says so). `artifact` is the first fold's file, for
    people; `artifacts_sha256` are the hashes of every fold's. `floor` marks a model that mitigates
    nothing. `training` is how each fold was trained, where the model tells. Skipped runs carry a
    `reason` and no figures.
    """

    key: RunKey
    status: Status
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
    artifact: str | None = None
    artifact_sha256: str | None = None
    artifacts_sha256: tuple[str, ...] = ()
    predictions_sha256: str | None = None
    weights_sha256: str | None = None
    fit_s: float | None = None
    training: tuple[Training, ...] = ()
    host: Mapping[str, Any] = field(default_factory=dict)
    created_utc: str = ""
    schema_version: int = SCHEMA_VERSION
    kind: str = "run"

    def digest(self) -> str:
        """Return the name of the record's file, without its ending."""
        return self.key.digest()


@dataclass(frozen=True)
class Latency:
    """Time of one call with `batch` rows, measured in a fresh process on one thread.

    All in microseconds; `low_us`..`high_us` is a 95 % nonparametric interval of the median.
    `samples_us` are the raw samples (each the mean of a calibrated loop) of the rounds that nothing
    disturbed. `unstable` warns that they drifted or spread too much to be quoted.
    `reference_ratio` is the time over that of a product of two 96 x 96 matrices in the same round.
    """

    batch: int
    median_us: float
    low_us: float
    high_us: float
    p95_us: float
    p99_us: float
    unstable: bool
    samples_us: list[float]
    reference_ratio: float | None = None


@dataclass(frozen=True)
class TimingRecord:
    """Measured speed and memory of one artifact on one machine.

    `withheld` says why there is no latency and no throughput: the machine was busy with other work
    in too many of the `rounds`, and such figures are not kept. `reference_us` is the level of the
    reference loop (`Latency.reference_ratio`) in microseconds.
    """

    model: str
    backend: str
    data: str
    artifact_sha256: str
    machine: Mapping[str, Any]
    latency: list[Latency]
    throughput_rows_per_s: float | None
    peak_memory_bytes: int
    energy_mj: Interval | None
    energy_how: str
    rounds: int = 0
    dropped: int = 0
    reference_us: float | None = None
    withheld: str | None = None
    created_utc: str = ""
    schema_version: int = SCHEMA_VERSION
    kind: str = "timing"

    def digest(self) -> str:
        """Return the name of the record's file, without its ending."""
        where = self.machine.get("id", self.machine)
        return json_digest([self.model, self.backend, self.data, self.artifact_sha256, where])


def to_json(record: RunRecord | TimingRecord | CountRecord) -> str:
    """Return the record as indented JSON text, with the hash of its content."""
    plain = json.loads(json.dumps(asdict(record), default=str))
    return json.dumps(sealed(plain), indent=1, sort_keys=True) + "\n"


def from_json(kind: type[T], content: Any) -> T:
    """Return the dataclass `kind` rebuilt from parsed JSON.

    Raises ValueError, saying why, where the content is not such a record or was edited since it
    was written.
    """
    import msgspec

    if not isinstance(content, dict):
        raise ValueError("not a JSON object")
    if content.get("schema_version") != SCHEMA_VERSION:
        raise ValueError(f"schema_version {content.get('schema_version')!r} of another program")
    if not is_sealed(content):
        raise ValueError(f"its content is not that of its {SEAL}: it was edited or damaged")
    return msgspec.convert(content, kind)
