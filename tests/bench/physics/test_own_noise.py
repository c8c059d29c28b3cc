"""The noise of a table's CIRs stays where its signals are scaled."""

import numpy as np
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.own_noise import unit_noise, with_own_noise


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
