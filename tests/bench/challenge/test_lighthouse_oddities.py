"""What the lighthouse's rock and lenses do to late parts: what they are said to do."""

from __future__ import annotations

import numpy as np
import pytest

from bench.challenge.families.lighthouse_oddities import (
    DARK_GAIN,
    DIPS,
    FLASH,
    LIT,
    NIGHT,
    RUNS,
    WOUND,
    blackened,
    chords,
    dipped,
    flashed,
    inward,
    middle_of_five,
    odd_and_even,
    plotted,
    run_down,
)


def test_orders_of_late_sizes_are_what_they_say() -> None:
    some = np.arange(20.0)
    assert odd_and_even(some)[:8].tolist() == [1, 3, 5, 7, 0, 2, 4, 6]
    assert odd_and_even(some)[16:].tolist() == [16, 17, 18, 19]
    assert inward(some)[:8].tolist() == [0, 6, 1, 5, 2, 4, 3, 7]
    assert sorted(inward(some).tolist()) == some.tolist()


def test_plates_blacken_by_half_at_the_middle_and_no_more_when_bright() -> None:
    some = np.random.default_rng(2).gamma(2.0, 50.0, 121)
    middle = float(np.median(some))
    made = blackened(some)
    assert np.array_equal(np.argsort(made), np.argsort(some))
    assert made.max() < 2.2 * middle
    assert np.interp(1.3 * middle, np.sort(some), np.sort(made)) == pytest.approx(
        1.1 * middle, rel=0.02
    )


def test_horizons_chords_and_middles_are_of_what_is_beside() -> None:
    some = np.random.default_rng(3).gamma(2.0, 50.0, 125)
    assert dipped(some)[60] == pytest.approx(abs(some[60] - DIPS * some[56:65].mean()))
    assert np.allclose(chords(some)[:120:6], some[:120:6])
    assert chords(some)[3] == pytest.approx(0.5 * (some[0] + some[6]))
    assert chords(some)[-1] == some[-1]
    assert middle_of_five(some)[40] == np.median(some[38:43])


def test_time_by_its_logarithm_begins_and_ends_as_it_was_and_is_slow_at_first() -> None:
    made = plotted(np.arange(120.0))
    assert made[0] == 0.0
    assert made[-1] == pytest.approx(119.0)
    assert (np.diff(made) > 0).all()
    assert made[1] < 0.4
    assert np.diff(made)[-1] > 1.8


def test_gains_flash_in_groups_and_run_down_until_wound() -> None:
    lit = flashed(np.ones(2 * FLASH * LIT + NIGHT + FLASH))
    assert (lit[:FLASH] == 1.0).all()
    assert (lit[FLASH : 2 * FLASH] == DARK_GAIN).all()
    assert (lit[2 * FLASH * LIT : -FLASH] == DARK_GAIN).all()
    assert (lit[-FLASH:] == 1.0).all()
    wound = run_down(np.ones(2 * WOUND))
    assert wound[0] == wound[WOUND] == 1.0
    assert wound[WOUND - 1] == pytest.approx(RUNS)
    assert np.allclose(np.diff(wound[:WOUND]), (RUNS - 1) / (WOUND - 1))
