"""A pattern of waveforms stands beside a level of every device: a weak anchor is no pattern."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from bench.discrepancy.joint.beyond_level import _weaker_devices
from bench.discrepancy.joint.settings import LEVEL_DB
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.propagation.path_loss import PathLoss

GIVEN = SimpleNamespace(
    names=("rx_power_dbm", "kurtosis"), links=3, devices=np.array([[1.0, 0], [0, 1], [0, 1]])
)
RESPONSE = np.array([[3.0, 0.3], [-3.0, -0.3], [1.0, 0.1]])  # a tenth per dB of level


def _fit(*effects: object) -> SimpleNamespace:
    names = tuple(one.name for one in effects)  # type: ignore[attr-defined]
    return SimpleNamespace(effects=effects, names=names, responses=(RESPONSE,) * len(effects))


def test_statistics_follow_the_level_of_a_device_as_they_follow_the_pattern() -> None:
    first, second = _weaker_devices(GIVEN, _fit(AntennaPattern(gain_db=3)), _fit())  # type: ignore[arg-type]
    np.testing.assert_allclose(first, LEVEL_DB * np.array([[1, 0.1], [0, 0], [0, 0]]))
    np.testing.assert_allclose(second, LEVEL_DB * np.array([[0, 0], [1, 0.1], [1, 0.1]]))


def test_other_effects_and_patterns_that_were_there_have_no_such_rivals() -> None:
    both = _fit(AntennaPattern(gain_db=3), PathLoss(exponent=3))
    assert not _weaker_devices(GIVEN, both, _fit(AntennaPattern(gain_db=3)))  # type: ignore[arg-type]
    assert not _weaker_devices(GIVEN, _fit(PathLoss(exponent=3)), _fit())  # type: ignore[arg-type]
