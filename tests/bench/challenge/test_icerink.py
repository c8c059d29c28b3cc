"""The ice rink: what is particular to it, and how large what it hides is."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import ks_2samp

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.icerink import CAUSES, MULLION_DB, STRAIGHT, TAG_DB
from bench.challenge.families.icerink_faults import (
    open_dbm,
)
from bench.challenge.families.icerink_rink import (
    AMID_M,
    CORNER_M,
    HALF_M,
    HALL_M,
    MULLIONS,
    MULLIONS_M,
    PLACES,
    TAGS,
    Period,
    at_rebound,
    glided,
    in_hold,
    off_boards,
    on_lap,
    rebounded,
    slid_m,
)
from bench.challenge.families.icerink_session import NEAREST_M, PRIME, ROUND_S, SLOT_S, answered
from tests.bench.challenge import shown

_are = partial(shown.are_of, "icerink")
_nothing: Any = partial(shown.nothing_of, "icerink")
_shift = partial(shown.shift_of, "icerink")
_tables = partial(shown.tables_of, "icerink")
_rows = partial(shown.rows_of, "icerink")
_known = partial(shown.known_of, "icerink")
_of = partial(shown.column_of, "icerink")


def _period() -> Period:
    return Period(_known(), 0, np.random.default_rng(0))


def _heat(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"heat (\d+)")[0]


def _course(count: int, **more: float) -> dict[str, np.ndarray]:
    names = ("east", "north", "tall", "heads", "pace", "bends", "slows", "spans")
    return {name: np.full(count, more.get(name, 0.0)) for name in names}


def test_skaters_are_slowed_by_squares_and_lean_as_before() -> None:
    when = np.linspace(0.0, 4.0, 801)
    course = _course(801, pace=3.0, slows=12.0, bends=0.4, heads=0.7)
    step = np.gradient(np.stack(glided(course, when), axis=1), when, axis=0)[2:-2]
    speed, turned = np.hypot(*step.T), np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    assert np.allclose(1 / speed, (1 + when[2:-2] / 12.0) / 3.0, rtol=1e-3)
    pull = speed[2:-2] * np.gradient(turned, when[2:-2])[2:-2]  # v times turn: g tan of the lean
    assert np.allclose(pull, 0.4 * 3.0, rtol=1e-3)


def test_penguins_rub_evenly_until_they_stand_and_rebound_as_they_came() -> None:
    when = np.linspace(0.0, 9.0, 901)
    slid = slid_m(_course(901, pace=2.0, slows=0.4), when)
    assert slid[-1] == pytest.approx(2.0**2 / (2 * 0.4))
    assert np.allclose(np.diff(slid, 2)[:490], -0.4 * when[1] ** 2)
    assert np.allclose(rebounded(np.array([1.0, 5.0, 6.5, 11.0]), 2.0, 6.0), [3.0, 5.0, 5.5, 3.0])
    there = at_rebound(_course(901, east=60.0, north=30.0, heads=0.6), np.linspace(0.0, 12.0, 901))
    step = np.linalg.norm(np.diff(there, axis=0), axis=1)
    assert np.median(step) == pytest.approx(12.0 / 900)
    assert there[:, 0].max() < AMID_M[0] + HALF_M[0] - 0.59


def test_laps_run_along_the_boards_at_even_pace_and_close() -> None:
    for spans in (1.0, 4.0):
        long = 2 * (2 * HALF_M[0] - 2 * CORNER_M) + 2 * (2 * HALF_M[1] - 2 * CORNER_M)
        long += 2 * np.pi * (CORNER_M - spans)
        course = _course(1501, pace=2.0, spans=spans, east=17.0)
        there = on_lap(course, np.linspace(0.0, long / 2.0, 1501))
        assert np.allclose(there[0], there[-1], atol=1e-6)
        assert np.allclose(off_boards(there[:, 0], there[:, 1]), spans)
        steps = np.linalg.norm(np.diff(there, axis=0), axis=1)
        assert np.allclose(steps, long / 1500, rtol=1e-3)


def test_who_is_drawn_in_keeps_the_spin() -> None:
    when = np.linspace(0.0, 4.0, 2001)
    there = in_hold(_course(2001, pace=1.2, slows=16.0, spans=1.5), when)[:, :2]
    step = np.gradient(there, when, axis=0)
    spin = there[:, 0] * step[:, 1] - there[:, 1] * step[:, 0]
    assert np.allclose(spin[2:-2], 1.2 * 1.5**2, rtol=1e-3)


def test_boards_are_as_far_as_they_are() -> None:
    x = AMID_M[0] + np.array([0.0, HALF_M[0], HALF_M[0] + 2.0, HALF_M[0]])
    y = AMID_M[1] + np.array([0.0, 0.0, 0.0, HALF_M[1]])
    corner = CORNER_M - np.sqrt(2) * CORNER_M
    assert np.allclose(off_boards(x, y), [HALF_M[1], 0.0, -2.0, corner])


def test_tags_stay_on_the_ice_and_a_heat_has_one_tag_and_some_mullions() -> None:
    rows = _rows()
    assert off_boards(rows["tx_x_m"].to_numpy(), rows["tx_y_m"].to_numpy()).min() > 0.4
    assert off_boards(MULLIONS_M[:11, 0], MULLIONS_M[:11, 1]).max() < 0
    for axis, most in zip("xyz", HALL_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.3, most).all()
        assert rows[f"rx_{axis}_m"].between(0.9, most - 0.9).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > NEAREST_M - 0.1
    heats = rows.groupby(_heat(rows))
    assert heats["tx"].nunique().eq(1).all()
    assert heats["rx"].nunique().between(2, 7).all()
    assert heats["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}
    kinds = rows.groupby("rx")["environment"].nunique()
    assert len(kinds) == MULLIONS
    assert kinds.median() > 2


def test_no_two_mullions_answer_at_once_and_their_slots_change_from_round_to_round() -> None:
    lengths = np.array([4, 11, 1, 5, 13, 16])
    which, since_s = answered(np.random.default_rng(3), lengths)
    assert np.bincount(which).tolist() == lengths.tolist()
    assert np.diff(since_s).min() > 0.4 * SLOT_S
    for number, length in enumerate(lengths):
        at = since_s[which == number] - since_s[which == number][0]
        assert len(at) == length
        assert at[-1] < PRIME * ROUND_S
    busy = since_s[which == 5]
    assert np.diff(busy).std() > SLOT_S  # seldom as long after as before


def test_who_rests_stays_and_all_else_moves_as_fast_as_such_things_are() -> None:
    rows = _known()
    still = rows.groupby(_heat(rows))["goes"].first().eq(0.0)
    spread = _rows().groupby(_heat(_rows()))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).median() > 0.3
    period = _period()
    fast = np.abs(period.skates_off(0.001)) / 0.001
    assert fast.max() < 4.0
    assert fast[period.are("resurfacer")].max() < 2.7
    assert fast[period.are("penguin")].max() < 3.5


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(5):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(17.0, 18.0).all()
            assert (table["rx_power_dbm"] - table["first_path_power_dbm"]).max() < 18


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
def test_nothing_hidden_is_equal_in_law_in_any_draw(mode: str) -> None:
    """Paired or not, at any ratio: of all that is measured, and of first paths' parts of it."""
    world: Any = world_of("icerink", mode)
    for drawn in (Draw(ratio=3), Draw(ratio=1, paired=False), Draw(ratio=1, concealed="scatter")):
        made = [world.tables(drawn, seed) for seed in range(6)]
        for column in ("error_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
                       "preamble_count"):  # fmt: skip
            sides: list[Any] = [
                np.concatenate([getattr(one, side).groupby("link")[column].first() for one in made])
                for side in ("recorded", "simulated")
            ]
            assert ks_2samp(*sides).pvalue > 0.002, (drawn, column)


