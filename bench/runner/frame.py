"""Records as one flat pandas frame."""

from __future__ import annotations

from collections.abc import Iterable
from typing import Any

import pandas as pd

from bench.results import RunRecord, Score, TimingRecord


def frame_of(runs: Iterable[RunRecord], timings: Iterable[TimingRecord]) -> pd.DataFrame:
    """Return one row per run; timings join on model, backend and data."""
    timed = {(one.model, one.backend, one.data): one for one in timings}
    rows = [_row(run, timed.get((run.key.model, run.key.backend, run.key.data))) for run in runs]
    return pd.DataFrame(rows)


def _row(run: RunRecord, timing: TimingRecord | None) -> dict[str, Any]:
    key = run.key
    row: dict[str, Any] = {
        "model": key.model,
        "backend": key.backend,
        "data": key.data,
        "simulated": run.simulated,
        "split": key.split,
        "seed": key.seed,
        "status": run.status,
        "reason": run.reason,
        **_score_columns("nlos", run.nlos),
        **_score_columns("los", run.los),
    }
    if run.size is not None:
        row |= {name: getattr(run.size, name) for name in run.size.__dataclass_fields__}
    return row | _timing_columns(timing)


def _score_columns(kind: str, score: Score | None) -> dict[str, float | int]:
    if score is None:
        return {}
    return {
        f"{kind}_rows": score.rows,
        f"{kind}_mae_m": score.mae_m.value,
        f"{kind}_r2": score.r2.value,
        f"{kind}_sigma_m": score.sigma_m.value,
        f"{kind}_raw_mae_m": score.raw_mae_m,
    }


def _timing_columns(timing: TimingRecord | None) -> dict[str, float | int | None]:
    if timing is None:
        return {}
    columns: dict[str, float | int | None] = {
        f"latency_batch{one.batch}_us": one.median_us for one in timing.latency
    }
    columns["throughput_rows_per_s"] = timing.throughput_rows_per_s
    columns["peak_memory_bytes"] = timing.peak_memory_bytes
    return columns
