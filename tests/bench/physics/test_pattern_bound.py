"""Ranges differ over the direction by as much as antennas make, or no pattern did it."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.scene import scene


@pytest.mark.parametrize(("amplitude_m", "possible"), [(0.1, True), (0.2, True), (0.32, False)])
def test_half_a_metre_over_the_direction_is_no_antenna(amplitude_m: float, possible: bool) -> None:
    turn = np.linspace(-180, 180, 60)
    rows = scene(pd.DataFrame({"true_range_m": 5.0, "azimuth_deg": turn}))
    shift_m = amplitude_m * np.cos(np.radians(turn)) + 0.4  # a constant is another's
    assert AntennaPattern.possible(rows, shift_m) is possible
