"""The watermill's world: how its tags go, which hatches hear them, how tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.watermill_day import (
    FRAME_S,
    FRAMES,
    HEARD,
    OF_ROWS,
    RESTS,
    SLOT_S,
    floors_between,
    slots,
    storey,
    through_the_wall,
)
from bench.challenge.families.watermill_race import (
    HATCHES,
    HATCHES_M,
    KINDS,
    STOREYS_M,
    TAGS,
    WALL_M,
    Grist,
    clear_m,
    drifts,
    goes_round,
    is_hoisted,
    is_lifted,
    walks_round,
    winds_out,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "watermill")
WHEN = np.linspace(0.0, 9.0, 901)
HERE = np.array([8.0, 6.0, 1.5])


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"mid_x": 8.0, "mid_y": 6.0, "mid_z": 1.5, "faces": 0.0, "pace": 0.6, "reach": 2.0}
    made |= {"twist": 0.5, "phase": 0.3} | other
    return {name: np.full(len(WHEN), one) for name, one in made.items()}


def _pace(at: np.ndarray) -> np.ndarray:
    return np.linalg.norm(np.gradient(at, WHEN, axis=0), axis=1)[5:-5]


def test_hatches_are_within_and_apart_and_nobody_is_outside() -> None:
    assert clear_m(HATCHES_M).min() > 0.3
    apart = np.linalg.norm(HATCHES_M[:, None] - HATCHES_M, axis=2) + 99 * np.eye(HATCHES)
    assert apart.min() > 3.0
    assert clear_m(_known()[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()).min() > 0.25
    assert clear_m(np.array([[20.0, 5.0, 5.0], [5.0, 5.0, 13.0], [5.0, 5.0, 5.0]])).tolist() == (
        pytest.approx([0.0, -0.5, 5.0])
    )


def test_paddles_keep_to_their_wheel_and_run_ahead_on_a_side() -> None:
    off = goes_round(_course(), WHEN) - HERE
    assert np.allclose(np.hypot(off[:, 0], off[:, 2]), 2.0)
    assert np.allclose(off[:, 1], 0.0)
    assert np.allclose(_pace(off), 1.2, atol=1e-3)
    uneven = goes_round(_course(pace=1.2), WHEN, 0.2) - HERE
    angle = np.unwrap(np.arctan2(uneven[:, 2], uneven[:, 0]))
    even = 0.3 + 1.2 * WHEN
    assert np.allclose(angle - even, 0.2 * (np.cos(even) - np.cos(0.3)))


def test_sacks_rise_once_slack_is_taken_up_and_sway_by_so_much() -> None:
    off = is_hoisted(_course(twist=1.2), WHEN) - HERE
    rises = np.gradient(off[:, 2], WHEN)
    assert np.allclose(rises[1:-1], 0.6 * -np.expm1(-WHEN / 1.2)[1:-1], atol=1e-3)
    assert np.allclose(off[0], 0.0)
    wide = is_hoisted(_course(twist=1.2), WHEN, 0.5) - HERE
    assert np.allclose(wide[:, :2], 1.5 * off[:, :2])
    assert np.allclose(wide[:, 2], off[:, 2])


def test_millers_walk_on_squares_with_round_corners_and_rounder_ones() -> None:
    for rounder, power in ((0.0, 4.0), (2.0, 2.0)):
        off = walks_round(_course(pace=0.7), WHEN, rounder)
        off -= off[0] - walks_round(_course(pace=0.7), WHEN, 0.0)[0]
        if rounder == 0.0:
            off -= HERE
            assert np.allclose((np.abs(off[:, :2]) ** power).sum(axis=1), 2.0**power)
        else:
            centre = 0.5 * (off.max(axis=0) + off.min(axis=0))
            assert np.allclose(np.linalg.norm(off - centre, axis=1), 2.0, atol=2e-3)


def test_drift_slows_down_towards_a_screen_and_more_so_if_it_drags() -> None:
    off = drifts(_course(pace=1.0, reach=6.0), WHEN) - HERE
    assert np.gradient(off[:, 0], WHEN)[0] == pytest.approx(1.0, abs=0.01)
    assert np.allclose(6.0 - off[:, 0], 6.0 * np.exp(-WHEN / 6.0))
    drags = drifts(_course(pace=1.0, reach=6.0), WHEN, 0.25) - HERE
    assert np.allclose(6.0 - drags[:, 0], 6.0 * np.exp(-0.75 * WHEN / 6.0))


def test_carts_keep_their_angle_and_pace_and_wind_tighter() -> None:
    for tighter, each in ((0.0, 0.5), (0.25, 0.4)):
        off = winds_out(_course(), WHEN, tighter) - HERE
        wide = np.hypot(off[:, 0], off[:, 1])
        turned = np.unwrap(np.arctan2(off[:, 1], off[:, 0]))
        assert np.allclose(np.log(wide / 2.0), each * (turned - 0.3), atol=1e-9)
        assert np.allclose(_pace(off), 0.6, atol=1e-3)


def test_buckets_keep_to_their_belt_and_slip_with_it() -> None:
    course = _course(pace=0.9, reach=3.0, phase=0.1)
    off = is_lifted(course, WHEN) - HERE
    assert np.allclose(_pace(off), 0.9, atol=0.01)
    assert off[:, 0].min() == pytest.approx(-0.5, abs=1e-6)
    assert off[:, 0].max() == pytest.approx(0.5, abs=1e-3)
    assert off[:, 2].max() == pytest.approx(3.5, abs=1e-3)
    assert np.allclose(_pace(is_lifted(course, WHEN, 0.1)), 0.81, atol=0.01)
    long_s = 2 * (3.0 + np.pi * 0.5) / 0.9
    assert np.allclose(is_lifted(course, WHEN), is_lifted(course, WHEN + long_s))


def test_hatches_have_slots_in_frames_of_which_each_takes_as_many_as_it_has_rows() -> None:
    counts = np.array([5, 1, 12, 7])
    who, since_s = slots(np.random.default_rng(4), counts)
    assert np.bincount(who).tolist() == counts.tolist()
    assert since_s[0] == 0.0
    assert (np.diff(since_s) > 0).all()
    assert since_s.max() < FRAMES * FRAME_S + 4 * SLOT_S
    assert min(np.diff(since_s[who == k]).min() for k in (0, 2, 3)) > FRAME_S - 0.03
    assert HEARD.sum() == len(OF_ROWS) == 133


def test_all_kinds_go_and_some_rest_for_a_grist() -> None:
    rows = _known()
    assert {*rows["gang"]} == {*rows.loc[rows["astir"] > 0, "gang"]} == {*range(len(KINDS))}
    grists = rows.groupby(rows["link"].str.extract(r"grist (\d+)")[0])["astir"].max()
    assert (grists == 0).sum() == RESTS
    assert rows["rx"].nunique() == HATCHES
    assert rows["tx"].nunique() == len(TAGS)
    assert rows["environment"].nunique() == len(KINDS)
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("watermill")


def test_ways_go_through_floors_and_the_wall_as_points_of_them_do() -> None:
    rows = _known().groupby("link").first()
    one, other = (rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("tx", "rx"))
    part = np.linspace(0.0, 1.0, 2001)[:, None, None]
    at = one + part * (other - one)
    crossed = np.abs(np.diff(storey(at[..., 2]), axis=0)).sum(axis=0)
    found = floors_between(one, other)
    assert (found <= crossed).all()
    inner = (at[..., 0] < WALL_M).all(axis=0)
    assert (found == crossed)[inner].mean() > 0.6  # but for those through the trap
    assert not found[(at[..., 0] > WALL_M).all(axis=0)].any()
    passes = np.abs(np.diff(at[..., 0] > WALL_M, axis=0)).any(axis=0)
    assert not through_the_wall(one, other)[~passes].any()
    assert 0.3 < through_the_wall(one, other)[passes].mean() < 0.95
    has = {what: rows["obstacles"].map(lambda some, what=what: some.count(what)).to_numpy()
           for what in ("metal", "wood", "brick")}  # fmt: skip
    clear = has["metal"] == 0
    assert np.array_equal(has["wood"][clear], found[clear])
    assert np.array_equal(has["brick"][clear] > 0, through_the_wall(one, other)[clear])
    assert has["metal"].mean() == pytest.approx(0.15, abs=0.01)
    assert rows["obstacles"][~clear].map(len).eq(1).all()
    assert storey(np.array([0.0, 4.0, 4.2, 9.0])).tolist() == [0, 0, 1, 2]
    assert len(STOREYS_M) == 3


def test_rows_know_who_is_heard_by_whom() -> None:
    grist = Grist(_known(), 0, np.random.default_rng(0))
    assert [TAGS[k] for k in grist.tag[:9]] == _known()["tx"].head(9).tolist()
    assert np.allclose(grist.hatch_m, HATCHES_M[grist.hatch])
    assert np.allclose(np.linalg.norm(grist.tag_m - grist.hatch_m, axis=1), grist.far)
    assert np.allclose(grist.stretched_m(0.0, grist.tag_m - grist.hatch_m), -grist.far)
    for kind in KINDS:
        assert np.array_equal(grist.of(kind), _known()["tx"].str.startswith(kind))


def test_sight_is_free_where_nothing_stands() -> None:
    rows = _known()
    assert np.array_equal(rows["los"].to_numpy(bool), rows["obstacles"].map(len).eq(0))
