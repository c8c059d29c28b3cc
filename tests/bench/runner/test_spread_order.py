"""Whose turn it is when whole models are given to several processes."""

from __future__ import annotations

from bench.plugins import find
from bench.runner.spread_groups import _turn, rows_to_see
from zoo.training.recipe import Stopping, TrainingRecipe


def test_teachers_come_before_those_they_teach_and_what_is_soon_done_last() -> None:
    names = ["none", "small-cnn", "mlp", "gbm", "small-levels", "remnet", "bregar2023"]
    order = sorted(names, key=lambda name: _turn(find("models", name), 36_000))
    assert set(order[3:5]) == {"small-cnn", "small-levels"}
    assert order[5:] == ["gbm", "none"]  # a floor last
    assert "remnet" in order[:2]  # as many rows to see as the other


def test_rows_to_see() -> None:
    by_epochs = TrainingRecipe("mae", 1e-3, 32, 30)
    assert rows_to_see(by_epochs, 100) == 3000
    by_steps = TrainingRecipe("mae", 1e-3, 32, 30, stopping=Stopping(most_steps=50))
    assert rows_to_see(by_steps, 100) == 1600
