"""The pottery's world: how its tags go, which purlins they call, how tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.pottery_day import (
    ANSWER,
    CALLS,
    IDLE,
    OF_ROWS,
    PAUSE_S,
    calls,
    walls_met,
)
from bench.challenge.families.pottery_floor import (
    DRYING_Y,
    GLAZE_X,
    KILN_M,
    PLANET,
    PURLINS,
    PURLINS_M,
    TAGS,
    TRADES,
    Firing,
    at_trade,
    carried,
    dipped,
    hoisted,
    lengths,
    rolled,
    room_m,
    spiralled,
    stirred,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "pottery")
WHEN = np.linspace(0.0, 8.0, 801)
HERE = np.array([14.0, 9.0, 2.0])


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"from_x": 14.0, "from_y": 9.0, "from_z": 2.0, "heads": 0.0, "brisk": 0.5}
    made |= {"wide": 2.0, "bent": 0.3, "turned": 0.4} | other
    return {name: np.full(len(WHEN), one) for name, one in made.items()}


def _plane(at: np.ndarray) -> np.ndarray:
    return (at - HERE)[:, 0] + 1j * (at - HERE)[:, 1]


def test_purlins_are_within_and_apart_and_nobody_is_in_walls_or_the_kiln() -> None:
    assert room_m(PURLINS_M).min() > 0.3
    apart = np.linalg.norm(PURLINS_M[:, None] - PURLINS_M, axis=2) + 99 * np.eye(PURLINS)
    assert apart.min() > 3.0
    assert room_m(_known()[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()).min() > 0.25
    assert room_m(np.array([[KILN_M[0], KILN_M[1], 3.0]]))[0] == pytest.approx(-KILN_M[2])


def test_boards_go_at_an_even_pace_and_turn_by_the_square_of_their_way() -> None:
    for tighter in (0.0, 0.5):
        step = np.diff(_plane(carried(_course(bent=0.1), WHEN, tighter))) / np.diff(WHEN)
        assert np.allclose(np.abs(step), 0.5, atol=1e-4)
        way = 0.5 * 0.5 * (WHEN[1:] + WHEN[:-1])
        assert np.allclose(np.angle(step), 0.05 * (1 + tighter) * way**2, atol=1e-3)


def test_trucks_roll_out_and_fettlers_step_out_as_they_go_round() -> None:
    for longer in (0.0, 0.5):
        along = _plane(rolled(_course(), WHEN, longer)).real
        pace = np.gradient(along, WHEN)
        assert np.allclose(np.gradient(np.log(pace), WHEN)[5:-5], -0.5 / (1 + longer), atol=1e-3)
        assert pace[0] == pytest.approx(0.5, abs=2e-3)
    arm = np.abs(_plane(spiralled(_course(), WHEN, 0.2)) + 2.0 * np.exp(0.4j))
    assert np.allclose(arm, 2.0 + 0.5 * 0.5 * WHEN)


def test_paddles_go_round_on_wheels_and_saggars_rise_from_rest() -> None:
    turn = 0.5 * WHEN
    for geared in (0.0, 0.7):
        small = _plane(stirred(_course(), WHEN, geared)) - 2.0 * (np.exp(1j * turn) - 1)
        small = small + 0.3 * np.exp(0.4j)
        assert np.allclose(small, 0.3 * np.exp(1j * (0.4 + (PLANET + geared) * turn)))
    up = (hoisted(_course(), WHEN) - HERE)[:, 2]
    assert np.gradient(up, WHEN)[0] < 0.01
    assert np.gradient(up, WHEN)[-1] == pytest.approx(0.5, abs=2e-3)
    assert np.allclose((hoisted(_course(), WHEN, 0.4) - HERE)[:, 2], 0.6 * up)


def test_dippers_reach_as_far_as_they_should_along_and_across() -> None:
    long_s = np.linspace(0.0, 60.0, len(WHEN))
    plain, more = (_plane(dipped(_course(), long_s, by)) for by in (0.0, 0.5))
    assert np.ptp(plain.real) == pytest.approx(4.0, abs=0.02)
    assert np.ptp(plain.imag) == pytest.approx(0.6, abs=0.01)
    assert np.allclose(more.imag, 1.5 * plain.imag)
    assert np.allclose(more.real, plain.real)


def test_calls_are_apart_and_all_answer_as_often_as_they_should() -> None:
    shares = np.array([5, 1, CALLS, 7])
    who, since_s = calls(np.random.default_rng(4), shares)
    assert np.bincount(who).tolist() == shares.tolist()
    assert since_s.min() == 0.0
    assert (np.diff(since_s) >= 0).all()
    assert np.diff(since_s[who == 2]).min() >= PAUSE_S - 1e-9
    assert ANSWER.sum() == len(OF_ROWS) == 130


def test_all_trades_go_and_some_tags_rest_for_a_round() -> None:
    rows = _known()
    assert {*rows["trade"]} == {*rows.loc[rows["stirs"] > 0, "trade"]} == {*range(6)}
    rounds = rows.groupby(rows["link"].str.extract(r"round (\d+)")[0])["stirs"].max()
    assert (rounds == 0).sum() == IDLE
    assert rows["rx"].nunique() >= PURLINS - 1
    assert rows["tx"].nunique() == len(TAGS)
    assert rows["environment"].nunique() == len(TRADES)
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("pottery")


def test_ways_meet_the_kiln_and_either_partition_where_these_are() -> None:
    one = np.array([[10.0, 11.0, 2.0], [10.0, 15.0, 2.0], [5.0, 15.0, 1.0], [24.0, 6.0, 1.0]])
    other = np.array([[26.0, 11.0, 3.0], [16.0, 15.0, 2.0], [5.0, 19.0, 2.0], [28.0, 6.0, 2.0]])
    met = walls_met(one, other)
    assert met["brick"].tolist() == [True, False, False, False]
    assert met["wood"].tolist() == [False, False, True, False]
    assert met["glass"].tolist()[1:] == [False, False, True]
    past = walls_met(np.array([[5.0, DRYING_Y + 0.1, 1.0], [GLAZE_X - 2, 20.0, 1.0]]),
                     np.array([[5.0, 22.0, 1.0], [GLAZE_X + 2, 20.0, 1.0]]))  # fmt: skip
    assert not past["wood"][0]
    assert not past["glass"][1]


def test_rows_know_who_calls_whom_and_sight_is_free_where_nothing_stands() -> None:
    rows = _known()
    firing = Firing(rows, 0, np.random.default_rng(0))
    assert [TAGS[k] for k in firing.tag[:9]] == rows["tx"].head(9).tolist()
    assert np.allclose(firing.purlin_m, PURLINS_M[firing.purlin])
    assert np.allclose(at_trade(firing.course, firing["into_s"]), firing.tag_m)
    assert np.allclose(lengths(firing.tag_m - firing.purlin_m), firing.far)
    assert np.allclose(firing.longer_m(firing.purlin_m - firing.tag_m), -firing.far)
    assert np.array_equal(rows["los"].to_numpy(bool), rows["obstacles"].map(len).eq(0))
    assert firing.through("brick").max() == 1
