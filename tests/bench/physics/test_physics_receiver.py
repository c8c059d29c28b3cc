"""Signature and magnitude of the effects on the waveform."""

import numpy as np
from physics_scenes import change, line, room, seen

from bench.physics import Base
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.late_detection import LateDetection
from bench.physics.effects.receiver.level_control import (
    LevelControl,
    accumulated_share,
    reported_dbm,
)
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.effects.receiver.quantisation import Quantisation
from bench.physics.filters import decaying, echo_taps


def shadowed(n: int = 512):
    """Return rows whose straight path is weak and a reflection 2 m longer strong."""
    return line(n, far_m=4.0, los=False).assign(true_range_m=3.0)


def test_a_raised_threshold_misses_the_weak_path_and_a_lowered_one_finds_it() -> None:
    frame = shadowed()
    before = Diffraction(strength_db=-20), SpecularReflections(wall_m=2.0, walls="metal")
    late, base = change(frame, *before, LateDetection(rise_db=34.0))
    shift = late.range_m - base.range_m
    assert np.median(shift) > 1.0  # the path over the wall: 5 m instead of 3
    assert shift.min() >= 0
    lead = late.cir[:, :3].max(axis=1)
    assert np.median(lead) > 5 * np.median(late.noise_std)  # energy before the detected path
    again, _ = change(frame, *before, LateDetection(rise_db=0.0))
    np.testing.assert_array_equal(again.range_m, base.range_m)


def test_threshold_as_a_share_of_the_peak_does_the_same() -> None:
    before = Diffraction(strength_db=-20), SpecularReflections(wall_m=2.0, walls="metal")
    late, base = change(shadowed(), *before, LateDetection(peak_fraction=0.5))
    assert np.median(late.range_m - base.range_m) > 1.0


def test_an_edge_is_timed_no_lower_than_the_fraction_of_the_peak_that_is_asked_for() -> None:
    base, low, high = (
        seen(line(256), *some).range_m
        for some in ((), (LateDetection(peak_fraction=0.45),), (LateDetection(peak_fraction=0.9),))
    )
    np.testing.assert_array_equal(low, base)  # half of the peak is higher
    assert 0.04 < np.median(high - base) < 0.3  # within a rise of 2 ns
    assert (high > base).all()


def test_late_detection_acts_on_paths_without_a_waveform() -> None:
    before = Diffraction(strength_db=-20), SpecularReflections(wall_m=2.0, walls="metal")
    late, base = change(shadowed(), *before, LateDetection(rise_db=34.0), cir=False)
    assert np.median(late.range_m - base.range_m) > 1.0


def test_ringing_is_an_echo_at_a_delay_that_no_distance_moves() -> None:
    frame = line(512)
    made, base = change(frame, PulseRinging(ring_db=-6, ring_delay_ns=12.0, ring_phase_deg=90))
    peak = made.cir.argmax(axis=1)
    at = peak[:, None] + np.arange(8, 17)
    echo = np.take_along_axis(made.cir, at, axis=1)
    assert abs(np.median(echo.argmax(axis=1)) + 8 - 12) <= 1
    ratio = echo.max(axis=1) / made.cir.max(axis=1)
    assert abs(20 * np.log10(np.median(ratio)) + 6) < 0.7
    np.testing.assert_allclose(made.rx_power_dbm, base.rx_power_dbm, atol=0.05)  # energy is kept
    np.testing.assert_allclose(made.range_m, base.range_m, atol=0.005)  # 1/64 sample


def test_a_wider_pulse_is_lower_or_has_more_energy() -> None:
    """As calibrated, its energy is kept; sent as high as before, it grows with the width."""
    frame = line(256)
    low, base = change(frame, PulseRinging(widening=1.5))
    high, _ = change(frame, PulseRinging(widening=1.5, as_high=1.0))
    np.testing.assert_allclose(low.rx_power_dbm, base.rx_power_dbm, atol=0.05)
    np.testing.assert_allclose(high.rx_power_dbm - base.rx_power_dbm, 1.76, atol=0.05)


def test_widening_widens_the_pulse() -> None:
    def width(*effects) -> float:
        cir = seen(line(256), *effects).cir
        return float(np.median((cir > 0.5 * cir.max(axis=1, keepdims=True)).sum(axis=1)))

    assert abs(width() - 2.5) <= 0.5
    assert abs(width(PulseRinging(widening=2.0)) - 5.0) <= 0.5


def test_noise_has_the_recorded_colour_and_level() -> None:
    frame = line(512, far_m=40.0)
    base = Base(cir_lead=100, cir_samples=120)  # long noise before the first path
    made = seen(frame, NoiseFloor(level_db=6.0), base=base, complex_cir=True)
    plain = seen(frame, base=base)
    assert abs(20 * np.log10(made.noise_std.mean() / plain.noise_std.mean()) - 6) < 0.1
    assert made.cir_complex is not None
    noise = made.cir_complex[:, :90].astype(np.complex128)
    power = np.mean(np.abs(noise) ** 2)
    for lag, expected in ((1, 0.32), (2, -0.17), (3, -0.20), (5, 0.0)):
        found = np.mean(noise[:, lag:] * noise[:, :-lag].conj()).real / power
        assert abs(found - expected) < 0.02


