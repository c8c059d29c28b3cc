"""`bench.run` with its work spread: the same figures however it was spread."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

import bench
from bench.recordings.table import Recordings
from bench.results import RunRecord
from bench.runner import api
from bench.runner.spread_groups import Notes

MODELS = "mlp,constant"
PASSING = {"created_utc", "fit_s", "host", "training", "content_sha256"}


def table() -> pd.DataFrame:
    rng = np.random.default_rng(0)
    error_m = rng.uniform(0.0, 0.5, 96)
    cirs = rng.rayleigh(50.0, (96, 157)).astype(np.float32)
    cirs[:, 7] += 4000.0 * error_m
    frame = pd.DataFrame({"range_m": 3.0 + error_m, "true_range_m": 3.0, "cir": list(cirs)})
    return frame.assign(first_path_index=5.0, los=False, link=[f"l{row // 8}" for row in range(96)])


@pytest.fixture
def quick(monkeypatch: pytest.MonkeyPatch) -> None:
    """Time nothing: what is spread is never timed."""
    monkeypatch.setattr(api, "time_artifacts", lambda *_: ([], []))


def figures(folder: Path, monkeypatch, **how: Any) -> list[Any]:
    """Return every run's record without what names time and machine, with nothing cached."""
    monkeypatch.setenv("BENCH_CACHE", str(folder / "cache"))
    asked = {"model": MODELS, "backend": "fp32,fp16", "split": "link-kfold:2"}
    heard, data = Notes(), Recordings(table(), "tiny")
    done = bench.run(**asked, data=data, out=folder / "out", observer=heard, **how)
    assert done.failures == []
    assert heard.lines == ["constant on fp16 skipped: Constant has no weights"]
    return [plain(record) for record in done.runs]


def plain(record: RunRecord) -> Any:
    from bench.results import to_json

    content = json.loads(to_json(record))
    return {name: value for name, value in content.items() if name not in PASSING}


@pytest.mark.slow
def test_figures_do_not_depend_on_how_the_work_was_spread(
    quick: None, cluster: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    alone = figures(tmp_path / "alone", monkeypatch)
    assert len(alone) == 4
    assert figures(tmp_path / "jobs", monkeypatch, jobs=2) == alone
    assert figures(tmp_path / "dask", monkeypatch, scheduler=cluster) == alone
