"""What the tram shed and its bells do to late parts: what they are said to do."""

from __future__ import annotations

import numpy as np
import pytest

from bench.challenge.families.tramshed_oddities import (
    ASLANT,
    LEAST,
    NOTCH,
    NOTCHES,
    OPEN,
    PLAY,
    SIDE,
    SPENT,
    TRIPPED,
    TRIPS,
    aslant,
    broken,
    carried_on,
    highest_so_far,
    means_so_far,
    notched,
    played,
    roots_of_both,
    spent,
    turned_tables,
    what_is_left,
)

SOME = np.random.default_rng(3).gamma(2.0, 50.0, 125)


def test_orders_of_late_sizes_are_what_they_say() -> None:
    rows = np.arange(40.0)
    assert turned_tables(rows)[:11].tolist() == [10, *range(10)]
    assert turned_tables(rows)[11:22].tolist() == [20, 21, *range(11, 20)]
    assert sorted(ASLANT.tolist()) == [*range(SIDE * SIDE)]
    assert {*ASLANT[:3].tolist()} == {0, 1, SIDE}
    assert aslant(rows)[36:].tolist() == [36, 37, 38, 39]
    for one in (turned_tables, aslant, carried_on):
        assert np.allclose(np.sort(one(SOME)), np.sort(SOME))


def test_largest_of_dozens_come_last_and_sevens_never_fall() -> None:
    dozens = carried_on(SOME)[:120].reshape(-1, 12)
    assert np.array_equal(dozens[:, -1], SOME[:120].reshape(-1, 12).max(axis=1))
    sevens = highest_so_far(SOME)[:119].reshape(-1, 7)
    assert (np.diff(sevens, axis=1) >= 0).all()
    assert np.array_equal(sevens[:, -1], SOME[:119].reshape(-1, 7).max(axis=1))


def test_means_roots_and_what_is_left_are_of_what_is_about() -> None:
    assert means_so_far(SOME)[40] == pytest.approx(SOME[:41].mean())
    assert roots_of_both(SOME)[40] == pytest.approx(np.sqrt(SOME[38] * SOME[42]))
    assert what_is_left(SOME)[43] == pytest.approx(SOME[40:50].max() - SOME[43])
    assert len(what_is_left(SOME)) == len(SOME)


def test_gears_stay_within_their_play() -> None:
    made, half = played(SOME), PLAY * SOME.mean()
    assert (np.abs(made - SOME) <= half + 1e-9).all()
    stays = np.diff(made) == 0
    assert 0.1 < stays.mean() < 0.95


def test_breakers_open_after_large_ones_and_gains_sag_by_what_was_spent() -> None:
    plain = np.ones(40)
    plain[5] = 9.0
    made = broken(plain)
    assert TRIPS * plain.mean() < 9.0
    assert np.allclose(made[6 : 6 + OPEN], TRIPPED)
    assert np.allclose(made[6 + OPEN :], 1.0)
    even = spent(np.ones(50))
    assert np.allclose(np.log(even), -SPENT * np.arange(50) / 50)


def test_controllers_notch_up_and_shut_off() -> None:
    made = notched(np.ones(2 * NOTCH * NOTCHES))
    assert np.allclose(made[:NOTCH], LEAST)
    assert np.allclose(made[NOTCH * NOTCHES - NOTCH : NOTCH * NOTCHES], 1.0)
    assert made[NOTCH * NOTCHES] == pytest.approx(LEAST)
