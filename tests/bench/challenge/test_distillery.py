"""The distillery's world: how its tags go, which lintels hear them, how tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.distillery_house import (
    INNER_M,
    KINDS,
    LINTELS,
    LINTELS_M,
    POTS_M,
    hauls,
    indoors_m,
    lifts,
    prowls,
    rakes,
    rolls,
    shovels,
)
from bench.challenge.families.distillery_shift import (
    DRIP_S,
    HEARD,
    OF_ROWS,
    RESTS,
    UNEVEN,
    WITHIN_S,
    cuts_the_corner,
    drips,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "distillery")
WHEN = np.linspace(0.0, 8.0, 801)
HERE = np.array([10.0, 5.0, 2.0])


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"at_x": 10.0, "at_y": 5.0, "at_z": 2.0, "aim": 0.0, "pace": 0.6, "wide": 1.5}
    made |= {"small": 0.2, "phase": 0.4} | other
    return {name: np.full(len(WHEN), one) for name, one in made.items()}


def test_lintels_are_within_and_apart_and_nobody_is_outside() -> None:
    assert indoors_m(LINTELS_M).min() > 0.25
    assert indoors_m(POTS_M).min() > 1.5
    apart = np.linalg.norm(LINTELS_M[:, None] - LINTELS_M, axis=2) + 99 * np.eye(LINTELS)
    assert apart.min() > 3.0
    assert indoors_m(_known()[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()).min() > 0.2
    some = np.array([[10.0, 12.0, 2.0], [25.0, 12.0, 2.0], [10.0, 5.0, 2.0], [10.0, 5.0, 10.8]])
    assert (indoors_m(some) > 0).tolist() == [False, True, True, False]


def test_casks_roll_as_far_as_they_turn_and_less_far_if_they_skid() -> None:
    course = _course(wide=0.5)
    off = rolls(course, WHEN) - HERE
    turned = 0.4 + 0.6 * WHEN / 0.5
    rim = np.column_stack([-np.sin(turned) + np.sin(0.4), -np.cos(turned)])
    assert np.allclose(off[:, [0, 2]] - np.outer(0.6 * WHEN, [1, 0]), 0.2 * rim)
    skids = rolls(course, WHEN, 0.2) - rolls(course, WHEN)
    assert np.allclose(skids, -0.2 * 0.6 * WHEN[:, None] * np.array([1.0, 0.0, 0.0]))


def test_rummagers_go_on_circles_about_a_circle() -> None:
    off = np.linalg.norm((rakes(_course(), WHEN) - HERE)[:, :2], axis=1)
    assert off.max() == pytest.approx(1.7, abs=1e-3)
    assert off.min() == pytest.approx(1.3, abs=1e-3)
    flung = np.linalg.norm((rakes(_course(), WHEN, 0.4) - HERE)[:, :2], axis=1)
    assert flung.max() == pytest.approx(2.3, abs=1e-3)


def test_maltmen_keep_an_even_pace_but_for_turns_and_tire_by_the_square_of_time() -> None:
    course = _course(small=0.0)
    aside = (shovels(course, WHEN) - HERE)[:, 1]
    speed = np.abs(np.gradient(aside, WHEN))
    assert np.median(speed) == pytest.approx(0.6 * 1.5 * 2 / np.pi, rel=0.12)
    assert np.abs(aside).max() < 1.5
    tired = shovels(course, WHEN, 0.5)
    assert np.allclose(tired[-1], shovels(course, np.full(801, 4.0))[0])


def test_drays_gain_way_evenly_and_hoists_settle() -> None:
    along = (hauls(_course(), WHEN) - HERE)[:, 0]
    assert np.allclose(np.gradient(along, WHEN)[1:-1], 0.6 + 0.2 * WHEN[1:-1])
    sways = hauls(_course(), WHEN, 0.3) - hauls(_course(), WHEN)
    assert np.allclose(sways[:, [0, 2]], 0.0)
    assert np.ptp(sways[:, 1]) == pytest.approx(0.6, abs=1e-3)
    course = _course(small=4.0, wide=3.0)
    left = 3.0 - (lifts(course, WHEN) - HERE)[:, 2]
    assert np.allclose(left, 3.0 * np.exp(-WHEN / 4.0))
    bobs = (lifts(course, WHEN, 0.5) - lifts(course, WHEN))[:, 2]
    assert 0.3 < np.abs(bobs).max() < 0.5


def test_cats_close_in_at_an_even_angle() -> None:
    near = np.linalg.norm((prowls(_course(), WHEN) - HERE)[:, :2], axis=1)
    assert np.allclose(np.diff(np.log(near)), -0.2 * WHEN[1])
    sooner = np.linalg.norm((prowls(_course(), WHEN, 1.0) - HERE)[:, :2], axis=1)
    assert np.allclose(sooner, 1.5 * (near / 1.5) ** 2)


def test_each_lintel_drips_at_a_pace_of_its_own() -> None:
    lengths = np.array([6, 1, 10, 3])
    who, since_s = drips(np.random.default_rng(4), lengths)
    assert np.bincount(who).tolist() == lengths.tolist()
    assert since_s[0] == 0.0
    assert (np.diff(since_s) > 0).all()
    assert since_s.max() < WITHIN_S + DRIP_S[1]
    for lintel in (0, 2, 3):
        between = np.diff(since_s[who == lintel])
        assert between.min() > DRIP_S[0] * (1 - UNEVEN)
        assert between.max() < DRIP_S[1] * (1 + UNEVEN)
        assert np.ptp(between) < 2 * UNEVEN * DRIP_S[1]
    assert HEARD.sum() == len(OF_ROWS) == 131


def test_all_kinds_go_and_some_rest_for_a_run() -> None:
    rows = _known()
    assert {*rows["sort"]} == {*range(len(KINDS))}
    assert {*rows.loc[rows["goes"] > 0, "sort"]} == {*range(len(KINDS))}
    runs = rows.groupby(rows["link"].str.extract(r"run (\d+)")[0])["goes"].max()
    assert (runs == 0).sum() == RESTS
    assert rows["rx"].nunique() == LINTELS
    assert rows["environment"].nunique() == 5
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("distillery")


def test_things_are_where_they_stand() -> None:
    rows = _known().groupby("link").first()
    ends = [rows[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("tx", "rx")]
    has = {what: rows["obstacles"].map(lambda some, what=what: what in some).to_numpy()
           for what in ("metal", "brick", "plywood")}  # fmt: skip
    cut = cuts_the_corner(*ends)
    assert np.array_equal(has["brick"], cut & ~has["metal"])
    assert has["metal"].mean() == pytest.approx(0.145, abs=0.01)
    assert rows["obstacles"][has["metal"]].map(len).eq(1).all()
    low = 0.5 * (ends[0] + ends[1])[:, 2] < 2.6
    assert has["plywood"][low].mean() > has["plywood"][~low].mean()
    corner = np.array([[*INNER_M, 1.0]])
    barn, stills, along = (corner + np.array(by) for by in ((-6, -1, 0), (1, 6, 0), (6, -1, 0)))
    assert cuts_the_corner(barn, stills)[0]
    assert not cuts_the_corner(barn, along)[0]


def test_sight_is_free_where_nothing_stands() -> None:
    rows = _known()
    assert np.array_equal(rows["los"].to_numpy(bool), rows["obstacles"].map(len).eq(0))
