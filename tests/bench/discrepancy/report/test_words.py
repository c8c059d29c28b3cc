"""What a report says of what is unknown or in a class, in words a radio engineer can act on."""

from __future__ import annotations

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.report.found_lines import describe
from bench.discrepancy.select.separate import separating
from bench.discrepancy.select.uncounted import NOTE
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown, not_tried
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.noise_floor import NoiseFloor


@pytest.mark.parametrize(("high", "lines"), [(0.0, 1), (2.0, 2)])
def test_a_regression_that_was_not_tried_removes_nothing_of_a_score(high: float, lines: int):
    said = describe(Unknown((), Estimate(0, 0, high, "nats"), {}, "a fault"))
    assert len(said) == lines
    assert all("nats" in line for line in said[1:])


def _option(effect: Effect) -> LeftOut:
    return LeftOut(effect, (), Estimate(1, 0, 2, "nats"), 1.0, Control("", None))


def test_a_tone_and_noise_are_told_apart_by_a_measurement_others_by_what_they_follow():
    both = _option(NoiseFloor()), _option(NarrowbandInterference())
    assert "while no tag sends" in separating(both)
    assert separating((both[0], _option(PathLoss()))).startswith("vary what only one")


def _found(size_db: float, where: str | None = None, trend: bool = False) -> Finding:
    """Return a level that is off by so much, known to half a decibel."""
    place = Place(where, 0.0, 1.0, trend) if where else Place(None, None, None, False)
    size = Estimate(size_db, size_db - 0.5, size_db + 0.5, "dB")
    return Finding(Cell("energy_db", "mean", place), size, 9.0, 0.002, 90, 30)


def test_what_holds_in_all_rows_is_not_said_again_of_some() -> None:
    every = (
        _found(4.0), _found(4.2, "tx_z_m"), _found(9.0, "rx_z_m"), _found(3.9, "time_s", True),
    )  # fmt: skip
    lines = describe(Unknown(every, Estimate(0, 0, 0, "nats"), {}, "left"))[1:]
    assert len(lines) == 3
    assert not any("tx_z_m" in line for line in lines)


def test_what_could_not_be_tried_is_told_what_it_needs() -> None:
    path_loss = _option(PathLoss())
    control = not_tried(path_loss, LevelControl(), NOTE)
    words = separating((path_loss, control))
    assert words.endswith("give level-control what it needs to be tried: the count of accumulated "
                          "symbols (preamble_count)")  # fmt: skip
    assert "to be tried" not in separating((path_loss, _option(NoiseFloor())))
