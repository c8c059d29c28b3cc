"""What the registers of a DW1000 mean, by its user manual."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

Floats = NDArray[np.float64]
POWER_CONSTANT_DB = {16: 113.77, 64: 121.74}  # by pulse repetition frequency in MHz
CARRIER_MHZ = {1: 3494.4, 2: 3993.6, 3: 4492.8, 4: 3993.6, 5: 6489.6, 7: 6489.6}
_INTEGRATOR_DIVISOR = {110: 8192, 850: 1024, 6800: 1024}  # by data rate in kb/s


def receive_power_dbm(cir_power: ArrayLike, preamble_count: ArrayLike, prf_mhz: int = 64) -> Floats:
    """Return the receive level: 10 log10(C 2^17 / N^2) - A (user manual, section 4.7.2)."""
    power = np.asarray(cir_power, np.float64) * 2.0**17
    return _level_dbm(power, preamble_count, prf_mhz)


def first_path_power_dbm(
    amplitudes: tuple[ArrayLike, ArrayLike, ArrayLike],
    preamble_count: ArrayLike,
    prf_mhz: int = 64,
) -> Floats:
    """Return the first-path level: 10 log10((F1^2 + F2^2 + F3^2) / N^2) - A (section 4.7.1)."""
    f1, f2, f3 = (np.asarray(amplitude, np.float64) for amplitude in amplitudes)
    return _level_dbm(f1**2 + f2**2 + f3**2, preamble_count, prf_mhz)


def _level_dbm(power: Floats, preamble_count: ArrayLike, prf_mhz: int) -> Floats:
    """Return a level in dBm; -inf where the chip reports no power."""
    with np.errstate(divide="ignore", invalid="ignore"):
        level = 10 * np.log10(power / np.asarray(preamble_count, np.float64) ** 2)
    return np.asarray(level - POWER_CONSTANT_DB[prf_mhz], np.float64)


def carrier_offset_ppm(
    integrator: ArrayLike, channel: int, data_rate_kbps: int, bits: int = 21
) -> Floats:
    """Return by how much the RECEIVER's clock runs fast against the sender's, in ppm.

    `integrator` is the carrier recovery integrator (DRX_CAR_INT) as an unsigned count of so many
    bits, two's complement; one count is 998.4e6 / 2 / divisor / 2^17 Hz with a divisor of 1024, or
    8192 at 110 kb/s.
    """
    counts = np.asarray(integrator, np.float64)
    signed = np.where(counts >= 2.0 ** (bits - 1), counts - 2.0**bits, counts)
    hertz = signed * 998.4e6 / 2 / _INTEGRATOR_DIVISOR[data_rate_kbps] / 2**17
    return np.asarray(hertz / CARRIER_MHZ[channel], np.float64)


def temperature_c(reading: ArrayLike, calibration_23c: ArrayLike) -> Floats:
    """Return the die temperature in degrees C: (reading - reading at 23 C) x 1.14 + 23."""
    counts = np.asarray(reading, np.float64) - np.asarray(calibration_23c, np.float64)
    return counts * 1.14 + 23.0
