from __future__ import annotations

import numpy as np
import pytest

from bench.recordings.dw1000 import (
    carrier_offset_ppm,
    first_path_power_dbm,
    receive_power_dbm,
    temperature_c,
)


def test_levels_are_the_user_manuals() -> None:
    # one outdoor row: printed receive level -79.68 dBm (the printed first-path level is not used)
    assert receive_power_dbm([6491], [230])[0] == pytest.approx(-79.68, abs=0.01)
    # one apartment frame: printed first-path level -81.5417 dBm from these three amplitudes
    level = first_path_power_dbm(([10000.0], [8000.0], [6000.0]), [288.0])[0]
    assert level == pytest.approx(10 * np.log10(2e8 / 288**2) - 121.74)


def test_no_power_is_minus_infinity() -> None:
    assert receive_power_dbm([0], [230])[0] == -np.inf


def test_16_mhz_has_its_own_constant() -> None:
    difference = receive_power_dbm([6491], [230], 16) - receive_power_dbm([6491], [230], 64)
    assert difference[0] == pytest.approx(121.74 - 113.77)


def test_the_carrier_integrator_is_twos_complement() -> None:
    fast, slow = carrier_offset_ppm([44122, 131072 - 44122], channel=3, data_rate_kbps=110, bits=17)
    assert fast == pytest.approx(4.5657, abs=1e-3)
    assert slow == pytest.approx(-fast)


def test_the_calibration_temperature_is_23_degrees() -> None:
    assert temperature_c([128, 129], [128, 128]).tolist() == [23.0, 24.14]
