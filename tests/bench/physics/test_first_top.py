"""The first path's pulse in CIRs of receivers that report its edge, its top or a threshold."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.base import Base
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.first_top import first_top
from bench.physics.foreign import ForeignTable
from bench.physics.materials import material, reflection
from bench.physics.units import energy

ROWS, SAMPLES = 120, 64
REPORTED = {"its top": 0.0, "half way up": -0.9, "a weak threshold": -2.2}  # samples off the top


def pulses(place: np.ndarray, size: np.ndarray, fwhm: float) -> np.ndarray:
    """Return CIRs [n, K] of one Gaussian pulse each, at a place in samples, of a complex size."""
    offset = np.arange(SAMPLES) - place[:, None]
    return np.asarray(size[:, None] * np.exp(-4 * np.log(2) * (offset / fwhm) ** 2), np.complex64)


@pytest.mark.parametrize("reported", REPORTED)
@pytest.mark.parametrize("fwhm", [1.6, 2.8])
def test_the_top_is_found_wherever_the_first_path_is_reported(reported: str, fwhm: float) -> None:
    rng = np.random.default_rng(2)
    place = rng.uniform(12, 40, ROWS)
    size = rng.uniform(50, 500, ROWS) * np.exp(2j * np.pi * rng.uniform(size=ROWS))
    noise = rng.normal(size=(ROWS, SAMPLES, 2)) @ [1, 1j]
    found, value = first_top(pulses(place, size, fwhm) + noise, place + REPORTED[reported], fwhm)
    assert np.abs(found - place).max() < 0.1
    assert np.abs(value / size - 1).max() < 0.12


def test_a_later_stronger_path_is_not_the_first_one() -> None:
    place, one = np.full(1, 20.0), np.ones(1)
    taps = pulses(place, one, 2.0) + 3 * pulses(place + 6, one, 2.0)
    found, value = first_top(taps, place - 1, 2.0)
    assert found == pytest.approx(20, abs=0.05)
    assert np.abs(value) == pytest.approx(1, abs=0.05)


def test_an_index_at_or_beyond_the_end_is_no_error() -> None:
    for index in (-5.0, SAMPLES - 1.0, SAMPLES + 9.0, np.nan):
        found, value = first_top(np.ones((1, SAMPLES), np.complex64), np.full(1, index), 2.0)
        assert 0 <= found[0] < SAMPLES
        assert np.isfinite(value).all()


@pytest.mark.parametrize("samples", [1, 2, 3])
def test_records_of_hardly_a_sample_are_no_error(samples: int) -> None:
    found, value = first_top(np.ones((2, samples), np.complex64), np.array([0.0, 5.0]), 2.0)
    assert (np.abs(found - np.clip([0.0, 5.0], 0, samples - 1)) <= 0.5).all()
    assert np.isfinite(value).all()


@pytest.mark.parametrize("reported", REPORTED)
def test_a_reflection_turns_beside_the_first_path_as_it_arrived(reported: str) -> None:
    """Beside complex CIRs of any phase levels go up and down as the receiver's own would."""
    rng, fwhm, centre_ghz = np.random.default_rng(6), 2.0, 6.4896  # channel 5
    far, low = rng.uniform(4, 20, ROWS), rng.uniform(0.6, 1.4, ROWS)
    place, size = rng.uniform(12, 20, ROWS), np.exp(2j * np.pi * rng.uniform(size=ROWS))
    taps = pulses(place, 1000 * size, fwhm)
    taps += rng.normal(size=(ROWS, SAMPLES, 2)) @ [1, 1j]
    frame = pd.DataFrame({"true_range_m": far, "range_m": far, "tx_z_m": 1.1, "rx_z_m": low})
    frame = frame.assign(
        link=[f"l{n}" for n in range(ROWS)], first_path_index=place + REPORTED[reported],
        sample_period_ns=1.0016, rx_power_dbm=-80.0, noise_std=1.25, cir_i=list(taps.real),
        cir_q=list(taps.imag),
    )  # fmt: skip
    table = ForeignTable(frame, Base(channel=5))
    made, bare = (table.observe(some) for some in ((GroundBounce(strength_db=-1.0),), ()))
    length = np.sqrt(far**2 + 4 * 1.1 * low)
    back = reflection(
        material("concrete").permittivity(centre_ghz), np.arccos((1.1 + low) / length)
    )
    size = size * back * 10 ** (-1 / 20) * far / length
    turn = np.exp(-2j * np.pi * (length - far) / 0.299792458 * centre_ghz)
    second = pulses(place + (length - far) / 0.299792458 / 1.0016, 1000 * size * turn, fwhm)
    true_db = 10 * np.log10(energy(taps + second) / energy(taps))
    said_db = made.rx_power_dbm - bare.rx_power_dbm
    assert np.corrcoef(said_db, true_db)[0, 1] > 0.97
    assert np.std(said_db) == pytest.approx(np.std(true_db), rel=0.2)
