"""The ship lock: what is particular to it, and what its staffs leave alone."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import ks_2samp

from bench.challenge.families.canal_chamber import (
    COPING_M,
    DAVITS_M,
    DAY_S,
    HEELS_M,
    LEAF_M,
    LOCK_M,
    PLACES,
    TAGS,
)
from bench.challenge.families.canal_effects import (
    CURTIS,
    PUMPS_M,
    edge_db,
    mixed,
    slabs_m,
    unruffled,
)
from bench.challenge.families.canal_faults import CABINET
from bench.challenge.families.canal_staff import TOLD, first_paths, splines
from bench.challenge.families.canal_traffic import ROUNDS_S, SLOT_S
from bench.challenge.families.canal_wave_effects import (
    against_itself,
    fresnel,
    register,
    scrambled,
    without_least,
    without_nought,
    zigzags_m,
)
from bench.challenge.families.case import Draw, world_of
from tests.bench.challenge import shown

_are = partial(shown.are_of, "canal")
_shift = partial(shown.shift_of, "canal")
_tables = partial(shown.tables_of, "canal")
_rows = partial(shown.rows_of, "canal")
_known = partial(shown.known_of, "canal")
_of = partial(shown.column_of, "canal")


def _davits() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("davit").astype(int).to_numpy()


def _locking(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"locking (\d+)")[0]


def test_tags_stay_at_the_lock_and_a_locking_has_one_tag_and_some_davits() -> None:
    rows = _rows()
    assert rows["tx_x_m"].between(0.0, LOCK_M[0]).all()
    assert rows["tx_y_m"].between(-4.6, LOCK_M[1] + 4.6).all()
    assert rows["true_range_m"].min() > 1.6
    lockings = rows.groupby(_locking(rows))
    assert lockings["tx"].nunique().eq(1).all()
    assert lockings["rx"].nunique().between(2, 7).all()
    assert lockings["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}
    assert "room_x_m" not in rows


def test_barges_float_as_high_as_the_water_and_all_else_is_over_the_copings() -> None:
    rows, floats = _rows(), _are("barge")
    assert np.allclose((rows["tx_z_m"] + rows["head_m"])[floats], 6.3)
    assert rows["tx_z_m"][~floats].between(COPING_M, COPING_M + 1.6).all()


def test_davits_ask_in_rounds_and_each_misses_one_stretch_of_these() -> None:
    rows = _rows()
    for _, one in rows.groupby(_locking(rows)):
        since = (one["time_s"] - one["time_s"].min()) / SLOT_S
        assert len(since) == len(np.unique(np.rint(since)))
        steps = one.groupby("link")["time_s"].diff().dropna().to_numpy()
        off = [np.abs(steps / s - np.rint(steps / s)).max(initial=0.0) for s in ROUNDS_S]
        pitch_s = ROUNDS_S[int(np.argmin(off))]
        assert min(off) < 1e-5
        missed = one.groupby("link")["time_s"].diff().gt(1.5 * pitch_s)
        assert missed.groupby(one["link"]).sum().max() <= 1


def test_barges_are_e_times_slower_by_each_reach_that_they_have_come() -> None:
    one = _known()
    one = one[one["tx"].str.startswith("barge") & one["goes"].eq(1.0)]
    along = np.abs(one["tx_x_m"] - one["from_x"])
    far = one["reach"] * np.log1p(one["speed"] * one["done_s"] / one["reach"])
    assert np.allclose(along, far, atol=0.03)
    assert along.max() > 3.0


def test_leaves_keep_their_tags_as_far_from_their_heels_and_open_no_further_than_they_can() -> None:
    leaves = _rows()[_are("leaf")]
    heels = HEELS_M[leaves["tx"].str[-1].astype(int)]
    off = leaves[["tx_x_m", "tx_y_m"]].to_numpy() - heels
    assert np.allclose(np.hypot(*off.T), LEAF_M)
    side = np.where(heels[:, 1] > 0, -1.0, 1.0)
    assert (off[:, 0] > 0).all()
    assert (side * off[:, 1] > 0).all()


def test_who_is_moored_rests_and_all_else_moves() -> None:
    moors = _known().groupby(_locking(_known()))["goes"].first().eq(0.0)
    rows = _rows()
    spread = rows.groupby(_locking(rows))[["tx_x_m", "tx_y_m"]].agg(np.ptp).max(axis=1)
    assert moors.sum() == 6
    assert spread[moors].max() == 0.0
    assert spread[~moors].min() > 0.01


def test_wider_leaves_move_leaves_alone_and_the_further_the_wider_they_stand() -> None:
    shift, leaves = _shift("leaves-swing-wider", 0.1), _are("leaf")
    assert not shift[~leaves].any()
    heels = HEELS_M[_rows()["tx"].str[-1].astype(int).to_numpy()[leaves]]
    off = _rows()[["tx_x_m", "tx_y_m"]].to_numpy()[leaves] - heels
    angle = np.abs(np.arctan2(off[:, 1], off[:, 0]))
    assert (np.abs(shift[leaves]) <= 0.1 * 0.09 * angle * LEAF_M + 1e-9).all()
    assert np.corrcoef(np.abs(shift[leaves]), angle)[0, 1] > 0.3


def test_a_well_that_lags_raises_barges_by_how_fast_the_chamber_fills() -> None:
    shift, floats = _shift("gauge-well-lags", 0.1), _are("barge")
    rise = (_of("rx_z_m") - _of("tx_z_m")) / _of("true_range_m")
    wanted = -0.1 * 17.0 * _of("fill_mms") / 1000.0 * rise
    assert not shift[~floats].any()
    assert np.allclose(shift[floats], wanted[floats], atol=3e-4)


def test_the_nearer_of_two_antennas_is_never_farther_than_their_middle() -> None:
    shift, two = _shift("nearer-of-two-antennas"), _are("barge", "mule")
    assert not shift[~two].any()
    assert shift.max() <= 0.0
    broadside = np.abs(np.sin(np.radians(_of("azimuth_deg"))))
    assert np.allclose(shift[two], -0.23 * broadside[two])


def test_a_cabinet_that_was_restarted_settles_at_its_own_davits() -> None:
    shift, own = _shift("cabinet-restarted"), np.isin(_davits(), CABINET)
    since = _of("time_s") - 0.36 * DAY_S
    assert not shift[~own | (since <= 0)].any()
    after = own & (since > 0)
    assert np.allclose(np.log(shift[after] / 0.21), -since[after] / 5200.0)
    assert 0.1 < after.mean() < 0.5


def test_spray_is_of_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("sluices-spray")
    fall = np.sqrt(2 * 9.81 * _of("head_m"))
    assert np.allclose(shift, 0.027 * _of("sluice_pct") / 100.0 * fall, atol=1e-9)
    for name in ("sluice_pct", "head_m"):
        assert abs(np.corrcoef(shift, _of(name))[0, 1]) < 0.97


def test_lids_freeze_over_in_frost_alone() -> None:
    frost = _of("temperature_c") < 1.5
    assert np.allclose(_shift("lids-freeze-over"), np.where(frost, 0.097, 0.0))
    assert 0.05 < frost.mean() < 0.5


def test_slime_comes_to_an_end_and_verdigris_does_not() -> None:
    slime, deep = _shift("slime-on-lids"), _of("slime_um")
    assert slime.max() < 0.235
    assert np.allclose(deep / slime, (deep + 32.0) / 0.235)
    green = _shift("verdigris-creeps")
    assert np.allclose(np.expm1(green / 0.071), _of("verdigris_mg") / 2.5)


SEEN = (
    "gauge-well-lags", "leaves-swing-wider", "nearer-of-two-antennas", "cabinet-restarted",
    "sluices-spray", "davit-bent-by-a-barge",
)  # fmt: skip


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
@pytest.mark.parametrize("name", SEEN)
def test_faults_move_ranges_by_more_than_these_scatter(name: str, mode: str) -> None:
    share, times = shown.moved_of("canal", name, mode)
    assert share > 0.05
    assert times > 1.5


ALIKE = ("nearer-of-two-antennas", "cabinet-restarted", "clock-offset", "ground-bounce", "")


@pytest.mark.parametrize("name", ALIKE)
def test_the_truth_is_what_was_recorded_drawn_once_more(name: str) -> None:
    world: Any = world_of("canal")
    made = [world.tables(Draw((name,) if name else (), ratio=1), seed) for seed in range(3)]
    for column in ("error_m", "rx_power_dbm", "first_path_power_dbm"):
        both = [
            pd.concat([getattr(one, side).groupby("link")[column].first() for one in made])
            for side in ("recorded", "truth")
        ]
        assert ks_2samp(*both).pvalue > 0.01


def test_davits_of_either_side_write_steps_of_their_own() -> None:
    written, davit = _tables("range-rounding").recorded["range_m"].to_numpy(), _davits()
    step = np.where(DAVITS_M[davit, 1] < 0, 0.11, 0.17)
    assert np.abs(written / step - np.rint(written / step)).max() < 1e-9
    assert (np.abs(_shift("range-rounding")) <= 0.5 * step + 1e-9).all()


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("canal", 0.449)
    assert np.mean(late > 4.59) < 0.3


def test_pumps_are_heard_by_near_davits_and_by_the_root_of_what_they_draw() -> None:
    made, root = _tables("noise-floor"), np.sqrt(_of("pump_kw") / 80.0)
    db = 20 * np.log10((made.recorded["noise_std"] / made.clean["noise_std"]).to_numpy())
    near = np.zeros(len(DAVITS_M))
    for davit in range(len(DAVITS_M)):
        here = _davits() == davit
        near[davit] = np.polyfit(root[here], db[here], 1)[0]
    apart = np.linalg.norm(DAVITS_M[:, None, :2] - PUMPS_M, axis=2).min(axis=1)
    assert np.allclose(near * np.cosh(apart / 12.0), 6.6)


def test_symbols_that_are_not_counted_take_their_noise_with_them() -> None:
    made = _tables("level-control")
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert 0.4 < counts.min() < 0.75
    assert counts.max() <= 1.0


def test_crystals_turn_over_as_tuning_forks_do() -> None:
    ppm = _shift("clock-offset") / _of("reply_time_s") / (149.896229 * 0.017)
    bent = pd.Series(ppm + 0.0011 * (_of("temperature_c") - 24.0) ** 2)
    for _, one in bent.groupby([_rows()["tx"], _rows()["rx"]]):
        assert np.ptp(one) < 1e-9


@pytest.mark.parametrize("name", ["time-lag", "exchange-motion"])
def test_what_goes_away_is_read_long_meanwhile(name: str) -> None:
    assert shown.with_speed("canal", name) > 0.6


def test_clenshaws_and_curtis_rule_is_exact_for_powers_up_to_the_fifth() -> None:
    for power in range(6):
        assert sum(by * at**power for by, at in CURTIS) == pytest.approx(1 / (1 + power))


def test_edges_take_six_db_where_they_touch_and_walls_return_all_that_grazes_them() -> None:
    legs = (np.full(3, 8.0), np.full(3, 12.0))
    lost = edge_db(np.array([0.0, 0.3, 0.9]), legs)
    assert lost[0] == pytest.approx(6.0, abs=0.1)
    assert (np.diff(lost) > 4.0).all()
    assert fresnel(6.1, np.array([1e-6]))[0] == pytest.approx(1.0, abs=1e-4)
    assert fresnel(6.1, np.ones(1))[0] == pytest.approx((np.sqrt(6.1) - 1) / (np.sqrt(6.1) + 1))


def test_rough_water_returns_the_less_the_steeper_and_mixtures_are_between_their_parts() -> None:
    left = unruffled(np.array([0.0, 0.003, 0.003]), np.array([0.5, 0.2, 0.8]))
    assert left[0] == pytest.approx(1.0)
    assert 0.0 < left[2] < left[1] < 1.0
    assert mixed((2.0, 60.0), (np.array([1.0, 0.5]), np.array([0.0, 0.5]))) == pytest.approx(
        [2.0, np.sqrt(120.0)]
    )
    assert slabs_m(np.full(1, 0.1), 5.24, np.zeros(1))[0] == pytest.approx(0.1289, abs=1e-4)
    assert np.allclose(zigzags_m(np.full(2, 12.0), 1), 3.0)


def test_a_register_runs_through_all_and_words_come_back_if_they_are_turned_twice() -> None:
    runs = register(400)
    assert np.array_equal(runs[:127], runs[127:254])
    assert not np.array_equal(runs[:100], runs[20:120])
    sizes, unit = np.random.default_rng(4).rayleigh(9.0, (3, 90)), np.full(3, 0.25)
    twice = scrambled(scrambled(sizes, unit), unit)
    assert np.abs(twice - sizes).max() <= 0.125 + 1e-9
    assert (np.abs(scrambled(sizes, unit) - sizes) > 1.0).mean() > 0.5


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes = np.random.default_rng(4).rayleigh(size=(3, 240))
    alike = against_itself(np.tile([[1.0, 3.0]], (2, 60)))
    assert alike[:, 0] == pytest.approx(3.0)
    assert (alike[:, 2:60:2] > alike[:, 1:59:2]).all()
    least = without_least(sizes).reshape(3, 80, 3)
    assert np.allclose(least.min(axis=2), 0.0)
    assert (without_least(sizes) <= sizes).all()
    waves = without_nought(sizes * np.exp(1j * np.arange(240)), 0.25)
    for part in (waves.real, waves.imag):
        assert np.abs(part).min() == pytest.approx(0.125)
        assert np.allclose(part / 0.25 - 0.5, np.rint(part / 0.25 - 0.5))


def test_first_paths_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    top, much = 70 + np.linspace(0, 1, 33), [0.0, 2.0]
    quiet = np.full(33, 0.003)
    one = splines(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, TOLD, atol=0.02)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + splines(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in much)
    assert np.allclose(deaf - sharp, 11.2, atol=0.05)
    soon, late = (first_paths(0.5 * one + splines(top + 3.4), 8 * quiet, by) for by in much)
    assert (late >= soon).all()
