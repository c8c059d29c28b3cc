"""The forms that the baths' effects have, and their probes: against laws that are known."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.special import j0

from bench.challenge.families.baths_effects import (
    KRONROD,
    WATER,
    edge_db,
    even_ripples,
    langevin,
    off_the_water,
    over_two_db,
    sagitta,
    slanting_m,
    thinner,
    wet_wood,
)
from bench.challenge.families.baths_hall import WAVE_M, Heat
from bench.challenge.families.baths_probe import (
    AHEAD,
    ALIKE,
    TAPS,
    centre,
    first_paths,
    ripple,
    ripples,
)
from bench.challenge.families.baths_wave_effects import (
    HOLDS,
    LEVELS,
    STAYS,
    as_cosines,
    carried_codes,
    caustic,
    cosines,
    mirrored,
    schlick,
    skipped,
    time_code,
    wandering,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "baths")


def test_kronrods_places_are_right_for_tenth_powers() -> None:
    half = KRONROD[:, 1] * np.where(KRONROD[:, 0] > 0, 2.0, 1.0)
    assert np.allclose([(half * KRONROD[:, 0] ** k).sum() for k in (0, 2, 4, 6, 8, 10)],
                       [2 / (k + 1) for k in (0, 2, 4, 6, 8, 10)])  # fmt: skip


def test_water_is_densest_at_four_degrees_and_magnets_turn_as_langevin_has_it() -> None:
    assert thinner(3.9863) == 0.0
    assert thinner(25.0) == pytest.approx(1 - 0.997047 / 0.999972, abs=2e-6)  # g/cm3
    field = np.array([-1e-6, 0.3, 50.0])
    assert np.allclose(langevin(field), [0.0, 0.0994, 0.98], atol=1e-3)
    assert sagitta(np.array([np.pi]))[0] == pytest.approx(0.0)
    assert (np.diff(sagitta(np.linspace(0, np.pi, 30))) < 0).all()


def test_things_are_as_late_as_their_mixtures_and_slants_have_it() -> None:
    assert np.allclose(wet_wood(np.array([0.0, 1.0])), [1.9, 64.0])
    deep = np.full(2, 0.2)
    late = slanting_m(deep, 4.0, np.array([0.0, 1.0]))
    assert late[0] == pytest.approx(0.2)
    assert late[1] > late[0]


def test_ripples_return_by_bessels_law_and_none_that_is_upright_near_brewsters_angle() -> None:
    down, high = np.array([0.1, 0.4, 0.8]), np.full(3, 0.006)
    assert np.allclose(even_ripples(down, high), j0(4 * np.pi / WAVE_M * high * down), atol=1e-6)
    longer, share = off_the_water(Heat(_known(), 0, np.random.default_rng(0)), 1.0)
    up = _known()["rx_z_m"] + _known()["tx_z_m"]
    flat = _known()["true_range_m"] ** 2 - (_known()["rx_z_m"] - _known()["tx_z_m"]) ** 2
    assert np.allclose(longer + _known()["true_range_m"], np.sqrt(flat + up**2))
    assert np.abs(share).max() <= 0.84 + 1e-9
    sines = np.linspace(0.01, 1.0, 200)
    root = np.sqrt(WATER - 1 + sines**2)
    back = np.abs((WATER * sines - root) / (WATER * sines + root))
    assert 0.08 < sines[back.argmin()] < 0.18


def test_edges_take_six_db_where_they_touch_and_two_take_more_than_one() -> None:
    over = np.linspace(-1.0, 5.0, 1201)
    found = edge_db(over)
    assert np.abs(np.diff(found)).max() < 0.2
    assert edge_db(np.zeros(1))[0] == pytest.approx(6.02)
    legs = (np.full(1, 4.0), np.full(1, 0.6), np.full(1, 5.0))
    two = over_two_db(legs, (np.full(1, 0.2), np.full(1, 0.2)))[0]
    one = edge_db(np.array([0.2 * np.sqrt(2 / WAVE_M * (1 / 4.0 + 1 / 5.6))]))[0]
    assert one < two < one + 12.0


def test_walls_return_what_they_do_head_on_and_all_that_grazes_them() -> None:
    assert schlick(0.4, np.ones(1))[0] == pytest.approx(0.4)
    assert schlick(0.4, np.zeros(1))[0] == pytest.approx(1.0)


def test_noise_is_summed_by_a_root_of_what_it_is_to_be_alike() -> None:
    assert np.allclose(np.correlate(TAPS, TAPS, "full")[3:], ALIKE, atol=1e-9)
    assert (np.abs(np.roots(TAPS)) < 1.0).all()


def test_first_centres_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    half = np.interp(-0.5, -ripple(np.linspace(0, 3, 999)), np.linspace(0, 3, 999))
    assert 2.1 < 2 * half < 2.7
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = ripples(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.02)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + ripples(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(deaf - sharp, 11.2, atol=0.06)
    soon, late = (first_paths(0.5 * one + ripples(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_centres_of_what_is_even_about_a_place_are_there() -> None:
    place = np.arange(80)
    values = np.stack([np.exp(-0.5 * ((place - 40.3) / 6.0) ** 2)])
    assert centre(values, np.array([40]))[0] == pytest.approx(40.3, abs=0.05)


def test_time_codes_keep_to_their_levels_and_chances_wander() -> None:
    sizes = np.abs(time_code(np.random.default_rng(4), 60))
    kept = np.isclose(sizes[..., None], LEVELS).any(axis=2)
    assert kept.mean() == pytest.approx(1 - 0.2 * 0.75, abs=0.06)
    assert HOLDS * (1 - kept.mean()) > 0.5
    chance = wandering(np.random.default_rng(4), 500)
    assert chance.std() == pytest.approx(1.0, abs=0.03)
    beside = (chance[:, 1:] * chance[:, :-1]).mean()
    assert beside == pytest.approx(STAYS, abs=0.03)


def test_caustics_ring_ever_faster_and_die_away() -> None:
    taps = caustic()
    assert not taps[:2].any()
    assert np.abs(taps).max() < 0.6
    crossings = np.flatnonzero(np.diff(np.sign(taps[taps != 0.0])))
    assert np.diff(crossings)[-3:].mean() <= np.diff(crossings)[:3].mean()
    assert np.abs(taps[-6:]).max() < 0.03


def test_codes_go_up_and_leap_at_carries() -> None:
    values = np.linspace(-9.0, 9.0, 3001)
    codes = carried_codes(values, 1.0)
    assert (np.diff(codes) >= 0).all()
    leaps = np.diff(np.unique(np.round(codes, 9)))
    assert {*np.round(leaps, 6)} == {0.915, 1.255}
    assert np.abs(codes - values).mean() < 0.4
    assert abs((codes - values).mean()) < 0.08


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes = np.arange(40.0)[None] + 1.0
    begin = np.array([[10]])
    left = skipped(sizes, begin)[0]
    assert np.array_equal(left[:14], sizes[0, :14])
    assert left[14:22].tolist() == [16, 17, 18, 19, 21, 22, 23, 24]
    assert np.allclose(cosines() @ cosines().T, np.eye(12))
    packed = as_cosines(np.ones((1, 40)), begin)[0]
    assert np.array_equal(packed[:10], np.ones(10))
    assert np.allclose(packed[10:22], [np.sqrt(12), *np.zeros(11)])
    both = mirrored(sizes, begin, 8)[0]
    assert np.allclose(both[10:18], 0.5 * (11 + 18))
    assert np.array_equal(both[18:], sizes[0, 18:])
