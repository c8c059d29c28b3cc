"""The networks of a search: drawn, sized, thinned, and their cost fitted."""

from __future__ import annotations

import numpy as np
import pytest
import torch
from torch import nn

from bench.errors import BenchError
from bench.search.calibrate import cost_model
from bench.search.halving import rungs, survivors
from bench.search.space import Candidate, Size, drawn, size_of
from zoo.modules.small import Shape, SmallNetwork

NETWORKS = drawn(40, 3, 300_000)


def test_drawn_are_different_small_enough_and_the_seeds() -> None:
    assert len(set(NETWORKS)) == len({one.name for one in NETWORKS}) == 40
    assert max(size_of(one).macs for one in NETWORKS) <= 300_000
    assert drawn(40, 3, 300_000) == NETWORKS
    assert drawn(40, 4, 300_000) != NETWORKS
    assert drawn(10, 3, 300_000) == NETWORKS[:10]


def test_more_than_there_are_is_refused() -> None:
    with pytest.raises(BenchError, match="--candidates 1: expected a whole number from 2 to"):
        drawn(1, 0, 300_000)
    with pytest.raises(BenchError, match="only 0 are as small as asked"):
        drawn(2, 0, 10)


@pytest.mark.parametrize("candidate", NETWORKS[:12], ids=lambda one: one.name)
def test_sizes_are_those_of_the_network(candidate: Candidate) -> None:
    network, layers = SmallNetwork(candidate.shape).eval(), []

    def note(layer: nn.Module, _: object, out: torch.Tensor) -> None:
        layers.append((layer.weight[0].numel(), out.numel(), layer.weight.numel(), layer.bias))

    for layer in network.modules():
        if isinstance(layer, nn.Conv1d | nn.Linear):
            layer.register_forward_hook(note)
    assert network(torch.zeros(1, candidate.samples)).shape == (1,)
    assert size_of(candidate) == Size(
        sum(taps * values for taps, values, _, _ in layers),
        sum(values for _, values, _, _ in layers),
        len(layers),
        sum(weights + 4 * bias.numel() for _, _, weights, bias in layers),
    )


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"kernel": 4}, "kernel must be odd"),
        ({"filters": 0}, "sizes must be positive"),
        ({"reduction": 5}, "does not divide"),
    ],
)
def test_a_shape_that_is_none_is_refused(wrong: dict[str, int], said: str) -> None:
    with pytest.raises(ValueError, match=said):
        SmallNetwork(Shape(**wrong))


def test_survivors_are_the_front_then_the_next() -> None:
    points = [(3.0, 1.0), (1.0, 3.0), (2.0, 2.0), (3.0, 3.0), (2.5, 2.5)]
    assert survivors(points, 3) == [0, 1, 2]
    assert survivors(points, 4) == [0, 1, 2, 4]
    assert survivors(points, 2) == [0, 1]  # both ends
    assert survivors(points, 9) == [0, 1, 2, 3, 4]


def test_rungs_end_in_full() -> None:
    assert rungs(30, 3) == [3, 10, 30]
    assert rungs(2, 3) == [1, 1, 2]


def test_a_cost_that_is_linear_is_found() -> None:
    sizes = [size_of(one) for one in NETWORKS[:10]]
    cycles = [3 * one.macs + 20 * one.values + 900 * one.layers + 5000 for one in sizes]
    flash = [1.1 * one.weights + 700 * one.layers + 2000 for one in sizes]
    costs = cost_model(sizes, cycles, flash)
    assert max(costs.worst) < 1e-6
    other = size_of(NETWORKS[20])
    expected = 3 * other.macs + 20 * other.values + 900 * other.layers + 5000
    assert costs.cycles_of(other) == pytest.approx(expected)
    assert costs.flash_of(other) == pytest.approx(1.1 * other.weights + 700 * other.layers + 2000)
    with pytest.raises(ValueError, match="at least 4"):
        cost_model(sizes[:3], cycles[:3], flash[:3])


def test_no_part_of_a_cost_is_negative() -> None:
    rng = np.random.default_rng(0)
    sizes = [size_of(one) for one in NETWORKS[:6]]
    costs = cost_model(sizes, rng.uniform(1, 2, 6).tolist(), rng.uniform(1, 2, 6).tolist())
    assert min(*costs.cycles, *costs.flash) >= 0
    assert max(costs.worst) > 0
