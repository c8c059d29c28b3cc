"""Which rows a run shows to fitting and to calibration: never one it is scored on."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
from numpy.typing import NDArray
from recordings_factory import make_recordings

import bench
from backends.fp32 import Fp32Backend
from bench.recordings import write_recordings
from bench.recordings.table import Recordings
from zoo.none import NoMitigation

Seen = list[set[str]]


def links_of(cirs: NDArray[np.float32], table: Recordings) -> set[str]:
    """Return the links whose rows these are: every row's CIR has a highest sample of its own."""
    known = {float(np.max(row)): link for row, link in table.frame[["cir", "link"]].to_numpy()}
    assert len(known) == len(table)
    return {known[float(value)] for value in cirs.max(axis=1)}


@pytest.fixture
def seen(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> dict[str, Seen]:
    """Run `none` on fp32 over two folds; return the links seen by fit, build and predict."""
    table, noted = make_recordings(rows=96), {"fit": [], "build": [], "predict": []}
    write_recordings(table, tmp_path / "noise.parquet")
    fit, build = NoMitigation.fit, Fp32Backend.build

    def spied_fit(self, X, y, **options):
        noted["fit"].append(links_of(X, table))
        return fit(self, X, y, **options)

    def spied_build(self, model, data, path, progress=None):
        noted["build"].append(links_of(data.cirs, table))
        artifact = build(self, model, data, path, progress)
        predict = artifact.predict
        object.__setattr__(artifact, "predict", lambda X: _note(noted, X, table) or predict(X))
        return artifact

    monkeypatch.setattr(NoMitigation, "fit", spied_fit)
    monkeypatch.setattr(Fp32Backend, "build", spied_build)
    monkeypatch.setattr("bench.runner.api.time_artifacts", lambda *_, **__: ([], []))
    done = bench.run(
        "none", "fp32", str(tmp_path / "noise.parquet"), split="link-kfold:2", out=tmp_path / "out"
    )
    assert not done.failures
    return noted


def _note(noted: dict[str, Seen], X: NDArray[np.float32], table: Recordings) -> None:
    noted["predict"].append(links_of(X, table))


@pytest.mark.parametrize("shown_to", ["fit", "build"])
def test_no_link_that_is_scored_is_shown(seen: dict[str, Seen], shown_to: str) -> None:
    every = {f"link-{k}" for k in range(12)}
    assert len(seen[shown_to]) == len(seen["predict"]) == 2
    for shown, scored in zip(seen[shown_to], seen["predict"], strict=True):
        assert shown | scored == every
        assert not shown & scored


def test_every_link_is_scored_once(seen: dict[str, Seen]) -> None:
    first, second = seen["predict"]
    assert not first & second
    assert len(first | second) == 12
