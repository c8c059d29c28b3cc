"""The tram shed's world: how its tags go, which rosettes call them, how tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.tramshed_depot import (
    ARCADE_Y,
    ARCHES_X,
    BOILER_M,
    DUTIES,
    FROM_REST_S,
    OFFICE_X,
    RESTS_S,
    ROSETTES,
    ROSETTES_M,
    SOFT_S,
    STROKE_S,
    TAGS,
    WEAVES,
    Fares,
    at_duty,
    jacked,
    lengths,
    room_m,
    swings,
    traverses,
    turns_out,
    walked_round,
    weaves,
)
from bench.challenge.families.tramshed_roster import (
    AFTER_S,
    CALLERS,
    IDLE,
    OF_ROWS,
    ROUND_S,
    ROUNDS,
    SLOWER,
    rings,
    walls_met,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "tramshed")
WHEN = np.linspace(0.0, 9.0, 901)
HERE = np.array([14.0, 9.0, 2.0])


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"from_x": 14.0, "from_y": 9.0, "from_z": 2.0, "points": 0.0, "pace": 0.4}
    made |= {"span": 2.0, "curl": 0.3, "phase": 0.4} | other
    return {name: np.full(len(WHEN), one) for name, one in made.items()}


def test_rosettes_are_within_and_apart_and_nobody_is_in_walls_or_the_boiler() -> None:
    assert room_m(ROSETTES_M).min() > 0.3
    apart = np.linalg.norm(ROSETTES_M[:, None] - ROSETTES_M, axis=2) + 99 * np.eye(ROSETTES)
    assert apart.min() > 3.0
    assert room_m(_known()[["rx_x_m", "rx_y_m", "rx_z_m"]].to_numpy()).min() > 0.25
    assert room_m(np.array([[BOILER_M[0], BOILER_M[1], 3.0]]))[0] == pytest.approx(-BOILER_M[2])


def test_trams_are_straight_before_and_past_the_blades_and_turn_out_by_their_span() -> None:
    off = turns_out(_course(pace=4.0, curl=12.0), WHEN) - HERE
    assert np.allclose(off[:, 0], 4.0 * WHEN)
    assert off[-1, 1] - off[0, 1] == pytest.approx(2.0, abs=1e-3)
    assert np.interp(12.0, off[:, 0], off[:, 1]) == pytest.approx(1.0, abs=1e-3)
    later = turns_out(_course(pace=4.0, curl=12.0), WHEN, 1.5) - HERE
    assert np.interp(13.5, later[:, 0], later[:, 1]) == pytest.approx(1.0, abs=1e-3)


def test_traversers_are_as_far_after_a_cycle_and_sweepers_weave_evenly() -> None:
    off = traverses(_course(), np.full(len(WHEN), SOFT_S)) - HERE
    assert np.allclose(off[:, 0], 0.4 * SOFT_S)
    far = traverses(_course(), np.full(len(WHEN), SOFT_S), 0.2) - HERE
    assert np.allclose(far[:, 0], 1.2 * off[:, 0])
    plain, wide = (weaves(_course(phase=0.0), WHEN, by)[:, 1] - HERE[1] for by in (0.0, 0.5))
    assert np.allclose(wide, 1.5 * plain)
    top = weaves(_course(phase=0.0), np.full(len(WHEN), 0.5 * np.pi / WEAVES), 0.0) - HERE
    assert top[0, 1] == pytest.approx(2.0)
    steps = np.abs(np.diff(plain[50:120]))
    assert steps.min() > 0.7 * steps.max()


def test_jacks_lift_by_whole_strokes_and_blocks_come_to_rest() -> None:
    up = jacked(_course(), np.full(len(WHEN), 3 * STROKE_S)) - HERE
    assert np.allclose(up[:, 2], 0.4 * 3 * STROKE_S)
    assert np.allclose((jacked(_course(), WHEN, 0.25) - HERE)[:, 2],
                       0.75 * (jacked(_course(), WHEN) - HERE)[:, 2])  # fmt: skip
    late = swings(_course(pace=1.0, curl=1.0), WHEN) - HERE
    middle = 2.0 * np.exp(0.4j)
    arm = np.abs(late[:, 0] + 1j * late[:, 1] + middle)
    assert np.allclose(arm, 2.0 * np.exp(-WHEN / RESTS_S))
    slow = swings(_course(pace=1.0, curl=1.0), WHEN, 3.0) - HERE
    angle = np.unwrap(np.angle(slow[:, 0] + 1j * slow[:, 1] + middle))
    assert np.allclose(np.gradient(angle, WHEN), 0.5, atol=1e-3)


def test_poles_go_round_from_rest_at_one_arm() -> None:
    off = walked_round(_course(), WHEN) - HERE
    plane = off[:, 0] + 1j * off[:, 1] + 2.0 * np.exp(0.4j)
    assert np.allclose(np.abs(plane), 2.0)
    angle = np.unwrap(np.angle(plane)) - 0.4
    assert np.allclose((angle / 0.4 + FROM_REST_S) ** 2, WHEN**2 + FROM_REST_S**2)


def test_rounds_come_ever_slower_and_all_call_as_often_as_they_should() -> None:
    shares = np.array([5, 1, 13, 7])
    who, since_s = rings(np.random.default_rng(4), shares)
    assert np.bincount(who).tolist() == shares.tolist()
    assert since_s.min() == 0.0
    gaps = np.diff(since_s[who == 2])
    assert len(gaps) == ROUNDS - 1
    assert np.allclose(gaps[1:] / gaps[:-1], SLOWER)
    assert ROUND_S[0] <= gaps[0] <= ROUND_S[1]
    assert since_s[who == 3].min() >= 3 * AFTER_S - 1e-9
    assert CALLERS.sum() == len(OF_ROWS) == 139


def test_all_duties_go_and_some_tags_rest_for_a_turn() -> None:
    rows = _known()
    assert {*rows["duty"]} == {*rows.loc[rows["goes"] > 0, "duty"]} == {*range(6)}
    turns = rows.groupby(rows["link"].str.extract(r"turn (\d+)")[0])["goes"].max()
    assert (turns == 0).sum() == IDLE
    assert rows["tx"].nunique() >= ROSETTES - 1
    assert rows["rx"].nunique() == len(TAGS)
    assert rows["environment"].nunique() == len(DUTIES)
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("tramshed")


def test_ways_go_through_walls_but_not_through_arches() -> None:
    arch = 0.5 * sum(ARCHES_X[0])
    one = np.array([[arch, 5.0, 2.0], [24.0, 5.0, 2.0], [3.0, 5.0, 1.0], [30.0, 5.0, 1.0]])
    other = np.array([[arch, 28.0, 3.0], [24.0, 28.0, 2.0], [3.0, 28.0, 1.0], [44.0, 6.0, 1.0]])
    arcade, office = walls_met(one, other)
    assert arcade.tolist() == [0, 1, 0, 0]
    assert office.tolist() == [0, 0, 0, 1]
    low = other.copy()
    low[:, 1] = ARCADE_Y - 0.1
    assert not walls_met(one, low)[0].any()
    assert walls_met(one, one + np.array([0.1, 0.0, 0.0]))[1].tolist() == [0, 0, 0, 0]
    assert 0 < OFFICE_X < 46.0


def test_rows_know_who_calls_whom_and_sight_is_free_where_nothing_stands() -> None:
    rows = _known()
    fares = Fares(rows, 0, np.random.default_rng(0))
    assert [TAGS[k] for k in fares.tag[:9]] == rows["rx"].head(9).tolist()
    assert np.allclose(fares.rosette_m, ROSETTES_M[fares.rosette])
    assert np.allclose(at_duty(fares.course, fares["into_s"]), fares.tag_m)
    assert np.allclose(lengths(fares.tag_m - fares.rosette_m), fares.far)
    assert np.allclose(fares.longer_m(fares.rosette_m - fares.tag_m), -fares.far)
    assert np.array_equal(rows["los"].to_numpy(bool), rows["obstacles"].map(len).eq(0))
    assert fares.through("brick").max() == 1
