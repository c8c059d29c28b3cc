"""How sets are searched: causes that only do much together, and what levels alone do not show."""

from __future__ import annotations

from collections.abc import Iterable
from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.sets.choose import Contest
from bench.physics.effects.ranging.power_bias import PowerBias
from tests.bench.discrepancy.sets.test_same_rows import names_of, rows_of


class Told(Contest):
    """A contest in which only the last two causes do anything, and only together."""

    def __init__(self) -> None:
        """Take part in nothing."""

    def weigh(self, sets: Iterable[tuple[str, ...]]) -> None:
        """Do nothing beforehand."""

    def worth(self, causes: tuple[str, ...]) -> float:
        """Return less for later causes, and much for the last pair."""
        pair = 100.0 if {"f", "g"} <= set(causes) else 0.0
        return pair - sum(ord(one) - 90 for one in causes)


def test_two_causes_that_do_little_alone_are_found() -> None:
    assert Told().best(tuple("abcdefg")) == ("f", "g")


def test_what_only_unusual_levels_show_gives_way_to_another_cause() -> None:
    contest = Told()
    weighed = SimpleNamespace(of=lambda _: SimpleNamespace(nats=0.0))
    evidence = SimpleNamespace(among=lambda _: weighed, mean_ratio=0.0)
    contest.evidence = evidence  # type: ignore[assignment]
    contest.usual, contest.crowding = np.ones(1, bool), 1.0
    contest.kinds = {"power-bias": PowerBias}
    contest.able = ("power-bias", "diffraction")
    contest.physical = contest._beyond_deformed = lambda able: able  # type: ignore[method-assign]
    assert contest._at_usual_levels(("power-bias",)) == ("diffraction",)


@pytest.mark.parametrize(
    ("shadowing_db", "left_open"),
    [(0.0, {"power-bias", "range-scale"}), (2.5, {"power-bias"})],
)
def test_a_scale_beside_a_constant_is_left_open_where_levels_follow_the_distance(
    shadowing_db: float, left_open: set[str]
) -> None:
    rng, frame = np.random.default_rng(4), rows_of(1)
    level = -62 - 20 * np.log10(frame["true_range_m"]) + rng.normal(0, shadowing_db, len(frame))
    curve = -0.012 * (level + 82) if shadowing_db else 0.004 * (frame["true_range_m"] - 11)
    assert names_of(frame.assign(rx_power_dbm=level), curve.to_numpy()) == left_open
