"""The forms that the observatory's effects have, and its plates: against laws that are known."""

from __future__ import annotations

from functools import partial
from itertools import pairwise

import numpy as np
import pytest
from scipy.special import fresnel

from bench.challenge.families.observatory_effects import (
    CHEBYSHEV,
    FLOOR,
    TWO_POLES,
    chord_m,
    cornu,
    even_enough,
    off_the_floor,
    past_a_stand,
    through_square_m,
)
from bench.challenge.families.observatory_hall import Exposure
from bench.challenge.families.observatory_plate import (
    AHEAD,
    first_paths,
    heights,
    moffat,
    outstanding,
    stars,
)
from bench.challenge.families.observatory_wave_effects import (
    CHIP,
    chips,
    clipped,
    combed,
    guided,
    returned,
    round_the_pier,
    spilled,
    time_signal,
    trailed,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "observatory")


def test_rules_of_two_lags_and_of_equal_weights_are_right_for_cubics() -> None:
    moments = [sum(by * age**power for age, by in TWO_POLES) for power in range(4)]
    assert np.allclose(moments, [1.0, 2.0, 6.0, 24.0])
    assert np.allclose([(CHEBYSHEV**k).mean() for k in range(4)], [1, 1 / 2, 1 / 3, 1 / 4])


def test_stands_take_what_fresnel_has_and_round_columns_the_most_amid() -> None:
    at = np.linspace(-4.0, 4.0, 81)
    sine, cosine = fresnel(at)
    assert np.allclose(cornu(at), cosine + 1j * sine, atol=0.003)
    wide = past_a_stand(np.full(1, -9.0), np.full(1, 1e-9))[0]
    assert wide == pytest.approx(6.0, abs=0.6)  # a half plane that touches the way
    assert past_a_stand(np.zeros(1), np.zeros(1))[0] == pytest.approx(0.0)
    aside = np.linspace(0.0, 1.0, 9)
    chords = chord_m(np.full(9, 0.2), aside)
    assert chords[[0, -1]] == pytest.approx([0.4, 0.0])
    assert (np.diff(chords) < 0).all()
    turned = np.linspace(0.0, np.pi, 50)
    assert (through_square_m(np.ones(50), turned) <= np.sqrt(2) + 1e-9).all()
    assert through_square_m(np.ones(1), np.zeros(1))[0] == pytest.approx(1.0)


def test_floors_return_as_fresnel_has_it_and_the_less_the_less_even_they_are() -> None:
    down = np.array([0.1, 0.5, 0.9])
    root = np.sqrt(FLOOR - 1 + down**2)
    assert np.allclose(-np.exp(-2 * np.arctanh(down / root)), (down - root) / (down + root))
    uneven = [even_enough(down, np.full(3, one)) for one in (0.0, 0.002, 0.01)]
    assert np.allclose(uneven[0], 1.0)
    assert all((more <= less).all() for less, more in pairwise(uneven))
    longer, share = off_the_floor(Exposure(_known(), 0, np.random.default_rng(0)), 1.0)
    image = _known()["rx_z_m"] + _known()["tx_z_m"]
    flat = _known()["true_range_m"] ** 2 - (_known()["rx_z_m"] - _known()["tx_z_m"]) ** 2
    assert np.allclose(longer + _known()["true_range_m"], np.sqrt(flat + image**2))
    assert np.abs(share).max() <= 0.84 + 1e-9


def test_walls_return_all_that_grazes_them_and_roots_of_a_ninth_of_what_comes_straight() -> None:
    assert returned(4.0, np.full(1, 1e-4))[0] == pytest.approx(1.0, abs=1e-3)
    assert returned(4.0, np.full(1, 0.9999))[0] == pytest.approx(1 / 3, abs=1e-3)
    late, left = round_the_pier(np.array([0.0, np.pi, 2 * np.pi]), np.full(3, 0.5))
    assert np.allclose(late, [0.0, 0.5 * np.pi, np.pi])
    assert left[0] == 1.0
    assert left[2] == pytest.approx(left[1] ** 2)


def test_first_tops_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    assert 2 * np.interp(-0.5, -moffat(np.linspace(0, 4, 999)), np.linspace(0, 4, 999)) < 2.8
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = stars(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.02)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + stars(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(deaf - sharp, 11.2, atol=0.05)
    soon, late = (first_paths(0.5 * one + stars(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_heights_are_those_of_pulses_whatever_ground_they_stand_on() -> None:
    place = np.arange(-60, 61) / 8
    sizes = np.stack([3.0 * moffat(place), 5.0 + 3.0 * moffat(place)])
    fits = heights(sizes)
    assert np.allclose(fits[:, 60], 3.0)
    assert fits[:, 20:101].argmax(axis=1).tolist() == [40, 40]


def test_what_is_higher_soon_after_outstands_a_top() -> None:
    values = np.zeros((1, 60))
    values[0, [10, 20, 50]] = (1.0, 2.0, 3.0)
    assert np.flatnonzero(outstanding(values)[0]).tolist() == [20, 50]


def test_chips_go_round_and_tubes_ring_from_their_cutoff_on() -> None:
    found = chips()
    assert len(found) == 511
    assert abs(found.sum()) == 1
    assert abs(found @ np.roll(found, 7)) == 1
    wave = time_signal(np.random.default_rng(4), 30)
    assert np.allclose(np.abs(wave), 1.0)
    jumps = np.abs(np.diff(np.angle(wave), axis=1)) > 1e-6
    assert jumps.mean() == pytest.approx(0.5 / CHIP, rel=0.2)
    taps = guided()
    assert not taps[:2].any()
    assert np.abs(taps).max() <= 1.0
    assert np.abs(taps[-6:]).max() < 0.1


def test_honeycombs_and_oddities_of_late_sizes_do_what_they_say() -> None:
    rng = np.random.default_rng(4)
    waves = rng.normal(size=(3, 240)) + 1j * rng.normal(size=(3, 240))
    cells = combed(waves, 0.5)
    assert np.abs(cells - waves).max() <= 0.5 / np.sqrt(3) + 1e-9
    assert np.allclose(combed(cells, 0.5), cells)
    sizes = np.abs(waves)
    blow = np.zeros((1, 8))
    blow[0, 2] = 1.0
    assert np.allclose(trailed(blow, 0.5)[0, 2:5], [0.5, 0.25, 0.125])
    spilt = spilled(np.array([[0.0, 0.0, 5.0, 0.0, 0.0]]), np.full(1, 1.0))
    assert np.allclose(spilt, [[2.0, 0.0, 1.0, 0.0, 2.0]])
    kept = clipped(sizes, 0.8) == sizes
    assert 0.2 < kept.mean() < 0.8
