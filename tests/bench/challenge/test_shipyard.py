"""The shipyard: what is particular to it, and how its tables are drawn."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.stats import ks_2samp

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.shipyard import (
    CAUSES,
    DERRICK_DB,
    STRAIGHT,
    TAG_DB,
    dithered,
    whims,
    wide_m,
)
from bench.challenge.families.shipyard_faults import open_dbm
from bench.challenge.families.shipyard_slip import (
    AT_FLANGE,
    DECLINES,
    DERRICKS,
    DERRICKS_M,
    DOCK_M,
    PLACES,
    TAGS,
    TANK_M,
    TANKS_M,
    Berth,
    inside_m,
    rolled_on,
    run_down,
    towed,
    walked_off,
)
from bench.challenge.families.shipyard_tide import NEAREST_M, ROUND_S, ROUNDS, RULER, rung
from tests.bench.challenge import shown

_nothing: Any = partial(shown.nothing_of, "shipyard")
_tables = partial(shown.tables_of, "shipyard")
_rows = partial(shown.rows_of, "shipyard")
_known = partial(shown.known_of, "shipyard")


def _berth() -> Berth:
    return Berth(_known(), 0, np.random.default_rng(0))


def _job(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"job (\d+)")[0]


def _course(count: int, **more: float) -> dict[str, np.ndarray]:
    names = ("east", "north", "up", "bears", "pace", "size", "begins")
    return {name: np.full(count, more.get(name, 0.0)) for name in names}


def test_cradles_are_pulled_evenly_and_held_by_the_square_of_their_speed() -> None:
    when = np.linspace(0.0, 5.0, 2001)
    there = run_down(_course(2001, pace=2.5, size=0.9, bears=0.7, up=2.0), when)
    way = np.hypot(there[:, 0], there[:, 1])
    speed = np.gradient(way, when)
    pulled = np.gradient(speed, when)[3:-3]
    assert np.allclose(pulled, 0.9 * (1 - (speed[3:-3] / 2.5) ** 2), atol=2e-3)
    assert np.allclose(2.0 - there[:, 2], DECLINES * way)
    assert np.allclose(there[1:, 1] / there[1:, 0], np.tan(0.7))


def test_drums_tags_are_at_rest_with_what_they_roll_on_but_for_how_far_in_they_are() -> None:
    when = np.linspace(0.0, 8.0, 4001)
    course = _course(4001, pace=1.1, size=0.8, begins=0.5)
    there = rolled_on(course, when)
    speed = np.linalg.norm(np.gradient(there, when, axis=0), axis=1)[2:-2]
    assert speed.min() == pytest.approx(1.1 * (1 - AT_FLANGE), rel=1e-3)
    assert speed.max() == pytest.approx(1.1 * (1 + AT_FLANGE), rel=1e-3)
    assert there[:, 2].max() == pytest.approx(0.8 * (1 + AT_FLANGE), rel=1e-4)
    hub = np.column_stack([1.1 * when, 0 * when, np.full(4001, 0.8)])
    for thinner in (0.0, 0.2):
        arm = np.linalg.norm(rolled_on(course, when, thinner) - hub, axis=1)
        assert np.allclose(arm, 0.8 * AT_FLANGE)


def test_haulers_walk_at_even_pace_on_lines_that_leave_a_circle_straight() -> None:
    when = np.linspace(0.0, 5.0, 2001)
    there = walked_off(_course(2001, pace=1.4, size=0.7, begins=2.0, bears=0.3), when)[:, :2]
    step = np.gradient(there, when, axis=0)[2:-2]
    assert np.allclose(np.hypot(*step.T), 1.4, rtol=1e-4)
    line = np.sqrt((there**2).sum(axis=1) - 0.7**2)  # from where it leaves the capstan
    assert np.allclose(line**2 - line[0] ** 2, 2 * 0.7 * 1.4 * when)
    toward = (there[2:-2] * step).sum(axis=1)  # square to the line: what is left is the circle's
    assert np.allclose(toward / 1.4, 0.7, atol=1e-3)


def test_punts_are_as_far_as_their_line_is_long_from_who_tows_and_go_toward_him() -> None:
    when = np.linspace(0.0, 4.0, 2001)
    there = towed(_course(2001, pace=1.5, size=4.0, begins=0.6), when)[:, :2]
    tows = np.column_stack([0.6 * 4.0 + 1.5 * when, 0 * when])
    line = tows - there
    assert np.allclose(np.hypot(*line.T), 4.0)
    step = np.gradient(there, when, axis=0)[2:-2]
    cross = step[:, 0] * line[2:-2, 1] - step[:, 1] * line[2:-2, 0]
    assert np.abs(cross).max() < 1e-4


def test_tags_stay_in_the_dock_and_a_job_has_one_tag_and_some_derricks() -> None:
    rows = _rows()
    assert inside_m(rows["tx_x_m"].to_numpy(), rows["tx_y_m"].to_numpy()).min() > 0.7
    assert inside_m(*DERRICKS_M[:, :2].T).min() > 1.5
    for axis, most in zip("xyz", DOCK_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.05, most).all()
        assert rows[f"rx_{axis}_m"].between(1.5, most).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > NEAREST_M - 0.1
    jobs = rows.groupby(_job(rows))
    assert jobs["tx"].nunique().eq(1).all()
    assert jobs["rx"].nunique().between(2, 7).all()
    assert jobs["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}
    assert rows["rx"].nunique() == DERRICKS
    for end in ("tx", "rx"):
        at = rows[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy()
        assert np.linalg.norm(at[:, None] - TANKS_M, axis=2).min() > TANK_M


def test_no_two_derricks_answer_at_once_and_gaps_are_those_of_a_golomb_ruler() -> None:
    gaps = [b - a for k, a in enumerate(RULER) for b in RULER[k + 1 :]]
    assert len(gaps) == len({*gaps})
    lengths = np.array([4, 11, 1, 5, 12, 14, 7])
    who, since_s = rung(np.random.default_rng(3), lengths)
    assert np.bincount(who).tolist() == lengths.tolist()
    assert np.diff(since_s).min() > 0.9 * ROUND_S / 30
    assert since_s.max() < ROUNDS * ROUND_S
    at = since_s[who == 5] / ROUND_S
    assert len({*np.round(np.diff(at), 6)}) > 4


def test_who_rests_stays_and_all_else_moves_as_fast_as_such_things_do() -> None:
    rows = _known()
    still = rows.groupby(_job(rows))["goes"].first().eq(0.0)
    spread = _rows().groupby(_job(_rows()))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).median() > 0.3
    berth = _berth()
    fast = np.abs(berth.hauls_off(0.001)) / 0.001
    assert fast.max() < 3.4
    assert fast[berth.of("drum")].max() < 1.3 * (1 + AT_FLANGE)
    assert fast[berth.of("punt")].max() < 2.0


def test_odds_are_carried_on_and_whims_scatter_by_one() -> None:
    taken = dithered(np.full(40, 0.3))
    assert taken.sum() == 12
    assert {*np.diff(np.flatnonzero(taken))} <= {3, 4}
    assert dithered(np.array([1.0, 1.0, 0.5, 0.5, 0.0, 1.0])).sum() == 4
    made = whims(np.random.default_rng(4), 200_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert made.mean() == pytest.approx(0.0, abs=0.01)
    assert (made**4).mean() == pytest.approx(4.2, rel=0.05)


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(5):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(20.0, 21.0).all()
            assert (table["rx_power_dbm"] - table["first_path_power_dbm"]).max() < 18


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
def test_nothing_hidden_is_equal_in_law_in_any_draw(mode: str) -> None:
    """Paired or not, at any ratio: of all that is measured, and of first paths' parts of it."""
    world: Any = world_of("shipyard", mode)
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
    world: Any = world_of("shipyard")
    made = [world.tables(Draw(ratio=1, paired=False, same_mix=False), s) for s in range(8)]
    over: list[Any] = []
    error: list[Any] = []
    far = []
    for side in ("recorded", "simulated"):
        first = pd.concat([getattr(one, side).groupby("link").first() for one in made])
        first = first.reset_index()
        berth = Berth(first, 0, np.random.default_rng(0))
        own = open_dbm(berth.far) + DERRICK_DB[berth.derrick] + TAG_DB[berth.tag]
        over.append(first["rx_power_dbm"] - own)
        error.append(first["error_m"] / wide_m(berth["rx_power_dbm"]))
        far.append(first["true_range_m"].mean())
    assert far[1] > 1.2 * far[0]
    assert ks_2samp(*over).pvalue > 0.002
    assert ks_2samp(*error).pvalue > 0.002


