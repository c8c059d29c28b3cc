"""A tone in another simulator's table, whose log of noise may be of power or of scatter."""

from dataclasses import replace

import numpy as np
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor

TONE = NarrowbandInterference(level_db=10 * np.log10(3), fading_db=0)  # 6 dB with the noise


def test_a_log_of_power_shows_a_tone_as_it_shows_noise_and_a_log_of_scatter_hardly() -> None:
    table = ForeignTable(Simulator().simulate(line(200, far_m=8.0, los=True)).frame)
    plain = table.frame["noise_std"].to_numpy()
    by_power = table.observe((replace(TONE, power_logged=1),)).noise_std / plain
    assert np.median(by_power) == pytest.approx(2.0, rel=0.02)
    floor = table.observe((NoiseFloor(level_db=10 * np.log10(4)),)).noise_std / plain
    assert np.median(floor) == pytest.approx(np.median(by_power), rel=0.05)
    by_scatter = table.observe((TONE,)).noise_std / plain
    assert np.median(by_scatter) < 1.6
