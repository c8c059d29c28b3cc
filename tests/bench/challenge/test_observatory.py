"""The observatory: what is particular to it, and what its plates leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.observatory_effects import (
    DRIVE_M,
    FULL_A,
    MARKS_M,
    by_hoops,
)
from bench.challenge.families.observatory_faults import LEANS_RAD, LOWER, NORTH, RED
from bench.challenge.families.observatory_hall import (
    HALL_M,
    LATITUDE_RAD,
    PLACES,
    SCONCES_M,
    TAGS,
    Exposure,
)
from bench.challenge.families.observatory_night import PIERS_M, PRIMES, SLOT_S
from tests.bench.challenge import shown

_are = partial(shown.are_of, "observatory")
_nothing = partial(shown.nothing_of, "observatory")
_shift = partial(shown.shift_of, "observatory")
_tables = partial(shown.tables_of, "observatory")
_rows = partial(shown.rows_of, "observatory")
_known = partial(shown.known_of, "observatory")
_of = partial(shown.column_of, "observatory")


def _sconces() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("sconce").astype(int).to_numpy()


def _watch(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"watch (\d+)")[0]


def test_tags_stay_in_the_hall_and_a_watch_has_one_tag_and_some_sconces() -> None:
    rows = _rows()
    for axis, most in zip("xyz", HALL_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.5, most - 0.5).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > 1.8
    watches = rows.groupby(_watch(rows))
    assert watches["tx"].nunique().eq(1).all()
    assert watches["rx"].nunique().between(3, 7).all()
    assert watches["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}


def test_sconces_ask_at_every_so_manieth_slot_by_a_prime_of_their_own() -> None:
    waits = _rows().groupby("link")["time_s"].diff().dropna() / SLOT_S
    assert len(waits) > 300
    assert np.isclose(waits.to_numpy()[:, None], PRIMES).any(axis=1).all()
    assert waits.groupby(_rows()["link"]).agg(np.ptp).max() < 1e-6


def test_tubes_turn_about_the_pole_and_chairs_and_stairs_are_round() -> None:
    one = _known()
    off = one[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy() - one[["base_x", "base_y", "base_z"]]
    tubes = one["tx"].str.startswith("tube")
    pole = np.array([0.0, np.cos(LATITUDE_RAD), np.sin(LATITUDE_RAD)])
    assert np.allclose(np.linalg.norm(off[tubes], axis=1), one["arm"][tubes])
    assert np.allclose(off[tubes] @ pole, one["arm"][tubes] * np.sin(one["tilt"][tubes]))
    rounds = one["tx"].str.startswith(("chair", "climber"))
    assert np.allclose(np.hypot(*off[rounds].T.to_numpy()[:2]), one["arm"][rounds])
    assert {*zip(one["base_x"][tubes], one["base_y"][tubes], strict=True)} <= {*PIERS_M}
    rises = off["base_z"] / (one["into_s"] * one["moves"]).clip(1e-9)
    climbs = one["tx"].str.startswith("climber") & one["moves"].eq(1.0)
    assert np.allclose(rises[climbs], (one["speed"] * np.sin(one["tilt"]))[climbs])


def test_who_rests_stays_and_all_else_moves() -> None:
    rests = _known().groupby(_watch(_known()))["moves"].first().eq(0.0)
    rows = _rows()
    spread = rows.groupby(_watch(rows))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp).max(axis=1)
    assert rests.sum() == 6
    assert spread[rests].max() == 0.0
    assert spread[~rests].min() > 0.01


@pytest.mark.parametrize("column", ["error_m", "rx_power_dbm", "noise_std"])
def test_means_of_twin_draws_differ_by_either_sign_and_by_chance(column: str) -> None:
    off = []
    for seed in range(60):
        one = _nothing(seed)
        links = [t.groupby("link")[column].mean() for t in (one.recorded, one.simulated)]
        gap = links[0] - links[1]
        off.append(float(gap.mean() / (gap.std() / np.sqrt(len(gap)))))
    assert abs(np.mean(off)) < 3 / np.sqrt(60)
    assert 0.7 < np.std(off) < 1.4
    assert 18 <= np.sum(np.array(off) > 0) <= 42


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(12):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.15
            assert table["first_path_index"].between(18.5, 20.5).all()
            gap = table["rx_power_dbm"] - table["first_path_power_dbm"]
            assert gap.max() < 16


def test_other_cities_poles_and_lower_stairs_move_their_own_tags_by_no_more_than_that() -> None:
    pole, tubes = _shift("pole-set-for-another-city", 0.1), _are("tube")
    assert not pole[~tubes].any()
    assert (np.abs(pole[tubes]) <= 0.0063 * _known()["arm"][tubes] + 1e-9).all()
    stairs, own = _shift("stairs-of-a-lower-rise", 0.1), _are("climber")
    assert not stairs[~own].any()
    assert (np.abs(stairs) <= 0.1 * LOWER * _of("tx_z_m") + 1e-9).all()
    higher = _of("tx_z_m") > _of("rx_z_m")
    assert (stairs[own & higher] < 1e-3).all()
    assert (stairs[own & ~higher] > 0).all()


def test_red_lamps_warm_their_own_sconces_and_a_wall_that_leans_moves_its_own() -> None:
    red = np.isin(_sconces(), RED)
    assert np.allclose(_shift("red-lamps-warm-their-sconces"), red * 0.0062 * _of("lamp_w"))
    assert 0.2 < red.mean() < 0.7
    shift, own = _shift("north-wall-leans-out", 0.1), np.isin(_sconces(), NORTH)
    assert not shift[~own].any()
    out = 0.1 * LEANS_RAD * _of("rx_z_m")
    north = (_of("rx_y_m") - _of("tx_y_m")) / _of("true_range_m")
    assert np.allclose(shift[own], (out * north)[own], atol=1e-4)


def test_mist_is_of_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("mist-comes-in-by-the-slit")
    assert np.allclose(shift, 0.46 * (_of("damp_pct") / 100) ** 2 * _of("slit_deg") / 100)
    for name in ("damp_pct", "slit_deg"):
        assert abs(np.corrcoef(shift, _of(name))[0, 1]) < 0.97


def test_dew_comes_to_an_end_and_tarnish_does_not() -> None:
    dew = _shift("dew-films-sconces")
    assert np.allclose(-np.log1p(-dew / 0.2), _of("dew_um") / 45.0)
    tarnish = _shift("silvering-tarnishes")
    assert np.allclose(np.expm1(tarnish / 0.074), _of("tarnish_nm") / 2.2)
    slit = _shift("slit-stands-wide-open")
    assert np.allclose(slit, np.where(_of("slit_deg") > 58.0, 0.092, 0.0))


def test_levels_fall_and_noise_rises_where_they_should() -> None:
    for name, low, high in (("path-loss", -6.5, -2.0), ("level-control", -3.0, -1.0)):
        made = _tables(name)
        lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
        assert low < lost.mean() < high
        assert not _shift(name).any()
    made = _tables("path-loss")
    lost = (made.clean["rx_power_dbm"] - made.recorded["rx_power_dbm"]).to_numpy()
    amid = pd.Series(lost / np.arcsinh(_of("true_range_m") / 7.0))
    assert amid.groupby(_rows()["link"]).agg(np.ptp).max() < 0.5


def test_marks_of_dials_are_as_far_apart_but_begin_elsewhere_at_each_sconce() -> None:
    made = _tables("range-rounding")
    part = np.exp(2j * np.pi * made.recorded["range_m"].to_numpy() / MARKS_M)
    begins = [part[_sconces() == k] for k in range(len(SCONCES_M))]
    assert max(np.abs(one - one[0]).max() for one in begins) < 1e-6
    assert np.std(np.angle([one[0] for one in begins])) > 0.5
    assert np.abs(made.recorded["range_m"] - made.clean["range_m"]).max() <= MARKS_M / 2 + 1e-9


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("observatory", 0.449)
    assert np.mean(late > 4.79) < 0.3


def test_hoops_return_something_that_is_late_enough_to_every_row() -> None:
    more = by_hoops(Exposure(_known(), 0, np.random.default_rng(0)))
    assert (more > 0.46).all()
    assert np.isfinite(more).all()
    assert np.median(more) < 6.0


def test_the_drive_is_heard_by_near_sconces_and_by_a_power_of_what_it_draws() -> None:
    made, part = _tables("noise-floor"), (_of("dome_a") / FULL_A) ** 1.6
    db = 20 * np.log10((made.recorded["noise_std"] / made.clean["noise_std"]).to_numpy())
    slopes = [np.polyfit(part[own], db[own], 1)[0] for own in np.eye(12, dtype=bool)[:, _sconces()]]
    apart = np.linalg.norm(SCONCES_M - DRIVE_M, axis=1)
    assert np.allclose(slopes * (1 + (apart / 13.0) ** 2), 8.8)


def test_symbols_that_are_not_counted_take_their_noise_with_them() -> None:
    made = _tables("level-control")
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert 0.35 < counts.min() < 0.75
    assert counts.max() <= 1.0


def test_crystals_are_off_by_cubics_of_warmth_that_tags_have() -> None:
    shift = _shift("clock-offset") / _of("reply_time_s")
    warm = (_of("temperature_c") - 25.0) / 20.0
    for tag in TAGS:
        own = (_rows()["tx"] == tag).to_numpy()
        columns = [warm, *np.eye(len(SCONCES_M))[_sconces()].T]
        rest = shift - 149.896229 * 0.022 * 0.35 * warm**3
        found = np.linalg.lstsq(np.column_stack(columns)[own], rest[own], rcond=None)[0]
        assert np.allclose(np.column_stack(columns)[own] @ found, rest[own], atol=1e-9)
