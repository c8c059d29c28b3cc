"""What the ropewalk hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.ropewalk_effects import (
    LONGEST_M,
    SOONEST_M,
    STEP_M,
    by_iron,
    slab,
    stepped,
)
from bench.challenge.families.ropewalk_faults import (
    ASKEW_RAD,
    BEAT_S,
    BOWS_M,
    DUST_M,
    DUSTY,
    FACES_M,
    HINGE_M,
    before,
    turned_m,
)
from bench.challenge.families.ropewalk_walk import (
    ANNEXE,
    HALF_LIGHT_M,
    HALL_M,
    IRON_M,
    LOW_STEAM_BAR,
    NORTH,
    TRESTLE_M,
    Hank,
)
from tests.bench.challenge import shown

_nothing = partial(shown.nothing_of, "ropewalk")
_shift = partial(shown.shift_of, "ropewalk")
_tables = partial(shown.tables_of, "ropewalk")
_rows = partial(shown.rows_of, "ropewalk")
_known = partial(shown.known_of, "ropewalk")
_of = partial(shown.column_of, "ropewalk")


def _hank() -> Hank:
    return Hank(_known(), 0, np.random.default_rng(0))


def _flat_and_rise(hank: Hank) -> tuple[np.ndarray, np.ndarray]:
    run = hank.strut_m - hank.tag_m
    return np.hypot(run[:, 0], run[:, 2]), run[:, 1]


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("ropewalk", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        assert {*world.CAUSES.values()} <= {*_nothing(0, mode).recorded}
    for name, column, sign in (
        ("tar-clings-to-covers", "tar_g", 1), ("twist-stiffens-strands-over-tags", "twist_rpm", 1),
        ("copper-swung-close-by", "copper_gap_m", -1),
        ("oakum-bales-stacked-before", "oakum_bales", 1),
        ("oil-creeps-since-hemp-was-dressed", "dressed_h", 1),
        ("belt-thrown-off-at-low-steam", "steam_bar", -1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    tar = _shift("tar-clings-to-covers") / 0.2
    assert np.allclose(-np.log1p(-tar), _of("tar_g") / 6.5)
    twist = np.log(_shift("twist-stiffens-strands-over-tags") / 0.16)
    assert np.allclose(twist, 1.7 * np.log(_of("twist_rpm") / 240.0))
    assert np.allclose(_shift("copper-swung-close-by") * _of("copper_gap_m"), 0.13)
    assert np.allclose(_shift("oakum-bales-stacked-before"), 0.0115 * _of("oakum_bales"))
    oil = np.expm1(_shift("oil-creeps-since-hemp-was-dressed") / 0.044)
    assert np.allclose(oil, _of("dressed_h") / 0.4)
    turn = 2 * np.pi * _of("spun_m") / TRESTLE_M - 0.7
    assert np.allclose(_shift("trestles-pass-underneath"), 0.062 * np.cos(turn))
    low = _of("steam_bar") < LOW_STEAM_BAR
    assert 0.2 < low.mean() < 0.8
    assert np.allclose(_shift("belt-thrown-off-at-low-steam"), 0.102 * low)


def test_dust_is_what_lies_along_the_way() -> None:
    hank, steps = _hank(), (np.arange(2000) + 0.5) / 2000
    east = hank.strut_m[:, :1] + steps * (hank.tag_m - hank.strut_m)[:, :1]
    part = np.exp(-east / DUST_M).mean(axis=1)
    law = DUSTY * _of("dust_g_m3") * hank.far * part
    assert np.allclose(_shift("hemp-dust-hangs-by-the-hackles"), law, atol=2e-4)


def test_faults_of_ways_concern_their_own_kind_and_not_what_rests() -> None:
    rests, hank = _known()["goes"].eq(0.0).to_numpy(), _hank()
    for name, kind, most in (("yarn-taken-up-as-it-twists", "spinner", 1.6),
                             ("strands-harden-and-draw-sledges-sooner", "sledge", 2.2),
                             ("rope-laid-longer-than-told", "top", 1.0),
                             ("cradles-geared-by-another-wheel", "bobbin", 0.9)):  # fmt: skip
        shift, own = _shift(name), hank.of(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        assert np.abs(shift[rests]).max() < 1e-9


def test_places_of_nearest_beats_are_as_often_too_late_as_too_soon() -> None:
    name = "places-looked-up-at-nearest-beats"
    rows = _rows().assign(shift=_shift(name))
    speeds, over, shifts = [], [], []
    for _, one in rows.groupby("link"):
        if len(one) > 4:
            speeds.append(np.gradient(one["true_range_m"], one["time_s"])[1:-1])
            at = one["time_s"].to_numpy()[1:-1]
            over.append(at - BEAT_S * np.rint(at / BEAT_S))
            shifts.append(one["shift"].to_numpy()[1:-1])
    speed, off, shift = map(np.concatenate, (speeds, over, shifts))
    assert np.corrcoef(speed * off, shift)[0, 1] > 0.95
    assert abs(np.corrcoef(speed, shift)[0, 1]) < 0.4


def test_walls_bow_out_by_how_much_snow_lies_and_the_north_row_is_further_in() -> None:
    hank = _hank()
    flat, rise = _flat_and_rise(hank)
    aside = np.tanh(2 * (hank.strut_m[:, 1] - HALL_M[1] / 2))
    out = BOWS_M * np.sin(np.pi * hank.strut_m[:, 0] / HALL_M[0]) * aside * _of("snow_cm") / 45.0
    found = _shift("walls-bow-out-under-snow")
    assert np.allclose(hank.far + found, np.hypot(flat, rise + out))
    north = np.isin(hank.strut, NORTH)
    found = _shift("north-row-taped-from-the-outer-face")
    assert np.allclose(hank.far + found, np.hypot(flat, rise - FACES_M * north))
    assert (hank.strut_m[north, 1] > 7.0).all()


def test_the_annexe_turns_about_a_corner_and_keeps_its_shape() -> None:
    at = np.array([[70.0, 1.0, 3.0], [85.0, 7.0, 2.0]])
    turned = at + turned_m(at, 0.3)
    arms = [np.linalg.norm(one[:, :2] - HINGE_M, axis=1) for one in (at, turned)]
    assert np.allclose(*arms)
    assert np.linalg.norm(turned[1] - turned[0]) == pytest.approx(np.linalg.norm(at[1] - at[0]))
    shift, hank = _shift("annexe-rebuilt-askew-since-the-survey"), _hank()
    own = np.isin(hank.strut, ANNEXE)
    assert not shift[~own].any()
    assert (hank.strut_m[own, 0] > HINGE_M[0]).all()
    arm = np.linalg.norm(hank.strut_m[:, :2] - HINGE_M, axis=1)
    assert (np.abs(shift) <= ASKEW_RAD * arm + 1e-9).all()


def test_booked_answers_are_those_before_on_a_strand_and_are_some() -> None:
    name = "answers-booked-to-who-answers-next"
    for strength, part in ((1.0, 0.11), (2.0, 0.22)):
        made, shift = _tables(name, strength), _shift(name, strength)
        strands = made.clean["link"].str.extract(r"(\d+)")[0]
        last = made.clean.groupby(strands, sort=False)["range_m"].shift(1)
        booked = np.abs(shift) > 1e-12
        assert np.allclose(made.recorded["range_m"][booked], last[booked])
        assert booked.mean() == pytest.approx(part, abs=0.05)
    rows = pd.concat([_rows(), _rows()], ignore_index=True)
    found = before(Hank(rows.assign(), 0, np.random.default_rng(0)))
    half = len(rows) // 2
    assert (found[:half] < half).all()  # each telling has its own before it
    assert np.array_equal(found[half:], found[:half] + half)


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    for name, low, high in (("path-loss", -6.0, -1.2), ("level-control", -3.4, -0.6)):
        made = _tables(name)
        lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
        assert low < lost.mean() < high
        assert not _shift(name).any()
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert counts.max() <= 1.0
    far = _tables("path-loss")
    lost = far.recorded["rx_power_dbm"] - far.clean["rx_power_dbm"]
    assert np.corrcoef(lost, -np.log10(1 + _of("true_range_m") / 7.0))[0, 1] > 0.6


def test_loud_rows_are_early_and_weak_ones_late() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    order = np.argsort(level)
    assert (np.diff(shift[order]) <= 1e-12).all()
    assert np.allclose(np.tan(shift / 0.043), (-82.5 - level) / 4.2)
    assert shift.min() < -0.03 < 0.03 < shift.max()


def test_clocks_count_by_ppm_and_by_how_long_replies_take() -> None:
    ppm = _shift("clock-offset") / (HALF_LIGHT_M * _of("reply_time_s"))
    rows = _rows().assign(ppm=ppm)
    assert np.abs(ppm).max() < 0.15
    for _, one in rows.groupby(["tx", "rx"]):
        if len(one) > 4 and np.ptp(one["time_s"]) < 60:
            assert np.ptp(one["ppm"]) < 1e-3


def test_scales_are_a_chains_and_hardly_each_struts_own() -> None:
    part = _shift("range-scale") / _of("true_range_m")
    by = pd.Series(part).groupby(_hank().strut).agg(["mean", np.ptp])
    assert by["ptp"].max() < 1e-12
    assert by["mean"].between(0.0056, 0.0080).all()


def test_ranges_are_read_in_whole_steps() -> None:
    steps = _tables("range-rounding").recorded["range_m"].to_numpy() / STEP_M
    assert np.allclose(steps, np.rint(steps))
    assert np.abs(_shift("range-rounding")).max() <= STEP_M / 2 + 1e-9
    assert np.allclose(stepped(np.array([4.4, 5.1, 6.9]), 2.0), [4.0, 6.0, 6.0])


def test_slabs_are_those_of_snell() -> None:
    thick, sine = np.array([0.2, 0.2]), np.array([0.0, 0.6])
    late = slab(2.0, thick, sine)
    assert late[0] == pytest.approx(0.2 * (2.0 - 1.0))
    within = np.arcsin(0.6 / 2.0)
    way = 2.0 * 0.2 / np.cos(within)  # and less of the way beside it
    beside = 0.2 * np.cos(np.arcsin(0.6) - within) / np.cos(within)
    assert late[1] == pytest.approx(way - beside)


def test_only_what_is_behind_something_is_blocked_and_by_the_soonest_way_there_is() -> None:
    late = shown.assert_blocked_behind_things("ropewalk", 0.5)
    assert late.max() < LONGEST_M + 1e-9
    hank = _hank()
    longer = by_iron(hank)
    assert longer.shape == (len(IRON_M) + 2, hank.rows)
    assert longer.min() >= -1e-9
    image = hank.tag_m * np.array([-1.0, 1.0, 1.0])
    assert np.allclose(longer[3] + hank.far, np.linalg.norm(image - hank.strut_m, axis=1))
    shift = _shift("blocked-path")
    there = np.flatnonzero(shift)
    own = np.concatenate([longer[:, there], np.full((1, len(there)), LONGEST_M)])
    assert (np.abs(own - shift[there]).min(axis=0) < 1e-9).all()
    assert (shift[there] > SOONEST_M).all()
