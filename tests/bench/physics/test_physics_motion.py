"""Effects of motion, scale and rounding: hand-made rows with known answers."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest
from physics_scenes import line, seen

from bench.discrepancy.data.columns import with_motion
from bench.physics.effects.ranging.exchange_motion import ExchangeMotion
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.time_lag import TimeLag
from bench.physics.scene import scene
from bench.recordings.motion import (
    SPEED,
    radial_speed_m_per_s,
    speed_by_places_m_per_s,
    with_radial_speed,
)


def drive(n: int = 200, speed: float = 2.0) -> pd.DataFrame:
    """Past an anchor and back: the range falls, then rises; 10 rows a second."""
    time = np.arange(n) / 10
    true = 3 + np.abs(20 - speed * time)
    frame = pd.DataFrame({"true_range_m": true, "time_s": time, "tx": "car", "rx": "mast"})
    return frame.assign(link="drive")


def test_speed_is_the_slope_of_the_true_range_and_flips_its_sign() -> None:
    speed = radial_speed_m_per_s(drive())
    assert speed[:98] == pytest.approx(-2.0)
    assert speed[103:] == pytest.approx(2.0)


def test_speed_knows_pairs_order_gaps_and_standing_still() -> None:
    both = pd.concat([drive(40), drive(40, speed=0.0).assign(rx="other")])
    mixed = both.sample(frac=1.0, random_state=3)
    speed = pd.Series(radial_speed_m_per_s(mixed), index=mixed["rx"])
    assert speed["mast"].to_numpy() == pytest.approx(-2.0)
    assert speed["other"].to_numpy() == pytest.approx(0.0)
    far = drive(4).assign(time_s=[0.0, 10.0, 20.0, 30.0])
    assert np.isnan(radial_speed_m_per_s(far)).all()
    assert np.isnan(radial_speed_m_per_s(drive(1))).all()


@pytest.mark.parametrize(("uneven_s", "off"), [(0.0, 0.05), (0.3, 0.08)])
def test_a_device_that_turns_is_not_slower_for_being_seen_seldom(
    uneven_s: float, off: float
) -> None:
    """Of a tag on a round of 8 s that is heard once a second; a straight line is 10 % off."""
    rng = np.random.default_rng(1)
    time, turn = np.arange(60) + rng.uniform(-uneven_s, uneven_s, 60), 2 * np.pi / 8
    frame = pd.DataFrame({"time_s": time, "true_range_m": 6 + np.sin(turn * time), "link": "a"})
    error = radial_speed_m_per_s(frame) - turn * np.cos(turn * time)
    assert np.abs(error[2:-2]).max() < off * turn
    # a short step beside long ones has no weight of its own
    jumpy = frame.assign(time_s=np.arange(60) + np.where(np.arange(60) % 2, -0.99, 0.0))
    jumpy["true_range_m"] = rng.normal(6, 1e-3, 60)
    assert np.nanmax(np.abs(radial_speed_m_per_s(jumpy)[2:-2])) < 5e-3


@pytest.mark.parametrize("noise_m", [0.01, 0.02])
def test_a_lag_is_not_smaller_for_a_truth_that_was_measured(noise_m: float) -> None:
    """Of a tag on a round of 30 s at 10 Hz (four neighbours: 30 % less)."""
    rng = np.random.default_rng(2)
    time, turn, lag_s = np.arange(600) / 10, 2 * np.pi / 30, 0.2
    error = lag_s * 1.5 * turn * np.cos(turn * time)
    true = 6 + 1.5 * np.sin(turn * time) + noise_m * rng.normal(size=600)
    speed = radial_speed_m_per_s(pd.DataFrame({"time_s": time, "true_range_m": true, "link": "a"}))
    assert error @ speed / (speed @ speed) == pytest.approx(lag_s, rel=0.03)


def test_rows_at_nearly_one_time_end_nothing_and_are_no_speed() -> None:
    """Each row twice, a nanosecond apart, of a truth that was measured."""
    time = np.sort(np.concatenate([np.arange(200) / 10, np.arange(200) / 10 + 1e-9]))
    true = 3 + 2 * time + np.random.default_rng(0).normal(0, 0.01, 400)
    speed = radial_speed_m_per_s(pd.DataFrame({"time_s": time, "true_range_m": true, "link": "a"}))
    assert np.median(speed) == pytest.approx(2.0, abs=0.2)


def test_a_speed_that_is_given_is_kept_and_none_is_made_without_times() -> None:
    given = drive().assign(**{SPEED: 7.0})
    assert (with_radial_speed(given)[SPEED] == 7.0).all()
    assert SPEED not in with_radial_speed(line())
    assert not scene(line()).has(SPEED)
    assert scene(drive()).has(SPEED)


def rounds(count: int, start_s: float, speed: float = 2.0) -> pd.DataFrame:
    """A car that four masts hear in turn, so many rounds of them."""
    masts = np.array([[0.0, 5, 3], [12, -4, 3], [24, 5, 3], [36, -4, 3]])
    which, turn = np.tile(np.arange(4), count), np.arange(4 * count)
    time = start_s + 0.05 * turn
    car = np.stack([3 + speed * (time - start_s), 0 * time, 1 + 0 * time], axis=1)
    ends = {f"tx_{a}_m": car[:, i] for i, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": masts[which, i] for i, a in enumerate("xyz")}
    frame = pd.DataFrame(ends | {"time_s": time, "tx": "car", "rx": [f"m{i}" for i in which]})
    return frame.assign(
        true_range_m=np.linalg.norm(car - masts[which], axis=1),
        link=[f"run {start_s} heard by m{i}" for i in which],
    )


def test_a_row_that_is_alone_in_its_link_has_the_speed_of_its_devices() -> None:
    frame = pd.concat([rounds(5, 0.0), rounds(1, 100.0)], ignore_index=True)
    assert np.isnan(radial_speed_m_per_s(frame)[20:]).all()
    line = (frame["tx_x_m"] - frame["rx_x_m"]) / frame["true_range_m"]
    assert with_motion(frame)[SPEED].to_numpy()[20:] == pytest.approx(2.0 * line.to_numpy()[20:])


def test_places_that_contradict_each_other_are_no_motion() -> None:
    frame = pd.concat([rounds(1, 0.0), rounds(1, 0.01).assign(tx_y_m=7.0)], ignore_index=True)
    assert np.isnan(speed_by_places_m_per_s(frame)).all()
    assert np.isnan(speed_by_places_m_per_s(frame.drop(columns="rx_z_m"))).all()
    assert speed_by_places_m_per_s(rounds(2, 0.0, speed=0.0)) == pytest.approx(0.0)


def test_a_lag_makes_an_error_of_lag_times_speed() -> None:
    frame = drive()
    change = seen(frame, TimeLag(lag_s=0.18)).range_m - seen(frame).range_m
    assert change[:98] == pytest.approx(-0.36)
    assert change[103:] == pytest.approx(0.36)
    assert not (seen(line(), TimeLag(lag_s=0.18)).range_m - seen(line()).range_m).any()


def test_motion_during_the_exchange_needs_a_reply_time() -> None:
    slow = drive().assign(reply_time_s=0.2)
    change = seen(slow, ExchangeMotion()).range_m - seen(slow).range_m
    assert change[:98] == pytest.approx(-0.2)
    assert not (seen(drive(), ExchangeMotion()).range_m - seen(drive()).range_m).any()


def test_a_scale_has_no_end() -> None:
    frame = line(far_m=100.0)
    change = seen(frame, RangeScale(scale=0.004)).range_m - seen(frame).range_m
    assert change == pytest.approx(0.004 * frame["true_range_m"].to_numpy())


def test_rounded_ranges_are_multiples_within_half_a_step() -> None:
    made, base = seen(line(), RangeRounding(step_m=0.1)).range_m, seen(line()).range_m
    assert made / 0.1 == pytest.approx(np.rint(made / 0.1))
    assert np.abs(made - base).max() <= 0.05 + 1e-9
    assert np.ptp(made - base) > 0.08


@pytest.mark.parametrize("effect", [TimeLag(lag_s=1.0), ExchangeMotion()])
def test_nothing_happens_at_rest(effect: TimeLag | ExchangeMotion) -> None:
    still = drive(speed=0.0).assign(reply_time_s=0.2)
    np.testing.assert_array_equal(seen(still, effect).range_m, seen(still).range_m)


def round_and_round(rows: int, radius_m: float, speed: float) -> pd.DataFrame:
    """Return a robot on a circle, heard by four masts in turn, every row in a link of its own."""
    masts = np.array([[0.0, 5, 3], [12, -4, 3], [24, 5, 3], [36, -4, 3]])
    which, time = np.arange(rows) % 4, 0.5 * np.arange(rows)
    turn = speed / radius_m * time
    at = radius_m * np.stack([np.cos(turn), np.sin(turn), 0 * turn], axis=1) + [8.0, 1.0, 0.5]
    ends = {f"tx_{a}_m": at[:, i] for i, a in enumerate("xyz")}
    ends |= {f"rx_{a}_m": masts[which, i] for i, a in enumerate("xyz")}
    line = at - masts[which]
    far = np.linalg.norm(line, axis=1)
    way = speed * np.stack([-np.sin(turn), np.cos(turn), 0 * turn], axis=1)
    true = (way * line).sum(axis=1) / far
    frame = pd.DataFrame(ends | {"time_s": time, "tx": "robot", "true_range_m": far, "true": true})
    return frame.assign(rx=[f"m{i}" for i in which], link=[f"cell {i}" for i in range(rows)])


def test_a_robot_that_turns_has_a_speed_too() -> None:
    """Eight rows on either side are no straight line, one on either side nearly is."""
    frame = round_and_round(80, 2.5, 1.5)
    speed = speed_by_places_m_per_s(frame)
    assert np.isfinite(speed[1:-1]).all()
    assert np.abs(speed - frame["true"])[1:-1].max() < 0.05 * 1.5 + 0.01
    assert np.isnan(speed_by_places_m_per_s(round_and_round(80, 0.5, 3.0))).mean() > 0.9