def test_deaf_lookouts_lose_some_first_paths_on_any_day_and_more_the_deafer_they_are() -> None:
    world: Any = world_of("shipyard", "CIR")
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
        berth = Berth(rows, 0, np.random.default_rng(0))
        gap = rows["rx_power_dbm"] - rows["first_path_power_dbm"]
        part.append((10 ** (-gap / 10)).mean())
        own = open_dbm(berth.far) + DERRICK_DB[berth.derrick] + TAG_DB[berth.tag]
        off.append((rows["rx_power_dbm"] - own)[berth.behind("metal") == 0].mean())
    assert np.mean(part) == pytest.approx(STRAIGHT, abs=0.025)
    assert np.mean(off) == pytest.approx(0.0, abs=0.3)


@pytest.mark.parametrize(
    "name", ["antenna-delay", "clock-offset", "heights-told-above-a-raking-keel"]
)
def test_waveforms_and_ranges_carry_the_same(name: str) -> None:
    """What devices, clocks and plans do to ranges is a law of rows, whatever else is kept."""
    ranges, waves = (_tables(name, mode=mode) for mode in ("ranges", "CIR"))
    sizes = [float(np.abs(t.recorded["error_m"] - t.clean["error_m"]).mean())
             for t in (ranges, waves)]  # fmt: skip
    assert sizes[0] == pytest.approx(sizes[1], rel=0.5)
    assert all(map(np.array_equal, waves.recorded["cir"], waves.clean["cir"]))


def test_in_the_clean_tables_nothing_goes_by_what_is_logged() -> None:
    """Over 20 days, errors go with no column more than chance has it."""
    made = [_nothing(seed) for seed in range(20)]
    columns = {c for c in CAUSES.values() if c not in ("time_s", "true_range_m")}
    first: pd.DataFrame = pd.concat(
        [t.groupby("link").first() for one in made for t in (one.recorded, one.simulated)]
    )
    for column in columns:
        by = np.corrcoef(first["error_m"], first[column])[0, 1]
        assert abs(by) * np.sqrt(len(first)) < 3.9, column
