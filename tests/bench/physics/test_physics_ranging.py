"""Signature, magnitude and negative control of the effects on timestamps and ranges."""

import numpy as np
import pandas as pd
import pytest
from physics_scenes import change, line, room, seen

from bench.physics.base import Base
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.clock_offset import ClockOffset
from bench.physics.effects.ranging.power_bias import PowerBias, published_bias_m
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.scene import scene

C_M_PER_NS = 0.299792458


def test_antenna_delay_is_a_constant_15_cm_per_ns() -> None:
    made, base = change(line(), AntennaDelay(delay_ns=1.0))
    np.testing.assert_allclose(made.range_m - base.range_m, C_M_PER_NS / 2)
    np.testing.assert_array_equal(made.cir, base.cir)


def test_antenna_delays_of_devices_separate_into_pairs() -> None:
    frame = line(400, tx=np.tile(["a", "b"], 200), rx=np.repeat(["c", "d"], 200))
    shift = np.subtract(*(x.range_m for x in change(frame, AntennaDelay(device_spread_ns=1.0))))
    ac, bc, ad, bd = shift[0], shift[1], shift[200], shift[201]
    assert abs(ac + bd - ad - bc) < 1e-9
    assert abs(ac - bc) > 1e-3


def test_a_drift_over_temperature_may_be_a_cubic_as_that_of_crystals() -> None:
    warm_c = np.linspace(-10.0, 50.0, 60)
    (ways,) = TemperatureDrift.ways(scene(line(60, temperature_c=warm_c))) or ()
    cubic_m = 0.08 * ((warm_c - 20) / 30) ** 3
    left_m = cubic_m - ways @ np.linalg.lstsq(ways, cubic_m, rcond=None)[0]
    assert np.abs(left_m).max() < 1e-9 < np.abs(cubic_m).max()


def test_power_bias_is_the_published_curve() -> None:
    points = {-61: -11.0, -69: -8.2, -77: 0.0, -79: 2.1, -85: 4.9, -93: 8.1}
    for level, cm in points.items():
        assert abs(published_bias_m(np.array([float(level)]))[0] * 100 - cm) < 1e-9
    curve = published_bias_m(np.linspace(-100, -50, 200))
    assert np.all(np.diff(curve) <= 0)


def test_power_bias_follows_the_true_level_in_line_of_sight() -> None:
    frame = line(256, los=True)
    made, base = change(frame, PowerBias())
    level = -14.3 - 44.47 - 20 * np.log10(frame["true_range_m"])
    np.testing.assert_allclose(made.range_m - base.range_m, published_bias_m(level), atol=2e-3)
    np.testing.assert_array_equal(made.cir, base.cir)


def test_clock_offset_is_15_cm_per_ppm_and_millisecond() -> None:
    frame = line(256, reply_time_s=np.repeat([0.0, 1e-3], 128))
    made, base = change(frame, ClockOffset(offset_ppm=2.0))
    shift = made.range_m - base.range_m
    np.testing.assert_array_equal(shift[:128], 0)  # no reply time, no error
    np.testing.assert_allclose(shift[128:], 2 * 0.149896, rtol=1e-5)
    np.testing.assert_array_equal(made.cir, base.cir)
    np.testing.assert_array_equal(made.clock_offset_ppm, 2.0)


def test_clock_offset_flips_with_the_roles_and_drifts() -> None:
    frame = line(256, reply_time_s=1e-3, tx="a", rx="b", time_s=np.linspace(0, 3600, 256))
    swapped = frame.assign(tx="b", rx="a")
    effect = ClockOffset(device_spread_ppm=5.0)
    ahead = np.subtract(*(x.range_m for x in change(frame, effect)))
    behind = np.subtract(*(x.range_m for x in change(swapped, effect)))
    np.testing.assert_allclose(ahead, -behind, atol=1e-12)
    assert abs(ahead[0]) > 0.01
    drift = np.subtract(*(x.range_m for x in change(frame, ClockOffset(drift_ppm_per_hour=1.0))))
    assert abs(drift[-1] - 0.149896) < 1e-5
    assert drift[0] == 0


