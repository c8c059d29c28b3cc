"""The ropewalk: what is particular to it, and how its tables are drawn."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import ks_2samp

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.ropewalk import (
    CAUSES,
    STRAIGHT,
    STRUT_DB,
    TAG_DB,
    freaks,
    wide_m,
)
from bench.challenge.families.ropewalk_faults import open_dbm
from bench.challenge.families.ropewalk_shift import (
    NEAREST_M,
    ROUND_S,
    ROUNDS,
    SWINGS,
    begun_s,
    called,
)
from bench.challenge.families.ropewalk_walk import (
    CRADLE,
    HALL_M,
    LAY_M,
    PLACES,
    REACH,
    STRUTS,
    STRUTS_M,
    TAGS,
    Hank,
    drawn_in,
    laid,
    spun,
    wheeled,
    within_m,
    wound_up,
)
from tests.bench.challenge import shown

_nothing: Any = partial(shown.nothing_of, "ropewalk")
_tables = partial(shown.tables_of, "ropewalk")
_rows = partial(shown.rows_of, "ropewalk")
_known = partial(shown.known_of, "ropewalk")
WHEN = np.linspace(0.0, 6.0, 2401)


def _hank() -> Hank:
    return Hank(_known(), 0, np.random.default_rng(0))


def _strand(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"strand (\d+)")[0]


def _course(**more: float) -> dict[str, np.ndarray]:
    names = ("east", "north", "up", "pace", "size", "turn")
    return {"heads": np.ones(len(WHEN))} | {
        name: np.full(len(WHEN), more.get(name, 0.0)) for name in names
    }


def test_spinners_weave_by_a_sine_of_their_way_and_yarn_that_is_taken_up_is_shorter() -> None:
    course = _course(pace=1.2, size=0.6, turn=5.0, up=1.1)
    there = spun(course, WHEN)
    assert np.allclose(there[:, 0], 1.2 * WHEN)
    assert np.allclose(there[:, 1], 0.6 * np.sin(2 * np.pi * there[:, 0] / 5.0))
    less = there[:, 0] - spun(course, WHEN, 0.05)[:, 0]
    assert np.allclose(np.gradient(less, there[:, 0])[2:-2], 0.05 * there[2:-2, 0])


def test_sledges_are_as_far_as_a_helix_of_their_strand_is_long() -> None:
    there = drawn_in(_course(pace=1.1, size=20.0, turn=3.0), WHEN)
    left = np.sqrt(20.0**2 - (1.1 * 3.0) ** 2) - there[:, 0]
    assert np.allclose(left**2 + (1.1 * (3.0 + WHEN)) ** 2, 20.0**2)
    sooner = drawn_in(_course(pace=1.1, size=20.0, turn=3.0), WHEN, 0.2)
    assert sooner[0, 0] == there[0, 0] == 0.0
    assert (np.diff(sooner[:, 0] - there[:, 0]) > 0).all()


def test_tops_tags_turn_once_a_lay_and_bobbins_against_their_discs() -> None:
    there = laid(_course(pace=1.2, size=0.4, turn=0.5, up=1.3), WHEN)
    assert np.allclose(np.hypot(there[:, 1], there[:, 2] - 1.3), 0.4)
    angle = np.unwrap(np.arctan2(there[:, 2] - 1.3, there[:, 1]))
    assert np.allclose(np.gradient(angle, there[:, 0]), 2 * np.pi / LAY_M)
    there = wheeled(_course(pace=1.0, size=0.9, turn=0.3), WHEN)
    disc = 0.9 * np.column_stack([np.cos(0.3 + WHEN), np.sin(0.3 + WHEN)])
    arm = there[:, 1:] - disc
    assert np.allclose(np.hypot(*arm.T), 0.9 * REACH)
    turned = np.unwrap(np.arctan2(arm[:, 1], arm[:, 0]))
    assert np.allclose(np.gradient(turned, WHEN), CRADLE)


def test_trucks_go_from_rest_to_rest_and_stay() -> None:
    way = wound_up(_course(size=9.0, turn=4.0), WHEN)[:, 0]
    speed = np.gradient(way, WHEN)
    assert way[-1] == pytest.approx(9.0)
    assert speed.max() == pytest.approx(2 * 9.0 / 4.0, rel=1e-3)
    assert np.abs(speed[[0, -1]]).max() < 1e-3
    assert (np.diff(way) >= 0).all()


def test_tags_stay_in_the_hall_and_a_strand_has_one_tag_and_some_struts() -> None:
    rows = _rows()
    tags, struts = (rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("rx", "tx"))
    assert within_m(tags).min() > 0.4
    assert within_m(struts).min() >= 0.4
    assert within_m(np.array([[-1.0, 4.0, 2.0]]))[0] == -1.0
    for axis, most in zip("xyz", HALL_M, strict=True):
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > NEAREST_M - 0.1
    strands = rows.groupby(_strand(rows))
    assert strands["rx"].nunique().eq(1).all()
    assert strands["tx"].nunique().between(2, 7).all()
    assert strands["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["rx"]} == {*TAGS}
    assert rows["tx"].nunique() == STRUTS == len(STRUTS_M)


def test_rounds_are_uneven_and_no_two_struts_call_at_once() -> None:
    begun = begun_s(np.arange(float(ROUNDS)))
    gaps = np.diff(begun)
    assert gaps.min() > 0.45 * ROUND_S
    assert gaps.max() < 1.6 * ROUND_S
    assert np.abs(begun - ROUND_S * np.arange(ROUNDS)).max() <= SWINGS * ROUND_S
    lengths = np.array([4, 12, 1, 5, 9, 2, 7])
    who, since_s = called(np.random.default_rng(3), lengths)
    assert np.bincount(who).tolist() == lengths.tolist()
    assert np.diff(since_s).min() > 0.01 * ROUND_S
    assert since_s.max() < (ROUNDS + 1) * ROUND_S
    assert np.ptp(np.diff(since_s[who == 1])) > 0.2 * ROUND_S


def test_who_rests_stays_and_all_else_moves_as_fast_as_such_things_do() -> None:
    rows = _known()
    still = rows.groupby(_strand(rows))["goes"].first().eq(0.0)
    spread = _rows().groupby(_strand(_rows()))[["rx_x_m", "rx_y_m", "rx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).median() > 0.3
    hank = _hank()
    fast = np.abs(hank.pays_out(0.001)) / 0.001
    assert fast.max() < 3.6
    assert fast[hank.of("sledge")].max() < 2.0
    assert fast[hank.of("bobbin")].max() < 1.3 * 1.15 * (1 - CRADLE * REACH)


def test_freaks_scatter_by_one_and_some_are_large() -> None:
    made = freaks(np.random.default_rng(4), 200_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert made.mean() == pytest.approx(0.0, abs=0.01)
    assert (made**4).mean() == pytest.approx(3 * 1.2, rel=0.05)


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(5):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.1
            assert table["first_path_index"].between(19.0, 20.0).all()
            assert (table["rx_power_dbm"] - table["first_path_power_dbm"]).max() < 18


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
def test_nothing_hidden_is_equal_in_law_in_any_draw(mode: str) -> None:
    """Paired or not, at any ratio: of all that is measured, and of first paths' parts of it."""
    world: Any = world_of("ropewalk", mode)
    for drawn in (Draw(ratio=3), Draw(ratio=1, paired=False), Draw(ratio=1, concealed="scatter")):
        made = [world.tables(drawn, seed) for seed in range(6, 12)]
        for column in ("error_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
                       "preamble_count"):  # fmt: skip
            sides: list[Any] = [
                np.concatenate([getattr(one, side).groupby("link")[column].first() for one in made])
                for side in ("recorded", "simulated")
            ]
            assert ks_2samp(*sides).pvalue > 0.002, (drawn, column)


