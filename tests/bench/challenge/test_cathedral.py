"""The cathedral's world: how its tags go, who calls whom when, and how its tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.cathedral_nave import (
    BOSSES,
    BOSSES_M,
    FALL,
    HALTS,
    KINDS,
    clear_m,
    files,
    hoists,
    paces,
    soars,
    swings,
    treads,
)
from bench.challenge.families.cathedral_office import (
    CHANGES,
    OF_ROWS,
    ROUND_S,
    ROUNDS,
    hunted,
    rung_in_changes,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "cathedral")
_of = partial(shown.column_of, "cathedral")
WHEN = np.linspace(0.0, 12.0, 600)


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"mid_x": 20.0, "mid_y": 13.0, "lift": 9.0, "reach": 7.0, "broad": 0.4, "turn": 1.1}
    return {name: np.full(600, one) for name, one in (made | {"tempo": 0.5} | other).items()}


def test_bosses_are_within_and_nobody_is_outside() -> None:
    assert clear_m(BOSSES_M).min() > 0.25
    apart = np.linalg.norm(BOSSES_M[:, None] - BOSSES_M, axis=2) + 99 * np.eye(BOSSES)
    assert apart.min() > 3.0
    assert clear_m(_known()[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()).min() > 0.25
    outside = np.array([[10.0, 3.0, 2.0], [26.0, 3.0, 2.0], [26.0, 13.0, 14.8]])
    assert (clear_m(outside) > 0).tolist() == [False, True, False]


def test_censers_hang_on_their_ropes_and_swing_as_long_as_pendulums() -> None:
    course = _course()
    off = swings(course, WHEN) - np.array([20.0, 13.0, 9.0])
    assert np.allclose(np.linalg.norm(off, axis=1), 7.0)
    angle = np.arcsin(off[:, :2] @ np.array([np.cos(1.1), np.sin(1.1)]) / 7.0)
    assert np.abs(angle).max() == pytest.approx(0.4, abs=1e-3)
    turns = WHEN[1:][np.diff(np.sign(angle)) > 0]
    assert np.diff(turns)[0] == pytest.approx(2 * np.pi * np.sqrt(7 / FALL) * 1.01, rel=0.01)
    wider = swings(course, WHEN, 0.25) - np.array([20.0, 13.0, 9.0])
    assert np.arcsin(np.abs(wider[:, 0] / np.cos(1.1)) / 7.0).max() == pytest.approx(0.5, abs=2e-3)


def test_vergers_nearly_halt_at_each_step_and_keep_their_pace_in_the_mean() -> None:
    at = paces(_course(tempo=1.2), WHEN)[:, 0]
    speed = np.gradient(at, WHEN)
    assert speed.min() == pytest.approx(1.2 * (1 - HALTS), abs=0.01)
    assert speed.max() == pytest.approx(1.2 * (1 + HALTS), abs=0.01)
    assert speed.mean() == pytest.approx(1.2, rel=0.1)
    slower = paces(_course(tempo=1.2), WHEN, 0.2)[:, 0]
    assert np.allclose(slower - 20.0, 0.8 * (at - 20.0))


def test_doves_fly_rings_and_sink_and_pilgrims_keep_to_theirs() -> None:
    course = _course(reach=3.0, broad=2.0)
    off = (soars(course, WHEN) - np.array([20.0, 13.0, 9.0])) / np.array([3.0, 2.0, 0.8])
    assert np.allclose(np.hypot(off[:, 0], off[:, 1]), 1.0)
    sunk = soars(course, WHEN)[:, 2] - soars(course, WHEN, 0.1)[:, 2]
    assert np.allclose(sunk, 0.1 * WHEN)
    flat = treads(course, WHEN)[:, :2] - np.array([20.0, 13.0])
    assert np.allclose(np.hypot(*flat.T), 3.0)
    oval = treads(course, WHEN, 0.1)[:, :2] - np.array([20.0, 13.0])
    assert np.allclose(np.hypot(oval[:, 0] / 2.7, oval[:, 1] / 3.3), 1.0)


def test_masons_are_hoisted_evenly_and_processions_that_cut_all_corners_are_ellipses() -> None:
    up = hoists(_course(), WHEN)[:, 2]
    assert np.allclose(np.diff(up), up[1] - up[0])
    more = hoists(_course(), WHEN, 0.05)[:, 2]
    assert np.allclose(more - up, 0.5 * 0.05 * WHEN**2)
    course = _course(reach=6.0, broad=3.0)
    ring, oblong = (
        (files(course, WHEN, cut) - np.array([20.0, 13.0, 9.0]))[:, :2] / np.array([6.0, 3.0])
        for cut in (1.0, 0.0)
    )
    assert np.allclose(np.hypot(*ring.T), 1.0)
    assert np.abs(oblong).max() == pytest.approx(1.0, abs=0.03)
    assert np.hypot(*oblong.T).max() == pytest.approx(1.2, abs=0.01)


def test_a_plain_hunt_comes_round_and_each_bell_moves_by_one_place_at_most() -> None:
    for bells in (3, 4, 7, 8):
        rows = hunted(bells, 2 * bells + 1)
        assert (np.sort(rows, axis=1) == np.arange(bells)).all()
        assert np.array_equal(rows[0], rows[-1])
        assert len({tuple(row) for row in rows.tolist()}) == 2 * bells
        places = np.argsort(rows, axis=1)
        assert np.abs(np.diff(places, axis=0)).max() == 1


def test_offices_call_bosses_in_changes() -> None:
    lengths = np.array([5, 1, 8, 9])
    who, since_s = rung_in_changes(np.random.default_rng(3), lengths)
    assert np.bincount(who).tolist() == lengths.tolist()
    assert (np.diff(since_s) > 0).all()
    assert since_s[0] == 0.0
    for bell in range(4):
        between = np.diff(since_s[who == bell]) / ROUND_S
        assert np.all((between > 0.7) & (between < 1.3))
    assert since_s.max() < ROUNDS * ROUND_S
    assert CHANGES.sum() == len(OF_ROWS) == 127


def test_kinds_rest_at_times_and_all_have_their_places() -> None:
    rows = _known()
    assert {*rows["gait"]} == {*range(len(KINDS))}
    assert rows.groupby("link")["goes"].nunique().max() == 1
    assert 0.1 < rows["goes"].eq(0.0).mean() < 0.4
    assert rows["rx"].nunique() == BOSSES
    assert rows["environment"].nunique() == 5
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("cathedral")


def test_things_are_where_they_stand() -> None:
    rows = _known().groupby("link").first()
    low = rows["rx_z_m"] + rows["tx_z_m"] < 6.0
    stalls = rows["obstacles"].map(lambda some: "wood" in some)
    assert stalls[low].mean() > stalls[~low].mean()
    iron = rows["obstacles"].map(lambda some: "metal" in some)
    assert iron.mean() == pytest.approx(0.15, abs=0.01)
    assert rows["obstacles"][iron].map(len).eq(1).all()
    passes = (rows["tx_x_m"] - 30) * (rows["rx_x_m"] - 30) < 0
    stone = rows["obstacles"].map(lambda some: "concrete" in some)
    assert stone[passes & ~iron].mean() > stone[~passes & ~iron].mean()
    assert np.array_equal(_of("los"), _known()["obstacles"].map(len).eq(0))
