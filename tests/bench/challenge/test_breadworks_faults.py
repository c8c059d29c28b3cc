"""What the breadworks hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.breadworks_effects import (
    ASIDE_M,
    MAKERS,
    SIDES,
    TICK_M,
    at_ticks,
    by_side,
    off_sides,
)
from bench.challenge.families.breadworks_faults import (
    BUCKLES_C,
    FED,
    FLUE_M,
    SAGS_M,
    YEAST_M,
    buckled_m,
    fed_m,
    worked,
)
from bench.challenge.families.breadworks_hall import (
    CORBELS_M,
    LINK_M,
    LOW_KG,
    METRES_OF_PPM_MS,
    OF_FLUE,
    Bake,
)
from bench.challenge.families.case import Draw, world_of
from tests.bench.challenge import shown

_are = partial(shown.are_of, "breadworks")
_nothing = partial(shown.nothing_of, "breadworks")
_shift = partial(shown.shift_of, "breadworks")
_tables = partial(shown.tables_of, "breadworks")
_rows = partial(shown.rows_of, "breadworks")
_known = partial(shown.known_of, "breadworks")
_of = partial(shown.column_of, "breadworks")


def _bake() -> Bake:
    return Bake(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("breadworks", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        assert {*world.CAUSES.values()} <= {*_nothing(0, mode).recorded}
    of_one = {
        "steam-let-into-ovens": "steam_l", "dough-swells-over-troughs": "swollen_cm",
        "flour-settles-since-swept": "swept_min", "tins-stacked-alongside": "tins",
    }  # fmt: skip
    for name, column in of_one.items():
        order = np.argsort(_of(column), kind="stable")
        assert (np.diff(_shift(name)[order]) > -1e-9).all(), name
    for name, column in (("hook-hung-close-by", "hook_gap_m"),
                         ("sifter-runs-on-a-low-hopper", "hopper_kg")):  # fmt: skip
        order = np.argsort(_of(column))
        assert (np.diff(_shift(name)[order]) < 1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    steam = _of("steam_l")
    assert np.allclose(_shift("steam-let-into-ovens") * (steam + 4.0), 0.21 * steam)
    dough = np.log(_shift("dough-swells-over-troughs") / 0.17)
    assert np.allclose(dough, 1.55 * np.log(_of("swollen_cm") / 20.0))
    assert np.allclose(_shift("hook-hung-close-by") * _of("hook_gap_m") ** 2, 0.13)
    flour = np.expm1(_shift("flour-settles-since-swept") / 0.043)
    assert np.allclose(flour, _of("swept_min") / 5.5)
    assert np.allclose(_shift("tins-stacked-alongside"), 0.0088 * _of("tins"))
    turn = 2 * np.pi * _of("spiral_m") / LINK_M - 0.7
    assert np.allclose(_shift("supports-of-the-belt-pass"), 0.061 * np.cos(turn))
    runs = _of("hopper_kg") < LOW_KG
    assert np.allclose(_shift("sifter-runs-on-a-low-hopper"), 0.094 * runs)


def test_yeast_works_by_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("yeast-works-by-warmth-and-hours")
    warm, hours = _of("temperature_c"), _of("proved_h")
    assert np.allclose(shift, YEAST_M * worked(hours, warm))
    assert np.allclose(worked(np.ones(3), np.array([18.0, 28.0, 38.0])), [0.5, 1.0, 2.0])
    for column in (warm, hours):
        assert abs(np.corrcoef(shift, column)[0, 1]) < 0.97


def test_faults_of_ways_concern_their_own_kind_and_are_as_large_as_is_said() -> None:
    rests = _known()["goes"].eq(0.0).to_numpy()
    for name, kind, most in (
        ("belts-slip-round-coolers", "tray", 1.0),
        ("castors-clogged-with-dough", "rack", 1.4),
        ("porters-sway-wider-than-told", "porter", 1.4),
        ("cams-worn-between-stands", "mould", 0.11 * 2.8 + 1e-6),
    ):
        shift, own = _shift(name), _are(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        assert np.abs(shift[rests]).max() < 1e-9


def test_the_flue_buckles_once_it_is_hot_and_its_corbels_come_down() -> None:
    shift, hangs = _shift("flue-buckles-as-ovens-heat"), np.isin(_bake().corbel, OF_FLUE)
    cold = _of("oven_c") < BUCKLES_C
    assert not shift[~hangs | cold].any()
    assert (shift[hangs] <= 0).all()  # all tags are lower
    steep = (_of("rx_z_m") - _of("tx_z_m"))[hangs] / _of("true_range_m")[hangs]
    bow = np.sin(np.pi * (_of("rx_x_m")[hangs] - FLUE_M[0]) / (FLUE_M[1] - FLUE_M[0]))
    down = buckled_m(_of("oven_c")[hangs]) * bow
    assert np.allclose(-shift[hangs], down * steep, atol=0.5 * SAGS_M**2 / 3.0)
    assert np.allclose(buckled_m(BUCKLES_C + np.array([-9.0, 50.0, 200.0])) / SAGS_M, [0, 0.5, 1])


def test_a_plan_that_is_fed_askew_is_sheared_and_ever_longer() -> None:
    off, x = fed_m(1.0), CORBELS_M[:, 0]
    assert np.allclose(off[:, 1] - off[0, 1], FED[0] * (x - x[0]))
    assert not off[:, 2].any()
    order = np.argsort(x)
    assert (np.diff(off[order, 0]) >= 0).all()
    assert 0.3 < np.linalg.norm(off, axis=1).max() < 0.8
    assert np.allclose(fed_m(2.0), 2 * off)


def test_missed_answers_are_on_a_line_through_the_two_before_and_some_are() -> None:
    name = "missed-answers-put-on-a-line"
    for strength, part in ((1.0, 0.4), (2.0, 0.8)):
        made, shift = _tables(name, strength), _shift(name, strength)
        links = made.clean.groupby("link", sort=False)
        missed = np.abs(shift) > 1e-12
        for link in made.clean["link"][missed].unique()[:12]:
            one = links.get_group(link)
            for k in np.flatnonzero(missed[one.index]).tolist():
                two = one.iloc[k - 2 : k]
                line = np.polyfit(two["time_s"] - one["time_s"].iloc[0], two["range_m"], 1)
                there = np.polyval(line, one["time_s"].iloc[k] - one["time_s"].iloc[0])
                assert made.recorded["range_m"][one.index[k]] == pytest.approx(there, abs=1e-4)
        third = links.cumcount() >= 2
        assert missed[third].mean() == pytest.approx(part, abs=0.07)
        assert not missed[~third].any()
    world: Any = world_of("breadworks")
    truth = world.tables(Draw((name,), ratio=3), 9)
    moved = (truth.truth["error_m"] - truth.simulated["error_m"]).abs()
    assert moved.max() < 6.0  # no row has those of another link before it


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    for name, low, high in (("path-loss", -6.0, -1.5), ("level-control", -3.2, -0.6)):
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
    assert np.corrcoef(lost, np.log(_of("true_range_m")))[0, 1] < -0.6


def test_loud_rows_are_early_and_weak_ones_late_and_both_come_to_an_end() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    order = np.argsort(level)
    assert (np.diff(shift[order]) <= 1e-12).all()
    assert np.abs(shift).max() < 0.0681
    assert shift.min() < -0.03 < 0.03 < shift.max()


def test_clocks_count_by_ppm_and_by_how_long_replies_take() -> None:
    ppm = _shift("clock-offset") / (METRES_OF_PPM_MS * 1e3 * _of("reply_time_s"))
    rows = _rows().assign(ppm=ppm)
    assert np.abs(ppm).max() < 0.15
    for _, one in rows.groupby(["tx", "rx"]):
        if len(one) > 4 and np.ptp(one["time_s"]) < 60:
            assert np.ptp(one["ppm"]) < 1e-3


def test_scales_are_those_of_three_makers() -> None:
    part = _shift("range-scale") / _of("true_range_m")
    by = pd.Series(part).groupby(_bake().corbel).agg(["mean", np.ptp])
    assert by["ptp"].max() < 1e-12
    assert np.allclose(np.unique(by["mean"].round(9)), MAKERS)


def test_ranges_are_read_at_ticks_of_which_every_third_is_worn_off() -> None:
    ticks = _tables("range-rounding").recorded["range_m"].to_numpy() / TICK_M
    assert np.allclose(ticks, np.rint(ticks), atol=1e-6)
    assert {*np.mod(np.rint(ticks), 3.0)} == {0.0, 1.0}
    assert np.abs(_shift("range-rounding")).max() <= TICK_M + 1e-9
    assert np.allclose(at_ticks(np.array([4.4, 4.9, 5.1, 6.2]), 1.0), [4.0, 4.0, 6.0, 6.0])


def test_only_what_is_behind_something_is_blocked_and_by_the_soonest_way_there_is() -> None:
    late = shown.assert_blocked_behind_things("breadworks", 0.5)
    assert late.max() < 14.0
    bake = _bake()
    longer = off_sides(bake)
    ceiling = by_side(bake, SIDES[-1])[0] - bake.far
    assert (longer > 0.0).all()
    assert (longer <= ceiling + 1e-9).all()
    least = 2 * np.hypot(0.5 * bake.far, ASIDE_M) - bake.far  # of what is so far aside
    assert (longer >= np.minimum(least, ceiling) - 1e-6).all()


def test_ways_by_sides_are_images_and_are_met_where_both_legs_make_them() -> None:
    bake = _bake()
    for axis, where in SIDES:
        way, aside = by_side(bake, (axis, where))
        over = np.abs(where - bake.tag_m[:, axis]) + np.abs(where - bake.corbel_m[:, axis])
        flat = bake.far**2 - (bake.tag_m[:, axis] - bake.corbel_m[:, axis]) ** 2
        assert np.allclose(way, np.sqrt(flat + over**2))
        assert (way + 1e-9 >= 2 * np.hypot(0.5 * bake.far, aside)).all()