def test_another_mix_has_the_same_law_given_how_far_it_is() -> None:
    """Levels over those in the open, and errors, are alike though distances are not."""
    world: Any = world_of("ropewalk")
    made = [world.tables(Draw(ratio=1, paired=False, same_mix=False), s) for s in range(8)]
    over: list[Any] = []
    error: list[Any] = []
    for side in ("recorded", "simulated"):
        first = pd.concat([getattr(one, side).groupby("link").first() for one in made])
        hank = Hank(first.reset_index(), 0, np.random.default_rng(0))
        own = open_dbm(hank.far) + STRUT_DB[hank.strut] + TAG_DB[hank.tag]
        over.append(hank["rx_power_dbm"] - own)
        error.append(hank["error_m"] / wide_m(hank["rx_power_dbm"]))
    assert ks_2samp(*over).pvalue > 0.002
    assert ks_2samp(*error).pvalue > 0.002


def test_deaf_telltales_lose_more_first_paths_the_deafer_they_are() -> None:
    world: Any = world_of("ropewalk", "CIR")
    sizes = []
    for strength in (0.25, 0.5, 1.0, 2.0):
        late = []
        for seed in range(3):
            made = world.tables(Draw(("late-detection",), strength, 1), seed)
            later = made.recorded["error_m"] - made.clean["error_m"]
            assert (later > 0.3).mean() < 0.35
            assert (later >= -1e-9).all()
            late.append(later.mean())
        sizes.append(np.mean(late))
    assert (np.diff(sizes) > 0).all()
    assert sizes[2] > 0.04


def test_what_comes_straight_is_as_large_a_part_with_waveforms_as_without() -> None:
    part, off = [], []
    for seed in range(6):
        rows = _nothing(seed, "CIR").recorded
        hank = Hank(rows, 0, np.random.default_rng(0))
        gap = rows["rx_power_dbm"] - rows["first_path_power_dbm"]
        part.append((10 ** (-gap / 10)).mean())
        own = open_dbm(hank.far) + STRUT_DB[hank.strut] + TAG_DB[hank.tag]
        off.append((rows["rx_power_dbm"] - own)[hank.behind("metal") == 0].mean())
    assert np.mean(part) == pytest.approx(STRAIGHT, abs=0.025)
    assert np.mean(off) == pytest.approx(0.0, abs=0.35)


@pytest.mark.parametrize(
    "name", ["antenna-delay", "clock-offset", "north-row-taped-from-the-outer-face"]
)
def test_waveforms_and_ranges_carry_the_same(name: str) -> None:
    """What devices, clocks and surveys do to ranges is a law of rows, whatever else is kept."""
    ranges, waves = (_tables(name, mode=mode) for mode in ("ranges", "CIR"))
    sizes = [float(np.abs(t.recorded["error_m"] - t.clean["error_m"]).mean())
             for t in (ranges, waves)]  # fmt: skip
    assert sizes[0] == pytest.approx(sizes[1], rel=0.5)
    assert all(map(np.array_equal, waves.recorded["cir"], waves.clean["cir"]))


def test_in_the_clean_tables_nothing_goes_by_what_is_logged() -> None:
    """Over 20 days, errors go with no column more than chance has it."""
    made = [_nothing(seed) for seed in range(20)]
    first: pd.DataFrame = pd.concat(
        [t.groupby("link").first() for one in made for t in (one.recorded, one.simulated)]
    )
    for column in {*CAUSES.values()} - {"time_s", "true_range_m"}:
        by = np.corrcoef(first["error_m"], first[column])[0, 1]
        assert abs(by) * np.sqrt(len(first)) < 3.9, column