def test_noise_differs_between_receiving_devices() -> None:
    frame = line(400, rx=np.repeat(["a", "b"], 200))
    made = seen(frame, NoiseFloor(device_spread_db=3.0))
    means = made.noise_std[:200].mean(), made.noise_std[200:].mean()
    assert abs(20 * np.log10(means[0] / means[1])) > 0.3


def test_level_control_compresses_as_the_manual_says() -> None:
    true = np.array([-100.0, -90.0, -86.5, -83.5, -80.0, -72.5, -60.0])
    read = np.array([-100.0, -90.0, -87.5, -85.0, -82.5, -80.0, -77.5])
    np.testing.assert_allclose(reported_dbm(true), read)
    shares = accumulated_share(np.array([-95.0, -88.5, -83.0, -70.0])) * 1024
    np.testing.assert_allclose(shares, [1024, 754, 539, 280])


def test_level_control_flattens_the_level_while_the_distance_falls() -> None:
    frame = line(512, far_m=60.0)
    made, base = change(frame, LevelControl(peak_counts=1e9))
    near, far = made.rx_power_dbm[:50], made.rx_power_dbm[-50:]
    np.testing.assert_allclose(made.rx_power_dbm, reported_dbm(base.rx_power_dbm), atol=0.3)
    assert near.max() - near.min() < 4 < np.ptp(base.rx_power_dbm[:50])
    assert made.preamble_count[0] == 280
    assert made.preamble_count[-1] > 900 or far.mean() > -92
    np.testing.assert_allclose(
        made.noise_std[:10] / base.noise_std[:10], np.sqrt(280 / 1024), rtol=1e-3
    )


def test_level_control_holds_peaks_in_the_recorded_range() -> None:
    frame = room(512)
    made = seen(frame, PathLoss(offset_db=8.0), DiffuseTail(), LevelControl())
    peaks = made.cir.max(axis=1)
    assert peaks.max() < 20_500
    assert np.median(peaks) > 10_000


def test_interference_ripples_through_all_bins_and_raises_the_noise() -> None:
    frame = line(512)
    base = Base(cir_lead=100, cir_samples=120)
    effect = NarrowbandInterference(level_db=20.0, offset_mhz=100.0)
    made = seen(frame, effect, base=base, complex_cir=True)
    plain = seen(frame, base=base)
    assert made.noise_std.mean() > 1.4 * plain.noise_std.mean()
    before = made.cir[:, :90].mean() / plain.cir[:, :90].mean()
    assert before > 4
    assert made.cir_complex is not None
    spectrum = np.abs(np.fft.fft(made.cir_complex[:, :90], axis=1)).mean(axis=0)
    tone = np.fft.fftfreq(90, 1.0016e-3)[spectrum.argmax()]  # MHz
    assert abs(tone - 100) < 12
    half = seen(frame, NarrowbandInterference(level_db=20.0, share=0.5), base=base)
    quiet = np.isclose(half.noise_std, plain.noise_std)
    assert 0.4 < quiet.mean() < 0.6


def test_quantisation_gives_whole_numbers_with_an_offset() -> None:
    frame = line(512, far_m=100.0, rx="b")
    base = Base(cir_lead=100, cir_samples=120)
    effect = Quantisation(step_counts=1.0, offset_counts=100.0)
    made = seen(frame, effect, base=base, complex_cir=True)
    assert made.cir_complex is not None
    np.testing.assert_array_equal(made.cir_complex, np.rint(made.cir_complex))
    offset = np.abs(made.cir_complex[:, :90].mean())
    assert abs(offset - 100) < 3


def test_quantisation_saturates() -> None:
    made = seen(line(64, far_m=2.0), Quantisation(limit_counts=32767), complex_cir=True)
    assert made.cir_complex is not None
    assert np.abs(made.cir_complex.real).max() <= 32767
    assert made.cir.max() > 30_000


def test_bits_dropped_at_read_out_leave_the_reported_noise() -> None:
    frame = line(256, far_m=100.0)
    plain = seen(frame)
    kept = seen(frame, Quantisation(step_counts=64.0, dropped=1.0, read_out=1.0), complex_cir=True)
    np.testing.assert_allclose(kept.noise_std, plain.noise_std, rtol=1e-3)
    assert kept.cir_complex is not None
    whole = kept.cir_complex.real / 64
    np.testing.assert_allclose(whole, np.rint(whole), atol=1e-3)
    assert (np.rint(whole) == 0).mean() > (np.abs(plain.cir) < 32).mean()  # towards zero


def test_noise_below_a_step_without_zero_is_steady() -> None:
    frame = line(256, far_m=100.0)
    plain = seen(frame, complex_cir=True)
    made = seen(frame, Quantisation(step_counts=512.0, beside_zero=1.0), complex_cir=True)
    assert made.cir_complex is not None
    halves = made.cir_complex.real / 512 % 1
    np.testing.assert_allclose(halves, 0.5, atol=1e-3)
    assert np.median(made.noise_std / plain.noise_std) < 0.8
    coarse = seen(frame, Quantisation(step_counts=1024.0, beside_zero=1.0))
    assert np.median(coarse.noise_std) < 0.5 * np.median(made.noise_std)


