"""The mint's world: how its tags go, which quoins call them, how tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.mint_court import (
    COURT_M,
    KINDS,
    QUOINS,
    QUOINS_M,
    carries,
    flies,
    inside_m,
    looks_in,
    rides,
    runs,
    unwinds,
)
from bench.challenge.families.mint_turns import (
    AFTER_S,
    BEAT_S,
    CALLS,
    OF_ROWS,
    RESTS,
    STRIKES,
    called,
    over_the_court,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "mint")
WHEN = np.linspace(0.0, 8.0, 801)
HERE = np.array([8.0, 6.0, 1.5])


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"mid_x": 8.0, "mid_y": 6.0, "mid_z": 1.5, "bears": 0.0, "fast": 0.8, "size": 2.0}
    made |= {"second": 0.5, "begins": 0.3} | other
    return {name: np.full(len(WHEN), one) for name, one in made.items()}


def test_quoins_are_within_and_apart_and_nobody_is_outside() -> None:
    assert inside_m(QUOINS_M).min() > 0.3
    apart = np.linalg.norm(QUOINS_M[:, None] - QUOINS_M, axis=2) + 99 * np.eye(QUOINS)
    assert apart.min() > 3.0
    assert inside_m(_known()[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy()).min() > 0.2
    some = np.array([[19.0, 15.0, 2.0], [5.0, 5.0, 2.0], [5.0, 5.0, 7.8], [26.0, 15.0, 2.0]])
    assert (inside_m(some) > 0).tolist() == [False, True, False, True]


def test_presses_keep_to_their_arms_and_to_a_screw() -> None:
    off = flies(_course(), WHEN) - HERE
    assert np.allclose(np.hypot(off[:, 0], off[:, 1]), 2.0)
    swung = 0.5 * np.sin(0.3 + 0.8 * WHEN)
    assert np.allclose(np.arctan2(off[:, 1], off[:, 0]), swung)
    assert np.allclose(off[:, 2], 0.4 * swung / (2 * np.pi))
    more = flies(_course(begins=0.0), WHEN, 0.2) - HERE
    assert np.ptp(np.arctan2(more[:, 1], more[:, 0])) == pytest.approx(1.2, abs=1e-3)


def test_rails_bend_evenly_more_each_metre_and_trucks_keep_their_pace() -> None:
    course = _course(second=0.1, begins=0.0)
    gone = np.gradient(rides(course, WHEN) - HERE, WHEN, axis=0)[5:-5]
    assert np.allclose(np.hypot(gone[:, 0], gone[:, 1]), 0.8, atol=1e-3)
    heads = np.arctan2(gone[:, 1], gone[:, 0])
    assert np.allclose(heads, 0.5 * 0.1 * (0.8 * WHEN[5:-5]) ** 2, atol=2e-3)
    sooner = np.gradient(rides(course, WHEN, 0.3), WHEN, axis=0)[5:-5]
    assert np.allclose(np.arctan2(sooner[:, 1], sooner[:, 0]), 1.3 * heads, atol=3e-3)


def test_warders_go_across_three_times_for_two_times_along() -> None:
    off = looks_in(_course(), WHEN) - HERE
    assert np.allclose(off[:, 0], 2.0 * np.sin(1.6 * WHEN + 0.3))
    assert np.allclose(off[:, 1], 0.5 * np.cos(2.4 * WHEN))
    hurried = looks_in(_course(), WHEN, 0.5) - HERE
    assert np.allclose(hurried[:, 1], 0.5 * np.cos(3.6 * WHEN))


def test_coils_are_wider_by_as_much_each_turn() -> None:
    for springs, each in ((0.0, 0.5), (1.2, 1.1)):
        off = unwinds(_course(fast=-0.8), WHEN, springs) - HERE
        wide = np.hypot(off[:, 0], off[:, 1])
        assert np.allclose(wide, 2.0 + each * 0.8 * WHEN / (2 * np.pi))


def test_ladles_go_from_rest_to_rest_and_hang_back_as_they_gain() -> None:
    course = _course(second=6.0, size=4.0)
    come = (carries(course, WHEN) - HERE)[:, 0]
    gains = np.gradient(np.gradient(come, WHEN), WHEN)
    assert come[-1] == pytest.approx(4.0)
    assert np.abs(gains[[3, 597]]).max() < 0.1
    hung = (carries(course, WHEN, 0.6) - carries(course, WHEN))[:, 0]
    inner = slice(5, 590)
    assert np.allclose(hung[inner], -0.6 * gains[inner], atol=2e-3)


def test_couriers_change_over_amid_their_way() -> None:
    aside = (runs(_course(second=3.0), WHEN) - HERE)[:, 1]
    steepest = 0.8 * WHEN[np.gradient(aside).argmax()]
    assert steepest == pytest.approx(3.0, abs=0.02)
    assert aside[-1] == pytest.approx(2.0, abs=0.02)
    cut = (runs(_course(second=3.0), WHEN, 0.8) - HERE)[:, 1]
    assert 0.8 * WHEN[np.gradient(cut).argmax()] == pytest.approx(2.2, abs=0.02)


def test_quoins_call_once_after_strikes_each_at_its_own_instant() -> None:
    counts = np.array([5, 1, 11, 7])
    who, since_s = called(np.random.default_rng(4), counts)
    assert np.bincount(who).tolist() == counts.tolist()
    assert since_s[0] == 0.0
    assert (np.diff(since_s) > 0).all()
    assert since_s.max() < STRIKES * BEAT_S[1] + AFTER_S
    assert min(np.diff(since_s[who == k]).min() for k in (0, 2, 3)) > BEAT_S[0] - 0.01
    assert CALLS.sum() == len(OF_ROWS) == 129


def test_all_kinds_go_and_some_rest_for_a_turn() -> None:
    rows = _known()
    assert {*rows["way"]} == {*range(len(KINDS))}
    assert {*rows.loc[rows["moving"] > 0, "way"]} == {*range(len(KINDS))}
    turns = rows.groupby(rows["link"].str.extract(r"turn (\d+)")[0])["moving"].max()
    assert (turns == 0).sum() == RESTS
    assert rows["tx"].nunique() == QUOINS
    assert rows["environment"].nunique() == len(KINDS)
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("mint")


def test_ways_go_over_the_court_as_points_of_them_do() -> None:
    rows = _known().groupby("link").first()
    ends = [rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("tx", "rx")]
    part = np.linspace(0.0, 1.0, 3001)[:, None, None]
    at = (ends[0] + part * (ends[1] - ends[0]))[..., :2]
    there = ((at > COURT_M[0]) & (at < COURT_M[1])).all(axis=2).any(axis=0)
    assert (there != over_the_court(*ends)).mean() < 0.02
    has = {what: rows["obstacles"].map(lambda some, what=what: what in some).to_numpy()
           for what in ("metal", "brick", "marble")}  # fmt: skip
    assert np.array_equal(has["brick"], over_the_court(*ends) & ~has["metal"])
    assert has["metal"].mean() == pytest.approx(0.14, abs=0.01)
    assert rows["obstacles"][has["metal"]].map(len).eq(1).all()
    low = 0.5 * (ends[0] + ends[1])[:, 2] < 2.4
    assert has["marble"][low].mean() > has["marble"][~low].mean()


def test_sight_is_free_where_nothing_stands() -> None:
    rows = _known()
    assert np.array_equal(rows["los"].to_numpy(bool), rows["obstacles"].map(len).eq(0))
