"""Tables whose CIRs were scaled to one peak: effects leave the peak, levels tell."""

import numpy as np
import pandas as pd
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.scaled_peaks import ScaledPeaks
from bench.physics.scene import scene


def scaled(along: bool) -> pd.DataFrame:
    """Return rows whose CIRs are scaled to 5000 counts, what is logged of noise `along`; SIMULATED.

    Else noise is as if it were added later: as large at every level.
    """
    frame = line(128)
    made = Simulator(seed=3).observe(scene(frame)).table(frame)
    ratio = np.array([5000 / np.abs(cir).max() for cir in made["cir"]])
    cirs = [cir * by for cir, by in zip(made["cir"], ratio, strict=True)]
    noise = made["noise_std"] * ratio if along else made["noise_std"] * 0 + 40.0
    return made.drop(columns=["cir_i", "cir_q"], errors="ignore").assign(cir=cirs, noise_std=noise)


def peaks(cirs: np.ndarray) -> np.ndarray:
    """Return the highest magnitude of every row."""
    return np.abs(cirs).max(axis=1)


@pytest.mark.parametrize("along", [True, False])
def test_a_path_loss_leaves_peaks_and_takes_from_levels(along: bool) -> None:
    frame = scaled(along)
    table = ForeignTable(frame)
    same, made = table.observe(()), table.observe((PathLoss(offset_db=6.0),))
    np.testing.assert_allclose(peaks(same.cir), 5000, rtol=1e-4)
    np.testing.assert_allclose(peaks(made.cir), 5000, rtol=1e-4)
    np.testing.assert_allclose(made.rx_power_dbm, frame["rx_power_dbm"] - 6, atol=0.1)
    early = np.median(made.cir[:, :3].mean(axis=1) / same.cir[:, :3].mean(axis=1))
    assert (early > 1.4) if along else (early == pytest.approx(1.0, abs=0.02))


def test_a_gain_that_is_turned_down_shows_in_the_level_alone() -> None:
    frame = scaled(along=False)
    made = ForeignTable(frame).observe((LevelControl(accumulation=0.0),))
    np.testing.assert_allclose(peaks(made.cir), 5000, rtol=1e-4)
    assert (frame["rx_power_dbm"] - made.rx_power_dbm).max() > 3


def test_only_peaks_that_are_alike_at_all_levels_were_scaled() -> None:
    rng = np.random.default_rng(0)
    level, noise = rng.normal(-80, 4, 50), np.full(50, 30.0)
    assert ScaledPeaks.of(np.full(50, 9000.0), level, noise) == ScaledPeaks(True)
    assert ScaledPeaks.of(9000 * 10 ** (level / 20), level, noise) == ScaledPeaks()
    assert ScaledPeaks.of(np.full(50, 9000.0), np.full(50, -80.0), noise) == ScaledPeaks()
    falling = noise * 10 ** (-(level + 80) / 20)
    assert ScaledPeaks.of(np.full(50, 9000.0), level, falling) == ScaledPeaks(True, True)
