"""What a set leaves is asked beside noise of the recorded colour, which has no name."""

from __future__ import annotations

import pytest
from test_joint_sets import compared, recordings

from bench.discrepancy.joint.polish import Fit, fitted
from bench.discrepancy.joint.remains import colour_of, coloured, remains
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.noise_floor import NoiseFloor

COLOUR = NoiseFloor(0.0, 0.0, 0.3, -0.15, -0.2)
FOUND = NoiseFloor(0.1, 0.0, 0.3, -0.15, -0.2)


def asked() -> tuple[Statistics, Fit, Fit]:
    """Return statistics of recordings, no set, and one that found a colour of their noise."""
    given = Statistics(*compared(recordings((COLOUR, PathLoss(offset_db=9.0)))))
    none, floor = fitted(given, ()), fitted(given, (FOUND,))
    assert none is not None
    assert floor is not None
    return given, none, floor


def more(fit: Fit) -> float:
    """Return an evidence by which any effect more is worth a name."""
    return NAME_NATS * len(fit.effects)


def test_noise_of_the_colour_that_was_found_is_as_loud_as_without() -> None:
    given, none, floor = asked()
    known = {frozenset(floor.names): floor}
    made = coloured(given, none, known, more)
    assert made is not None
    assert made.effects == (COLOUR,) == (colour_of(floor),)
    assert coloured(given, none, known, lambda fit: 0.99 * more(fit)) is None


def test_no_colour_is_put_beside_a_noise_floor_or_where_none_was_found(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    given, none, floor = asked()
    known = {frozenset(floor.names): floor}
    assert coloured(given, none, {frozenset(): none}, more) is None
    assert coloured(given, floor, known, more) is None
    monkeypatch.setattr(given, "by_rows", False)  # samples of a table have the noise they have
    assert coloured(given, none, known, more) is None


def test_much_is_left_where_no_colour_of_noise_explains_it() -> None:
    given, none, floor = asked()
    found = remains(given, none, floor, none, 0.0)
    assert found.much
    assert found.nats > NAME_NATS