def test_double_sided_ranging_leaves_only_offset_times_flight() -> None:
    frame = line(256, reply_time_s=0.2)
    made, base = change(frame, ClockOffset(offset_ppm=10.0, double_sided=1))
    np.testing.assert_allclose(made.range_m - base.range_m, 1e-5 * frame["true_range_m"])


def test_recorded_clock_offset_is_used_when_asked_for() -> None:
    frame = line(64, reply_time_s=1e-3, clock_offset_ppm=3.0)
    made, base = change(frame, ClockOffset(use_column=1))
    np.testing.assert_allclose(made.range_m - base.range_m, 3 * 0.149896, rtol=1e-5)


def test_temperature_is_2_mm_per_degree_and_zero_at_the_reference() -> None:
    frame = line(128, temperature_c=np.repeat([25.0, 35.0], 64))
    made, base = change(frame, TemperatureDrift())
    shift = made.range_m - base.range_m
    np.testing.assert_array_equal(shift[:64], 0)
    np.testing.assert_allclose(shift[64:], 0.0215)


def test_warming_up_is_exponential_in_time() -> None:
    frame = line(3, time_s=[0.0, 600.0, 1e6])
    effect = TemperatureDrift(slope_mm_per_c=2.0, warm_up_c=10.0, warm_up_s=600.0)
    shift = np.subtract(*(x.range_m for x in change(frame, effect)))
    np.testing.assert_allclose(shift, [0, 0.02 * (1 - np.exp(-1)), 0.02], atol=1e-9)


def test_antenna_pattern_is_periodic_in_heading_and_alike_at_all_distances() -> None:
    heading = np.tile(np.arange(0, 360, 5.0), 8)
    frame = line(len(heading), azimuth_deg=heading)
    effect = AntennaPattern(delay_m=0.15, phase_deg=90.0, gain_db=6.0)
    made, base = change(frame, effect)
    wave = np.cos(np.radians(heading - 90))
    np.testing.assert_allclose(made.range_m - base.range_m, 0.15 * wave, atol=0.03)
    np.testing.assert_allclose(made.rx_power_dbm - base.rx_power_dbm, -6 * wave, atol=0.3)


def test_antenna_pattern_takes_the_bearing_where_no_azimuth_is_known() -> None:
    frame = room(256)
    way = np.arctan2(frame["tx_y_m"] - frame["rx_y_m"], frame["tx_x_m"] - frame["rx_x_m"])
    made, base = change(frame, AntennaPattern(delay_2_m=0.1), cir=False)
    np.testing.assert_allclose(made.range_m - base.range_m, 0.1 * np.cos(2 * way), atol=1e-6)


def test_jitter_scatters_ranges_alone() -> None:
    frame = line(4000)
    made, base = change(frame, TimestampJitter(jitter_samples=0.08))
    shift = made.range_m - base.range_m
    assert abs(shift.std() - 0.08 * 0.3003) < 1e-3
    assert abs(shift.mean()) < 2e-3
    assert abs(np.corrcoef(shift[:-1], shift[1:])[0, 1]) < 0.05
    np.testing.assert_array_equal(made.cir, base.cir)
    heavy = np.subtract(*(x.range_m for x in change(frame, TimestampJitter(0.08, heavy=0.2))))
    assert 0.08 < np.mean(np.abs(heavy) > 3 * 0.024) < 0.14  # 20 % of rows, 55 % of those


@pytest.mark.parametrize(
    ("effect", "columns", "rows"),
    [
        (ClockOffset(), {"reply_time_s": [0.0, 1e-3]}, [True, False]),
        (TemperatureDrift(), {"temperature_c": [25.0, 30.0]}, [True, False]),
    ],
)
def test_negative_controls_are_named_row_by_row(effect, columns, rows) -> None:
    frame = line(2).assign(**columns)
    np.testing.assert_array_equal(effect.inert(Base().paths(scene(frame))), rows)
    assert seen(frame, effect).range_m.shape == (2,)


def test_a_scale_beyond_its_bound_is_a_unit() -> None:
    rows = scene(pd.DataFrame({"true_range_m": [1.0, 4.0, 9.0]}))
    assert RangeScale.possible(rows, 0.04 * rows.true_range_m)
    assert not RangeScale.possible(rows, (0.9144 - 1) * rows.true_range_m)
