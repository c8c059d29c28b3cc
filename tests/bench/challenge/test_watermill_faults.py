"""What the watermill hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.watermill_effects import (
    BIAS_M,
    CABLES_M,
    FLATTER,
    KNEE_DBM,
    LONGEST_M,
    MOST_DB,
    SOFT_DB,
    SOONEST_M,
    STAMPS_M,
    STEPS_M,
    of_cut,
)
from bench.challenge.families.watermill_faults import (
    CHARGES_M,
    CHARGES_S,
    DRAWN_M,
    EACH_C,
    FULL_T,
    HALVES,
    LENGTH_M,
    LINE_M2,
    NOTCH_M,
    PLAY_MM,
    ROD_M,
    SAGS_M,
    SHAFT_M,
    SHORT_M,
    SPRAY_M,
    STEAM_M,
    TWISTS,
    in_the_wheel_house,
    played,
    since_last_s,
    upstairs,
)
from bench.challenge.families.watermill_race import (
    COG_M,
    HATCHES_M,
    LIGHT_M_US,
    PENSTOCK_CM,
    WALL_M,
    Grist,
)
from tests.bench.challenge import shown

_shift = partial(shown.shift_of, "watermill")
_tables = partial(shown.tables_of, "watermill")
_known = partial(shown.known_of, "watermill")
_of = partial(shown.column_of, "watermill")


def _grist() -> Grist:
    return Grist(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("watermill", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        nothing = shown.nothing_of("watermill", 0, mode)
        assert {*world.CAUSES.values()} <= {*nothing.recorded}
    for name, column, sign in (
        ("meal-cakes-about-hatches", "meal_g", 1), ("sacks-stacked-before-hatches", "sacks", 1),
        ("thatch-soaks-since-it-rains", "rain_h", 1), ("bran-settles-since-swept", "swept_h", -1),
        ("stone-crane-hung-close", "crane_m", -1), ("pond-presses-on-the-breast", "pond_m", 1),
        ("penstock-lifted-past-its-stop", "penstock_cm", -1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    meal = -8.0 * np.log1p(-_shift("meal-cakes-about-hatches") / 0.16)
    assert np.allclose(meal, _of("meal_g"))
    rain = 0.9 * np.expm1(_shift("thatch-soaks-since-it-rains") / 0.066)
    assert np.allclose(rain, _of("rain_h"))
    assert np.allclose(_shift("sacks-stacked-before-hatches"), 0.0135 * _of("sacks"))
    swept = 30.0 * (_shift("bran-settles-since-swept") / 0.16) ** 2
    assert np.allclose(swept, _of("swept_h"))
    assert np.allclose(_shift("stone-crane-hung-close") * _of("crane_m"), 0.095)
    assert np.allclose(_shift("pond-presses-on-the-breast"), 0.19 * (_of("pond_m") / 2.4) ** 2)
    off = _of("tenter_mm") - 1.7
    assert np.allclose(_shift("stones-tentered-too-near-or-too-far"), 0.052 * off**2)
    turn = 2 * np.pi * _of("spur_m") / COG_M - 0.7
    assert np.allclose(_shift("cogs-of-the-great-spur-pass"), 0.062 * np.sin(turn))
    lifted = _of("penstock_cm") > PENSTOCK_CM
    assert 0.2 < lifted.mean() < 0.8
    assert np.allclose(_shift("penstock-lifted-past-its-stop"), -0.092 * lifted)


def test_spray_counts_by_the_way_in_the_wheel_house_and_steam_by_warmth() -> None:
    grist, part = _grist(), (np.arange(4000) + 0.5)[:, None] / 4000
    within = in_the_wheel_house(grist.tag_m, grist.hatch_m)
    for tag, hatch, long_m in zip(grist.tag_m[::9], grist.hatch_m[::9], within[::9], strict=True):
        there = (tag + part * (hatch - tag))[:, 0] > WALL_M
        assert long_m == pytest.approx(there.mean() * np.linalg.norm(hatch - tag), abs=0.02)
    law = SPRAY_M * within * _of("spray_g")
    assert np.allclose(_shift("spray-hangs-in-the-wheel-house"), law)
    steam = STEAM_M * np.exp(EACH_C * (_of("warm_c") - 20)) * (_of("damp_pct") - 10) / 11
    assert np.allclose(_shift("steam-of-damp-grain-by-warmth"), steam)


def test_rods_lag_by_no_more_than_their_play_and_by_where_they_came_from() -> None:
    moved = np.array([0.0, 5.0, 20.0, 15.0, 2.0, 30.0])
    assert played(moved, 10.0).tolist() == [0.0, 0.0, 10.0, 10.0, 10.0, 20.0]
    lags = _shift("rods-of-the-governor-have-play") / ROD_M
    assert np.abs(lags).max() <= PLAY_MM + 1e-9
    order = np.argsort(_of("time_s"))
    moved = _of("governor_mm")[order]
    assert np.allclose(moved + lags[order], played(moved, PLAY_MM))
    assert abs(np.corrcoef(lags, _of("governor_mm"))[0, 1]) < 0.95


def test_faults_of_ways_concern_their_own_kind() -> None:
    rests, grist = _known()["astir"].eq(0.0).to_numpy(), _grist()
    for name, kind, most in (("wheel-runs-ahead-on-its-heavy-side", "paddle", 1.2),
                             ("sacks-sway-wider-than-told", "sack", 1.0),
                             ("millers-round-their-corners", "miller", 1.5),
                             ("drift-drags-behind-the-stream", "drift", 1.2),
                             ("carts-wind-in-tighter", "cart", 1.8),
                             ("buckets-slip-with-their-belt", "bucket", 1.0)):  # fmt: skip
        shift, own = _shift(name), grist.of(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        assert np.abs(shift[rests]).max() < 1e-9, name


def test_foretold_places_matter_where_ways_bend() -> None:
    rows = _known()
    shift = _shift("places-foretold-straight-on")
    assert np.abs(shift[rows["astir"].eq(0.0)]).max() < 1e-9
    straight = rows["tx"].str.startswith("bucket").to_numpy()
    round_ = rows["tx"].str.startswith("miller").to_numpy()
    moving = rows["astir"].to_numpy() > 0
    assert np.median(np.abs(shift[straight & moving])) < 0.01
    assert np.abs(shift[round_ & moving]).mean() > 0.03


def _with_hatches_at(off: np.ndarray) -> np.ndarray:
    grist = _grist()
    return np.asarray(np.linalg.norm(grist.hatch_m + off - grist.tag_m, axis=1) - grist.far)


def test_hatches_are_elsewhere_as_chains_plans_floors_and_shafts_have_it() -> None:
    grist = _grist()
    at, east = grist.hatch_m, np.zeros((len(grist.hatch), 3))
    east[:, 0] = SHORT_M * np.floor(at[:, 0] / LENGTH_M)
    assert np.allclose(_shift("chain-a-link-short-each-length"), _with_hatches_at(east))
    turn, round_ = TWISTS * at[:, 2], np.zeros((len(grist.hatch), 3))
    round_[:, 0] = -turn * (at[:, 1] - SHAFT_M[1])
    round_[:, 1] = turn * (at[:, 0] - SHAFT_M[0])
    assert np.allclose(_shift("mill-twists-about-its-shaft"), _with_hatches_at(round_))
    up = np.zeros((len(grist.hatch), 3))
    up[:, 2] = DRAWN_M[upstairs()][grist.hatch]
    assert np.allclose(_shift("storeys-drawn-all-alike"), _with_hatches_at(up))
    bent = np.sin(np.pi * at[:, 0] / 20.0) * (upstairs()[grist.hatch] > 0)
    up[:, 2] = -SAGS_M * bent * _of("bin_t") / FULL_T
    assert np.allclose(_shift("floors-sag-under-full-bins"), _with_hatches_at(up))
    assert not upstairs()[HATCHES_M[:, 0] > WALL_M].any()
    assert {*upstairs()} == {0, 1, 2}


def test_answers_are_late_by_how_soon_they_come_after_others() -> None:
    grist = _grist()
    since = since_last_s(grist)
    for hatch in range(3):
        own = grist.hatch == hatch
        when = np.sort(grist["time_s"][own])
        assert np.allclose(since[own][np.argsort(grist["time_s"][own])][1:], np.diff(when))
    late = _shift("answers-late-until-charged-again")
    assert np.allclose(late, CHARGES_M * np.exp(-since / CHARGES_S))
    often = Grist(pd.concat([grist.table] * 2, ignore_index=True), 0, np.random.default_rng(0))
    assert np.allclose(since_last_s(often), np.tile(since, 2))


def test_a_notch_that_is_stuck_is_in_every_range() -> None:
    made = _tables("notch-stuck-in-the-tally-stick")
    assert (np.floor(made.recorded["range_m"] / NOTCH_M + 1e-9) % 2 == 1).all()
    added = made.recorded["range_m"] - made.clean["range_m"]
    assert np.allclose(np.unique(added.round(9)), [0.0, NOTCH_M])


@pytest.mark.parametrize("ratio", [1, 3])
def test_slips_and_halves_go_by_what_was_before_and_tellings_are_apart(ratio: int) -> None:
    behind = _tables("slips-hung-one-nail-behind", ratio=ratio)
    halves = _tables("changes-of-ranges-told-by-halves", ratio=ratio)
    for which in ("truth", "simulated"):
        assert len(getattr(behind, which)) == ratio * len(behind.recorded)
    for made, plain in ((behind.recorded, behind.clean), (behind.truth, behind.simulated)):
        rows = plain.assign(told=made["range_m"])
        rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
        for _, one in rows.sort_values("time_s").groupby(["link", "copy"]):
            ranges = one["range_m"].to_numpy()
            assert np.allclose(one["told"], [ranges[0], *ranges[:-1]])
    rows = halves.clean.assign(told=halves.recorded["range_m"]).sort_values("time_s")
    for _, one in rows.groupby("link"):
        since = one["range_m"] - one["range_m"].iloc[0]
        assert np.allclose(one["told"] - one["range_m"].iloc[0], (1 - HALVES) * since)


def test_a_line_is_taken_for_one_that_sags_by_its_cube() -> None:
    assert np.allclose(_shift("sag-of-a-line-taken-off"), -LINE_M2 * _of("true_range_m") ** 3)


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    assert lost.min() >= -MOST_DB - 1e-9
    assert np.corrcoef(lost, np.log(_of("true_range_m")))[0, 1] < -0.7
    made = _tables("level-control")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    over = np.log1p(np.exp((made.clean["rx_power_dbm"].to_numpy() - KNEE_DBM) / SOFT_DB))
    assert np.allclose(lost, -FLATTER * SOFT_DB * over.clip(max=7.0))
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.min() < 0.8 < counts.max() <= 1.0
    assert not _shift("path-loss").any()
    assert not _shift("level-control").any()


def test_loud_rows_are_early_and_weak_ones_late() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert -BIAS_M - 1e-9 < shift.min() < -0.7 * BIAS_M
    assert 0.5 * BIAS_M < shift.max() < BIAS_M + 1e-9


def test_cables_are_of_pairs_and_clocks_wander() -> None:
    rows = _known().assign(late=_shift("antenna-delay"))
    assert rows.groupby(["tx", "rx"])["late"].agg(np.ptp).max() < 1e-9
    assert rows["late"].between(CABLES_M, 0.36).all()
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    assert 0.01 < np.abs(ppm).max() < 0.25
    assert _known().assign(ppm=ppm).groupby("link")["ppm"].agg(np.ptp).max() < 2e-3


def test_crystals_of_an_at_cut_turn_and_stamps_are_of_a_triangles_law() -> None:
    assert np.allclose(of_cut(np.array([20.0, 35.0, 5.0])), [0.0, 0.65, -0.65])
    assert of_cut(np.array([23.0]))[0] < 0 < of_cut(np.array([17.0]))[0]
    assert np.abs(_shift("temperature-drift")).max() < 0.3
    stamps = _shift("timestamp-jitter")
    assert np.abs(stamps).max() < STAMPS_M
    assert (np.abs(stamps) < 0.5 * STAMPS_M).mean() == pytest.approx(0.75, abs=0.06)


def test_ranges_are_told_by_middles_of_steps_of_three_sorts() -> None:
    told = _tables("range-rounding").recorded
    step = np.array(STEPS_M)[told["rx"].str.removeprefix("hatch").to_numpy(int) % 3]
    steps = told["range_m"].to_numpy() / step
    assert np.allclose(steps - 0.5, np.rint(steps - 0.5))
    assert (np.abs(_shift("range-rounding")) <= 0.5 * step + 1e-9).all()


def test_only_what_is_behind_something_is_blocked_and_late_by_shafts() -> None:
    late = shown.assert_blocked_behind_things("watermill", 0.5)
    assert late.min() >= SOONEST_M
    assert late.max() < LONGEST_M + 1e-9
    assert 1.0 < np.median(late) < 0.95 * LONGEST_M