def test_an_echo_within_the_pulse_takes_no_level_away() -> None:
    ring = {"ring_db": -3.0, "ring_delay_ns": 0.5, "ring_phase_deg": 180.0}
    frame = line(64, far_m=5.0)
    kept, base = change(frame, PulseRinging(**ring))
    made, _ = change(frame, PulseRinging(**ring, on_top=1.0))
    np.testing.assert_allclose(made.rx_power_dbm, kept.rx_power_dbm)
    np.testing.assert_allclose(made.rx_power_dbm, base.rx_power_dbm, atol=0.05)


def test_an_echo_may_come_on_top_and_off_the_strongest_path_alone() -> None:
    frame = shadowed(256)
    before = (SpecularReflections(wall_m=6.0, walls="metal"),)
    ring = {"ring_db": -6.0, "ring_delay_ns": 12.0}
    made, base = change(frame, *before, PulseRinging(**ring, on_top=1.0))
    louder = np.median(made.rx_power_dbm - base.rx_power_dbm)
    assert abs(louder - 10 * np.log10(1.25)) < 0.2
    alone, _ = change(frame, *before, PulseRinging(**ring, on_top=1.0, first_alone=1.0))
    assert np.median(alone.rx_power_dbm) < np.median(made.rx_power_dbm)
    assert np.median(alone.rx_power_dbm) > np.median(base.rx_power_dbm) + 0.3


def test_a_level_may_be_held_in_the_report_alone() -> None:
    frame = line(128, far_m=2.0)
    told, base = change(frame, LevelControl(accumulation=0.0, peak_counts=1e9, in_samples=0.0))
    seen_too, _ = change(frame, LevelControl(accumulation=0.0, peak_counts=1e9))
    np.testing.assert_array_equal(told.cir, base.cir)
    assert np.median(base.rx_power_dbm - told.rx_power_dbm) > 5
    np.testing.assert_allclose(told.rx_power_dbm, seen_too.rx_power_dbm, atol=0.3)
    assert np.median(seen_too.cir.max(axis=1)) < 0.6 * np.median(base.cir.max(axis=1))


def test_resonance_rings_on_and_decays() -> None:
    """A damped oscillation: every sample later it is weaker by 1/e per decay time, and turned."""
    ring = decaying(3.0, 0.15)
    assert np.isclose((np.abs(ring) ** 2).sum(), 1)
    assert np.allclose(np.abs(ring[1:] / ring[:-1]), np.exp(-1 / 3))
    assert np.allclose(np.angle(ring[1:] / ring[:-1]), 2 * np.pi * 0.15)
    assert abs(ring[-1]) < 0.03 * abs(ring[0])
    assert decaying(0.0, 0.15).tolist() == [1]
    lags, taps = echo_taps(5.0, 0.5 * ring)
    at = dict(zip(lags[1:].tolist(), taps[1:], strict=True))
    assert np.allclose([at[5], at[6]], 0.5 * ring[:2], atol=1e-6)


def test_what_reflects_twice_echoes_again_and_again() -> None:
    """A cable that fits neither end: at every multiple of its length, each time by one factor."""
    lags, taps = echo_taps(5.0, 0.3j, again=0.2j)
    at = {int(lag): tap for lag, tap in zip(lags, taps, strict=True) if abs(tap) > 1e-6}
    assert sorted(at) == [0, 5, 10, 15]
    assert np.allclose([at[5], at[10], at[15]], [0.3j, 0.3j * 0.2j, 0.3j * (0.2j) ** 2])
    assert np.array_equal(echo_taps(5.0, 0.3j, again=0.0)[1], echo_taps(5.0, 0.3j)[1])


def test_energy_of_what_echoes_again_grows_from_zero_as_a_line() -> None:
    wave = np.zeros((1, 60), np.complex64)
    wave[0, 5] = 1
    ring = {"ring_db": -6.0, "ring_delay_ns": 10.0, "ring_phase_deg": 0.0, "on_top": 1.0}
    rung = [PulseRinging(**ring, again=share)._rung(wave, 1.0) for share in (0.0, 0.1, 0.2)]
    none, some, twice = (float(np.abs(one[0, 25]) ** 2) for one in rung)
    assert none == 0
    assert np.isclose(some, 0.1 * 10**-1.2, rtol=1e-3)
    assert np.isclose(twice, 2 * some, rtol=1e-3)


def test_level_control_follows_a_receiver_whose_levels_are_calibrated_otherwise() -> None:
    """Other tools' levels are 15 dB off as easily: what is held and cut short is the same."""
    frame = line(64)
    usual = seen(frame, LevelControl())
    off = seen(frame, PathLoss(offset_db=-15.0), LevelControl(shift_db=15.0))
    assert usual.preamble_count.min() < 0.7 * usual.preamble_count.max()
    np.testing.assert_array_equal(off.preamble_count, usual.preamble_count)
