"""The gasworks' world: how its tags go, which brackets call them, how tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.gasworks_shift import CALLED, OF_ROWS, RESTS, calls, walls_met
from bench.challenge.families.gasworks_yard import (
    BRACKETS,
    BRACKETS_M,
    RETORTS_M,
    SHARPENS,
    TAGS,
    TANKS_M,
    TRADES,
    Charge,
    driven,
    hauled,
    rakes,
    room_m,
    spirals,
    strolls,
    wheeled,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "gasworks")
WHEN = np.linspace(0.0, 9.0, 901)
HERE = np.array([8.0, 6.0, 1.5])


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"mid_x": 8.0, "mid_y": 6.0, "mid_z": 1.5, "bears": 0.0, "pace": 0.6, "span": 2.0}
    made |= {"curl": 0.5, "turn": 0.3} | other
    return {name: np.full(len(WHEN), one) for name, one in made.items()}


def _pace(at: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.gradient(at, WHEN, axis=0), axis=1)[5:-5]


def test_brackets_are_within_and_apart_and_nobody_is_outside_or_in_a_tank() -> None:
    assert room_m(BRACKETS_M).min() > 0.3
    apart = np.linalg.norm(BRACKETS_M[:, None] - BRACKETS_M, axis=2) + 99 * np.eye(BRACKETS)
    assert apart.min() > 3.0
    assert room_m(_known()[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy()).min() > 0.25
    in_tank = np.array([[TANKS_M[0, 0], TANKS_M[0, 1], 3.0]])
    assert room_m(in_tank)[0] == pytest.approx(-TANKS_M[0, 2])


def test_stokers_go_to_and_fro_and_further() -> None:
    off = rakes(_course(pace=2.0), WHEN) - HERE
    assert np.ptp(off[:, 0]) == pytest.approx(4.0, rel=1e-3)
    assert np.allclose(off[:, 1], 0.25 * off[:, 0])
    assert np.allclose(rakes(_course(pace=2.0), WHEN, 0.5) - HERE, 1.5 * off)


def test_barrows_keep_their_pace_and_bend_ever_more() -> None:
    for veers in (0.0, 0.1):
        off = wheeled(_course(curl=0.05), WHEN, veers) - HERE
        assert np.allclose(_pace(off), 0.6, atol=1e-3)
        heads = np.unwrap(np.arctan2(*np.gradient(off[:, :2], WHEN, axis=0).T[::-1]))
        way = 0.6 * WHEN
        law = (0.05 + veers) * way + 0.5 * SHARPENS * way**2
        assert np.allclose(heads[5:-5], law[5:-5], atol=1e-3)


def test_bells_turn_as_they_rise_and_skips_jerk_up_a_slope() -> None:
    off = spirals(_course(pace=0.15), WHEN) - HERE
    assert np.allclose(np.hypot(off[:, 0], off[:, 1]), 2.0)
    assert np.allclose(off[:, 2], 0.15 * WHEN)
    angle = np.unwrap(np.arctan2(off[:, 1], off[:, 0]))
    assert np.allclose(angle - 0.3, off[:, 2] / 0.5)
    up = hauled(_course(span=0.3), WHEN) - HERE
    assert np.allclose(up[:, 2], 0.3 * up[:, 0])
    assert np.diff(up[:, 0]).min() > 0.0  # never back, unless they surge
    assert np.diff(hauled(_course(span=0.3), WHEN, 0.9)[:, 0]).min() < 0.0


def test_lamplighters_go_in_eights_and_rams_by_a_crank() -> None:
    for cuts in (0.0, 0.4):
        off = strolls(_course(pace=0.8), WHEN, cuts) - HERE
        ahead = off[:, 0] / 2.0
        aside = off[:, 1] / 2.0 - cuts * np.sin(0.3) * np.cos(0.3)
        assert np.allclose(aside**2, (1 - cuts) ** 2 * ahead**2 * (1 - ahead**2))
    course = _course(span=1.2, curl=3.0, pace=1.0)
    out = driven(course, WHEN)[:, 0]
    assert np.ptp(out) == pytest.approx(2.4, rel=1e-3)
    assert np.ptp(driven(course, WHEN, 0.5)[:, 0]) == pytest.approx(2.4, rel=1e-3)


def test_brackets_call_by_periods_of_their_own() -> None:
    counts = np.array([5, 1, 9, 7])
    who, since_s = calls(np.random.default_rng(4), counts)
    assert np.bincount(who).tolist() == counts.tolist()
    assert since_s[0] == 0.0
    assert (np.diff(since_s) >= 0).all()
    for k in (0, 2, 3):
        gaps = np.diff(since_s[who == k])
        assert np.allclose(gaps / gaps.min(), np.rint(gaps / gaps.min()), atol=0.01)
    assert CALLED.sum() == len(OF_ROWS) == 135


def test_all_trades_work_and_some_tags_rest_for_a_charge() -> None:
    rows = _known()
    assert {*rows["trade"]} == {*rows.loc[rows["works"] > 0, "trade"]} == {*range(len(TRADES))}
    charges = rows.groupby(rows["link"].str.extract(r"charge (\d+)")[0])["works"].max()
    assert (charges == 0).sum() == RESTS
    assert rows["tx"].nunique() == BRACKETS
    assert rows["rx"].nunique() == len(TAGS)
    assert rows["environment"].nunique() == len(TRADES)
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("gasworks")


def test_ways_go_through_walls_where_they_pass_these() -> None:
    rows = _known().groupby("link").first()
    one, other = (rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("tx", "rx"))
    wall, shed = walls_met(one, other)
    passes = (one[:, 0] > RETORTS_M) != (other[:, 0] > RETORTS_M)
    assert not wall[~passes].any()
    assert 0.2 < wall[passes].mean() < 0.95
    assert {*shed} <= {0, 1, 2}
    has = {what: rows["obstacles"].map(lambda some, what=what: some.count(what)).to_numpy()
           for what in ("metal", "wood", "brick")}  # fmt: skip
    clear = has["metal"] == 0
    assert np.array_equal(has["wood"][clear], shed[clear])
    assert np.array_equal(has["brick"][clear] > 0, wall[clear])
    assert has["metal"].mean() == pytest.approx(0.15, abs=0.01)


def test_rows_know_who_is_called_by_whom_and_sight_is_free_where_nothing_stands() -> None:
    rows = _known()
    charge = Charge(rows, 0, np.random.default_rng(0))
    assert [TAGS[k] for k in charge.tag[:9]] == rows["rx"].head(9).tolist()
    assert np.allclose(charge.bracket_m, BRACKETS_M[charge.bracket])
    assert np.allclose(np.linalg.norm(charge.tag_m - charge.bracket_m, axis=1), charge.far)
    assert np.allclose(charge.longer_m(charge.bracket_m - charge.tag_m), -charge.far)
    assert np.array_equal(rows["los"].to_numpy(bool), rows["obstacles"].map(len).eq(0))
