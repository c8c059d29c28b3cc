"""What a run gives: records with units, written as one JSON file each.

A `RunRecord` holds what the data, split, model, backend and seed determine; a `TimingRecord` what
the artifact and the machine determine. Leaderboards are rebuilt from these files alone.
"""

from __future__ import annotations

import hashlib
import json
from collections.abc import Mapping
from dataclasses import asdict, dataclass, field, fields, is_dataclass
from types import NoneType, UnionType
from typing import Any, Literal, TypeVar, get_args, get_origin, get_type_hints

T = TypeVar("T")

SCHEMA_VERSION = 1
Status = Literal["ok", "skipped"]


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
    """What determines a run. Its hash is the record's file name."""

    model: str
    backend: str
    data: str
    data_fingerprint: str
    split: str
    seed: int
    code_hash: str
    versions: Mapping[str, str]

    def digest(self) -> str:
        """Return 20 hex digits that stand for this key."""
        text = json.dumps(asdict(self), sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:20]


@dataclass(frozen=True)
class Size:
    """What the artifact takes: bytes on disk, bytes of weights, parameters, multiply-adds."""

    file_bytes: int
    weight_bytes: int
    parameters: int
    macs: int


@dataclass(frozen=True)
class Estimate:
    """Latency and energy of one inference (batch 1) on a device, from its profile: an ESTIMATE.

    `reason` is set, and the figures None, where the device cannot run that precision.
    """

    device: str
    latency_us: Interval | None
    energy_mj: Interval | None
    reason: str | None = None


@dataclass(frozen=True)
class RunRecord:
    """One model on one backend on one data set, split and seed.

    `nlos` and `los` are None where the test rows hold none of that kind (or no label at all: then
    every row is scored under `nlos` and `note` says so). `artifact` is the file beside the
    record, `artifact_sha256` its hash. Skipped runs carry a `reason` and no figures.
    """

    key: RunKey
    status: Status
    simulated: bool
    reason: str | None = None
    nlos: Score | None = None
    los: Score | None = None
    size: Size | None = None
    precision: str | None = None
    integer_kernels: str | None = None
    note: str = ""
    artifact: str | None = None
    artifact_sha256: str | None = None
    weights_sha256: str | None = None
    opener: str | None = None
    fit_s: float | None = None
    estimates: list[Estimate] = field(default_factory=list)
    host: Mapping[str, Any] = field(default_factory=dict)
    created_utc: str = ""
    schema_version: int = SCHEMA_VERSION
    kind: str = "run"


@dataclass(frozen=True)
class Latency:
    """Time of one call with `batch` rows, measured in a fresh process on one thread.

    All in microseconds; `low_us`..`high_us` is a 95 % nonparametric interval of the median.
    `samples_us` are the raw samples (each the mean of a calibrated loop). `unstable` warns that
    the samples drifted or spread too much to be quoted.
    """

    batch: int
    median_us: float
    low_us: float
    high_us: float
    p95_us: float
    p99_us: float
    unstable: bool
    samples_us: list[float]


@dataclass(frozen=True)
class TimingRecord:
    """Measured speed and memory of one artifact on one machine."""

    model: str
    backend: str
    data: str
    artifact_sha256: str
    machine: Mapping[str, Any]
    latency: list[Latency]
    throughput_rows_per_s: float
    peak_memory_bytes: int
    energy_mj: Interval | None
    energy_how: str
    created_utc: str = ""
    schema_version: int = SCHEMA_VERSION
    kind: str = "timing"


def to_json(record: RunRecord | TimingRecord) -> str:
    """Return the record as indented JSON text."""
    return json.dumps(asdict(record), indent=1, sort_keys=True, default=str) + "\n"


def from_json(kind: type[T], content: Mapping[str, Any]) -> T:
    """Return the dataclass `kind` rebuilt from parsed JSON.

    Raises KeyError, TypeError or ValueError where the content is not such a record.
    """
    hints = get_type_hints(kind)
    names = [one.name for one in fields(kind)]  # type: ignore[arg-type]
    return kind(**{name: _rebuild(hints[name], content[name]) for name in names})


def _rebuild(hint: Any, value: Any) -> Any:
    if get_origin(hint) is UnionType:
        inner = [arm for arm in get_args(hint) if arm is not NoneType]
        return None if value is None else _rebuild(inner[0], value)
    if get_origin(hint) is list:
        return [_rebuild(get_args(hint)[0], item) for item in value]
    return from_json(hint, value) if isinstance(hint, type) and is_dataclass(hint) else value
