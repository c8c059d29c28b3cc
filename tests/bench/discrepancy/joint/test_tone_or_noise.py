"""A tone and a noise floor: fits begin at the same power, and logged noise tells them apart."""

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.joint.tone_or_noise import (
    counterparts,
    steadied,
    steadier_db,
    told_apart,
    too_steady,
)
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


def test_samples_before_the_path_tell_a_tone_wherever_noise_is_logged():
    tone, floor = NarrowbandInterference(level_db=5.0), NoiseFloor(level_db=5.0)
    assert _apart_early(tone, left_db=0.0, response_db=-3.0) > 3  # as steady as a tone makes them
    assert _apart_early(tone, left_db=3.0, response_db=-3.0) == 0  # as noise is
    assert _apart_early(floor, left_db=-1.5, response_db=0.0, again=True) == 0  # no noise is so
    assert _apart_early(floor, left_db=0.0, response_db=0.0, again=True) == float("inf")


def test_where_hardly_a_sample_is_before_the_path_it_tells_nothing():
    given, moments = _seen(0.0, names=("energy_db",))
    assert steadied(given, moments, np.full((84, 1), -9.0)) == 0
    assert too_steady(given, moments) == 0


def _seen(left_db: float, names: tuple[str, ...] = ("early_scatter",), again: bool = False):
    given = SimpleNamespace(
        names=names, count=np.ones(84, int), links=84, crowding=1.0, by_rows=again
    )
    covariances = {1: np.array([[3.0**2]])}
    left = np.full((84, 1), left_db)
    return given, SimpleNamespace(covariances=covariances, uneven=None, left=left, spared=None)


def _apart_early(effect, left_db: float, response_db: float, again: bool = False) -> float:
    given, moments = _seen(left_db, again=again)
    responses = (np.full((84, 1), response_db),)
    fit = SimpleNamespace(
        effects=(effect,), names=(effect.name,), moments=moments, responses=responses
    )
    return told_apart(given, fit, effect.name)


def _apart(level_db: float, again: bool = True, uneven: np.ndarray | None = None) -> float:
    links, scatter_db = 84, 0.4
    names = ("noise_std",)
    given = SimpleNamespace(names=names, count=np.ones(links, int), crowding=1.0, by_rows=again)
    covariances = {1: np.array([[scatter_db**2]])}
    moments = SimpleNamespace(
        covariances=covariances, uneven=uneven, left=np.zeros((links, 1)), spared=None
    )
    fit = SimpleNamespace(
        effects=(NoiseFloor(level_db=level_db),),
        names=("noise-floor",),
        moments=moments,
        responses=(np.zeros((links, 1)),),
    )
    return told_apart(given, fit, "noise-floor")
