"""Depthwise and grouped convolutions: a plug-in's network in C, as the runtime computes it."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from torch import Tensor, nn

from backends.base import TrainingData
from backends.c.compile import FLAGS, NATIVE, QUICK, missing_compiler
from backends.c.emit import generate
from backends.c.run import load
from backends.fp32 import Fp32Backend
from backends.int8 import Int8Backend
from backends.ort import open_optimised
from zoo.base import TrainingRecipe
from zoo.module_model import NeuralModel
from zoo.modules.preparation import Crop, Preparation
from zoo.modules.scaling import GlobalScale

pytestmark = pytest.mark.skipif(missing_compiler() is not None, reason=str(missing_compiler()))
SCALAR = (*QUICK, "-DUWB_SCALAR")


class Grouped(nn.Module):
    """Each channel by itself, mixed, then in two groups with gaps between the taps."""

    def __init__(self) -> None:
        super().__init__()
        self.layers = nn.Sequential(
            nn.Conv1d(1, 8, 5, stride=2, padding=2),
            nn.ReLU(),
            nn.Conv1d(8, 16, 3, stride=2, padding=1, groups=8),
            nn.ReLU(),
            nn.Conv1d(16, 8, 1),
            nn.ReLU(),
            nn.Conv1d(8, 8, 3, padding=1, groups=8),
            nn.Conv1d(8, 12, 3, padding=2, dilation=2, groups=2),
            nn.ReLU(),
            nn.Flatten(),
            nn.Linear(16 * 12, 1),
        )

    def forward(self, x: Tensor) -> Tensor:
        error: Tensor = self.layers(x.unsqueeze(1))
        return error.squeeze(-1)


class GroupedModel(NeuralModel):
    """The network as a model of a plug-in."""

    random_state = 0

    def training_recipe(self) -> TrainingRecipe:
        return TrainingRecipe("mae", 1e-3, 32, 1)

    def _preparation(self, width: int) -> Preparation:
        return Preparation(Crop(width, 0, 64), GlobalScale())

    def _network(self, preparation: Preparation) -> nn.Module:
        torch.manual_seed(0)
        network = Grouped()
        for parameter in network.parameters():
            parameter.data *= 2  # from where they start, answers would hardly differ
        return network


@pytest.fixture(scope="module")
def grouped() -> tuple[GroupedModel, TrainingData, NDArray[np.float32]]:
    rng = np.random.default_rng(0)
    rows = rng.rayleigh(100, (1200, 70)).astype(np.float32)
    errors_m = (rows[:, :24].mean(1) / 100 - rows[:, 9] / 300).astype(np.float32)
    model = GroupedModel().fit(rows[:600], errors_m[:600])
    return model, TrainingData(rows[:600], errors_m[:600], 0), rows[600:]


def test_float_c_with_groups_is_torch_in_float64(grouped, tmp_path: Path) -> None:
    model, data, rows = grouped
    artifact = Fp32Backend().build(model, data, tmp_path / "model.onnx")
    source = generate(artifact.path, "fp32")
    builds = [load(source, flags)(rows) for flags in (SCALAR, (*FLAGS, NATIVE))]
    with torch.inference_mode():
        exact = model.to_module().double()(torch.tensor(rows).double()).numpy()
    assert np.std(exact) > 1e-3
    assert np.abs(builds[0] - exact).max() <= 1e-6
    assert np.array_equal(*builds)


def test_8_bit_c_with_groups_is_the_runtime_bit_by_bit(grouped, tmp_path: Path) -> None:
    model, data, rows = grouped
    path = Int8Backend().build(model, data, tmp_path / "model.onnx").path
    expected = open_optimised(path)(rows)
    assert len(np.unique(expected)) > 20
    assert np.array_equal(load(generate(path, "int8"), SCALAR)(rows), expected)
    fixed = load(generate(path, "int8", "fixed"), SCALAR)(rows)
    assert np.mean(fixed == expected) >= 0.99
    small = load(generate(path, "int8", "fixed"), (*QUICK, "-D__ARM_ARCH_6M__"))(rows)
    assert np.array_equal(small, fixed)
