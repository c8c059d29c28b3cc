"""The pull and the fading of a reflection of the ground, found from ranges and levels."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.physics.base import Base
from bench.physics.effects.fitted.ground_ray import GroundRay
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.two_rays import (
    LEAST_POWER,
    Rays,
    fading_db,
    fading_ways,
    pulled_m,
    rays,
)
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

HIDDEN = GroundRay(size=0.5, level_size=0.4, carrier_ghz=6.4896, reach_m=0.7, steepness=0.5)


def _frame() -> pd.DataFrame:
    rng = np.random.default_rng(1)
    heights = {"tx_z_m": rng.uniform(1, 2, 200), "rx_z_m": rng.uniform(2, 3, 200)}
    return pd.DataFrame({"true_range_m": rng.uniform(4, 40, 200), **heights})


def _changed(effect: GroundRay) -> tuple[np.ndarray, np.ndarray]:
    rows = scene(_frame(), "recorded")
    made, bare = (
        Simulator(Base(), some, 0).observe(rows, 0, cir=False) for some in ((effect,), ())
    )
    assert made.range_m is not None
    assert bare.range_m is not None
    assert made.rx_power_dbm is not None
    assert bare.rx_power_dbm is not None
    return made.range_m - bare.range_m, made.rx_power_dbm - bare.rx_power_dbm


def test_size_and_carrier_are_found_again_beside_a_constant() -> None:
    pulled, louder = _changed(HIDDEN)
    noise = 0.02 * np.random.default_rng(2).normal(size=len(pulled))
    found = GroundRay.fit_values(_frame(), pulled + noise + 0.3)
    assert isinstance(found, GroundRay)
    assert found.carrier_ghz == HIDDEN.carrier_ghz
    assert found.size == pytest.approx(HIDDEN.size, abs=0.08)
    assert found.with_level(_frame(), louder).level_size == pytest.approx(0.4, abs=0.06)


def test_a_reflection_that_is_not_turned_around_has_a_size_below_zero() -> None:
    upright = GroundRay(size=-0.5, level_size=-0.4, reach_m=0.7, steepness=0.5)
    pulled, louder = _changed(upright)
    noise = 0.02 * np.random.default_rng(4).normal(size=len(pulled))
    found = GroundRay.fit_values(_frame(), pulled + noise)
    assert isinstance(found, GroundRay)
    assert found.size == pytest.approx(-0.5, abs=0.1)
    assert found.with_level(_frame(), louder).level_size == pytest.approx(-0.4, abs=0.1)


def test_two_rays_within_a_pulse_are_one_edge_and_none_beyond() -> None:
    ray = np.full(2, -0.5 + 0j)
    near, far = pulled_m(np.array([0.05, 5.0]), ray, 0.7)
    assert near == pytest.approx(-0.05, rel=0.01)  # -0.5 / (1 - 0.5) of the excess
    assert far == pytest.approx(0.0, abs=1e-6)
    assert fading_db(ray)[0] == pytest.approx(-6.02, abs=0.01)
    assert fading_db(np.array([-1.0 + 0j]))[0] == pytest.approx(10 * np.log10(LEAST_POWER))


def test_noise_is_hardly_a_reflection_and_no_heights_are_none() -> None:
    noise = 0.02 * np.random.default_rng(3).normal(size=200)
    found = GroundRay.fit_values(_frame(), noise)
    assert found is None or found.values()["size"] < 0.2
    assert GroundRay.fit_values(_frame().drop(columns="rx_z_m"), noise) is None


def test_what_it_may_do_holds_what_a_reflection_does() -> None:
    rows = scene(_frame().assign(channel=5), "recorded")
    parts = GroundBounce.ways(rows)
    assert parts is not None
    assert len(parts) == 1
    pulled, _ = _changed(HIDDEN)
    left = pulled - parts[0] @ np.linalg.lstsq(parts[0], pulled, rcond=None)[0]
    assert np.std(left) < 0.25 * np.std(pulled)


def _found() -> Rays:
    found = rays(scene(_frame(), "recorded"))
    assert found is not None
    return found


def _crossed_m(found: Rays) -> np.ndarray:
    """Return how much later a threshold is crossed: sooner where both rays are louder [n]."""
    near = np.exp(-found.longer_m / 0.8)
    return -0.15 * np.log(np.abs(1 + near * found.ray(6.4896, 0.6, 0.5)))


def _energy_db(found: Rays) -> np.ndarray:
    """Return the gain of two pulses whose energies add where they do not overlap [n]."""
    ray = found.ray(6.4896, 0.6, 0.0)
    near = np.exp(-((found.longer_m / 0.5) ** 2))
    return 10 * np.log10(1 + np.abs(ray) ** 2 + 2 * near * np.real(ray))


def test_a_threshold_that_both_rays_cross_is_within_what_it_may_do() -> None:
    rows, crossed = scene(_frame().assign(channel=5), "recorded"), _crossed_m(_found())
    parts = GroundBounce.ways(rows)
    assert parts is not None
    left = crossed - parts[0] @ np.linalg.lstsq(parts[0], crossed, rcond=None)[0]
    assert np.std(left) < 0.25 * np.std(crossed)


def test_a_receiver_of_another_kind_is_followed_in_ranges_and_levels() -> None:
    frame, found = _frame().assign(channel=5), _found()
    noise = 0.01 * np.random.default_rng(5).normal(size=len(frame))
    fitted = GroundRay.fit_values(frame, _crossed_m(found) + noise)
    assert isinstance(fitted, GroundRay)
    bare = fitted._pulled(found)
    left, plain = (_crossed_m(found) - one for one in (fitted._moved(found), bare))
    assert np.std(left) < 0.5 * np.std(plain)
    gain = _energy_db(found)
    louder = fitted.with_level(frame, gain)
    assert np.std(gain - louder._faded(found)) < 0.25 * np.std(gain)
    assert abs(np.mean(gain - louder._faded(found))) < 0.5 * np.mean(gain)


def test_energies_that_add_are_among_the_ways_of_a_named_reflection() -> None:
    rows, gain = scene(_frame().assign(channel=5), "recorded"), _energy_db(_found())
    named, any_one = (fading_ways(rows, known) for known in (True, False))
    left = [gain - one @ np.linalg.lstsq(one, gain, rcond=None)[0] for one in (named, any_one)]
    assert np.std(left[0]) < 0.1 * np.std(gain)
    assert np.std(left[0]) < 0.3 * np.std(left[1])


def test_a_curve_over_the_distance_is_no_reflection_and_a_ripple_is_one() -> None:
    frame = _frame()
    rows, far = scene(frame, "recorded"), frame["true_range_m"].to_numpy()
    assert GroundBounce.possible(rows, _crossed_m(_found()))
    assert not GroundBounce.possible(rows, 0.1 * far / (far + 10))
    assert not GroundBounce.possible(rows, -0.05 * frame["rx_z_m"].to_numpy())
    assert not GroundBounce.possible(scene(frame.drop(columns="rx_z_m"), "recorded"), far)


def test_a_path_loss_is_left_to_levels_beside_a_reflection() -> None:
    frame = _frame().assign(channel=5)
    fall = -10 * 0.6 * np.log10(frame["true_range_m"].to_numpy())
    gain, noise = _energy_db(_found()), 0.5 * np.random.default_rng(6).normal(size=len(frame))
    fitted = replace(HIDDEN, carrier_ghz=6.4896)
    for lost in (fall, 0 * fall):
        made = fitted.with_level(frame, gain + lost + noise)._faded(_found())
        assert np.std(gain - made) < 0.35 * np.std(gain)
        assert abs(np.mean(gain - made)) < 0.6


@pytest.mark.parametrize("constant_db", [-12.0, -3.0, 0.0, 3.0, 12.0])
def test_levels_are_no_farther_for_a_reflection_beside_whatever_constant(
    constant_db: float,
) -> None:
    """Ranges showed a reflection of 0.18 nats that its levels, a constant off, took back."""
    _, louder = _changed(HIDDEN)
    found = HIDDEN.with_level(_frame(), louder + constant_db)
    left = louder + constant_db - found._faded(_found())
    assert np.abs(left).mean() < np.abs(louder + constant_db).mean()
    assert found.size == HIDDEN.size
