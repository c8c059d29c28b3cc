"""The forms that the planetarium's effects have, and its almanacs: against laws that are known."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.planetarium_almanac import (
    AHEAD,
    ALIKE,
    HALF,
    METRES,
    STEPS,
    brights,
    glows,
    levels_db,
    looked_at,
    risings,
    set_later,
    starlight,
)
from bench.challenge.families.planetarium_dome import MIDDLE_M, RADIUS_M, WAVE_M, Seating
from bench.challenge.families.planetarium_effects import (
    SCREED,
    about_a_drum,
    carpeted,
    lacking,
    off_the_carpet,
    rise_of_two,
    secants,
)
from bench.challenge.families.planetarium_wave_effects import (
    BACK,
    CABLE,
    CLASS,
    DEPTH,
    KNOTS,
    PITCHES,
    WOBBLES,
    amid_steps,
    apart,
    by_a_screen,
    by_the_dome,
    by_the_table,
    by_the_wall,
    halves_changed,
    held,
    in_classes,
    of_two_rooms,
    returned,
    rung,
    two_waves,
    wobbling,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "planetarium")


def _seating() -> Seating:
    return Seating(_known(), 0, np.random.default_rng(0))


def test_secants_scatter_by_one_and_have_their_tails() -> None:
    made = secants(np.random.default_rng(1), 200_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert 4.3 < (made**4).mean() < 5.0  # of all of it 5; the farthest are left out


def test_patches_lack_nothing_ahead_and_all_behind() -> None:
    made = lacking(np.linspace(-np.pi, np.pi, 361))
    assert made[180] == pytest.approx(0.0)
    assert np.allclose(made[[0, 45, 315, 360]], 1.0)
    assert (np.diff(made[180:]) >= -1e-12).all()


def test_the_way_about_a_drum_is_tangents_and_an_arc() -> None:
    """From 3 m and 4 m off its axis, which is in the way itself."""
    radius, aside, ends = np.array([0.5]), np.array([0.0]), (np.array([3.0]), np.array([4.0]))
    longer, lost = about_a_drum(radius, aside, ends)
    tangents = np.sqrt(9 - 0.25) + np.sqrt(16 - 0.25)
    turn = np.pi - np.arccos(0.5 / 3) - np.arccos(0.5 / 4)
    assert longer[0] == pytest.approx(tangents + 0.5 * turn - 7.0)
    assert lost[0] == pytest.approx(
        8.686 * 2.02 * (np.pi * 0.5 / WAVE_M) ** (1 / 3) * turn, rel=1e-3
    )
    grazed, none = about_a_drum(radius, radius, ends)
    assert np.allclose([grazed[0], none[0]], 0.0, atol=1e-9)


def test_carpet_that_is_nothing_returns_what_screed_does() -> None:
    sine = np.linspace(0.05, 0.9, 40)
    root = np.sqrt(SCREED - 1 + sine**2)
    assert np.allclose(carpeted(sine, np.zeros(40)), (sine - root) / (sine + root))
    level = carpeted(np.array([1e-6]), np.array([0.01]))
    assert level[0] == pytest.approx(-1.0, abs=1e-3)
    assert np.abs(carpeted(sine, np.full(40, 0.01))).max() < 1.0


def test_the_way_by_the_floor_is_an_images() -> None:
    seating = _seating()
    longer, share = off_the_carpet(seating, 1.0)
    image = seating.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + seating.far, np.linalg.norm(image - seating.cove_m, axis=1))
    assert np.abs(share).max() <= 0.82 + 1e-9


def test_what_ranges_have_of_two_pulses_is_what_almanacs_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late, high = rise_of_two(np.full(4, 0.35), share)
    top = np.full(4, 81.6)
    both: Any = glows(top) + share[:, None] * glows(top + 0.35 / METRES)
    told = METRES * (risings(both, np.full(4, 1e-6)) - top + AHEAD)
    assert np.allclose(late, told, atol=0.01)
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_pulses_are_as_long_as_measured_and_half_as_high_ahead() -> None:
    at = np.linspace(0.0, 1.0, 1001)
    high = np.concatenate([glows(np.full(1, 70.0 + HALF * k))[:, 70] for k in at])
    assert 2 * HALF * np.interp(-0.5, -high, at) == pytest.approx(2 * AHEAD, abs=0.01)
    assert 2.1 < 2 * AHEAD < 2.7
    assert glows(np.full(1, 70.0))[0, 74:].max() < 1e-12


def test_noise_is_beside_itself_as_asked_from_the_first_sample_on() -> None:
    noise = starlight(np.random.default_rng(2), 4000)
    assert np.allclose(noise.real.std(axis=0), 1.0, atol=0.06)
    for apart_, alike in enumerate(ALIKE):
        there = (noise[:, apart_:] * noise[:, : noise.shape[1] - apart_].conj()).real.mean() / 2
        assert there == pytest.approx(alike, abs=0.01)


def test_sizes_between_samples_are_those_of_pulses() -> None:
    wave: Any = 2.0j * glows(np.array([60.25]))
    sizes = looked_at(wave.astype(np.complex128))[0]
    there = (
        2 * np.cos(0.5 * np.pi * ((np.arange(len(sizes)) / STEPS - 60.25) / HALF).clip(-1, 1)) ** 4
    )
    assert np.abs(sizes - there).max() < 0.02
    twice = set_later(set_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * glows(np.full(1, 61.25))).max() < 0.02


def test_rises_are_where_pulses_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = glows(top).astype(np.complex128)
    at = risings(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.012)
    assert np.allclose(risings(30.0j * one, quiet), at, atol=1e-6)
    weak = 0.25 * one + glows(top + 11.2)
    sharp, deaf = (risings(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.01)
    assert np.allclose(deaf - sharp, 11.2, atol=0.02)
    soon, late = (risings(0.5 * one + glows(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (25.0, 80.0):
        wave = high * glows(top) + starlight(np.random.default_rng(2), 1000)
        off = risings(wave, np.ones(1000)) - top + AHEAD
        assert abs(off.mean()) < 0.01
        assert off.std() < 2.4 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-3)
    wave = (2.0 * glows(top) + 1.0 * glows(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.1)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.1)
    assert np.allclose(brights(wave, top - AHEAD), 2.0)


def test_the_dome_returns_waves_where_ways_are_longest() -> None:
    seating = _seating()
    way, there = by_the_dome(seating)
    assert 0.2 < there.mean() <= 1.0
    assert (way > seating.far + 1.0).all()
    one, other = seating.tag_m[:1] - MIDDLE_M, seating.cove_m[:1] - MIDDLE_M
    even = np.random.default_rng(1).normal(size=(60_000, 3))
    even *= RADIUS_M / np.linalg.norm(even, axis=1)[:, None]
    every = np.linalg.norm(even - one, axis=1) + np.linalg.norm(even - other, axis=1)
    assert way[0] == pytest.approx(every.max(), abs=0.02)  # no other place is farther round


def test_the_wall_is_farthest_round_and_screens_and_the_table_are_mirrors() -> None:
    seating = _seating()
    way, there = by_the_wall(seating)
    assert 0.05 < there.mean() < 1.0
    bearing = np.linspace(0.0, 2 * np.pi, 20_000)
    flat = MIDDLE_M[:2] + RADIUS_M * np.stack([np.cos(bearing), np.sin(bearing)], axis=1)
    ends = (seating.tag_m[0], seating.cove_m[0])
    legs = sum(np.linalg.norm(flat - end[:2], axis=1) for end in ends)
    assert way[0] == pytest.approx(float(np.hypot(np.max(legs), ends[0][2] - ends[1][2])), abs=0.01)
    for axis, side in ((0, 1.0), (1, -1.0)):
        way, there = by_a_screen(seating, axis, side)
        image = seating.tag_m.copy()
        image[:, axis] = 2 * (MIDDLE_M[axis] + side * 10.9) - image[:, axis]
        far = np.linalg.norm(image - seating.cove_m, axis=1)
        assert np.allclose(way[there > 0], far[there > 0])
    way, there = by_the_table(seating)
    image = seating.tag_m * np.array([1.0, 1.0, -1.0]) + np.array([0.0, 0.0, 1.2])
    far = np.linalg.norm(image - seating.cove_m, axis=1)
    assert np.allclose(way[there > 0], far[there > 0])
    assert all((share >= 0.0).all() and (share <= 1.0).all() for _, share in returned(seating))


def test_fades_are_of_two_waves_and_have_power_one() -> None:
    made = two_waves(np.random.default_rng(2), 1500)
    assert (made**2).mean() == pytest.approx(1.0, abs=0.02)
    powers = made[:, ::KNOTS] ** 2
    apart_ = 2 * 0.8**2 + 4 * 0.45**2 * (1 + 0.8**2) + 4 * 0.45**4
    assert powers.var() == pytest.approx(apart_ / (1 + 0.8**2 + 2 * 0.45**2) ** 2, rel=0.06)


def test_tails_die_off_soon_and_then_slowly() -> None:
    since = np.linspace(0.0, 120.0, 400)
    slope = np.gradient(np.log(of_two_rooms(since)), since)
    assert slope[0] < -0.12
    assert slope[-1] == pytest.approx(-1 / 27.0, rel=0.01)
    assert (np.diff(slope)[2:-2] > -1e-9).all()
    assert not of_two_rooms(np.array([-3.0, -0.1])).any()


def test_cables_return_waves_again_and_again_upside_down() -> None:
    made = rung(glows(np.full(1, 20.0)).astype(np.complex128))[0]
    one = np.array([20 + CABLE * k for k in (1, 2, 3)])
    sizes = [(made * glows(np.full(1, at))[0]).sum().real for at in one]
    assert np.allclose(np.divide(sizes[1:], sizes[:-1]), -BACK, atol=0.01)
    assert np.abs(made[:20]).max() < 0.02


def test_tones_wobble_within_a_band() -> None:
    tone = wobbling(np.random.default_rng(3), 40)
    assert np.allclose(np.abs(tone), 1.0)
    pitch = np.angle(tone[:, 1:] * tone[:, :-1].conj())
    reach = DEPTH * WOBBLES[1]
    assert pitch.min() > PITCHES[0] - reach - 1e-9
    assert pitch.max() < PITCHES[1] + reach + 1e-9
    assert np.ptp(pitch, axis=1).min() > DEPTH * WOBBLES[0]


def test_noise_is_said_by_how_far_sizes_are_apart_and_parts_are_kept_amid_steps() -> None:
    noise = starlight(np.random.default_rng(4), 400)
    assert apart(3 * noise) == pytest.approx(3 * apart(noise))
    assert apart(noise) == pytest.approx(np.abs(noise).std(), rel=0.02)
    kept = amid_steps(3 * noise, 0.4)
    for part in (kept.real / 0.4, kept.imag / 0.4):
        assert np.allclose(part - 0.5, np.rint(part - 0.5), atol=1e-9)
    assert np.abs((kept - 3 * noise).real).max() <= 0.2 + 1e-9


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    rng = np.random.default_rng(6)
    sizes, begin = 1 + 10 * rng.random((3, 160)), np.array([20, 33, 90])
    for made in (in_classes, halves_changed, held):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    classes = np.log(in_classes(sizes, begin)[0, 20:] / sizes[0, 20:].mean()) / np.log(CLASS)
    assert np.allclose(classes, np.rint(classes))
    changed = halves_changed(np.arange(24.0)[None], np.array([12]))[0, 12:]
    assert changed.tolist() == [18, 19, 20, 21, 22, 23, 12, 13, 14, 15, 16, 17]
    kept = held(np.arange(24.0)[None], np.array([2]))[0, 2:]
    assert kept.tolist()[:14] == [2, 3, 4, 5, 5, 7, 7, 7, 10, 10, 10, 10, 10, 15]
