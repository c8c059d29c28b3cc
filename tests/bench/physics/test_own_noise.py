"""The noise of a table's CIRs stays where its signals are scaled."""

import numpy as np
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.own_noise import unit_noise, with_own_noise
from bench.physics.shaped import first_share, noise_left


@pytest.mark.parametrize("gain_db", [-8.0, 6.0])
def test_noise_stays_and_signals_follow(gain_db: float) -> None:
    rng = np.random.default_rng(1)
    noise = rng.normal(size=(200, 64, 2)) @ np.array([1, 1j]) * 10 / np.sqrt(2)
    signal = np.zeros_like(noise)
    signal[:, 40:46] = 1000
    gain = np.full(200, 10 ** (gain_db / 20))
    scaled = ((signal + noise) * gain[:, None]).astype(np.complex64)
    drawn = unit_noise(np.arange(200.0), 64)
    made = with_own_noise(scaled, gain, np.full(200, 100.0), drawn, np.full(200, 40.0))
    quiet_db = 10 * np.log10((np.abs(made[:, :30]) ** 2).mean() / 100)
    assert abs(quiet_db) < 0.3 + 0.1 * abs(gain_db)
    ahead_db = 10 * np.log10((np.abs(made[:, 36:39]) ** 2).mean() / 100)
    assert abs(ahead_db) < 1.5  # what lies just ahead of a pulse is noise, too
    np.testing.assert_allclose(np.abs(made[:, 43]), 1000 * gain, rtol=0.08)


def test_rows_that_are_not_scaled_stay_as_they_are() -> None:
    given = np.ones((3, 8), np.complex64)
    assert with_own_noise(given, np.ones(3), np.ones(3), given, np.ones(3)) is given


@pytest.mark.parametrize("offset_db", [10.0, -5.0])
def test_a_weaker_table_looks_like_a_weaker_simulation(offset_db: float) -> None:
    frame, change = line(200, far_m=8.0, los=True), (PathLoss(offset_db=offset_db),)
    lead = slice(0, 5)
    made = ForeignTable(Simulator().simulate(frame).frame).observe(change).cir
    true = np.stack(Simulator(effects=change).simulate(frame).frame["cir"])
    ratio = (made[:, lead] ** 2).mean() / (true[:, lead] ** 2).mean()
    assert abs(10 * np.log10(ratio)) < 0.25 * abs(offset_db)
    assert abs(20 * np.log10(np.median(made.max(axis=1) / true.max(axis=1)))) < 0.3


TAKING_AWAY: dict[str, Effect] = {
    "a wall": MaterialDelay(thickness_scale=4.0, loss_scale=4.0),
    "an edge": Diffraction(blocking_db=40.0),
    "what blocks": BlockedPath(share=1.0, detour_m=3.0),
    "what is in the way": ObstructedPath(share=1.0, loss_db=30.0, loss_spread_db=0.0),
}


@pytest.mark.parametrize("what", TAKING_AWAY)
def test_noise_ahead_stays_where_a_first_path_is_taken_away(what: str) -> None:
    frame = line(200, far_m=8.0, los=False)
    given = Simulator().simulate(frame).frame
    made = np.asarray(ForeignTable(given).observe((TAKING_AWAY[what],)).cir)
    before = np.stack(given["cir"].to_list())
    first = made.max(axis=1) / before.max(axis=1)
    assert np.median(first) < 0.75  # it does take something away
    ahead = (made[:, :3] ** 2).mean() / (before[:, :3] ** 2).mean()
    assert abs(10 * np.log10(ahead)) < 0.7


def test_noise_that_is_left_adds_up_by_power_where_a_path_is_later() -> None:
    taps = np.exp(-4 * np.log(2) * ((np.arange(40.0) - 20) / 2) ** 2)[None].astype(np.complex64)
    share = first_share(taps, np.full(1, 20.0), 2.0)
    still = noise_left(share, np.ones((1, 1), np.float32), np.zeros(1))
    np.testing.assert_allclose(still, 1.0, atol=1e-6)  # nothing is changed
    away = noise_left(share, np.zeros((1, 1), np.float32), np.zeros(1))
    np.testing.assert_allclose(away, 1 - share, atol=1e-6)
    later = noise_left(share, np.ones((1, 1), np.float32), np.full(1, 6.0))
    np.testing.assert_allclose(later[0, :20], 1.0, atol=1e-6)  # noise of other samples instead
    assert later.max() <= 1


def test_a_table_without_its_first_path_looks_like_a_simulation_without() -> None:
    frame = line(200, far_m=8.0, los=False)
    effect = ObstructedPath(share=1.0, loss_db=30.0, loss_spread_db=0.0, common=0.0, delay_m=0.0)
    made = np.asarray(ForeignTable(Simulator().simulate(frame).frame).observe((effect,)).cir)
    true = np.stack(Simulator(effects=(effect,)).simulate(frame).frame["cir"].to_list())
    both = (made[:, 3:11], true[:, 3:11])  # the first path's top is at the seventh sample
    mean_db = [10 * np.log10((one**2).mean(axis=0)) for one in both]
    assert np.abs(mean_db[0] - mean_db[1]).max() < 1.0