def test_another_mix_has_the_same_law_given_how_far_it_is() -> None:
    """Levels over those in the open, and errors, are alike though distances are not."""
    world: Any = world_of("icerink")
    made = [world.tables(Draw(ratio=1, paired=False, same_mix=False), s) for s in range(8)]
    rows = [pd.concat([getattr(one, side).assign(case=k) for k, one in enumerate(made)])
            for side in ("recorded", "simulated")]  # fmt: skip
    over: list[Any] = []
    error: list[Any] = []
    for table in rows:
        first = table.groupby(["case", "link"]).first().reset_index()
        period = Period(first, 0, np.random.default_rng(0))
        own = open_dbm(period.far) + MULLION_DB[period.mullion] + TAG_DB[period.tag]
        level = first["rx_power_dbm"] - own
        over.append(level)
        wide = np.hypot(0.0125, 0.008 * 10 ** ((-90.0 - first["rx_power_dbm"]) / 20).clip(upper=3))
        error.append(first["error_m"] / np.hypot(wide, 0.009 / np.sqrt(3)))
    assert rows[1]["true_range_m"].mean() > 1.2 * rows[0]["true_range_m"].mean()
    assert ks_2samp(*over).pvalue > 0.002
    assert ks_2samp(*error).pvalue > 0.002


def test_deaf_timers_lose_some_first_paths_on_any_day_and_more_the_deafer_they_are() -> None:
    world: Any = world_of("icerink", "CIR")
    sizes = []
    for strength in (0.25, 0.5, 1.0, 2.0):
        late = []
        for seed in range(4):
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
        period = Period(rows, 0, np.random.default_rng(0))
        gap = rows["rx_power_dbm"] - rows["first_path_power_dbm"]
        part.append((10 ** (-gap / 10)).mean())
        own = open_dbm(period.far) + MULLION_DB[period.mullion] + TAG_DB[period.tag]
        off.append((rows["rx_power_dbm"] - own)[period.through("metal") == 0].mean())
    assert np.mean(part) == pytest.approx(STRAIGHT, abs=0.025)
    assert np.mean(off) == pytest.approx(0.0, abs=0.3)


@pytest.mark.parametrize("name", ["antenna-delay", "clock-offset", "resurfacers-lap-further-in"])
def test_waveforms_and_ranges_carry_the_same(name: str) -> None:
    """What devices, clocks and courses do to ranges is a law of rows, whatever else is kept."""
    ranges, waves = (_tables(name, mode=mode) for mode in ("ranges", "CIR"))
    sizes = [float(np.abs(t.recorded["error_m"] - t.clean["error_m"]).mean())
             for t in (ranges, waves)]  # fmt: skip
    assert sizes[0] == pytest.approx(sizes[1], rel=0.5)
    assert all(map(np.array_equal, waves.recorded["cir"], waves.clean["cir"]))


def test_in_the_clean_tables_nothing_goes_by_what_is_noted() -> None:
    """Over 20 days, errors go with no column more than chance has it."""
    made = [_nothing(seed) for seed in range(20)]
    columns = {c for c in CAUSES.values() if c not in ("time_s", "true_range_m")}
    first: pd.DataFrame = pd.concat(
        [t.groupby("link").first() for one in made for t in (one.recorded, one.simulated)]
    )
    for column in columns:
        by = np.corrcoef(first["error_m"], first[column])[0, 1]
        assert abs(by) * np.sqrt(len(first)) < 3.9, column
