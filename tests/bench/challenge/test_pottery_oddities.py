"""What the pottery and its cones do to late parts: what they are said to do."""

from __future__ import annotations

import numpy as np
import pytest

from bench.challenge.families.pottery_cone import cast_later, thuds
from bench.challenge.families.pottery_oddities import (
    HANDS,
    MESH,
    NECK,
    POTS,
    ROUNDS,
    WEDGE,
    WIDE,
    as_bends,
    bottled,
    by_a_cone,
    chequered,
    least_of_three,
    of_one_height,
    of_two_hands,
    off_their_mean,
    sieved,
    thrown_round,
    wedged,
)

SOME = np.random.default_rng(3).gamma(2.0, 50.0, 125)


def test_orders_of_late_sizes_are_what_they_say() -> None:
    rows = np.arange(24.0)
    assert WEDGE.tolist() == [0, 11, 1, 10, 2, 9, 3, 8, 4, 7, 5, 6]
    assert wedged(rows)[:4].tolist() == [0.0, 6.0, 11.0, 5.0]
    assert thrown_round(rows)[:12].tolist() == [0, 1, 2, 3, 20, 21, 22, 23, 4, 5, 6, 7]
    for one in (wedged, thrown_round):
        assert np.allclose(np.sort(one(SOME)), np.sort(SOME))
        assert not np.allclose(one(SOME), SOME)


def test_least_ones_means_and_bends_are_of_what_is_about() -> None:
    assert least_of_three(SOME)[40] == SOME[39:42].min()
    near = SOME[40 - WIDE : 41 + WIDE].mean()
    assert off_their_mean(SOME)[40] == pytest.approx(abs(SOME[40] - near))
    assert as_bends(SOME)[40] == pytest.approx(abs(2 * SOME[40] - SOME[39] - SOME[41]))
    line = np.arange(60.0)
    assert np.allclose(as_bends(line)[1:-1], 0.0)
    assert np.allclose(off_their_mean(line)[WIDE:-WIDE], 0.0)


def test_eights_are_of_one_height_and_sieves_keep_the_sum() -> None:
    eights = of_one_height(SOME)[:120].reshape(-1, 8).max(axis=1)
    assert np.allclose(eights, eights[0])
    made = sieved(SOME)
    assert made[:-2].sum() <= SOME.sum() + 1e-9
    assert made.sum() == pytest.approx(SOME.sum(), rel=0.02)
    alone = np.full(30, 1.0)
    alone[10] = 9.0
    mesh = MESH * alone.mean()
    assert sieved(alone)[10:13].tolist() == pytest.approx([mesh, 1 + (9 - mesh) / 2] * 1
                                                          + [1 + (9 - mesh) / 2])  # fmt: skip


def test_cones_bend_about_the_mean_and_hands_take_turns() -> None:
    even = by_a_cone(np.full(20, 7.0))
    assert np.allclose(even, 7.0)
    assert by_a_cone(SOME).max() < 2 * SOME.mean()
    assert (np.diff(by_a_cone(np.sort(SOME))) >= 0).all()
    turns = of_two_hands(np.ones(8 * POTS))[::POTS]
    assert turns.tolist() == [HANDS[k] for k in (0, 1, 1, 0, 1, 0, 0, 1)]


def test_bottles_are_narrow_at_both_ends_with_a_low_belly() -> None:
    made = bottled(np.ones(120))
    assert made[0] == made[-1] == pytest.approx(NECK[0])
    assert made.max() == pytest.approx(NECK[1], abs=1e-3)
    assert 20 < made.argmax() < 60


def test_chequers_pass_all_power_but_later() -> None:
    wave = thuds(np.full(3, 60.0)).astype(np.complex128)
    later = np.array([5.0, 7.5, 9.0])
    made = chequered(wave, later, 0.6)
    assert (np.abs(made) ** 2).sum() == pytest.approx((np.abs(wave) ** 2).sum(), rel=0.02)
    assert np.allclose(chequered(wave, later, 0.0), cast_later(wave, later))
    where = (np.abs(made) ** 2 @ np.arange(236.0)) / (np.abs(made) ** 2).sum(axis=1)
    assert np.allclose(where - 60.0, later, atol=0.6)
    assert ROUNDS >= 5
