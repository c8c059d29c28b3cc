"""Makes folders of result files out of the records `bench run` writes."""

from __future__ import annotations

import hashlib
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from msgspec import convert

from bench.results import (
    Cost,
    Estimate,
    Interval,
    Latency,
    Layer,
    RunKey,
    RunRecord,
    Score,
    Size,
    TimingRecord,
    to_json,
)
from reports import Results, read_results
from reports.load import Estimate as GuessRead
from reports.load import Run

VERSIONS = {"numpy": "2.4.6", "onnxruntime": "1.31.1", "torch": "2.13.0"}
MACHINE = {
    "cpu": "Example CPU 3000",
    "cores": 2,
    "instruction_sets": ["avx2", "fma"],
    "system": "Linux x86_64",
    "python": "3.11.9",
    "id": "0123abcd",
}


ESTIMATES = [
    Estimate("cortex-a53", Interval(900.0, 500.0, 1500.0), Interval(1.5, 0.8, 2.9)),
    Estimate("edge-tpu", None, None, "runs int8 only"),
]
GUESSED: dict[str, list[Estimate]] = {}


def interval(value: float, half: float) -> Interval:
    return Interval(value, value - half, value + half)


def score(mae: float = 0.07, raw_mae: float = 0.12, **changes: Any) -> Score:
    made = Score(
        rows=8000,
        links=160,
        mae_m=interval(mae, 0.004),
        r2=interval(1 - mae / raw_mae, 0.03),
        sigma_m=interval(1.4 * mae, 0.006),
        bias_m=0.001,
        raw_mae_m=raw_mae,
        raw_sigma_m=1.3 * raw_mae,
    )
    return replace(made, **changes)


def key(model: str = "remnet", backend: str = "fp32", **changes: Any) -> RunKey:
    made = RunKey(
        model=model,
        backend=backend,
        data="rooms",
        data_fingerprint="0123456789abcdef",
        split="leave-environment-out:medium",
        seed=0,
        code_hash="c0de",
        versions=VERSIONS,
    )
    return replace(made, **changes)


def run(model: str = "remnet", backend: str = "fp32", **changes: Any) -> RunRecord:
    """Return a finished run; keyword arguments of RunKey change the key, others the record."""
    of_key = {k: changes.pop(k) for k in list(changes) if k in RunKey.__dataclass_fields__}
    made_key = key(model, backend, **of_key)
    estimates = changes.pop("estimates", ESTIMATES)
    GUESSED[made_key.digest()] = estimates
    made = RunRecord(
        floor=model == "none",
        key=made_key,
        status="ok",
        simulated=made_key.data == "rooms",
        nlos=score(),
        los=score(0.04, 0.06),
        size=Size(30_000, 24_604, 6151, 1_234_567),
        cost=Cost((Layer("conv", 1_234_567, 5000, "fp32"),), 24_604),
        precision="fp32",
        artifact_sha256=hashlib.sha256(repr(made_key).encode()).hexdigest(),
        created_utc="2026-03-01T10:00:00+00:00",
    )
    return replace(made, **changes)


def skipped(model: str, backend: str, reason: str, **changes: Any) -> RunRecord:
    made = run(model, backend, **changes)
    bare = {"nlos": None, "los": None, "size": None, "artifact_sha256": None}
    GUESSED[made.digest()] = []
    return replace(made, status="skipped", reason=reason, **bare)


def latency(batch: int, median_us: float, unstable: bool = False) -> Latency:
    low, high = 0.98 * median_us, 1.02 * median_us
    p95, p99 = 1.2 * median_us, 1.5 * median_us
    return Latency(batch, median_us, low, high, p95, p99, unstable, [low, median_us, high])


def timing(of: RunRecord, median_us: float = 100.0, **changes: Any) -> TimingRecord:
    made = TimingRecord(
        model=of.key.model,
        backend=of.key.backend,
        data=of.key.data,
        artifact_sha256=of.artifact_sha256 or "",
        machine=MACHINE,
        latency=[latency(1, median_us), latency(4, 2.5 * median_us)],
        throughput_rows_per_s=4e6 / (2.5 * median_us),
        peak_memory_bytes=80_000_000,
        energy_mj=None,
        energy_how="",
        created_utc="2026-03-01T11:00:00+00:00",
    )
    return replace(made, **changes)


def write(folder: Path, *records: RunRecord | TimingRecord) -> Path:
    """Write each record under its digest, as the runner does; return the folder."""
    for record in records:
        part = folder / f"{record.kind}s"
        part.mkdir(parents=True, exist_ok=True)
        (part / f"{record.digest()}.json").write_text(to_json(record))
    return folder


def guesses(run: Run) -> list[GuessRead]:
    """Return the estimates that `run` was told to have, as a reader of the folder makes them."""
    digest = RunKey(**asdict(run.key)).digest()
    return [convert(asdict(one), GuessRead) for one in GUESSED[digest]]


def read(folder: Path, *records: RunRecord | TimingRecord) -> Results:
    """Write the records and read the folder, estimates included."""
    return read_results(write(folder, *records), guesses)


def full_folder(folder: Path) -> Path:
    """Write a folder with simulated and real data, several seeds, skips and odd timings."""
    maes = {"none": 0.12, "svm": 0.09, "mlp": 0.085, "cnn1d": 0.075, "remnet": 0.07}
    speeds = {"none": 3.0, "svm": 400.0, "mlp": 40.0, "cnn1d": 150.0, "remnet": 90.0}
    backends = {"fp32": 1.0, "graph": 0.8, "fp16": 0.95, "int8": 0.5, "qat": 0.5}
    for data in ("rooms", "apartment"):
        for model, mae in maes.items():
            for i, (backend, factor) in enumerate(backends.items()):
                write(
                    folder, *_pair(data, model, mae + 0.0005 * i, backend, factor * speeds[model])
                )
    return folder


def _pair(
    data: str, model: str, mae_m: float, backend: str, median_us: float
) -> list[RunRecord | TimingRecord]:
    split = {"rooms": "leave-environment-out:medium", "apartment": "link-kfold:5"}[data]
    place = {"data": data, "split": split, "data_fingerprint": f"{data}0123456789"[:16]}
    if model in ("none", "svm") and backend == "qat":
        return [skipped(model, backend, "not trained by gradient descent", **place)]
    integer = backend in ("int8", "qat")
    first = [
        run(
            model,
            backend,
            seed=seed,
            nlos=score(mae_m + 0.0003 * seed),
            size=Size(12_000 if integer else 30_000, 6_151 if integer else 24_604, 6151, 1_234_567),
            integer_kernels="14/14" if integer else None,
            precision="int8" if integer else "fp32",
            note="weights stored as fp16, computed in fp32" if backend == "fp16" else "",
            **place,
        )
        for seed in range(3)
    ]
    return [*first, timing(first[0], median_us)]
