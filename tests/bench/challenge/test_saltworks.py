"""The saltworks: what is particular to it, and what its gauges leave alone."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.special import fresnel, j0
from scipy.stats import ks_2samp

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.saltworks_day import GROWS
from bench.challenge.families.saltworks_effects import (
    BRINE,
    DURAND,
    MILLS_M,
    SALT,
    VERNIER_M,
    blows,
    by_heaps,
    crusted,
    edge_db,
    gap_k,
    hanai,
    haze,
    rippled,
    slab_m,
    tukey,
)
from bench.challenge.families.saltworks_faults import PHASE
from bench.challenge.families.saltworks_gauge import TOLD, first_paths, hump, humps, unsurpassed
from bench.challenge.families.saltworks_pans import PLACES, TAGS, VANES_M, WORKS_M, Haul
from bench.challenge.families.saltworks_wave_effects import (
    BIT,
    aslant,
    bessel,
    carried,
    keyed,
    leontovich,
    order_m,
    residues,
    reversed_bits,
)
from tests.bench.challenge import shown

_are = partial(shown.are_of, "saltworks")
_shift = partial(shown.shift_of, "saltworks")
_tables = partial(shown.tables_of, "saltworks")
_rows = partial(shown.rows_of, "saltworks")
_known = partial(shown.known_of, "saltworks")
_of = partial(shown.column_of, "saltworks")


def _vanes() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("vane").astype(int).to_numpy()


def _turn(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"turn (\d+)")[0]


def test_tags_stay_in_the_works_and_a_turn_has_one_tag_and_some_vanes() -> None:
    rows = _rows()
    assert rows["tx_x_m"].between(0.0, WORKS_M[0]).all()
    assert rows["tx_y_m"].between(0.0, WORKS_M[1]).all()
    assert rows["true_range_m"].min() > 1.8
    turns = rows.groupby(_turn(rows))
    assert turns["tx"].nunique().eq(1).all()
    assert turns["rx"].nunique().between(3, 7).all()
    assert turns["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}


def test_vanes_wait_an_eighth_longer_from_one_time_to_the_next() -> None:
    waits = _rows().groupby("link")["time_s"].diff()
    grown = waits / waits.groupby(_rows()["link"]).shift(1)
    assert grown.notna().sum() > 200
    assert np.allclose(grown.dropna(), GROWS)


def test_rakes_go_to_and_fro_by_as_much_as_they_reach_and_step_aside() -> None:
    one = _known()
    one = one[one["tx"].str.startswith("raker") & one["goes"].eq(1.0)]
    off = (one["tx_x_m"] - one["from_x"]) + 1j * (one["tx_y_m"] - one["from_y"])
    turned = off.to_numpy() * np.exp(-1j * one["bears"].to_numpy())
    assert np.abs(turned.real).max() <= 1.25 + 1e-9
    assert turned.real.min() < -0.5 < 0.5 < turned.real.max()
    assert np.allclose(turned.imag, one["speed"] * one["done_s"])


def test_harvesters_come_in_as_they_go_round_and_cover_as_much_way_as_their_speed_has_it() -> None:
    one = _known()
    one = one[one["tx"].str.startswith("harvester") & one["goes"].eq(1.0)]
    off = (one["tx_x_m"] - one["from_x"]) + 1j * (one["tx_y_m"] - one["from_y"])
    inward = np.sin(np.arctan(one["lasts"].to_numpy(np.float64)))
    come = one["speed"].abs() * one["done_s"] * inward
    assert np.allclose(np.abs(off), one["swing"] - come)


def test_who_rests_stays_and_all_else_moves() -> None:
    rests = _known().groupby(_turn(_known()))["goes"].first().eq(0.0)
    rows = _rows()
    spread = rows.groupby(_turn(rows))[["tx_x_m", "tx_y_m"]].agg(np.ptp).max(axis=1)
    assert rests.sum() == 6
    assert spread[rests].max() == 0.0
    assert spread[~rests].min() > 0.01


def test_longer_strokes_and_tighter_spirals_move_their_own_tags_by_no_more_than_that() -> None:
    strokes = _shift("strokes-longer-than-told", 0.1)
    assert not strokes[~_are("raker")].any()
    assert np.abs(strokes).max() <= 0.042 + 1e-9
    spirals, own = _shift("spirals-wind-tighter", 0.1), _are("harvester")
    assert not spirals[~own].any()
    one = _known()[own]
    far = np.hypot(one["tx_x_m"] - one["from_x"], one["tx_y_m"] - one["from_y"])
    gone = np.log(one["swing"] / far)
    most = 0.0115 * gone / one["lasts"] * one["swing"]
    assert (np.abs(spirals[own]) <= most + 1e-9).all()


def test_a_phase_that_sags_is_of_its_own_vanes_and_of_what_the_engine_draws() -> None:
    shift, own = _shift("one-phase-sags-while-hauling"), np.isin(_vanes(), PHASE)
    assert np.allclose(shift, np.where(own, 0.0031 * _of("haul_a"), 0.0))
    assert 0.2 < own.mean() < 0.7


def test_eastern_vanes_are_turned_about_their_station_and_no_others() -> None:
    shift, east = _shift("east-dyke-by-another-north", 0.1), VANES_M[:, 0] > 40.0
    assert not shift[~east[_vanes()]].any()
    arm = np.hypot(*(VANES_M[:, :2] - (40.0, 2.0)).T)[_vanes()]
    assert (np.abs(shift) <= 0.00155 * arm + 1e-6).all()
    assert np.abs(shift).max() > 0.02


def test_spray_is_of_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("spray-blown-across")
    wanted = 0.24 * (_of("wind_ms") / 12.0) ** 2 * _of("brine_cm") / 30.0
    assert np.allclose(shift, wanted)
    for name in ("wind_ms", "brine_cm"):
        assert abs(np.corrcoef(shift, _of(name))[0, 1]) < 0.97


def test_crusts_come_to_an_end_and_iodine_does_not() -> None:
    crust = _shift("gypsum-crusts-on-lids")
    assert np.allclose(-np.log1p(-crust / 0.205), _of("crust_um") / 46.0)
    iodine = _shift("iodine-stains-copper")
    assert np.allclose(np.expm1(iodine / 0.075), _of("iodine_ug") / 2.2)
    assert np.allclose(_shift("sails-furled"), np.where(_of("wind_ms") > 10.5, 0.093, 0.0))


SEEN = (
    "strokes-longer-than-told", "spirals-wind-tighter", "one-phase-sags-while-hauling",
    "east-dyke-by-another-north", "spray-blown-across", "vane-knocked-by-a-tipper",
)  # fmt: skip


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
@pytest.mark.parametrize("name", SEEN)
def test_faults_move_ranges_by_more_than_these_scatter(name: str, mode: str) -> None:
    share, times = shown.moved_of("saltworks", name, mode)
    assert share > 0.05
    assert times > 1.5


ALIKE = ("one-phase-sags-while-hauling", "clock-offset", "ground-bounce", "")


@pytest.mark.parametrize("name", ALIKE)
def test_the_truth_is_what_was_recorded_drawn_once_more(name: str) -> None:
    world: Any = world_of("saltworks")
    made = [world.tables(Draw((name,) if name else (), ratio=1), seed) for seed in range(6)]
    for column in ("error_m", "rx_power_dbm", "first_path_power_dbm"):
        both = [
            pd.concat([getattr(one, side).groupby("link")[column].first() for one in made])
            for side in ("recorded", "truth")
        ]
        assert ks_2samp(*both).pvalue > 0.01


def test_ranges_are_written_as_the_nearer_mark_of_two_scales() -> None:
    made = _tables("range-rounding")
    written, was = (one["range_m"].to_numpy() for one in (made.recorded, made.clean))
    off = [np.abs(written / step - np.rint(written / step)) for step in VERNIER_M]
    assert np.min(off, axis=0).max() < 1e-9
    marks = [np.abs(step * np.rint(was / step) - was) for step in VERNIER_M]
    assert np.allclose(np.abs(written - was), np.min(marks, axis=0))


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("saltworks", 0.449)
    assert np.mean(late > 4.69) < 0.45


def test_heaps_return_what_makes_one_angle_with_their_flanks() -> None:
    more = by_heaps(Haul(_known(), 0, np.random.default_rng(0)))
    assert (more > 0.45).all()
    assert np.median(more) < 4.0 < more.max() < 40.0


def test_mills_are_heard_by_near_vanes_and_by_cubes_of_the_wind() -> None:
    made, part = _tables("noise-floor"), blows(_of("wind_ms"))
    assert (part == 0.0).any()
    assert (part == 1.0).any()
    db = 20 * np.log10((made.recorded["noise_std"] / made.clean["noise_std"]).to_numpy())
    near = [np.polyfit(part[own], db[own], 1)[0] for own in np.eye(13, dtype=bool)[:, _vanes()]]
    apart = np.linalg.norm(VANES_M[:, None, :2] - MILLS_M, axis=2).min(axis=1)
    assert np.allclose(near * (1 + (apart / 15.0) ** 2) ** 0.75, 9.4)


def test_symbols_that_are_not_counted_take_their_noise_with_them() -> None:
    made = _tables("level-control")
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert 0.35 < counts.min() < 0.75
    assert counts.max() <= 1.0


def test_a_loop_learns_what_crystals_are_off_but_never_all_of_it() -> None:
    shift = pd.Series(_shift("clock-offset") / _of("reply_time_s"))
    rows = _rows()
    since = rows["time_s"] - rows.groupby("link")["time_s"].transform("min")
    left = shift / (0.45 + 0.55 * np.exp(-since / 0.9))
    assert left.groupby([rows["tx"], rows["rx"]]).agg(np.ptp).max() < 1e-9
    assert (shift.abs()[since > 1.5] / left.abs()[since > 1.5]).max() < 0.6


@pytest.mark.parametrize("name", ["time-lag", "exchange-motion"])
def test_what_goes_away_is_read_long_meanwhile(name: str) -> None:
    assert shown.with_speed("saltworks", name) > 0.6


def test_durands_rule_is_right_for_lines_and_gaps_close_faster_the_warmer_it_is() -> None:
    assert DURAND.sum() == pytest.approx(1.0)
    assert DURAND @ np.arange(5) == pytest.approx(2.0)
    steps = np.diff(gap_k(np.array([0.0, 10.0, 20.0, 30.0])))
    assert (np.diff(steps) > 0).all()
    assert np.allclose(steps, 5.2, atol=0.3)


def test_edges_are_as_fresnel_has_them_and_faces_return_what_grazes_them() -> None:
    over = np.linspace(0.0, 6.0, 60)
    sine, cosine = fresnel(over)
    wanted = -20 * np.log10(np.hypot(0.5 - sine, 0.5 - cosine) / np.sqrt(2))
    legs = np.full(60, 2 * 2 / (0.299792458 / 3.9936))
    assert np.allclose(edge_db(over, legs, legs), wanted, atol=0.15)
    assert leontovich(3.91 + 0j, np.array([1e-6]))[0] == pytest.approx(1.0, abs=1e-4)
    assert leontovich(3.91 + 0j, np.ones(1))[0] == pytest.approx(0.328, abs=1e-3)
    assert leontovich(90 - 900j, np.array([0.7]))[0] > 0.9


def test_brine_below_no_crust_returns_as_fresnel_has_it_and_ripples_leave_as_bessel_has_it() -> (
    None
):
    down = np.array([0.1, 0.5, 1.0])
    root = np.sqrt(BRINE - 1 + down**2)
    bare = crusted(down, np.zeros(3))
    assert np.allclose(bare, (down - root) / (down + root))
    thick = 0.5 * 0.0750682 / np.sqrt(SALT - 1 + down**2).real
    assert np.allclose(crusted(down, thick), bare, atol=0.03)  # half a wave in salt is as nothing
    assert (np.abs(crusted(down, 0.5 * thick)) < np.abs(bare)).all()
    steep = np.linspace(0.0, 2.3, 12)
    assert np.allclose(rippled(steep), j0(steep))
    assert np.allclose(bessel(10 * steep), j0(10 * steep), atol=1e-6)


def test_what_is_soaked_is_between_its_parts_and_haze_between_that_of_both_heights() -> None:
    part = np.array([0.0, 0.1, 0.3, 1.0])
    mixed = hanai(1.99, 62.0, part)
    assert mixed[[0, 3]] == pytest.approx([1.99, 62.0])
    assert (np.diff(mixed) > 0).all()
    kept = (62.0 - mixed) / (62.0 - 1.99) * np.cbrt(1.99 / mixed)
    assert np.allclose(kept, 1 - part)
    assert slab_m(np.full(1, 0.1), 5.24, np.zeros(1))[0] == pytest.approx(0.1289, abs=1e-4)
    low, high = np.array([1.0, 2.0]), np.array([1.0, 6.0])
    heights = np.linspace(low, high, 4001)
    assert np.allclose(haze(low, high), np.exp(-heights / 3.2).mean(axis=0), atol=1e-3)


def test_tukeys_law_is_even_and_has_heavier_ends_than_a_bell() -> None:
    even = np.linspace(0.001, 0.999, 9999)
    made = tukey(even)
    assert np.allclose(made, -made[::-1])
    assert (made**4).mean() / (made**2).mean() ** 2 > 3.5


def test_pulses_end_and_first_tops_are_where_they_are_however_high_and_never_sooner_if_deaf() -> (
    None
):
    assert hump(np.array([0.0, 4.75, 9.0])) == pytest.approx([1.0, 0.0, 0.0])
    assert 2 * np.interp(-0.5, -hump(np.linspace(0, 4, 999)), np.linspace(0, 4, 999)) < 2.8
    top, much = 70 + np.linspace(0, 1, 33), [0.0, 2.0]
    quiet = np.full(33, 0.003)
    one = humps(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, TOLD, atol=0.02)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + humps(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in much)
    assert np.allclose(deaf - sharp, 11.2, atol=0.05)
    soon, late = (first_paths(0.5 * one + humps(top + 3.4), 8 * quiet, by) for by in much)
    assert (late >= soon).all()


def test_what_is_higher_soon_after_surpasses_a_top() -> None:
    values = np.zeros((1, 60))
    values[0, [10, 20, 50]] = (1.0, 2.0, 3.0)
    kept = np.flatnonzero(unsurpassed(values)[0] & (values[0] > 0))
    assert kept.tolist() == [20, 50]


def test_orders_come_ever_later_and_bits_are_keyed_for_as_long_as_they_last() -> None:
    late = np.array([order_m(order, np.ones(1))[0] for order in range(6)])
    assert late[0] == 0.0
    assert (np.diff(late, 2) > 0).all()
    wave = keyed(np.random.default_rng(4), 40)
    assert np.allclose(np.abs(wave), 1.0)
    pitch = np.angle(wave[:, 1:] * wave[:, :-1].conj())
    assert np.abs(pitch).max() < 0.3 + 1e-9
    alike = [np.mean(pitch[:, k:] * pitch[:, : pitch.shape[1] - k]) for k in (0, 2 * BIT)]
    assert abs(alike[1]) < 0.15 * alike[0]


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes = np.random.default_rng(4).rayleigh(size=(3, 240))
    assert np.allclose(residues(2.0 + 0.3 * np.arange(240.0)[None])[:, 2:], 0.0)
    order = reversed_bits(38)
    assert order[:16].tolist() == [0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15]
    assert np.array_equal(order[order], np.arange(38))
    written = carried(sizes, np.full(3, 2.0))
    assert {*np.unique(written)} <= {0.0, 2.0, 4.0, 6.0}
    assert np.abs(np.cumsum(written - sizes, axis=1)).max() <= 1.0 + 1e-9
    waves = aslant(sizes * np.exp(1j * np.arange(240)), 0.25)
    for part in (waves.real + waves.imag, waves.real - waves.imag):
        assert np.allclose(part / 0.25, np.rint(part / 0.25))
