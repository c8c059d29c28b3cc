"""A small `dataset.pkl` of exactly the published form, with something in it to learn."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

KINDS = (
    *("0000000000", "0000001000", "0010000000", "0000000100", "0000000010"),
    *("1000000000", "0100000001"),
)


def deepuwb_table(rows_per_run: int = 20, runs: int = 70, seed: int = 0) -> pd.DataFrame:
    """Return runs of one room and one set of obstacles; a long range has a weak first path."""
    rng = np.random.default_rng(seed)
    rows = rows_per_run * runs
    run = np.arange(rows) // rows_per_run
    error_m = rng.gamma(2.0, 0.06, rows)
    pulse = np.exp(-(((np.arange(157) - 6) / 1.6) ** 2))
    cirs = np.abs(rng.normal(0, 60, (rows, 157)))
    cirs += 12000 * np.exp(-4 * error_m)[:, None] * pulse
    return pd.DataFrame(
        {
            "CIR": list(cirs),
            "Error": error_m,
            "Room": run % 5,
            "Obstacles": pd.Series([KINDS[r % len(KINDS)] for r in run], dtype=object),
        }
    )


@pytest.fixture
def deepuwb(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """Put the data set where `bench` looks for it; nothing else is there."""
    monkeypatch.setenv("BENCH_DATA", str(tmp_path / "data"))
    path = tmp_path / "data" / "deepuwb" / "dataset.pkl"
    path.parent.mkdir(parents=True)
    deepuwb_table().to_pickle(path)
    return path
