"""Networks against what is published: sizes, shapes, and REMnet's equations written out again."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest
import torch
from numpy.typing import NDArray
from torch import nn

from zoo import CNN1D, FeatureMLP, REMnet
from zoo.cnn1d import FEWEST_SAMPLES, BregarNetwork, flat_features
from zoo.module_model import NeuralModel

Array = NDArray[np.float64]


@pytest.mark.parametrize(
    ("model", "parameters"), [(REMnet(), 6151), (CNN1D(), 47_147), (FeatureMLP(), 4673)]
)
def test_trainable_parameters(model: NeuralModel, parameters: int) -> None:
    module = model.untrained(157)
    assert sum(p.numel() for p in module.parameters() if p.requires_grad) == parameters


def layer_shapes(network: nn.Module, samples: int) -> list[tuple[str, tuple[int, ...]]]:
    """Return kind and output shape, without the batch, of every layer that carries weights."""
    shapes: list[tuple[str, tuple[int, ...]]] = []

    def note(layer: nn.Module, inputs: Any, output: torch.Tensor) -> None:
        shapes.append((type(layer).__name__, tuple(output.shape[1:])))

    for layer in network.modules():
        if isinstance(layer, nn.Conv1d | nn.Linear):
            layer.register_forward_hook(note)
    network.eval()(torch.zeros(1, samples))
    return shapes


def test_remnet_layer_shapes() -> None:
    def reduction(time: int) -> list[tuple[str, tuple[int, ...]]]:
        gate = [("Linear", (2,)), ("Linear", (16,))]
        return [("Conv1d", (16, time)), *gate, *[("Conv1d", (16, time // 2))] * 2]

    expected = [("Conv1d", (16, 128)), *reduction(128), *reduction(64), *reduction(32)]
    network = REMnet().untrained(157).network
    assert layer_shapes(network, 128) == [*expected, ("Linear", (1,))]
    assert network.head.in_features == 128 // 2**3 * 16


def test_cnn1d_layer_shapes() -> None:
    assert layer_shapes(CNN1D().untrained(157).network, 152) == [
        ("Conv1d", (10, 149)),
        ("Conv1d", (20, 75)),
        ("Conv1d", (20, 34)),
        ("Conv1d", (40, 17)),
        ("Linear", (128,)),
        ("Linear", (1,)),
    ]


@pytest.mark.parametrize("samples", [FEWEST_SAMPLES, 31, 100, 152, 153])
def test_cnn1d_flattened_length_at_other_widths(samples: int) -> None:
    network = BregarNetwork(samples, 0.5)
    assert network(torch.zeros(2, samples)).shape == (2,)
    assert network.dense.in_features == flat_features(samples)


def test_cnn1d_refuses_a_width_its_layers_cannot_take() -> None:
    with pytest.raises(ValueError, match="at least 30, got 29"):
        CNN1D(cir_samples=29).fit(np.ones((4, 157)), np.ones(4))


@pytest.mark.parametrize(("samples", "modules"), [(128, 3), (157, 3), (8, 1), (45, 2)])
def test_remnet_forward_pass_is_the_papers_equations(samples: int, modules: int) -> None:
    generator = np.random.default_rng(samples)
    network = REMnet(cir_samples=samples, modules=modules).untrained(157).network.eval()
    weights = {
        name: generator.normal(0, 0.3, value.shape).astype(np.float32).astype(np.float64)
        for name, value in network.state_dict().items()
    }
    network.load_state_dict({name: torch.from_numpy(value) for name, value in weights.items()})
    rows = generator.rayleigh(0.5, (20, samples))
    with torch.no_grad():
        double = network.double()(torch.from_numpy(rows)).numpy()
        single = network.float()(torch.from_numpy(rows).float()).numpy()
    expected = np.array([remnet(weights, row, modules) for row in rows])
    np.testing.assert_allclose(double, expected, rtol=1e-12, atol=1e-12 * np.ptp(expected))
    np.testing.assert_allclose(single, expected, rtol=1e-4, atol=1e-5 * np.ptp(expected))


def remnet(w: dict[str, Array], cir: Array, modules: int) -> float:
    """REMnet by the paper's equations, on a K x F tensor as it writes them."""
    x = relu(conv(w, "first", cir[:, None]))
    for n in range(modules):
        x = reduce_(w, f"rrms.{n}", residual(w, f"rrms.{n}", x))
    flat = x.T.reshape(-1)  # the head's columns are ordered feature by feature
    return float(flat @ w["head.weight"][0] + w["head.bias"][0])


def residual(w: dict[str, Array], name: str, x: Array) -> Array:
    """Res(x) = SE(Conv1D(x)) + x."""
    return squeeze_excite(w, f"{name}.gate", relu(conv(w, f"{name}.residual", x))) + x


def reduce_(w: dict[str, Array], name: str, x: Array) -> Array:
    """Red(x) = Conv1D_1(x) + Conv1D_2(x), both with stride 2."""
    return relu(conv(w, f"{name}.wide", x, 2)) + relu(conv(w, f"{name}.narrow", x, 2))


def squeeze_excite(w: dict[str, Array], name: str, x: Array) -> Array:
    """SE(x) = FC_2(FC_1(mean over time)) * x."""
    hidden = relu(dense(w, f"{name}.squeeze", x.sum(0) / len(x)))
    return x * (1 / (1 + np.exp(-dense(w, f"{name}.excite", hidden))))


def dense(w: dict[str, Array], name: str, x: Array) -> Array:
    return w[f"{name}.weight"] @ x + w[f"{name}.bias"]


def conv(w: dict[str, Array], name: str, x: Array, stride: int = 1) -> Array:
    """Zero-padded convolution of x [K, in]: output t looks at the kernel centred on t x stride."""
    kernel = w[f"{name}.weight"]  # [out, in, taps]
    half = kernel.shape[2] // 2
    padded = np.pad(x, ((half, half), (0, 0)))
    steps = range(0, len(x), stride)
    taps = [padded[t : t + kernel.shape[2]] for t in steps]
    return np.array([np.einsum("oik,ki->o", kernel, tap) for tap in taps]) + w[f"{name}.bias"]


def relu(x: Array) -> Array:
    return np.maximum(x, 0)
