"""The velodrome: what is particular to it, and how large what it hides is."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.velodrome_effects import ROOT_M, by_rails
from bench.challenge.families.velodrome_evening import LAP_S, TURN_S, eliminated
from bench.challenge.families.velodrome_faults import PULLS_M, paces
from bench.challenge.families.velodrome_track import (
    BEND_M,
    HALL_M,
    LAP_M,
    LINE,
    MOST_BENT,
    PLACES,
    POSTS,
    POSTS_M,
    STATIONS_M,
    STRAIGHT_M,
    TAGS,
    Race,
    bends,
    on_boards,
)
from tests.bench.challenge import shown

_are = partial(shown.are_of, "velodrome")
_nothing = partial(shown.nothing_of, "velodrome")
_shift = partial(shown.shift_of, "velodrome")
_tables = partial(shown.tables_of, "velodrome")
_rows = partial(shown.rows_of, "velodrome")
_known = partial(shown.known_of, "velodrome")
_of = partial(shown.column_of, "velodrome")


def _posts() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("post").astype(int).to_numpy()


def _race(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"race (\d+)")[0]


def test_seven_laps_are_a_kilometre_and_a_lap_comes_back_to_where_it_began() -> None:
    assert pytest.approx(1000.0) == 7 * LAP_M
    ends = on_boards(np.array([0.0, LAP_M - 1e-9]), np.zeros(2), np.ones(2))
    assert np.allclose(ends[0], ends[1], atol=2e-3)
    steps = np.hypot(np.diff(LINE[1]), np.diff(LINE[2]))
    assert np.allclose(steps, LINE[0, 1], rtol=1e-3)
    into = np.linspace(STRAIGHT_M, LAP_M / 2, 4001)
    turned = MOST_BENT * bends(into).mean() * BEND_M
    assert turned == pytest.approx(np.pi, rel=1e-3)
    assert not bends(np.linspace(0.0, STRAIGHT_M, 9)).any()


def test_boards_are_banked_inward_and_what_stands_on_them_leans() -> None:
    along = np.array([9.0, STRAIGHT_M + 0.5 * BEND_M])
    low, high, up = (
        on_boards(along, np.full(2, lane), np.full(2, tall))
        for lane, tall in ((0.0, 0.0), (1.0, 0.0), (0.0, 1.0))
    )
    banked = np.degrees(np.arcsin((high - low)[:, 2]))
    assert np.allclose(banked, [13.0, 43.0])
    assert np.allclose(np.sum((high - low) * (up - low), axis=1), 0.0)
    middle = np.array([36.0, 27.0])
    inner, outer = (np.linalg.norm(one[:, :2] - middle, axis=1) for one in (low, high))
    assert (outer > inner).all()


def test_tags_stay_in_the_hall_and_a_race_has_one_tag_and_some_posts() -> None:
    rows = _rows()
    for axis, most in zip("xyz", HALL_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.4, most - 0.5).all()
        assert rows[f"rx_{axis}_m"].between(0.4, most - 0.5).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > 2.9
    races = rows.groupby(_race(rows))
    assert races["tx"].nunique().eq(1).all()
    assert races["rx"].nunique().between(3, 8).all()
    assert races["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}


def test_who_is_heard_first_in_a_lap_is_heard_last_in_the_next_and_some_drop_out() -> None:
    which, since_s = eliminated(np.random.default_rng(1), np.array([4, 2, 4]))
    assert which.tolist() == [0, 1, 2, 1, 2, 0, 0, 2, 2, 0]
    laps = np.floor((since_s + 1e-3) / LAP_S).astype(int)
    assert laps.tolist() == [0, 0, 0, 1, 1, 1, 2, 2, 3, 3]
    assert (np.diff(since_s) > TURN_S - 0.001).all()
    rows = _rows()
    first = rows.groupby("link")["time_s"].min()
    begun = rows.groupby(_race(rows))["time_s"].min()
    number = first.index.str.extract(r"race (\d+)")[0]
    assert (first.to_numpy() - begun[number].to_numpy()).max() < 8 * TURN_S  # all in the first lap


def test_riders_are_as_fast_as_riders_are_and_holders_run() -> None:
    rows = _known()
    fast = paces(Race(rows, 0, np.random.default_rng(0)))
    goes, runs = rows["goes"].eq(1.0), rows["tx"].str.startswith("holder")
    assert not fast[~goes].any()
    assert 5.0 < fast[goes & ~runs].min() < fast.max() < 21.0
    assert 0.5 < fast[goes & runs].min() < fast[goes & runs].max() < 6.0


def test_who_stays_still_stays_and_all_else_moves() -> None:
    still = _known().groupby(_race(_known()))["goes"].first().eq(0.0)
    spread = _rows().groupby(_race(_rows()))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).min() > 0.01


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(8):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(18.0, 19.0).all()
            gap = table["rx_power_dbm"] - table["first_path_power_dbm"]
            assert gap.max() < 18


def test_deaf_cameras_lose_some_first_paths_in_any_evening() -> None:
    world: Any = world_of("velodrome", "CIR")
    for seed in range(4):
        made = world.tables(Draw(("late-detection",), 1.0, 1), seed)
        later = made.recorded["error_m"] - made.clean["error_m"]
        assert 0.015 < (later > 0.3).mean() < 0.3
        assert (later >= -1e-9).all()


def test_who_rides_fast_in_bends_is_pressed_down_and_nobody_else_is() -> None:
    pressed, rides = _shift("riders-pressed-down-in-bends"), _are("sprinter", "slinger")
    assert not pressed[~rides].any()
    straight = bends(_known()["along"].to_numpy()) == 0
    still = _known()["goes"].eq(0.0).to_numpy()
    assert np.abs(pressed[still | (straight & _are("holder"))]).max() < 1e-9
    assert 0.05 < np.abs(pressed).max() < 0.25


def test_flatter_boards_let_tags_down_and_engines_pull_their_own() -> None:
    assert np.abs(_shift("boards-flatter-than-drawn", 0.1)).max() < 0.1 * 0.5
    assert np.abs(_shift("boards-flatter-than-drawn")).mean() > 0.02
    pulls, own = _shift("ignition-pulls-dernies-tags"), _are("derny")
    assert not pulls[~own].any()
    assert np.allclose(pulls[own], PULLS_M * (_of("derny_rpm")[own] / 2600.0) ** 2)


def test_posts_of_another_line_are_off_the_more_the_later_they_stand() -> None:
    chained, post = np.abs(_shift("stations-chained-along-another-line", 0.1)), _posts()
    count = len(STATIONS_M)
    assert not chained[post >= count].any()
    most = [chained[post == k].max() for k in range(count)]
    assert np.corrcoef(most, STATIONS_M)[0, 1] > 0.8
    assert len(POSTS_M) == POSTS


def test_fog_is_of_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("fog-that-fans-thin")
    assert np.allclose(shift, 0.34 * _of("fog_pct") / 100 / (1 + _of("fans_hz") / 5))
    for name in ("fog_pct", "fans_hz"):
        assert abs(np.corrcoef(shift, _of(name))[0, 1]) < 0.95


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    wax = np.log1p(-_shift("wax-films-the-posts") / 0.18)
    assert np.allclose(wax, -_of("wax_um") / 31.0, atol=1e-6)
    assert np.allclose(np.expm1(-_shift("chain-oil-on-tags") / 0.055), _of("oil_ul") / 5.5)
    assert np.allclose(_shift("lap-board-close-by") * _of("board_m") ** 2, 0.21)
    damp = np.log(_shift("boards-swell-in-damp") / 0.2)
    assert np.allclose(damp, 2.4 * np.log(_of("damp_pct") / 80.0))


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    for name, low, high in (("path-loss", -6.5, -2.0), ("level-control", -3.0, -1.0)):
        made = _tables(name)
        lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
        assert low < lost.mean() < high
        assert not _shift(name).any()
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert counts.max() <= 1.0


def test_roots_of_ranges_are_written_in_whole_steps() -> None:
    told = np.sqrt(_tables("range-rounding").recorded["range_m"]) / ROOT_M
    assert np.allclose(told, np.rint(told))
    shift = np.abs(_shift("range-rounding"))
    assert (shift <= ROOT_M * np.sqrt(_of("range_m")) + ROOT_M**2).all()


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("velodrome", 0.499)
    assert np.mean(late > 4.39) < 0.5


def test_rails_return_something_that_is_late_enough_to_every_row() -> None:
    more = by_rails(Race(_known(), 0, np.random.default_rng(0)))
    assert np.isfinite(more).all()
    assert (more > 0.5).all()


def test_all_posts_hear_and_each_hears_tags_of_more_than_one_kind() -> None:
    kinds = _rows().groupby("rx")["environment"].nunique()
    assert len(kinds) == POSTS
    assert kinds.min() > 1
