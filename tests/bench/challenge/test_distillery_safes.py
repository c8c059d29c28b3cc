"""The forms that the distillery's effects have, and its safes: against laws that are known."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.distillery_effects import (
    WAVE_M,
    WET_FLOOR,
    by_pots,
    creeping,
    level_waves,
    of_a_cut,
    off_the_floor,
    slab,
    strapped,
    told_of_two,
)
from bench.challenge.families.distillery_house import POTS_M, Run
from bench.challenge.families.distillery_safe import (
    AHEAD,
    ALIKE,
    METRES,
    OF_SIZES,
    REACH,
    SIEVE,
    STEPS,
    calm,
    drawn_out,
    drops,
    matched,
    run_later,
    seething,
    strengths_db,
    tellings,
)
from bench.challenge.families.distillery_wave_effects import (
    CABLE,
    GROWS,
    RETURNS,
    RIDGE_M,
    SLOPE,
    astray,
    backwards,
    between_steps,
    by_a_slope,
    by_knots,
    grown_and_waned,
    half_way_on,
    hearts,
    off_pots,
    to_and_fro,
    warbling,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "distillery")


def _run() -> Run:
    return Run(_known(), 0, np.random.default_rng(0))


def test_straps_shade_what_is_behind_them_alone() -> None:
    made = strapped(np.radians([180.0, -180.0, 0.0, 90.0]))
    assert np.allclose(made[:2], 1.0)
    assert made[2] < 0.05
    assert made[2] < made[3] < 0.25


def test_crystals_drift_by_a_cubic() -> None:
    assert np.allclose(of_a_cut(np.array([21.0, 38.0, 4.0])), [0.0, 1.0, -1.0])
    assert np.ptp(np.diff(of_a_cut(np.linspace(4, 38, 50)), n=3)) < 1e-12


def test_slabs_delay_by_their_root_and_more_if_aslant() -> None:
    straight, aslant = slab(4.0, np.full(2, 0.1), np.array([0.0, 0.8]))
    assert straight == pytest.approx(0.1)
    assert aslant == pytest.approx(0.1 * (np.sqrt(4 - 0.64) - 0.6))
    assert slab(1.0, np.full(1, 0.3), np.array([0.5]))[0] == pytest.approx(0.0)


def test_what_creeps_goes_by_tangents_and_an_arc() -> None:
    longer, lost = creeping(*(np.array([one]) for one in (10.0, 5.0, 1.0)))
    angle = 2 * np.arcsin(0.2)
    assert longer[0] == pytest.approx(2 * np.sqrt(24.0) + angle - 10.0)
    assert lost[0] == pytest.approx(6.0 + 8.686 * 1.01 * (np.pi / WAVE_M) ** (1 / 3) * angle)
    none, grazed = creeping(*(np.array([one]) for one in (10.0, 5.0, 1e-9)))
    assert none[0] == pytest.approx(0.0, abs=1e-7)
    assert grazed[0] == pytest.approx(6.0, abs=1e-3)


def test_level_waves_are_turned_over_at_any_angle_and_more_so_if_they_graze() -> None:
    made = level_waves(np.array([1e-7, 0.3, 1.0]), WET_FLOOR)
    assert made[0] == pytest.approx(-1.0, abs=1e-3)
    root = np.sqrt(WET_FLOOR)
    assert made[2] == pytest.approx((1 - root) / (1 + root))
    assert -1.0 < made[1].real < made[2].real < 0.0


def test_ways_by_the_floor_and_by_pots_are_as_long_as_images_are_far() -> None:
    run = _run()
    longer, share = off_the_floor(run, 1.0)
    image = run.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + run.far, np.linalg.norm(image - run.lintel_m, axis=1))
    assert np.abs(share).max() <= 0.78 + 1e-9
    every = np.stack([way for way, _ in off_pots(run)]) - run.far
    late = by_pots(run)
    near = np.abs(every.clip(0.6, 3.9) - late).min(axis=0)
    assert near.max() < 1e-9
    assert len(every) == len(POTS_M)


def test_what_ranges_have_of_two_pulses_is_what_safes_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late, high = told_of_two(np.full(4, 0.35), share.astype(np.complex128))
    top = np.full(4, 84.7)
    both = np.asarray(drops(top) + share[:, None] * drops(top + 0.35 / METRES), np.complex128)
    assert np.allclose(late, METRES * (tellings(both) - top + AHEAD), atol=5e-3)
    assert late[0] > 0.02
    assert late[1] < -0.02
    assert late[3] == pytest.approx(0.0, abs=1e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)


def test_pulses_are_even_never_below_nought_and_none_where_they_end() -> None:
    off = np.linspace(-12.0, 12.0, 2401)
    high = np.array([drops(np.full(1, 90.0 - one))[0, 90] for one in off])
    assert np.allclose(high, high[::-1])
    assert high.min() >= 0.0
    over = off[high >= 0.5]
    assert 2.2 < over[-1] - over[0] < 2.7  # of a DW1000 about 2.5
    assert high[np.abs(off) > REACH].max() < 0.003
    assert drops(np.full(1, 90.0 - REACH))[0, 90] == pytest.approx(0.0, abs=1e-12)


def test_noise_comes_through_a_sieve_of_four_taps() -> None:
    assert np.allclose(np.correlate(SIEVE, SIEVE, "full")[3:], ALIKE, atol=1e-6)
    noise = seething(np.random.default_rng(2), 3000)
    assert np.allclose(noise.real.std(axis=0), 1.0, atol=0.07)
    assert np.abs(noise).std() == pytest.approx(OF_SIZES, rel=0.01)


def test_pulses_that_come_later_are_as_they_were_and_drawn_out_without_loss() -> None:
    wave = np.asarray(2.0j * drops(np.array([60.25])), np.complex128)
    twice = run_later(run_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * drops(np.full(1, 61.25))).max() < 1e-3
    power = drawn_out(wave)
    assert np.allclose(power[:, ::STEPS], np.abs(wave) ** 2, atol=1e-9)
    assert power.argmax() == 60.25 * STEPS


def test_calm_blocks_are_not_moved_by_one_that_is_loud() -> None:
    noise = 3.0 * seething(np.random.default_rng(5), 800)
    quiet = calm(noise)
    assert 0.7 < np.median(quiet) / (3.0 * np.sqrt(2)) < 1.0
    noise[:, 10:18] *= 20.0
    assert np.median(calm(noise)) < 1.25 * np.median(quiet)


def test_first_paths_are_read_however_high_and_never_sooner_if_dull() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = drops(top).astype(np.complex128)
    at = tellings(one)
    assert np.allclose(top - at, AHEAD, atol=0.005)
    assert np.allclose(tellings(30.0j * one), at, atol=1e-6)
    weak = 0.25 * one + drops(top + 11.2)
    sharp, dull = tellings(weak), tellings(weak, 1.0)
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(dull - sharp, 11.2, atol=0.02)
    assert (tellings(0.5 * one + drops(top + 3.4), 2.0) >= at - 0.2).all()


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (20.0, 80.0):
        off = tellings(high * drops(top) + seething(np.random.default_rng(2), 1000)) - top + AHEAD
        assert abs(np.median(off)) < 0.01
        assert (np.abs(off) > 0.5).mean() < 0.003
        assert off[np.abs(off) < 0.5].std() < 1.6 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-4)
    wave = (2.0 * drops(top) + 1.0 * drops(top + 20.0)).astype(np.complex128)
    every, first = strengths_db(wave, top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.02)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.02)
    noisy = 9.0 * drops(np.full(4000, 90.4)) + seething(np.random.default_rng(8), 4000)
    high = matched(noisy, np.full(4000, 90.4 - AHEAD), np.ones(4000))
    assert (high**2).mean() == pytest.approx(81.0, rel=0.01)


def test_slopes_of_the_roof_are_mirrors() -> None:
    run = _run()
    for side in (1.0, -1.0):
        out = np.array([0.0, side * np.sin(SLOPE), np.cos(SLOPE)])
        behind = run.tag_m + 2 * ((np.array([0.0, *RIDGE_M]) - run.tag_m) @ out)[:, None] * out
        way, there = by_a_slope(run, side)
        own = there > 0
        far = np.linalg.norm(behind - run.lintel_m, axis=1)
        assert own.any()
        assert np.allclose(way[own], far[own])


def test_fades_have_power_one_and_are_alike_within_knots() -> None:
    made = by_knots(np.random.default_rng(2), 3000)
    assert (made**2).mean() == pytest.approx(1.0, abs=0.02)
    assert np.corrcoef(made[:, 50], made[:, 51])[0, 1] > 0.8
    assert abs(np.corrcoef(made[:, 50], made[:, 75])[0, 1]) < 0.1


def test_tails_grow_before_they_wane() -> None:
    made = grown_and_waned(np.array([-3.0, 0.0, GROWS, 60.0, 77.0]))
    assert np.allclose(made[:2], 0.0)
    assert made[2] > made[3] > 0.0
    assert made[4] / made[3] == pytest.approx(np.exp(-1.0), rel=1e-3)


def test_cables_return_less_each_time_and_the_other_way_up() -> None:
    made = to_and_fro(drops(np.full(1, 60.0)).astype(np.complex128))[0].real
    like = [drops(np.full(1, 60.0 + turn * CABLE))[0] for turn in (1, 2, 3)]
    size = [float(made @ one / (one @ one)) for one in like]
    assert size[1] / size[0] == pytest.approx(-RETURNS, abs=0.12)
    assert size[2] / size[1] == pytest.approx(-RETURNS, abs=0.12)
    assert np.abs(made[:58]).max() < 0.01


def test_tones_swing_about_their_pitch_and_keep_their_size() -> None:
    tone = warbling(np.random.default_rng(3), 200)
    assert np.allclose(np.abs(tone), 1.0)
    pitch = np.angle(tone[:, 1:] * tone[:, :-1].conj())
    assert np.ptp(pitch, axis=1).max() > 0.2
    assert 0.4 < pitch.mean(axis=1).mean() < 1.3


def test_noise_is_said_by_how_sizes_scatter_and_parts_lie_between_steps() -> None:
    noise = seething(np.random.default_rng(4), 900)
    assert astray(noise) == pytest.approx(OF_SIZES, rel=0.02)
    assert astray(3 * noise) == pytest.approx(3 * astray(noise))
    kept = between_steps(noise, 0.4)
    assert np.allclose(kept.real / 0.4 % 1.0, 0.5)
    assert np.abs((kept - noise).imag).max() <= 0.2 + 1e-9


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes, begin = 1 + 10 * np.random.default_rng(6).random((3, 160)), np.array([20, 33, 90])
    for made in (hearts, backwards, half_way_on):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    tens = np.arange(23.0)[None]
    assert hearts(tens, np.array([3]))[0, 3:13].tolist() == [6, 6, 6, 6, 7, 8, 9, 9, 9, 9]
    assert backwards(tens, np.array([4]))[0, 4:12].tolist() == [10, 9, 8, 7, 6, 5, 4, 17]
    assert half_way_on(tens, np.array([19]))[0, 19:].tolist() == [20, 21, 20, 21]
