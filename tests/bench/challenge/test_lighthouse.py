"""The lighthouse's world: how its tags go, which cressets hear them, how tables are mixed."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.lighthouse_station import (
    CALLINGS,
    CRESSETS,
    CRESSETS_M,
    OIL_M,
    SPIN_UP_S,
    TAGS,
    TOWER_M,
    UNEVEN,
    Entries,
    clear_m,
    drifts,
    hoisted,
    paces,
    revolves,
    wheels,
    winds,
)
from bench.challenge.families.lighthouse_watch import (
    DARK_S,
    FLASH_S,
    GROUP,
    HEARD,
    OF_ROWS,
    RESTS,
    flashes,
    walls_met,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "lighthouse")
WHEN = np.linspace(0.0, 9.0, 901)
HERE = np.array([9.0, 7.0, 1.5])


def _course(**other: float) -> dict[str, np.ndarray]:
    made = {"heart_x": 9.0, "heart_y": 7.0, "heart_z": 1.5, "heads": 0.0, "rate": 0.4}
    made |= {"reach": 2.0, "bend": 0.3, "phase": 0.4} | other
    return {name: np.full(len(WHEN), one) for name, one in made.items()}


def test_cressets_are_within_and_apart_and_nobody_is_outside_or_in_the_tank() -> None:
    assert clear_m(CRESSETS_M).min() > 0.3
    apart = np.linalg.norm(CRESSETS_M[:, None] - CRESSETS_M, axis=2) + 99 * np.eye(CRESSETS)
    assert apart.min() > 3.0
    assert clear_m(_known()[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy()).min() > 0.25
    assert clear_m(np.array([[OIL_M[0], OIL_M[1], 3.0]]))[0] == pytest.approx(-OIL_M[2])


def test_keepers_go_round_squares_or_circles_if_corners_are_cut() -> None:
    begun = 2.0 * np.exp(0.4j)
    off = paces(_course(rate=0.7), WHEN, 1.0) - HERE
    plane = off[:, 0] + 1j * off[:, 1] + begun
    assert np.allclose(np.abs(plane), 2.0)
    square = paces(_course(rate=0.7), WHEN) - HERE
    corner = 2.0 * 0.11 * np.exp(-1.2j)
    assert np.ptp(np.abs(square[:, 0] + 1j * square[:, 1] + begun + corner)) > 0.3


def test_tenders_slow_down_and_set_aside_and_gulls_go_along_trochoids() -> None:
    off = drifts(_course(rate=1.0, reach=3.0), WHEN) - HERE
    assert np.allclose(off[:, 0], 3.0 * (1 - np.exp(-WHEN / 3.0)))
    assert np.allclose(off[:, 1], 0.3 * off[:, 0])
    assert (np.diff(drifts(_course(), WHEN, 0.5)[:, 0] - drifts(_course(), WHEN)[:, 0]) > 0).all()
    wide = wheels(_course(), WHEN, 0.5) - HERE
    plain = wheels(_course(), WHEN) - HERE
    ahead = 0.4 * WHEN
    assert np.allclose(wide[:, 0] - ahead, 1.5 * (plain[:, 0] - ahead))
    assert np.allclose(wide[:, 1:], 1.5 * plain[:, 1:])


def test_cans_run_up_and_lenses_turn_unevenly_at_one_arm() -> None:
    up = hoisted(_course(rate=0.6), WHEN)[:, 2] - hoisted(_course(rate=0.0), WHEN)[:, 2]
    pace = np.gradient(up, WHEN)
    law = 0.6 * (1 - np.exp(-WHEN / SPIN_UP_S))
    assert np.allclose(pace[5:-5], law[5:-5], atol=1e-3)
    off = revolves(_course(), WHEN) - HERE
    assert np.allclose(np.hypot(off[:, 0], off[:, 1]), 2.0)
    angle = np.unwrap(np.arctan2(off[:, 1], off[:, 0]))
    even = 0.4 + 0.4 * WHEN
    assert np.allclose(angle - even, UNEVEN * (np.sin(2 * even) - np.sin(0.8)))


def test_donkeys_wind_in_by_so_many_e_folds_a_radian() -> None:
    for sooner in (0.0, 1.0):
        off = winds(_course(), WHEN, sooner) - HERE
        arm = np.log(np.hypot(off[:, 0], off[:, 1]) / 2.0)
        assert np.allclose(arm, -(1 + sooner) * 0.3 * 0.4 * WHEN)


def test_flashes_come_in_groups_with_dark_between() -> None:
    counts = np.array([5, 1, 9, 7])
    who, since_s = flashes(np.random.default_rng(4), counts)
    assert np.bincount(who).tolist() == counts.tolist()
    assert since_s[0] == 0.0
    gaps = np.diff(np.unique(since_s[who == 2]))
    assert gaps.min() >= FLASH_S[0] - 1e-9
    assert gaps.max() > FLASH_S[0] + DARK_S
    assert since_s.max() < 12 * FLASH_S[1] + DARK_S * GROUP + 0.1
    assert HEARD.sum() == len(OF_ROWS) == 137


def test_all_callings_stir_and_some_tags_rest_for_a_watch() -> None:
    rows = _known()
    assert {*rows["calling"]} == {*rows.loc[rows["stirs"] > 0, "calling"]} == {*range(6)}
    watches = rows.groupby(rows["link"].str.extract(r"watch (\d+)")[0])["stirs"].max()
    assert (watches == 0).sum() == RESTS
    assert rows["rx"].nunique() == CRESSETS
    assert rows["tx"].nunique() == len(TAGS)
    assert rows["environment"].nunique() == len(CALLINGS)
    assert (rows["azimuth_deg"].abs() <= 180.0).all()


def test_another_mix_shares_some_links_that_are_neither_near_nor_far() -> None:
    shown.assert_mixes_overlap("lighthouse")


def test_ways_go_through_walls_where_they_pass_these() -> None:
    east, north, radius = TOWER_M
    one = np.array([[east, north, 2.0], [east - 6, north, 2.0], [1.0, 1.0, 1.0], [36.0, 12.0, 1.0]])
    other = np.array([[east + 9, north, 3.0], [east + 6, north, 2.0], [5.0, 1.0, 1.0],
                      [27.0, 13.0, 1.0]])  # fmt: skip
    tower, cottage, window = walls_met(one, other)
    assert tower.tolist() == [1, 2, 0, 0]
    assert cottage.tolist() == [0, 0, 0, 0]
    assert window.tolist() == [0, 0, 0, 1]
    aside = np.array([0.0, radius + 0.1, 0.0])
    assert walls_met(one[1:2] + aside, other[1:2] + aside)[0].tolist() == [0]


def test_rows_know_who_is_heard_by_whom_and_sight_is_free_where_nothing_stands() -> None:
    rows = _known()
    entries = Entries(rows, 0, np.random.default_rng(0))
    assert [TAGS[k] for k in entries.tag[:9]] == rows["tx"].head(9).tolist()
    assert np.allclose(entries.cresset_m, CRESSETS_M[entries.cresset])
    assert np.allclose(np.linalg.norm(entries.tag_m - entries.cresset_m, axis=1), entries.far)
    assert np.allclose(entries.grows_m(entries.cresset_m - entries.tag_m), -entries.far)
    assert np.array_equal(rows["los"].to_numpy(bool), rows["obstacles"].map(len).eq(0))
