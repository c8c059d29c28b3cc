"""The baths: what is particular to them, and how large what they hide is."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.baths_day import MARK_S, MASTS_M, RULER
from bench.challenge.families.baths_effects import MARK_M, POLES_M, by_poles, knots_m
from bench.challenge.families.baths_faults import DEEP_M, LESS, SHAKEN, SINKS
from bench.challenge.families.baths_hall import (
    ARCHES_M,
    BASIN_M,
    BATHS_M,
    PLACES,
    TAGS,
    Heat,
)
from bench.challenge.families.case import Draw, world_of
from tests.bench.challenge import shown

_nothing = partial(shown.nothing_of, "baths")
_shift = partial(shown.shift_of, "baths")
_tables = partial(shown.tables_of, "baths")
_rows = partial(shown.rows_of, "baths")
_known = partial(shown.known_of, "baths")
_of = partial(shown.column_of, "baths")


def _arches() -> np.ndarray:
    return _rows()["tx"].str.removeprefix("arch").astype(int).to_numpy()


def _are(kind: str) -> np.ndarray:
    return _rows()["rx"].str.startswith(kind).to_numpy()


def _heat(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"heat (\d+)")[0]


def test_tags_stay_in_the_baths_and_a_heat_has_one_tag_and_some_arches() -> None:
    rows = _rows()
    for axis, most in zip("xyz", BATHS_M, strict=True):
        assert rows[f"rx_{axis}_m"].between(0.05, most - 0.5).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > 1.8
    heats = rows.groupby(_heat(rows))
    assert heats["rx"].nunique().eq(1).all()
    assert heats["tx"].nunique().between(3, 7).all()
    assert heats["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["rx"]} == {*TAGS}


def test_tags_blink_at_marks_of_which_no_two_are_as_far_apart_as_two_others() -> None:
    apart = (RULER[None] - RULER[:, None])[np.triu_indices(len(RULER), 1)]
    assert len({*apart}) == len(apart) == 55
    waits = _rows().groupby("link")["time_s"].diff().dropna() / MARK_S
    assert len(waits) > 300
    assert np.isclose(waits.to_numpy()[:, None], np.diff(RULER), atol=1e-6).any(axis=1).all()
    again = waits.round(3).groupby(_rows()["link"]).agg(lambda one: one.duplicated().any())
    assert not again.any()


def test_swimmers_keep_to_lanes_and_riders_come_nearer_to_their_mast_as_they_fall() -> None:
    one = _known()
    (west, south), (east, north) = BASIN_M
    swims, rides = one["rx"].str.startswith("swimmer"), one["rx"].str.startswith("rider")
    assert one["rx_x_m"][swims].between(west, east).all()
    assert one["rx_y_m"][swims].between(south, north).all()
    assert np.ptp(one["rx_y_m"][swims] - one["from_y"][swims]) < 1e-9
    assert {*zip(one["from_x"][rides], one["from_y"][rides], strict=True)} <= {*MASTS_M}
    out = np.hypot(one["rx_x_m"] - one["from_x"], one["rx_y_m"] - one["from_y"])[rides]
    falls = (one["from_z"] - one["rx_z_m"])[rides]
    nearer = one["beat"][rides] / 0.22 * falls
    assert np.allclose(one["swell"][rides] - out, nearer)
    assert (falls > 0.0).mean() > 0.6


def test_who_stays_still_stays_and_all_else_moves() -> None:
    still = _known().groupby(_heat(_known()))["stirs"].first().eq(0.0)
    spread = _rows().groupby(_heat(_rows()))[["rx_x_m", "rx_y_m", "rx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).min() > 0.01


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(12):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(18.0, 19.0).all()
            gap = table["rx_power_dbm"] - table["first_path_power_dbm"]
            assert gap.max() < 18


def test_deaf_probes_lose_some_first_paths_in_any_day() -> None:
    world: Any = world_of("baths", "CIR")
    for seed in range(4):
        made = world.tables(Draw(("late-detection",), 1.0, 1), seed)
        later = made.recorded["error_m"] - made.clean["error_m"]
        assert 0.015 < (later > 0.3).mean() < 0.3
        assert (later >= -1e-9).all()


def test_strokes_that_reach_less_and_riders_in_bends_move_their_own_tags_alone() -> None:
    strokes, swims = _shift("strokes-reach-less-far", 0.1), _are("swimmer")
    gone = np.abs(_known()["rx_x_m"] - _known()["from_x"]).to_numpy()
    assert not strokes[~swims].any()
    assert (np.abs(strokes) <= 0.1 * LESS * gone + 1e-9).all()
    assert np.abs(strokes[swims]).max() > 0.005
    bends, rides = _shift("riders-ride-up-in-bends", 0.1), _are("rider")
    assert not bends[~rides].any()
    higher = ARCHES_M[_arches(), 2] > _of("rx_z_m") + 3.0
    assert np.median(bends[rides & higher]) < 0.0


def test_pumps_shake_their_own_arches_and_a_deep_end_settles_the_more_the_farther_out() -> None:
    own = np.isin(_arches(), SHAKEN)
    assert np.allclose(_shift("pumps-shake-their-arches"), own * 0.19 * (_of("pump_hz") / 50) ** 2)
    assert 0.2 < own.mean() < 0.7
    shift = _shift("deep-end-settles", 0.1)
    down = 0.1 * SINKS * (ARCHES_M[_arches(), 0] - DEEP_M).clip(0.0)
    rise = (_of("tx_z_m") - _of("rx_z_m")) / _of("true_range_m")
    assert np.allclose(shift, -down * rise, atol=2e-4)
    assert 0.2 < (down > 0).mean() < 0.8


def test_steam_is_of_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("steam-room-left-ajar")
    door = 1 - np.cos(np.radians(_of("ajar_deg")))
    assert np.allclose(shift, 0.34 * _of("steam_pct") / 100 * door)
    for name in ("steam_pct", "ajar_deg"):
        assert abs(np.corrcoef(shift, _of(name))[0, 1]) < 0.97


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    beads = _shift("beads-of-water-on-arches")
    assert np.allclose(0.24 / beads - 1, 38.0 / _of("beads_um"))
    assert np.allclose(np.expm1(_shift("suncream-on-caps") / 0.068), _of("cream_mg") / 1.9)
    steel = _shift("steel-slide-close-by")
    assert np.allclose(steel * _of("slide_m") ** 2, 0.29)
    fur = np.log(_shift("scale-furs-the-nozzles") / 0.155)
    assert np.allclose(fur, 1.7 * np.log(_of("fur_mm") / 8.0))


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


def test_knots_are_short_and_long_in_turn_and_ranges_are_at_the_nearest() -> None:
    knots = knots_m(MARK_M, 50.0)
    apart = np.diff(knots) / MARK_M
    assert {*np.round(apart, 6)} == {1.0, 1.618034}
    assert (apart[:-1] + apart[1:] > 2.5).all()  # no two short ones in a row
    told = _tables("range-rounding").recorded["range_m"].to_numpy()
    assert np.abs(told[:, None] - knots).min(axis=1).max() < 1e-9
    assert np.abs(_shift("range-rounding")).max() <= MARK_M * 1.6181 / 2


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("baths", 0.469)
    assert np.mean(late > 4.69) < 0.3


def test_poles_return_something_that_is_late_enough_to_every_row() -> None:
    heat = Heat(_known(), 0, np.random.default_rng(0))
    more = by_poles(heat)
    assert (more > 0.47).all()
    assert np.isfinite(more).all()
    at = np.linspace(0.0, BATHS_M[2], 4001)
    poles = np.concatenate([np.column_stack([*np.broadcast_arrays(*one, at)]) for one in POLES_M])
    legs = [np.linalg.norm(end[7] - poles, axis=1) for end in (heat.low, heat.high)]
    ways = (legs[0] + legs[1] - heat.far[7]).reshape(len(POLES_M), -1).min(axis=1)
    assert ways[ways > 0.47].min() == pytest.approx(more[7], abs=1e-4)
