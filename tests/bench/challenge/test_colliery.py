"""The colliery: what is particular to it, and how large what it hides is."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.colliery import CAUSES
from bench.challenge.families.colliery_effects import SLIDE, round_corners, shrunk
from bench.challenge.families.colliery_faults import (
    HUNTS_M,
    LEANS,
    RINGS_BPM,
    SHAKES_M,
    traverse_m,
)
from bench.challenge.families.colliery_pit import (
    HALL_M,
    INCLINE_M,
    MOST_RAD,
    PLACES,
    PROPS,
    PROPS_M,
    RAILS,
    SLOPE_RAD,
    TAGS,
    WOUND_S,
    Tally,
    on_incline,
    on_rails,
    wound_m,
)
from bench.challenge.families.colliery_shift import OFTEN, ROUND_S, SLOT_S, answered
from tests.bench.challenge import shown

_are = partial(shown.are_of, "colliery")
_nothing = partial(shown.nothing_of, "colliery")
_shift = partial(shown.shift_of, "colliery")
_tables = partial(shown.tables_of, "colliery")
_rows = partial(shown.rows_of, "colliery")
_known = partial(shown.known_of, "colliery")
_of = partial(shown.column_of, "colliery")


def _props() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("prop").astype(int).to_numpy()


def _wind(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"wind (\d+)")[0]


def test_rails_meander_and_are_as_long_as_they_say() -> None:
    steps = np.hypot(np.diff(RAILS[1]), np.diff(RAILS[2]))
    assert np.allclose(steps, RAILS[0, 1], rtol=1e-3)
    assert np.abs(RAILS[3]).max() == pytest.approx(MOST_RAD, abs=1e-3)
    amid = np.array([12.3, 33.0])
    right, left = (on_rails(amid, aside, 1.0) for aside in (-0.5, 0.5))
    assert np.allclose(np.linalg.norm(left - right, axis=1), 1.0)
    assert np.allclose(left[:, 2], 1.0)


def test_skips_start_and_stop_gently_and_the_incline_is_as_steep_as_it_says() -> None:
    when = np.linspace(0.0, WOUND_S, 901)
    come = wound_m(when)
    pace = np.gradient(come, when)
    assert come[[0, -1]] == pytest.approx([0.0, INCLINE_M])
    assert pace[[0, -1]] == pytest.approx([0.0, 0.0], abs=0.01)
    assert pace.max() == pytest.approx(2 * INCLINE_M / WOUND_S, rel=1e-3)
    low, high, up = (on_incline(np.array([u]), np.ones(1), np.array([t]))[0]
                     for u, t in ((2.0, 0.0), (3.0, 0.0), (2.0, 1.0)))  # fmt: skip
    assert (high - low)[2] == pytest.approx(np.sin(SLOPE_RAD))
    assert (high - low) @ (up - low) == pytest.approx(0.0, abs=1e-12)


def test_tags_stay_in_the_hall_and_a_wind_has_one_tag_and_some_props() -> None:
    rows = _rows()
    for axis, most in zip("xyz", HALL_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.3, most - 0.3).all()
        assert rows[f"rx_{axis}_m"].between(0.4, most - 0.5).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > 2.9
    winds = rows.groupby(_wind(rows))
    assert winds["tx"].nunique().eq(1).all()
    assert winds["rx"].nunique().between(2, 7).all()
    assert winds["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}


def test_props_answer_in_slots_by_lot_and_some_in_every_other_round() -> None:
    lengths = np.array([4, OFTEN + 2, 1, 5])
    slots = set()
    for seed in range(12):
        which, since_s = answered(np.random.default_rng(seed), lengths)
        assert np.bincount(which).tolist() == lengths.tolist()
        assert (np.diff(since_s) > SLOT_S - 1e-9).all()
        own = np.diff(since_s[which == 0])
        often = np.diff(since_s[which == 1])
        assert often.max() < 2 * ROUND_S
        slots |= {int(np.rint(own.mean() / ROUND_S))}
    assert slots == {1, 2}


def test_who_rests_stays_and_all_else_moves() -> None:
    still = _known().groupby(_wind(_known()))["goes"].first().eq(0.0)
    spread = _rows().groupby(_wind(_rows()))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).min() > 0.01


def test_tags_are_as_fast_as_such_things_are() -> None:
    rows = _known()
    tally = Tally(rows, 0, np.random.default_rng(0))
    fast = np.abs(tally.recedes_by(0.001)) / 0.001
    assert fast.max() < 6.5
    walks = rows["tx"].str.startswith("lamp").to_numpy()
    assert fast[walks].max() < 2.4


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(8):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(18.0, 19.0).all()
            gap = table["rx_power_dbm"] - table["first_path_power_dbm"]
            assert gap.max() < 18


def test_deaf_geophones_lose_some_first_paths_in_any_shift() -> None:
    world: Any = world_of("colliery", "CIR")
    for seed in range(4):
        made = world.tables(Draw(("late-detection",), 1.0, 1), seed)
        later = made.recorded["error_m"] - made.clean["error_m"]
        assert 0.015 < (later > 0.3).mean() < 0.3
        assert (later >= -1e-9).all()


def test_every_effect_acts_in_both_modes_and_what_has_a_column_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("colliery", mode)
        for name, column in CAUSES.items():
            if name in (*world.KNOWN, *world.LAWS):
                assert column in _tables(name, mode=mode).recorded, name
    of_one = {
        "stone-dust-lies-on-props": "dust_g", "roof-drips-on-covers": "drip_ml",
        "covers-soak-since-they-were-hung": "hung_d", "chocks-stand-beside": "chocks",
        "drives-cut-off-at-firedamp": "ch4_pct",
    }  # fmt: skip
    for name, column in of_one.items():
        order = np.argsort(_of(column), kind="stable")
        assert (np.diff(_shift(name)[order]) > -1e-9).all(), name
    order = np.argsort(_of("belt_gap_m"))
    assert (np.diff(_shift("conveyor-runs-close-by")[order]) < 1e-9).all()


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    dust = _shift("stone-dust-lies-on-props")
    assert np.allclose(dust * (_of("dust_g") + 34.0), 0.23 * _of("dust_g"))
    drips = np.log(_shift("roof-drips-on-covers") / 0.19)
    assert np.allclose(drips, 1.45 * np.log(_of("drip_ml") / 60.0))
    assert np.allclose(_shift("conveyor-runs-close-by") * _of("belt_gap_m"), 0.115)
    soaks = _shift("covers-soak-since-they-were-hung")
    assert np.allclose(np.expm1(soaks / 0.043), _of("hung_d") / 3.0)


def test_haze_is_of_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("haze-that-draught-clears")
    assert np.allclose(shift, 0.3 * _of("haze_pct") / 100 * np.exp(-_of("draught_ms") / 2.4))
    for name in ("haze_pct", "draught_ms"):
        assert abs(np.corrcoef(shift, _of(name))[0, 1]) < 0.95


def test_ropes_let_skips_down_and_tubs_hunt_and_drills_shake_booms() -> None:
    for name, kind, most in (
        ("winding-rope-stretches", "skip", 0.3),
        ("tubs-hunt-on-their-rails", "tub", HUNTS_M * np.hypot(1, LEANS)),
        ("drilling-shakes-booms", "boom", SHAKES_M),
    ):
        shift, own = _shift(name), _are(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most + 1e-3, name
    own = _are("boom")
    off = (_of("drill_bpm")[own] - RINGS_BPM) / 620.0
    assert np.allclose(_shift("drilling-shakes-booms")[own] * (1 + off**2), SHAKES_M)
    toward = (_rows()["rx_x_m"] - _rows()["tx_x_m"]).to_numpy()
    skips = _are("skip") & (toward < -8)  # props below skips, at the foot of the incline
    assert (_shift("winding-rope-stretches")[skips] < 0.02).all()


def test_props_are_lower_amid_and_off_the_more_the_later_a_traverse_comes() -> None:
    sinks = np.abs(_shift("roof-comes-down-amid"))
    hang = _props() >= PROPS - 2
    assert sinks[hang].mean() > 3 * sinks[~hang].mean()
    off = np.linalg.norm(traverse_m(1.0), axis=1)
    assert off[0] == 0.0
    assert off.max() < 0.35
    legs = np.linalg.norm(np.diff(PROPS_M[:, :2], axis=0), axis=1)
    ways = np.linalg.norm(np.diff(traverse_m(1.0)[:, :2], axis=0), axis=1)
    assert np.allclose(ways / legs, ways[0] / legs[0] * np.arange(1, PROPS))


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


def test_logarithms_of_ranges_are_written_in_whole_steps() -> None:
    told = np.log(_tables("range-rounding").recorded["range_m"]) / SLIDE
    assert np.allclose(told, np.rint(told))
    shift = np.abs(_shift("range-rounding"))
    assert (shift <= 0.51 * SLIDE * _of("range_m")).all()


def test_paper_shrinks_by_what_lies_between_two_places() -> None:
    begin, end = np.array([3.0, 50.0, 20.5]), np.array([33.0, 12.0, 20.6])
    parts = [np.linspace(a, b, 4001) for a, b in zip(begin, end, strict=True)]
    local = [shrunk(one, one + 1e-6).mean() for one in parts]
    assert np.allclose(shrunk(begin, end), local, rtol=1e-3)
    assert np.allclose(shrunk(begin, end), shrunk(end, begin))
    assert shrunk(np.zeros(1), np.full(1, 1e-6))[0] == pytest.approx(0.0, abs=1e-9)


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("colliery", 0.5)
    assert np.mean(late > 4.09) < 0.9
    more = round_corners(Tally(_known(), 0, np.random.default_rng(0)))
    assert (more > 0.5).all()


def test_all_props_hear_and_each_hears_tags_of_more_than_one_kind() -> None:
    kinds = _rows().groupby("rx")["environment"].nunique()
    assert len(kinds) == PROPS
    assert kinds.min() > 1


@pytest.mark.parametrize("name", ["antenna-delay", "clock-offset", "tubs-hunt-on-their-rails"])
def test_waveforms_and_ranges_bear_the_same(name: str) -> None:
    """What devices, clocks and courses do to ranges is a law of rows, whatever else is kept."""
    ranges, waves = (_tables(name, mode=mode) for mode in ("ranges", "CIR"))
    sizes = [float(np.abs(t.recorded["error_m"] - t.clean["error_m"]).mean())
             for t in (ranges, waves)]  # fmt: skip
    assert sizes[0] == pytest.approx(sizes[1], rel=0.5)
    assert all(map(np.array_equal, waves.recorded["cir"], waves.clean["cir"]))


def test_in_the_clean_tables_nothing_goes_by_what_is_noted() -> None:
    """Over 20 shifts, errors less those simulated go with no column more than chance has it."""
    made = [_nothing(seed) for seed in range(20)]
    columns = [c for c in CAUSES.values() if c not in ("time_s", "true_range_m")]
    first = [t.groupby("link").first() for one in made for t in (one.recorded, one.simulated)]
    off = np.concatenate([one["error_m"] for one in first])
    for column in {*columns}:
        by = np.concatenate([one[column] for one in first])
        assert abs(np.corrcoef(off, by)[0, 1]) * np.sqrt(len(off)) < 3.9, column
