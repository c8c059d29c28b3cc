"""Rounded artifacts that are of no use are declined, with what they leave."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path

import numpy as np
import pytest
from recordings_factory import make_recordings

from backends.base import TrainingData
from bench.runner.evaluate import evaluate
from bench.runner.failure import DeclinedError
from bench.runner.material import load_material
from bench.runner.rounding import why_useless
from zoo.none import NoMitigation

ERRORS_M = np.linspace(0.0, 0.4, 600).astype(np.float32)  # 0.1 m about their median on average
DATA = TrainingData(ERRORS_M[:, None], ERRORS_M, 0)


@dataclass
class Off:
    """An artifact, and a model, that say each row's error but for a constant."""

    off_m: float
    precision: str = "int8"
    opener: str = "somewhere:open"

    def predict(self, rows):
        return rows[:, 0] + np.float32(self.off_m)


@pytest.mark.parametrize(("off_m", "of_use"), [(0.0, True), (0.09, True), (0.11, False)])
def test_rounding_may_cost_as_much_as_errors_spread(off_m: float, of_use: bool) -> None:
    said = why_useless(Off(0.0), Off(off_m), DATA)
    assert (said is None) == of_use
    if said:
        assert "int8: 0.11 m of error on training rows, the model itself 0 m" in said


def test_what_was_no_better_before_it_was_rounded_stays() -> None:
    assert why_useless(Off(5.0), Off(5.05), DATA) is None
    assert why_useless(Off(5.0), Off(0.0), DATA) is None  # trained further, and better


def test_nothing_rounded_nothing_asked() -> None:
    assert why_useless(Off(0.0), Off(5.0, "fp32"), DATA) is None


def test_the_pair_is_declined() -> None:
    class Rounding:
        opener = "somewhere:open"

        def build(self, model, data, path, progress):
            return Off(1e6)

    material = load_material(make_recordings(rows=96), "link-kfold:2")
    models = [NoMitigation().fit(material.cirs, material.errors_m) for _ in range(2)]
    with pytest.raises(DeclinedError, match="useless in int8"):
        evaluate(models, Rounding(), material, 0, [Path("a"), Path("b")])
