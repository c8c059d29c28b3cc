"""Steps written out for small networks against the plain loop, and what they leave to it."""

from __future__ import annotations

from copy import deepcopy
from dataclasses import replace

import numpy as np
import pytest
import torch

from zoo.modules.small import Shape, SmallNetwork
from zoo.training import by_hand, eager
from zoo.training.recipe import Stopping, TrainingRecipe

RECIPE = TrainingRecipe("mae", 3e-3, 64, 2, decay=True)
SHAPES = [
    (96, 16, 7, 2, 1),
    (96, 16, 7, 2, 2),
    (33, 5, 5, 2, 3),
    (20, 3, 3, 1, 0),
    (31, 4, 7, 3, 2),
]


def rows(samples: int) -> tuple[np.ndarray, np.ndarray]:
    X = np.random.default_rng(0).rayleigh(1, (300, samples)).astype(np.float32)
    return X, X[:, 5] / 5


@pytest.mark.parametrize("sizes", SHAPES)
def test_it_ends_where_the_plain_loop_does(sizes: tuple[int, ...]) -> None:
    X, y = rows(sizes[0])
    ours = SmallNetwork(Shape(*sizes), seed=1)
    start, theirs = deepcopy(ours), deepcopy(ours)
    told: list[float] = []
    log = by_hand.train(ours, X, y, RECIPE, progress=told.append)
    plain = eager.train(theirs, X, y, RECIPE)
    assert (log.engine, log.steps, told) == ("fused", plain.steps, [0.5, 1.0])
    np.testing.assert_allclose(log.epoch_losses, plain.epoch_losses, rtol=1e-5)
    for own, other, first in zip(*(m.parameters() for m in (ours, theirs, start)), strict=True):
        assert not torch.equal(own, first)
        torch.testing.assert_close(own, other, atol=2e-6, rtol=1e-5)


def test_the_same_seed_gives_the_same_bits_and_another_does_not() -> None:
    X, y = rows(40)
    ends = []
    for seed in (0, 0, 1):
        network = SmallNetwork(Shape(40, 4, 3, 2, 1), seed=3)
        by_hand.train(network, X, y, replace(RECIPE, seed=seed))
        ends.append(network.head.weight.detach())
    assert torch.equal(ends[0], ends[1])
    assert not torch.equal(ends[0], ends[2])


@pytest.mark.parametrize(
    ("shape", "recipe"),
    [
        (Shape(20, 4, 3, 2, 1, reduction=2), RECIPE),
        (Shape(20, 4, 3, 2, 1, hidden=3), RECIPE),
        (Shape(20, 4, 3, 2, 1), replace(RECIPE, loss="mse")),
        (Shape(20, 4, 3, 2, 1), replace(RECIPE, decay=False, stopping=Stopping(4, 2, 1))),
    ],
)
def test_what_is_not_written_out_is_trained_plainly(shape: Shape, recipe: TrainingRecipe) -> None:
    network, (X, y) = SmallNetwork(shape), rows(20)
    assert by_hand.why_not(network, recipe)
    assert by_hand.train(network, X, y, recipe).engine == "eager"


def test_dropout_and_frozen_weights_are_left_to_the_plain_loop() -> None:
    assert "dropout" in str(by_hand.why_not(SmallNetwork(Shape(20), dropout=0.5), RECIPE))
    frozen = SmallNetwork(Shape(20))
    frozen.head.bias.requires_grad_(False)
    assert "frozen" in str(by_hand.why_not(frozen, RECIPE))


def test_empty_and_mismatched_rows_are_refused() -> None:
    X, y = rows(20)
    for few, errors_m in ((X[:0], y[:0]), (X, y[:5])):
        with pytest.raises(ValueError, match=r"no rows|do not match"):
            by_hand.train(SmallNetwork(Shape(20)), few, errors_m, RECIPE)
