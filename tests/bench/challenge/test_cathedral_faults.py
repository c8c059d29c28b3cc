"""What the cathedral hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.cathedral_effects import (
    BREAK_M,
    EVEN_C,
    LESS,
    LONGEST_M,
    SOONEST_M,
    STEP_M,
    to_steps,
)
from bench.challenge.families.cathedral_faults import (
    ASKEW,
    CHAIN_M,
    COURSE_M,
    KEEPS_M,
    LEANS,
    LOSES_S,
    QUARTER_S,
    RACK_M,
    WARM_M,
    WARMS_M,
    in_order,
    passed_at_m,
)
from bench.challenge.families.cathedral_nave import FLAG_M, LIGHT_M_US, SLACK_MM, Vigil
from tests.bench.challenge import shown

_nothing = partial(shown.nothing_of, "cathedral")
_shift = partial(shown.shift_of, "cathedral")
_tables = partial(shown.tables_of, "cathedral")
_rows = partial(shown.rows_of, "cathedral")
_known = partial(shown.known_of, "cathedral")
_of = partial(shown.column_of, "cathedral")


def _vigil() -> Vigil:
    return Vigil(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("cathedral", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        assert {*world.CAUSES.values()} <= {*_nothing(0, mode).recorded}
    for name, column, sign in (
        ("wax-gutters-over-covers", "wax_mm", 1), ("incense-thickens-about-tags", "incense_g", 1),
        ("candlestands-drawn-close", "stand_m", -1),
        ("hassocks-heaped-before-bosses", "hassocks", 1),
        ("pipes-cool-since-stoked", "stoked_min", -1), ("damp-rises-behind-bosses", "damp_pct", 1),
        ("blower-runs-at-slack-wind", "wind_mm", -1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    wax = -np.log(1 - _shift("wax-gutters-over-covers") / 0.165)
    assert np.allclose(6.2 * wax, _of("wax_mm"), atol=1e-6)
    incense = (_shift("incense-thickens-about-tags") / 0.17) ** (1 / 0.6)
    assert np.allclose(incense, _of("incense_g") / 70.0)
    assert np.allclose(_shift("candlestands-drawn-close") * _of("stand_m"), 0.088)
    assert np.allclose(_shift("hassocks-heaped-before-bosses"), 0.0078 * _of("hassocks"))
    cool = np.expm1(_shift("pipes-cool-since-stoked") / -0.043)
    assert np.allclose(1.2 * cool, _of("stoked_min"))
    assert np.allclose(np.sqrt(_shift("damp-rises-behind-bosses") / 0.155), _of("damp_pct") / 100)
    turn = 2 * np.pi * _of("paced_m") / FLAG_M + 0.8
    assert np.allclose(_shift("joints-of-flags-pass-underfoot"), 0.06 * np.cos(turn))
    slack = _of("wind_mm") < SLACK_MM
    assert 0.2 < slack.mean() < 0.8
    assert np.allclose(_shift("blower-runs-at-slack-wind"), 0.096 * slack)


def test_candles_warm_ways_by_how_near_these_pass() -> None:
    vigil, part = _vigil(), np.linspace(0.0, 1.0, 801)[:, None]
    ways = [low + part * (high - low) for low, high in zip(vigil.tag_m, vigil.boss_m, strict=True)]
    near = np.array([np.linalg.norm(way - RACK_M, axis=1).min() for way in ways])
    assert np.allclose(passed_at_m(RACK_M, vigil.tag_m, vigil.boss_m), near, atol=0.02)
    law = WARMS_M * np.exp(-((near / WARM_M) ** 2)) * _of("candles") / 240.0
    assert np.allclose(_shift("candles-warm-ways-that-pass-them"), law, atol=2e-3)


def test_faults_of_ways_concern_their_own_kind() -> None:
    rests, vigil = _known()["goes"].eq(0.0).to_numpy(), _vigil()
    for name, kind, most in (("thuribles-swing-wider-than-told", "censer", 1.3),
                             ("vergers-halt-for-longer", "verger", 2.0),
                             ("doves-sink-as-they-glide", "dove", 0.7),
                             ("labyrinth-laid-oval", "pilgrim", 0.7),
                             ("winch-drum-fills-as-it-winds", "mason", 2.0),
                             ("processions-cut-their-corners", "chorister", 1.4)):  # fmt: skip
        shift, own = _shift(name), vigil.of(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        if kind in ("verger", "dove", "mason"):
            assert np.abs(shift[rests]).max() < 1e-9


def test_a_clock_that_loses_is_right_after_each_quarter() -> None:
    lost_s = LOSES_S * (_of("time_s") / QUARTER_S - np.floor(_of("time_s") / QUARTER_S))
    assert lost_s.max() < LOSES_S
    shift = _shift("clock-of-places-set-right-each-quarter")
    assert np.allclose(shift, _vigil().strays_off(lost_s))
    assert (np.abs(shift) <= 5.5 * lost_s).all()  # nobody goes faster


def _with_bosses_at(off: np.ndarray) -> np.ndarray:
    vigil = _vigil()
    return np.asarray(np.linalg.norm(vigil.boss_m + off - vigil.tag_m, axis=1) - vigil.far)


def test_bosses_are_elsewhere_as_towers_plans_and_courses_have_it() -> None:
    at = _vigil().boss_m
    off = np.zeros(at.shape)
    off[:, 0], off[:, 1] = LEANS[0] * at[:, 2], LEANS[1] * at[:, 2]
    assert np.allclose(_shift("tower-leans-off-its-plumb"), _with_bosses_at(off))
    off = np.zeros(at.shape)
    off[:, 0] = ASKEW * (at[:, 1] - 13.0)
    assert np.allclose(_shift("cross-drawn-askew"), _with_bosses_at(off))
    off = np.zeros(at.shape)
    off[:, 2] = at[:, 2] % COURSE_M
    assert np.allclose(_shift("heights-told-in-whole-courses-of-stone"), _with_bosses_at(off))
    shift = _shift("places-told-as-middles-of-flags")
    assert np.abs(shift).max() < FLAG_M / np.sqrt(2) + 1e-9
    assert abs(shift.mean()) < 0.03


def test_answers_are_kept_lengthened_and_cut_off_as_said() -> None:
    made = _tables("answers-kept-until-they-differ-enough")
    for _, one in made.clean.assign(told=made.recorded["range_m"]).groupby("link"):
        last = one["range_m"].iloc[0]
        for now, told in zip(one["range_m"], one["told"], strict=True):
            last = last if abs(now - last) < KEEPS_M else now
            assert told == pytest.approx(last)
    made = _tables("longer-of-two-answers-told")
    before = made.clean.groupby("link")["range_m"].shift(1).fillna(0.0)
    assert np.allclose(made.recorded["range_m"], np.maximum(before, made.clean["range_m"]))
    made = _tables("answers-no-longer-than-a-chain")
    assert np.allclose(made.recorded["range_m"], made.clean["range_m"].clip(upper=CHAIN_M))
    rows = pd.concat([_known(), _known()], ignore_index=True)
    parts = in_order(Vigil(rows, 0, np.random.default_rng(0)))
    assert len(parts) == 2 * _known()["link"].nunique()
    assert all((np.diff(rows["time_s"].to_numpy()[one]) > 0).all() for one in parts)


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
    assert np.allclose(lost[_of("true_range_m") < BREAK_M], 0.0)
    assert -6.0 < lost.mean() < -1.2
    made = _tables("level-control")
    lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
    order = np.argsort(_of("rx_power_dbm"))
    assert (np.diff(lost.to_numpy()[order]) < 1e-9).all()
    assert lost.min() > -16.0 * LESS - 1e-9
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.max() <= 1.0
    assert not _shift("path-loss").any()
    assert not _shift("level-control").any()


def test_loud_rows_are_early_and_weak_ones_late() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert shift.min() < -0.03
    assert shift.max() > 0.03


def test_clocks_age_evenly_and_boards_drift_by_nothing_where_it_is_mild() -> None:
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    assert 0.01 < np.abs(ppm).max() < 0.15
    assert _rows().assign(ppm=ppm).groupby("link")["ppm"].agg(np.ptp).max() < 1e-4
    shift, warm = _shift("temperature-drift"), _of("temperature_c")
    mild = (warm > EVEN_C[0]) & (warm < EVEN_C[1])
    assert not shift[mild].any()
    assert (shift[warm > EVEN_C[1]] > 0).all()
    assert (shift[warm < EVEN_C[0]] < 0).all()


def test_ranges_are_told_in_steps_that_begin_elsewhere_at_each_boss() -> None:
    told = _tables("range-rounding").recorded
    steps = told["range_m"] / STEP_M
    off = steps - np.floor(steps)
    turned = np.exp(2j * np.pi * off)
    assert np.allclose(np.abs(turned.groupby(told["rx"]).mean()), 1.0)
    assert np.abs(_shift("range-rounding")).max() <= 0.5 * STEP_M + 1e-9
    assert to_steps(np.array([5.3]), 2.0, np.array([0.5]))[0] == pytest.approx(4.5)


def test_only_what_is_behind_something_is_blocked_and_late_by_vaults() -> None:
    late = shown.assert_blocked_behind_things("cathedral", 0.5)
    assert late.min() >= SOONEST_M
    assert late.max() < LONGEST_M + 1e-9
    assert 1.0 < np.median(late) < LONGEST_M + 1e-9
