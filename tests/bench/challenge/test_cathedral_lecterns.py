"""The forms that the cathedral's effects have, and its lecterns: against laws that are known."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.cathedral_effects import (
    STONE,
    chord,
    edge_db,
    lobed,
    logistic,
    off_the_floor,
    over_two_edges,
    read_of_two,
    returned_by_stone,
)
from bench.challenge.families.cathedral_lectern import (
    AHEAD,
    ALIKE,
    METRES,
    WIDTH,
    chimes,
    levels_db,
    lingered,
    loudness,
    readings,
    sough,
)
from bench.challenge.families.cathedral_nave import WAVE_M, Vigil
from bench.challenge.families.cathedral_wave_effects import (
    DEEP,
    FALLS,
    HALF,
    POWER,
    RINGS,
    VAULT_M,
    begun_anew,
    by_a_needle,
    by_a_plane,
    cut_off,
    in_changes,
    keyed,
    mirrors,
    pipe,
    reverberant,
    strong_and_weak,
    unlike,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "cathedral")


def _vigil() -> Vigil:
    return Vigil(_known(), 0, np.random.default_rng(0))


def test_logistic_chances_scatter_by_one_and_have_their_tails() -> None:
    made = logistic(np.random.default_rng(1), 200_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert 3.9 < (made**4).mean() < 4.3  # of all of it 4.2; the farthest are brought in


def test_lobes_lack_nothing_ahead_and_a_half_in_the_mean() -> None:
    made = lobed(np.linspace(-np.pi, np.pi, 721))
    assert made[360] == pytest.approx(0.0)
    assert made[0] == pytest.approx(1.0)
    assert made[:-1].mean() == pytest.approx(0.5)
    assert made.min() > -1e-9
    assert made.max() < 1.1


def test_edges_take_six_db_where_grazed_and_as_kirchhoff_has_it_far_behind() -> None:
    one = np.array([4.0])
    assert edge_db(np.zeros(1), one, one)[0] == pytest.approx(6.02, abs=0.01)
    by = 3.0 * np.sqrt(2 / WAVE_M * 0.5)
    assert edge_db(np.array([3.0]), one, one)[0] == pytest.approx(
        20 * np.log10(np.sqrt(2) * np.pi * by), abs=0.02
    )


def test_the_way_over_two_edges_has_three_parts() -> None:
    longer, lost = over_two_edges(*(np.array([one]) for one in (10.0, 4.0, 0.5, 0.6)))
    assert longer[0] == pytest.approx(np.hypot(4.0, 0.6) + 0.5 + np.hypot(5.5, 0.6) - 10.0)
    assert lost[0] > 12.0
    none, grazed = over_two_edges(*(np.array([one]) for one in (10.0, 4.0, 0.5, 0.0)))
    assert none[0] == pytest.approx(0.0)
    assert grazed[0] == pytest.approx(12.04, abs=0.01)


def test_chords_are_those_of_circles() -> None:
    assert np.allclose(chord(np.array([0.0, 0.6, 1.0])), [1.0, 0.8, 0.0])


def test_stone_returns_nothing_at_brewsters_angle_and_less_if_rough() -> None:
    brewster = np.array([np.sin(np.arctan(1 / np.sqrt(STONE)))])
    assert returned_by_stone(brewster, np.zeros(1))[0] == pytest.approx(0.0, abs=1e-12)
    assert returned_by_stone(np.array([1e-6]), np.zeros(1))[0] == pytest.approx(-1.0, abs=1e-3)
    steep = np.full(2, 0.9)
    smooth, rough = returned_by_stone(steep, np.array([0.0, 0.01]))
    assert 0 < rough < smooth < 1


def test_the_way_by_the_floor_is_an_images() -> None:
    vigil = _vigil()
    longer, share = off_the_floor(vigil, 1.0)
    image = vigil.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + vigil.far, np.linalg.norm(image - vigil.boss_m, axis=1))
    assert np.abs(share).max() <= 0.8 + 1e-9


def test_what_ranges_have_of_two_pulses_is_what_lecterns_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late, high = read_of_two(np.full(4, 0.35), share.astype(np.complex128))
    top = np.full(4, 84.7)
    both = np.asarray(chimes(top) + share[:, None] * chimes(top + 0.35 / METRES), np.complex128)
    assert np.allclose(late, METRES * (readings(both) - top + AHEAD), atol=0.01)
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.02)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_pulses_rise_sooner_than_they_fall() -> None:
    fine = np.array([chimes(np.full(1, 70.0 - off))[0, 70] for off in np.linspace(-6, 6, 1201)])
    over = np.linspace(-6, 6, 1201)[fine >= 0.5]
    assert over[-1] > -over[0]
    assert over[-1] - over[0] == pytest.approx(WIDTH, rel=0.03)
    assert fine.max() == pytest.approx(1.0)


def test_noise_is_beside_itself_as_asked() -> None:
    noise = sough(np.random.default_rng(2), 4000)
    assert np.allclose(noise.real.std(axis=0), 1.0, atol=0.06)
    for apart, alike in enumerate((*ALIKE, 0.0)):
        there = (noise[:, apart:] * noise[:, : noise.shape[1] - apart].conj()).real.mean() / 2
        assert there == pytest.approx(alike, abs=0.01)


def test_pulses_that_come_later_are_as_they_were() -> None:
    wave = np.asarray(2.0j * chimes(np.array([60.25])), np.complex128)
    twice = lingered(lingered(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * chimes(np.full(1, 61.25))).max() < 0.03


def test_first_paths_are_read_however_high_and_never_sooner_if_deaf() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = chimes(top).astype(np.complex128)
    at = readings(one)
    assert np.allclose(top - at, AHEAD, atol=0.012)
    assert np.allclose(readings(30.0j * one), at, atol=1e-6)
    weak = 0.25 * one + chimes(top + 11.2)
    sharp, deaf = readings(weak), readings(weak, 2.0)
    assert np.allclose(sharp, at, atol=0.01)
    assert np.allclose(deaf - sharp, 11.2, atol=0.02)
    assert (readings(0.5 * one + chimes(top + 3.4), 2.0) >= at - 0.2).all()


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (25.0, 80.0):
        wave = high * chimes(top) + sough(np.random.default_rng(2), 1000)
        off = readings(wave) - top + AHEAD
        assert abs(np.median(off)) < 0.01
        assert (np.abs(off) > 0.5).mean() < 0.003
        assert off[np.abs(off) < 0.5].std() < 2.4 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-3)
    wave = (2.0 * chimes(top) + 1.0 * chimes(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.1)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.1)
    assert np.allclose(loudness(wave, top - AHEAD, quiet), 2.0, atol=0.02)


def test_walls_and_vaults_are_mirrors() -> None:
    vigil = _vigil()
    for axis, at_m in ((1, 7.0), (0, 38.0), (2, VAULT_M)):
        way, part = by_a_plane(vigil, axis, at_m)
        same = (vigil.tag_m[:, axis] - at_m) * (vigil.boss_m[:, axis] - at_m) > 0
        image = vigil.tag_m.copy()
        image[:, axis] = 2 * at_m - image[:, axis]
        far = np.linalg.norm(image - vigil.boss_m, axis=1)
        assert np.allclose(way[same], far[same])
        assert ((part >= 0) & (part <= 1)).all()
    for way, share in mirrors(vigil):
        assert (way >= vigil.far - 1e-9).all()
        assert ((share >= 0.0) & (share <= 1.0)).all()


def test_fades_are_of_a_strong_wave_amid_weak_ones_and_have_power_one() -> None:
    made = strong_and_weak(np.random.default_rng(2), 1500)
    assert (made**2).mean() == pytest.approx(1.0, abs=0.02)
    beside = np.corrcoef(made[:, 50], made[:, 51])[0, 1]
    apart = np.corrcoef(made[:, 50], made[:, 75])[0, 1]
    assert beside > 0.9
    assert abs(apart) < 0.1


def test_tails_die_off_by_a_power_of_time() -> None:
    since = np.array([-2.0, 0.0, HALF, 3 * HALF])
    assert np.allclose(reverberant(since), [0.0, 1.0, 2.0**-POWER, 4.0**-POWER])


def test_pipes_ring_evenly_less() -> None:
    made = np.abs(pipe(chimes(np.full(1, 20.0)).astype(np.complex128))[0])
    assert np.allclose(made[40:60] / made[39:59], RINGS, atol=0.01)
    assert made[:16].max() < 0.02


def test_tones_are_keyed_and_have_power_one() -> None:
    tone = np.abs(keyed(np.random.default_rng(3), 200))
    assert (tone**2).mean() == pytest.approx(1.0, abs=0.03)
    assert tone.max() / tone.min() == pytest.approx((1 + DEEP) / (1 - DEEP), rel=0.01)


def test_noise_is_said_by_how_unlike_sizes_are_and_parts_are_cut_off() -> None:
    noise = sough(np.random.default_rng(4), 400)
    assert unlike(3 * noise) == pytest.approx(3 * unlike(noise))
    assert unlike(np.array([1.0, 3.0])) == pytest.approx(1.0)  # of each with each, itself too
    kept = cut_off(3 * noise, 0.4)
    assert np.allclose(kept.real / 0.4, np.rint(kept.real / 0.4), atol=1e-9)
    assert (np.abs(kept.imag) <= np.abs(3 * noise.imag) + 1e-9).all()
    assert np.abs((kept - 3 * noise).real).max() < 0.4 + 1e-9


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes, begin = 1 + 10 * np.random.default_rng(6).random((3, 160)), np.array([20, 33, 90])
    for made in (in_changes, by_a_needle, begun_anew):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    changed = in_changes(np.arange(12.0)[None], np.array([4]))[0]
    assert changed.tolist() == [0, 1, 2, 3, 5, 4, 7, 6, 9, 8, 11, 10]
    needle = by_a_needle(sizes, begin)
    assert (needle >= sizes).all()
    assert (needle[0, 22:] >= FALLS * needle[0, 21:-1] - 1e-9).all()
    full = 1.25 * sizes[0, 20:].mean()
    anew = begun_anew(sizes, begin)[0, 20:]
    assert (anew < full).all()
    assert np.allclose((sizes[0, 20:] - anew) / full, np.rint((sizes[0, 20:] - anew) / full))
