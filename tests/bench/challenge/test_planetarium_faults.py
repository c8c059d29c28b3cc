"""What the planetarium hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.planetarium_dome import (
    LIGHT_M_US,
    MIDDLE_M,
    RADIUS_M,
    TEETH_M,
    TRIPS_V,
    Seating,
)
from bench.challenge.families.planetarium_effects import (
    LONGEST_M,
    SOONEST_M,
    STEP_M,
    by_lot,
    slower,
)
from bench.challenge.families.planetarium_faults import (
    DECLINES_RAD,
    FAINT_DB,
    HAZE_UP_M,
    HAZY,
    SMOOTH,
    SWELLS_M,
    TAPED,
    WOW_S,
    chained,
    lower_m,
    square_mean,
    turned_m,
)
from tests.bench.challenge import shown

_nothing = partial(shown.nothing_of, "planetarium")
_shift = partial(shown.shift_of, "planetarium")
_tables = partial(shown.tables_of, "planetarium")
_rows = partial(shown.rows_of, "planetarium")
_known = partial(shown.known_of, "planetarium")
_of = partial(shown.column_of, "planetarium")


def _seating() -> Seating:
    return Seating(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("planetarium", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        assert {*world.CAUSES.values()} <= {*_nothing(0, mode).recorded}
    for name, column, sign in (
        ("felt-glued-over-covers", "felt_mm", 1), ("breath-dampens-the-felt", "humid_pct", 1),
        ("slide-tins-stacked-near", "tins_gap_m", -1),
        ("programmes-piled-on-coves", "programmes", 1),
        ("valves-warm-since-switched-on", "switched_min", -1),
        ("fog-blown-about-tags", "fog_ml", 1), ("dimmers-trip-at-low-mains", "mains_v", -1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    felt = _shift("felt-glued-over-covers") / 0.21
    assert np.allclose(5.5 * felt / (1 - felt), _of("felt_mm"))
    damp = np.sqrt(_shift("breath-dampens-the-felt") / 0.15)
    assert np.allclose(damp, _of("humid_pct") / 100.0)
    assert np.allclose(_shift("slide-tins-stacked-near") * _of("tins_gap_m") ** 2, 0.105)
    assert np.allclose(_shift("programmes-piled-on-coves"), 0.0082 * _of("programmes"))
    warm = np.expm1(_shift("valves-warm-since-switched-on") / -0.041)
    assert np.allclose(warm, _of("switched_min") / 1.5)
    assert np.allclose((_shift("fog-blown-about-tags") / 0.15) ** 2, _of("fog_ml") / 60.0)
    turn = 2 * np.pi * _of("rack_m") / TEETH_M - 1.1
    assert np.allclose(_shift("worn-teeth-pass-on-racks"), 0.058 * np.sin(turn))
    low = _of("mains_v") < TRIPS_V
    assert 0.2 < low.mean() < 0.8
    assert np.allclose(_shift("dimmers-trip-at-low-mains"), 0.094 * low)


def test_haze_is_what_lies_along_the_way() -> None:
    seating, steps = _seating(), (np.arange(1000) + 0.5) / 1000
    low, high = seating.tag_m[:, 2:], seating.cove_m[:, 2:]
    mean = ((low + steps * (high - low)) ** 2).mean(axis=1)
    assert np.allclose(square_mean(low[:, 0], high[:, 0]), mean, atol=1e-4)
    law = HAZY * mean / HAZE_UP_M**2 * _of("haze_pct") / 100.0 * seating.far
    assert np.allclose(_shift("haze-gathers-under-the-dome"), law, atol=1e-5)


def test_faults_of_ways_concern_their_own_kind() -> None:
    rests, seating = _known()["goes"].eq(0.0).to_numpy(), _seating()
    for name, kind, most in (("planets-driven-by-an-equant", "planet", 1.6),
                             ("moons-slip-on-their-wheels", "moon", 1.4),
                             ("ushers-walk-a-heptagon", "usher", 1.0),
                             ("wires-sag-under-comets", "comet", 0.6),
                             ("trolleys-roll-back", "trolley", 0.8)):  # fmt: skip
        shift, own = _shift(name), seating.of(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        if kind in ("moon", "trolley"):
            assert np.abs(shift[rests]).max() < 1e-9


def test_a_tape_that_wows_is_as_often_ahead_as_behind() -> None:
    rows = _rows().assign(shift=_shift("places-read-off-a-tape-that-wows"))
    speeds, ahead, shifts = [], [], []
    for _, one in rows.groupby("link"):
        if len(one) > 4:
            speeds.append(np.gradient(one["true_range_m"], one["time_s"])[1:-1])
            ahead.append(np.sin(2 * np.pi * one["time_s"].to_numpy()[1:-1] / WOW_S))
            shifts.append(one["shift"].to_numpy()[1:-1])
    speed, off, shift = map(np.concatenate, (speeds, ahead, shifts))
    assert np.corrcoef(speed * off, shift)[0, 1] > 0.9
    assert abs(np.corrcoef(speed, shift)[0, 1]) < 0.4


def _with_coves_at(off: np.ndarray) -> np.ndarray:
    seating = _seating()
    return np.linalg.norm(seating.cove_m + off - seating.tag_m, axis=1) - seating.far


def test_coves_are_elsewhere_as_the_sun_the_compass_and_the_tape_have_it() -> None:
    at = _seating().cove_m
    high = (at[:, 2] > MIDDLE_M[2])[:, None]
    out = (at - MIDDLE_M) / np.linalg.norm(at - MIDDLE_M, axis=1)[:, None]
    sun = (_of("sun_w_m2") / 900.0)[:, None]
    found = _shift("dome-swells-in-the-sun")
    part = 1 - 0.3 / RADIUS_M
    assert np.allclose(found, _with_coves_at(SWELLS_M * part * high * sun * out))
    turned = turned_m(at, DECLINES_RAD)
    arms = [np.linalg.norm((one - MIDDLE_M)[:, :2], axis=1) for one in (at, at + turned)]
    assert np.allclose(*arms)
    assert np.allclose(_shift("bearings-from-magnetic-north"), _with_coves_at(turned))
    down = np.zeros(at.shape)
    down[:, 2] = -TAPED * lower_m(at[:, 2])
    assert np.allclose(_shift("heights-taped-along-the-dome"), _with_coves_at(down))
    assert lower_m(np.array([1.0]))[0] == 0.0
    top = MIDDLE_M[2] + 0.5 * np.pi * RADIUS_M
    assert lower_m(np.array([top]))[0] == pytest.approx((0.5 * np.pi - 1) * RADIUS_M)


def test_smoothed_answers_are_means_of_those_before_and_faint_ones_the_last() -> None:
    made = _tables("answers-smoothed-as-they-come")
    old = SMOOTH / (1 + SMOOTH)
    for _, one in made.clean.assign(told=made.recorded["range_m"]).groupby("link"):
        last = one["range_m"].iloc[0]
        for now, told in zip(one["range_m"], one["told"], strict=True):
            last = now + old * (last - now)
            assert told == pytest.approx(last)
    made = _tables("weak-answers-told-as-the-last")
    told, chain = made.recorded["range_m"], made.clean.groupby("link")
    faint = made.clean["rx_power_dbm"].lt(FAINT_DB) & chain.cumcount().gt(0)
    last = told.groupby(made.clean["link"]).shift(1)
    assert np.allclose(told, np.where(faint, last, made.clean["range_m"]))
    rows = pd.concat([_known(), _known()], ignore_index=True)
    link, place = chained(Seating(rows, 0, np.random.default_rng(0)))
    half = len(rows) // 2
    assert not {*link[:half]} & {*link[half:]}  # each telling has its own before it
    assert np.array_equal(place[:half], place[half:])


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    for name, low, high in (("path-loss", -6.0, -1.2), ("level-control", -3.6, -0.6)):
        made = _tables(name)
        lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
        assert low < lost.mean() < high
        assert not _shift(name).any()
    rungs = -lost.to_numpy() / 0.72
    assert np.allclose(rungs, np.rint(rungs), atol=1e-6)
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert counts.max() <= 1.0


def test_loud_rows_are_early_and_weak_ones_late() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert shift.min() < -0.03
    assert 0.02 < shift.max() < 0.045


def test_clocks_count_by_ppm_and_by_how_long_replies_take() -> None:
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    rows = _rows().assign(ppm=ppm)
    assert np.abs(ppm).max() < 0.1
    assert rows.groupby("link")["ppm"].agg(np.ptp).median() < 1e-12


def test_counts_are_short_by_as_much_for_each_tag() -> None:
    part = _shift("range-scale") / _of("true_range_m")
    by = pd.Series(part).groupby(_seating().tag).agg(["mean", np.ptp])
    assert by["ptp"].max() < 1e-12
    assert by["mean"].between(0.0075, 0.0112).all()


def test_ranges_are_read_in_whole_steps_and_right_in_the_mean() -> None:
    steps = _tables("range-rounding").recorded["range_m"].to_numpy() / STEP_M
    assert np.allclose(steps, np.rint(steps))
    assert np.abs(_shift("range-rounding")).max() <= STEP_M
    made = by_lot(np.random.default_rng(1), np.full(40000, 5.3), 2.0)
    assert {*made} == {4.0, 6.0}
    assert made.mean() == pytest.approx(5.3, abs=0.02)


def test_sheets_are_those_of_snell() -> None:
    thick, sine = np.array([0.2, 0.2]), np.array([0.0, 0.6])
    late = slower(2.0, thick, sine)
    assert late[0] == pytest.approx(0.2)
    within = np.arcsin(0.6 / 2.0)
    beside = 0.2 * np.cos(np.arcsin(0.6) - within) / np.cos(within)
    assert late[1] == pytest.approx(2.0 * 0.2 / np.cos(within) - beside)


def test_only_what_is_behind_something_is_blocked_and_late_by_seats_about() -> None:
    late = shown.assert_blocked_behind_things("planetarium", 0.5)
    assert late.min() > SOONEST_M
    assert late.max() < LONGEST_M + 1e-9
    assert 1.0 < np.median(late) < 3.0
