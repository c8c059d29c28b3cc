"""A table of another sample period, and one that logs its noise in another way; SIMULATED."""

import numpy as np
import pytest
from physics_scenes import line

from bench.physics import ForeignTable, Simulator
from bench.physics.base import Base
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.own_base import at_period, pulse_width


def _table(period_ns: float, noise: float = 1.0) -> ForeignTable:
    """Return rows at a sample period whose noise is logged `noise` times as large."""
    base = Base(sample_period_ns=period_ns, cir_lead=16)
    frame = Simulator(base).simulate(line(200, far_m=8.0, los=True)).frame
    return ForeignTable(frame.assign(noise_std=frame["noise_std"] * noise))


@pytest.mark.parametrize("period_ns", [0.5, 0.8, 1.25])
def test_an_echo_comes_as_late_as_it_says(period_ns: float) -> None:
    table = _table(period_ns)
    made = table.observe((PulseRinging(ring_db=-3.0, ring_delay_ns=15.0),))
    assert made.sample_period_ns == period_ns
    assert made.cir is not None
    assert made.first_path_index is not None
    about = made.first_path_index[:, None] + (15.0 + 1.25) / period_ns + np.arange(-8, 9)
    near = np.take_along_axis(made.cir, np.rint(about).astype(int), axis=1).mean(axis=0)
    assert abs(int(np.argmax(near)) - 8) * period_ns <= 1.3


@pytest.mark.parametrize("logged", [0.5, 1.0, 1.5])
def test_noise_in_samples_stays_however_it_is_logged(logged: float) -> None:
    table = _table(1.0016, logged)
    made, lead = table.observe((PathLoss(offset_db=10.0),)).cir, slice(0, 8)
    plain = np.stack(table.frame["cir"])
    ratio = (made[:, lead] ** 2).mean() / (plain[:, lead] ** 2).mean()
    assert abs(10 * np.log10(ratio)) < 2.0


def test_a_period_that_cannot_be_simulated_is_left() -> None:
    assert at_period(Base(), 0.01) == Base()
    assert at_period(Base(), 0.5).sample_period_ns == 0.5


@pytest.mark.parametrize("width", [1.5, 2.5, 4.0])
def test_what_is_added_is_as_wide_as_the_pulses_of_the_table(width: float) -> None:
    frame = Simulator(Base(pulse_fwhm=width)).simulate(line(100, far_m=8.0, los=True)).frame
    table = ForeignTable(frame)
    assert table.own.pulse_fwhm == pytest.approx(width, rel=0.08)
    assert ForeignTable(frame.head(3), like=table).own.pulse_fwhm == table.own.pulse_fwhm


def test_a_few_pulses_or_noise_tell_no_width() -> None:
    rng = np.random.default_rng(3)
    noise = np.abs(rng.normal(size=(100, 60)))
    assert np.isnan(pulse_width(noise, np.full(100, 16.0)))
    pulse = np.exp(-((np.arange(60) - 17.0) ** 2) / 2) * 1e3 + noise
    assert pulse_width(pulse, np.full(100, 16.0)) == pytest.approx(2.355, rel=0.02)
    assert np.isnan(pulse_width(pulse[:9], np.full(9, 16.0)))
