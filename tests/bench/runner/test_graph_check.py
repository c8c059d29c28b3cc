"""A model whose graph says something else than its `predict` is remarked upon."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest
import torch
from recordings_factory import make_recordings

from bench.plugins import Plugin
from bench.runner.graph_check import graph_remark
from bench.runner.groups import _fit
from bench.runner.material import load_material
from bench.runner.spread_groups import Notes
from zoo.none import NoMitigation

ROWS = np.ones((200, 12), np.float32)


class Shifted(NoMitigation):
    """Predicts a little more than its graph does."""

    def __init__(self, by_m: float = 0.04) -> None:
        self.by_m = by_m

    def predict(self, X):
        return super().predict(X) + np.float32(self.by_m)


class Broken(NoMitigation):
    def to_module(self) -> torch.nn.Module:
        raise RuntimeError("no graph")


@pytest.mark.parametrize(("by_m", "said"), [(0.0, None), (5e-4, None), (0.025, "0.025 m")])
def test_a_difference_is_told_in_metres(by_m: float, said: str | None) -> None:
    model = Shifted(by_m).fit(ROWS, np.zeros(200))
    remark = graph_remark("mine", model, ROWS)
    assert (remark is None) == (said is None)
    if said:
        assert remark.startswith("mine: predict() and the graph of to_module() differ by up to ")
        assert said in remark
        assert "64 training rows" in remark


def test_what_cannot_be_asked_is_not_remarked_upon() -> None:
    assert graph_remark("mine", Broken().fit(ROWS, np.zeros(200)), ROWS) is None
    assert graph_remark("mine", NoMitigation().fit(ROWS, np.zeros(200)), ROWS[:0]) is None


def test_a_run_says_so_once(tmp_path, monkeypatch) -> None:
    monkeypatch.setenv("BENCH_CACHE", str(tmp_path))
    plugin = Plugin("models", "shifted", f"{__name__}:Shifted", "tests")
    job, notes = SimpleNamespace(model=plugin, key=SimpleNamespace(seed=0)), Notes()
    _fit(job, load_material(make_recordings(rows=96), "link-kfold:2"), notes)
    [line] = notes.lines
    assert "differ by up to 0.04 m" in line
