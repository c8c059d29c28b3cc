"""The granary: what is particular to it, and how large what it hides is."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.granary import CAUSES, SPOUT_DB, STRAIGHT, TAG_DB
from bench.challenge.families.granary_bins import (
    BIN_M,
    BINS_M,
    FOOT_M,
    HALL_M,
    MAGNET_A,
    PIN_M,
    PLACES,
    RIM_M,
    ROUND_M,
    SPOUTS,
    SPOUTS_M,
    TAGS,
    TOP_M,
    Docket,
    hooked,
    on_cycloid,
    on_legs,
    paid_out,
)
from bench.challenge.families.granary_effects import VULGAR, WRITTEN_M, round_bins, vulgar
from bench.challenge.families.granary_faults import (
    BENDS_RAD,
    RACKED_M,
    STATION_M,
    TILT_RAD,
    open_dbm,
    outward,
    tilted_m,
)
from bench.challenge.families.granary_harvest import RESTS, SLOT_S, contended
from tests.bench.challenge import shown

_are = partial(shown.are_of, "granary")
_nothing = partial(shown.nothing_of, "granary")
_shift = partial(shown.shift_of, "granary")
_tables = partial(shown.tables_of, "granary")
_rows = partial(shown.rows_of, "granary")
_known = partial(shown.known_of, "granary")
_of = partial(shown.column_of, "granary")


def _docket() -> Docket:
    return Docket(_known(), 0, np.random.default_rng(0))


def _load(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"load (\d+)")[0]


def test_a_shaft_behind_a_joint_comes_round_as_often_and_its_tangent_is_as_a_cosine() -> None:
    turn = np.linspace(-7.0, 7.0, 1401)
    after = hooked(turn, np.full(1401, 0.6))
    assert np.allclose(np.tan(after) * np.cos(0.6), np.tan(turn), atol=1e-6, rtol=1e-6)
    assert np.abs(after - turn).max() < 0.1
    assert np.allclose(hooked(turn + np.pi, np.full(1401, 0.6)) - after, np.pi)


def test_six_sided_wheels_pay_out_six_sides_a_turn_by_jerks() -> None:
    turn = np.linspace(0.0, 2 * np.pi, 6001)
    out = paid_out(turn)
    assert paid_out(np.array([2 * np.pi]))[0] == pytest.approx(6 * RIM_M)
    pace = np.gradient(out, turn) / RIM_M
    assert pace.max() == pytest.approx(1.0, abs=1e-4)
    assert pace.min() == pytest.approx(np.cos(np.pi / 6), abs=1e-3)
    low, high = on_legs(np.array([0.0, np.linalg.norm(np.subtract(TOP_M, FOOT_M))]), np.zeros(2))
    assert np.allclose([low, high], [FOOT_M, TOP_M])


def test_troughs_are_as_long_as_they_say_and_bring_down_from_any_height_in_one_time() -> None:
    slid = np.linspace(-8.0, 8.0, 4001)
    there = on_cycloid(slid, np.ones(4001), np.zeros(4001))
    steps = np.linalg.norm(np.diff(there, axis=0), axis=1)
    assert np.allclose(steps, slid[1] - slid[0], rtol=1e-3)
    slope = np.gradient(there[:, 2], slid)[5:-5]  # pulls as a spring does: by how far it is
    assert np.allclose(slope, slid[5:-5] / (4 * ROUND_M), atol=1e-4)


def test_tags_stay_in_the_hall_and_out_of_bins_and_a_load_has_one_tag_and_some_spouts() -> None:
    rows = _rows()
    for axis, most in zip("xyz", HALL_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.5, most - 0.5).all()
        assert rows[f"rx_{axis}_m"].between(0.9, most - 0.9).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    off = rows[["tx_x_m", "tx_y_m"]].to_numpy()[:, None] - BINS_M
    assert np.linalg.norm(off, axis=2).min() > BIN_M
    assert rows["true_range_m"].min() > 2.9
    loads = rows.groupby(_load(rows))
    assert loads["tx"].nunique().eq(1).all()
    assert loads["rx"].nunique().between(2, 7).all()
    assert loads["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}


def test_spouts_are_heard_one_at_a_time_and_wait_after_they_were() -> None:
    lengths = np.array([4, 11, 1, 5, 2])
    firsts = set()
    for seed in range(12):
        which, since_s = contended(np.random.default_rng(seed), lengths)
        assert np.bincount(which).tolist() == lengths.tolist()
        slots = since_s / SLOT_S
        assert np.allclose(slots, np.rint(slots))
        assert np.diff(slots).min() > 0.5
        for spout in (0, 1, 3):
            assert np.diff(slots[which == spout]).min() > RESTS
        firsts |= {int(which[0])}
    assert len(firsts) > 2


def test_more_spouts_take_longer_as_they_clash() -> None:
    spans = []
    for count in (2, 7):
        lots = [contended(np.random.default_rng(s), np.full(count, 6))[1][-1] for s in range(12)]
        spans.append(np.mean(lots))
    assert spans[1] > 1.25 * spans[0]


def test_who_rests_stays_and_all_else_moves_as_fast_as_such_things_are() -> None:
    rows = _known()
    still = rows.groupby(_load(rows))["runs"].first().eq(0.0)
    spread = _rows().groupby(_load(_rows()))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).min() > 0.003
    docket = _docket()
    fast = np.abs(docket.draws_off(0.001)) / 0.001
    assert fast.max() < 5.5
    assert fast[docket.of("barrow")].max() < 2.8
    assert fast[docket.of("bucket")].max() < 2.1


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(5):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(18.0, 19.0).all()
            gap = table["rx_power_dbm"] - table["first_path_power_dbm"]
            assert gap.max() < 18


def test_deaf_sieves_lose_some_first_paths_on_any_day_and_more_the_deafer_they_are() -> None:
    world: Any = world_of("granary", "CIR")
    sizes = []
    for strength, least in ((0.25, 0.002), (0.5, 0.01), (1.0, 0.03), (2.0, 0.07)):
        late = []
        for seed in range(4):
            made = world.tables(Draw(("late-detection",), strength, 1), seed)
            later = made.recorded["error_m"] - made.clean["error_m"]
            assert least < (later > 0.3).mean() < 0.3
            assert (later >= -1e-9).all()
            late.append(later.mean())
        sizes.append(np.mean(late))
    assert np.allclose(np.array(sizes) / sizes[2], [0.25, 0.5, 1.0, 2.0], rtol=0.35, atol=0.1)


def test_what_comes_straight_is_as_large_a_part_with_waveforms_as_without() -> None:
    part, off = [], []
    for seed in range(6):
        rows = _nothing(seed, "CIR").recorded
        docket = Docket(rows, 0, np.random.default_rng(0))
        gap = rows["rx_power_dbm"] - rows["first_path_power_dbm"]
        part.append((10 ** (-gap / 10)).mean())
        own = open_dbm(docket.far) + SPOUT_DB[docket.spout] + TAG_DB[docket.tag]
        off.append((rows["rx_power_dbm"] - own)[docket.past("metal") == 0].mean())
    assert np.mean(part) == pytest.approx(STRAIGHT, abs=0.02)
    assert np.mean(off) == pytest.approx(0.0, abs=0.25)


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("granary", mode)
        known = {*world.KNOWN, *world.LAWS}
        assert {name for name in world.CAUSES if name not in known} == set()
        assert {*world.CAUSES.values()} <= {*_nothing(0, mode).recorded}
    of_one = {
        "chaff-clings-to-spouts": "chaff_g", "meal-cakes-on-covers": "caked_mm",
        "tallow-creeps-since-greased": "greased_h", "sacks-lean-on-posts": "sacks",
        "magnet-drum-holds-nails": "magnet_a",
    }  # fmt: skip
    for name, column in of_one.items():
        order = np.argsort(_of(column), kind="stable")
        assert (np.diff(_shift(name)[order]) > -1e-9).all(), name
    order = np.argsort(_of("drier_gap_m"))
    assert (np.diff(_shift("drier-stands-close-by")[order]) < 1e-9).all()


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    chaff = np.arctanh(_shift("chaff-clings-to-spouts") / 0.17)
    assert np.allclose(chaff, _of("chaff_g") / 55.0, atol=1e-6)
    meal = np.log(_shift("meal-cakes-on-covers") / 0.18)
    assert np.allclose(meal, 1.6 * np.log(_of("caked_mm") / 9.0))
    assert np.allclose(_shift("drier-stands-close-by") * _of("drier_gap_m"), 0.12)
    tallow = np.expm1(_shift("tallow-creeps-since-greased") / 0.046)
    assert np.allclose(tallow, _of("greased_h") / 5.0)
    assert np.allclose(_shift("sacks-lean-on-posts"), 0.0115 * _of("sacks"))
    turn = 2 * np.pi * _of("chain_m") / PIN_M + 0.9
    assert np.allclose(_shift("chain-pins-pass"), 0.06 * np.cos(turn))
    assert np.allclose(_shift("magnet-drum-holds-nails") > 0.01, _of("magnet_a") > MAGNET_A)


def test_wheat_heats_by_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("damp-wheat-heats")
    damp, warm = _of("moist_pct"), _of("temperature_c")
    assert not shift[damp < 11.0].any()
    both = np.log2(shift[damp > 11.5] / (damp[damp > 11.5] - 11.0))
    line = np.polyfit(warm[damp > 11.5], both, 1)
    assert line[0] == pytest.approx(0.1)
    for column in (damp, warm):
        assert abs(np.corrcoef(shift, column)[0, 1]) < 0.95


def test_faults_of_ways_concern_their_own_kind_and_are_as_large_as_is_said() -> None:
    for name, kind, most in (
        ("sacks-rub-in-chutes", "sack", 0.6),
        ("elevator-racked-aside", "bucket", 1.7 * RACKED_M),
        ("augers-bend-back", "auger", BENDS_RAD * 6.5**3 / 9.0),
    ):
        shift, own = _shift(name), _are(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
    rests = _known()["runs"].eq(0.0).to_numpy()
    assert not _shift("sacks-rub-in-chutes")[rests].any()


def test_walls_bulge_outward_and_the_roof_does_not() -> None:
    out = outward()
    assert not out[-2:].any()
    rest = out[:-2]
    assert (np.linalg.norm(rest, axis=1) > 0.3).all()
    moved = SPOUTS_M[:-2] + 0.1 * rest
    inside = np.minimum(SPOUTS_M[:-2], np.array(HALL_M) - SPOUTS_M[:-2])[:, :2].min(axis=1)
    closer = np.minimum(moved, np.array(HALL_M) - moved)[:, :2].min(axis=1)
    assert (closer < inside).all()
    hangs = _rows()["rx"].isin(["spout10", "spout11"]).to_numpy()
    assert not _shift("walls-bulge-when-filled")[hangs].any()


def test_a_tilted_axis_turns_all_about_its_station() -> None:
    off = tilted_m(1.0)
    arms = SPOUTS_M - np.array(STATION_M)
    assert np.allclose((off * arms).sum(axis=1), 0.0)
    assert np.allclose(off @ np.array(TILT_RAD), 0.0)
    assert 0.2 < np.abs(off[:, 2]).max() < 0.7


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    for name, low, high in (("path-loss", -7.5, -2.0), ("level-control", -3.2, -0.6)):
        made = _tables(name)
        lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
        assert low < lost.mean() < high
        assert not _shift(name).any()
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert counts.max() <= 1.0


def test_ranges_are_written_in_vulgar_fractions() -> None:
    part = np.mod(_tables("range-rounding").recorded["range_m"].to_numpy() / WRITTEN_M, 1.0)
    off = np.abs(part[:, None] - VULGAR).min(axis=1)
    assert off.max() < 1e-6
    assert np.abs(_shift("range-rounding")).max() <= WRITTEN_M / 8 + 1e-9
    assert np.allclose(vulgar(np.array([3.34, 3.9, 3.1]), 1.0), [3 + 1 / 3, 4.0, 3.0])


def test_strings_round_bins_are_longer_than_any_way_past_these() -> None:
    docket = _docket()
    longer = round_bins(docket)
    assert longer.shape == (docket.count, len(BINS_M))
    assert longer.min() > 0.0
    for number, at in enumerate(BINS_M):  # by the farthest place of a bin it is no longer
        far = [np.linalg.norm(one[:, :2] - at, axis=1) for one in (docket.from_m, docket.to_m)]
        assert (longer[:, number] + docket.far < sum(far) + 2 * np.pi * BIN_M + 15.0).all()


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("granary", 0.5)
    assert np.mean(late > 4.25) < 0.9


def test_all_spouts_hear_and_each_hears_tags_of_more_than_one_kind() -> None:
    kinds = _rows().groupby("rx")["environment"].nunique()
    assert len(kinds) == SPOUTS
    assert kinds.min() > 1


@pytest.mark.parametrize("name", ["antenna-delay", "clock-offset", "augers-bend-back"])
def test_waveforms_and_ranges_carry_the_same(name: str) -> None:
    """What devices, clocks and courses do to ranges is a law of rows, whatever else is kept."""
    ranges, waves = (_tables(name, mode=mode) for mode in ("ranges", "CIR"))
    sizes = [float(np.abs(t.recorded["error_m"] - t.clean["error_m"]).mean())
             for t in (ranges, waves)]  # fmt: skip
    assert sizes[0] == pytest.approx(sizes[1], rel=0.5)
    assert all(map(np.array_equal, waves.recorded["cir"], waves.clean["cir"]))


def test_in_the_clean_tables_nothing_goes_by_what_is_noted() -> None:
    """Over 20 days, errors less those simulated go with no column more than chance has it."""
    made = [_nothing(seed) for seed in range(20)]
    columns = [c for c in CAUSES.values() if c not in ("time_s", "true_range_m")]
    first = [t.groupby("link").first() for one in made for t in (one.recorded, one.simulated)]
    off = np.concatenate([one["error_m"] for one in first])
    for column in {*columns}:
        by = np.concatenate([one[column] for one in first])
        assert abs(np.corrcoef(off, by)[0, 1]) * np.sqrt(len(off)) < 3.9, column
