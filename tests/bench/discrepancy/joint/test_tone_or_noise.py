"""A tone and a noise floor: fits begin at the same power, and logged noise tells them apart."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.joint.tone_or_noise import counterparts, steadier_db, told_apart
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor


def test_a_noise_floor_and_a_tone_begin_at_each_others_power():
    (tone,) = counterparts(NoiseFloor(level_db=2.0))
    (floor,) = counterparts(tone)

    assert isinstance(tone, NarrowbandInterference)
    assert floor.level_db == pytest.approx(2.0, abs=0.01)
    assert counterparts(PathLoss()) == ()


def test_magnitudes_scatter_as_rice_says():
    rng = np.random.default_rng(0)
    noise = rng.normal(size=400_000) + 1j * rng.normal(size=400_000)
    alone, with_tone = np.abs(noise).var(), np.abs(noise + 2.0).var()

    drawn_db = 10 * np.log10(3.0 * alone / with_tone)  # power 4 beside the noise's 2

    assert steadier_db(2.0) == pytest.approx(drawn_db, abs=0.03)
    assert steadier_db(0.1) < 0.02


def test_a_weak_tone_is_not_told_from_noise_and_a_loud_one_is():
    assert _apart(0.6) < 3 < _apart(5.0)
    assert _apart(5.0, again=False) == 0  # another tool may log the power of noise
    assert _apart(5.0, uneven=np.ones((84, 1, 1))) == 0  # a tone may come and go, too


def _apart(level_db: float, again: bool = True, uneven: np.ndarray | None = None) -> float:
    links, scatter_db = 84, 0.4
    names = ("noise_std",)
    given = SimpleNamespace(names=names, count=np.ones(links, int), crowding=1.0, by_rows=again)
    moments = SimpleNamespace(covariances={1: np.array([[scatter_db**2]])}, uneven=uneven)
    fit = SimpleNamespace(effects=(NoiseFloor(level_db=level_db),), moments=moments, responses=())
    return told_apart(given, fit, "noise-floor")
