"""The planetarium's world: how its tags go, who calls whom when, and how its tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.planetarium_dome import (
    BEARINGS,
    COVES,
    COVES_M,
    HALL_M,
    INSIDE_M,
    KINDS,
    MIDDLE_M,
    RADIUS_M,
    SAG_M,
    SIDES,
    anomaly,
    clear_m,
    climbs,
    orbits,
    slides,
    walks,
    wheels,
)
from bench.challenge.families.planetarium_show import HEARD_BY, OF_ROWS, TURN_S, swept
from tests.bench.challenge import shown

_known = partial(shown.known_of, "planetarium")
_of = partial(shown.column_of, "planetarium")


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"bears": 0.4, "out": 4.0, "up": 1.5, "sense": 1.0, "rate": 0.3, "size": 0.4}
    return {name: np.full(400, one) for name, one in (made | {"phase": 1.1} | other).items()}


WHEN = np.linspace(0.0, 2 * np.pi / 0.3, 400)


def test_coves_are_on_the_wall_and_up_the_dome_and_nobody_is_outside() -> None:
    off = COVES_M - MIDDLE_M
    out = np.sqrt(off[:, 0] ** 2 + off[:, 1] ** 2 + off[:, 2].clip(0) ** 2)
    assert np.allclose(out, RADIUS_M - INSIDE_M)
    assert (COVES_M > 0).all()
    assert (COVES_M < HALL_M).all()
    assert np.diff(np.sort(BEARINGS)).min() > 0.1
    places = _known()[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()
    assert clear_m(places).min() > 0.3
    assert clear_m(np.array([[*MIDDLE_M[:2], 14.0]]))[0] == pytest.approx(0.6)


def test_planets_sweep_even_areas_and_are_back_after_their_year() -> None:
    course = _course()
    flat = (orbits(course, WHEN) - MIDDLE_M)[:, :2]
    swept_m2 = flat[:-1, 0] * flat[1:, 1] - flat[:-1, 1] * flat[1:, 0]
    assert np.allclose(swept_m2, swept_m2.mean(), rtol=1e-3)
    assert np.allclose(flat[0], flat[-1])
    far = np.hypot(*flat.T)
    assert far.min() == pytest.approx(4.0 * 0.6, rel=1e-3)
    assert far.max() == pytest.approx(4.0 * 1.4, rel=1e-3)
    half = anomaly(np.linspace(-3, 3, 60), np.full(60, 0.55))
    assert np.allclose(half - 0.55 * np.sin(half), np.linspace(-3, 3, 60))


def test_an_equant_is_a_circle_that_is_turned_about_from_beyond_its_middle() -> None:
    course = _course(phase=0.0, bears=0.0)
    flat = (orbits(course, WHEN, 1.0) - MIDDLE_M)[:, :2]
    middle, beyond = np.array([-1.6, 0.0]), np.array([-3.2, 0.0])
    assert np.allclose(np.linalg.norm(flat - middle, axis=1), 4.0)
    turn = np.unwrap(np.arctan2(*(flat - beyond).T[::-1]))
    assert np.allclose(turn - turn[0], 0.3 * WHEN, atol=1e-9)


def test_moons_keep_to_their_wheels_and_ushers_to_sides_of_a_heptagon() -> None:
    course = _course(size=0.8)
    arm = 0.4 + 0.3 * WHEN
    at = MIDDLE_M[:2, None] + 4.0 * np.stack([np.cos(arm), np.sin(arm)])
    off = (wheels(course, WHEN) - np.column_stack([at.T, np.full(400, 1.5)])) / 0.8
    assert np.allclose(np.hypot(off[:, 0], off[:, 1]), 1.0)
    course = _course(size=0.0)
    flat = (walks(course, WHEN, 1.0) - MIDDLE_M)[:, :2]
    sides = np.pi * (2 * np.arange(SIDES) + 1) / SIDES
    from_sides = 4.0 * np.cos(np.pi / SIDES) - flat @ np.stack([np.cos(sides), np.sin(sides)])
    assert np.allclose(from_sides.min(axis=1), 0.0, atol=1e-9)
    assert np.allclose(np.hypot(*(walks(course, WHEN) - MIDDLE_M)[:, :2].T), 4.0)


def test_wires_hang_deepest_amid_them_and_trolleys_stay_on_the_dome() -> None:
    course = _course(size=3.0, up=4.0)
    one, deeper = slides(course, WHEN), slides(course, WHEN, 0.5)
    assert one[:, 2].min() == pytest.approx(4.0 - SAG_M, abs=1e-3)
    assert (one[:, 2] - deeper[:, 2]).max() == pytest.approx(0.5 * SAG_M, abs=1e-3)
    assert np.allclose(one[:, :2], deeper[:, :2])
    course = _course(out=10.5, rate=0.1, phase=0.3)
    for back in (0.0, 0.02):
        there = climbs(course, WHEN / 4, back) - MIDDLE_M
        assert np.allclose(np.linalg.norm(there, axis=1), 10.5)


def test_each_show_calls_coves_as_the_beam_turns_past_them() -> None:
    rng = np.random.default_rng(3)
    coves, lengths = np.array([4, 9, 2]), np.array([5, 1, 8])
    who, since_s = swept(rng, coves, lengths)
    assert [int((who == cove).sum()) for cove in coves] == lengths.tolist()
    for cove in coves:
        assert np.allclose(np.diff(since_s[who == cove]), TURN_S)
    turns = (since_s - since_s[0]) / TURN_S - (BEARINGS[who] - BEARINGS[who[0]]) / (2 * np.pi)
    assert np.allclose(turns, np.rint(turns))
    assert HEARD_BY.sum() == len(OF_ROWS) == 123


def test_kinds_rest_at_times_and_all_have_their_places() -> None:
    rows = _known()
    assert {*rows["kind"]} == {*range(len(KINDS))}
    assert rows.groupby("link")["goes"].nunique().max() == 1
    assert 0.1 < rows["goes"].eq(0.0).mean() < 0.4
    assert rows["rx"].nunique() == COVES
    assert rows["environment"].nunique() == 3
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("planetarium")


def test_things_are_where_they_stand() -> None:
    rows = _known().groupby("link").first()
    low = rows["rx_z_m"] + rows["tx_z_m"] < 5.0
    seats = rows["obstacles"].map(lambda some: "wood" in some)
    assert seats[low].mean() > seats[~low].mean()
    iron = rows["obstacles"].map(lambda some: "metal" in some)
    assert iron.mean() == pytest.approx(0.15, abs=0.01)
    assert rows["obstacles"][iron].map(len).eq(1).all()
    assert np.array_equal(_of("los"), _known()["obstacles"].map(len).eq(0))
