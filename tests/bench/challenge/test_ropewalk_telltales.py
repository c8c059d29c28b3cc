"""The forms that the ropewalk's effects have, and its telltales: against laws that are known."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.stats import weibull_min

from bench.challenge.families.ropewalk_effects import (
    CLAY,
    ROUGH_M,
    about_iron,
    crept,
    of_earth,
    off_the_floor,
    past_db,
    tents,
    top_of_two,
    walks,
)
from bench.challenge.families.ropewalk_telltale import (
    AHEAD,
    ALIKE,
    HALF,
    METRES,
    MODEL_POWER,
    POWER,
    creaking,
    first_paths,
    fitted,
    highs,
    levels_db,
    strung_out,
    tufts,
)
from bench.challenge.families.ropewalk_walk import HALL_M, WAVE_M, Hank
from bench.challenge.families.ropewalk_wave_effects import (
    ABOUT,
    BUZZES,
    DECAYS,
    FLUTTERS,
    KNOTS,
    PACE,
    RINGS,
    SHAPE,
    STRETCH,
    across,
    among_sevens,
    buzzed,
    by_sides,
    hoop,
    in_steps,
    laid_of_three,
    of_hemp,
    rung,
    scattering,
    weibull,
    winched,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "ropewalk")


def _hank() -> Hank:
    return Hank(_known(), 0, np.random.default_rng(0))


def test_walks_go_as_far_as_the_root_of_their_time() -> None:
    made = walks(np.random.default_rng(1), 4000, np.array([0.0, 1 / 9, 1.0]))
    assert (made[:, 2] - made[:, 0]).std() == pytest.approx(1.0, rel=0.05)
    assert (made[:, 1] - made[:, 0]).std() == pytest.approx(1 / 3, rel=0.05)


def test_what_creeps_about_a_case_is_none_in_the_mean_and_most_behind() -> None:
    turn = np.linspace(-np.pi, np.pi, 721)[1:]
    made = crept(turn)
    assert made.mean() == pytest.approx(0.0, abs=1e-6)
    assert np.abs(turn[made.argmax()]) == pytest.approx(np.pi)
    assert np.abs(turn[made.argmin()]) < 0.01


def test_tents_scatter_by_one() -> None:
    made = tents(np.random.default_rng(1), 100_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert (made**4).mean() == pytest.approx(2.4, rel=0.02)
    assert np.abs(made).max() <= np.sqrt(6)


def test_edges_take_what_the_recommendation_says() -> None:
    """6 dB where they just touch, and 13 dB and 20 dB at once and at 2.4."""
    assert np.allclose(past_db(np.array([-1.0, 0.0, 1.0, 2.4])), [0.0, 6.0, 13.9, 20.5], atol=0.4)
    hank = _hank()
    wide = np.full(hank.rows, 0.5)
    longer, lost = about_iron(hank, wide, 0.0 * wide, 0.5 * hank.far)
    bent = 2 * np.hypot(0.25, 0.5 * hank.far) - hank.far
    assert np.allclose(longer, bent, rtol=0.02)
    side = past_db(0.25 * np.sqrt(8 / (WAVE_M * hank.far)))
    assert np.allclose(lost, side - 10 * np.log10(2.0))


def test_earth_returns_all_of_level_waves_and_less_of_steep_ones() -> None:
    sines = np.linspace(1e-5, 0.9, 200)
    left = of_earth(sines)
    assert left[0] == pytest.approx(-1.0, abs=1e-3)
    root = np.sqrt(CLAY - 1 + 0.81)
    up_m = ROUGH_M * np.random.default_rng(1).standard_normal(400_000)
    over = np.exp(4j * np.pi * up_m * 0.9 / WAVE_M).mean()
    assert left[-1] == pytest.approx((0.9 - root) / (0.9 + root) * over, abs=5e-3)
    assert (np.diff(np.abs(left)) < 0).all()


def test_the_way_by_the_floor_is_an_images() -> None:
    hank = _hank()
    longer, share = off_the_floor(hank, 1.0)
    image = hank.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + hank.far, np.linalg.norm(image - hank.strut_m, axis=1))
    assert np.abs(share).max() <= 0.75 + 1e-9


def test_what_ranges_have_of_two_pulses_is_what_telltales_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late, high = top_of_two(np.full(4, 0.35), share)
    top = np.full(4, 79.1)
    both: Any = tufts(top) + share[:, None] * tufts(top + 0.35 / METRES)
    told = METRES * (first_paths(both, np.full(4, 1e-6)) - top + AHEAD)
    assert np.allclose(late, told, atol=0.02)
    assert late[3] == pytest.approx(0.0, abs=1e-3)
    assert high[3] == pytest.approx(1.0, abs=1e-3)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_pulses_are_powers_of_a_parabola_as_long_as_measured() -> None:
    at = np.linspace(0.0, 1.0, 1001)
    high = np.concatenate([tufts(np.full(1, 70.0 + HALF * k))[:, 70] for k in at])
    assert 2.1 < 2 * HALF * np.interp(-0.5, -high, at) < 2.7
    assert np.allclose(high ** (1 / POWER), 1 - at**2, atol=1e-6)
    assert not tufts(np.full(1, 70.0))[0, 74:].any()


def test_noise_is_beside_itself_as_asked_and_fits_are_by_least_squares() -> None:
    noise = creaking(np.random.default_rng(2), 2000)
    for apart, alike in enumerate([*ALIKE, 0.0]):
        there = (noise[:, apart:] * noise[:, : noise.shape[1] - apart].conj()).real.mean() / 2
        assert there == pytest.approx(alike, abs=0.01)
    wave: Any = 2.0j * tufts(np.full(1, 60.0))
    assert fitted(wave.astype(np.complex128))[0, 60] == pytest.approx(2.0j, abs=1e-9)
    assert pytest.approx(float((np.abs(wave / 2) ** 2).sum()), abs=1e-9) == MODEL_POWER
    twice = strung_out(strung_out(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * tufts(np.full(1, 61.0))).max() < 0.03


def test_tops_are_where_pulses_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = tufts(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.001)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-6)
    weak = 0.25 * one + tufts(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.01)
    assert np.allclose(deaf - sharp, 11.2, atol=0.02)
    soon, late = (first_paths(0.5 * one + tufts(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (25.0, 80.0):
        wave = high * tufts(top) + creaking(np.random.default_rng(2), 1000)
        off = first_paths(wave, np.ones(1000)) - top + AHEAD
        assert abs(off.mean()) < 4 * off.std() / np.sqrt(1000)
        assert off.std() < 1.7 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-3)
    wave = (2.0 * tufts(top) + 1.0 * tufts(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.1)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.1)
    assert np.allclose(highs(wave, top - AHEAD), 2.0)


def test_walls_answer_by_images_of_images_and_gables_once() -> None:
    hank = _hank()
    image = hank.tag_m.copy()
    image[:, 1] = -image[:, 1]
    assert np.allclose(across(hank, -1), np.linalg.norm(image - hank.strut_m, axis=1))
    image[:, 1] = image[:, 1] + 2 * HALL_M[1]  # of that one in the other wall, again
    assert np.allclose(across(hank, 1), np.linalg.norm(image - hank.strut_m, axis=1))
    image[:, 1] = hank.tag_m[:, 1] + 2 * HALL_M[1]
    assert np.allclose(across(hank, 2), np.linalg.norm(image - hank.strut_m, axis=1))
    assert np.allclose(across(hank, 0), hank.far)
    made = by_sides(hank)
    assert len(made) == 2 * FLUTTERS + 2
    for way, share in made:
        assert (way >= hank.far - 1e-6).all()
        assert 0.0 < share.min() <= share.max() <= 1.0


def test_fades_have_weibulls_law_and_power_one() -> None:
    made = weibull(np.random.default_rng(2), 800)
    assert (made**2).mean() == pytest.approx(1.0, abs=0.02)
    law, knots = weibull_min(SHAPE), made[:, ::KNOTS]
    for low, high in ((0.25, 0.5), (0.5, 0.75)):
        ratio = np.quantile(knots, high) / np.quantile(knots, low)
        assert ratio == pytest.approx(law.ppf(high) / law.ppf(low), rel=0.05)


def test_tails_are_kohlrauschs() -> None:
    since = np.linspace(0.5, 80.0, 200)
    log = np.log(-np.log(of_hemp(since)))
    assert np.allclose(np.gradient(log, np.log(since))[2:-2], STRETCH, atol=1e-3)
    assert of_hemp(np.array([DECAYS]))[0] == pytest.approx(np.exp(-1.0))
    assert not of_hemp(np.array([-3.0, -0.1])).any()


def test_hoops_ring_after_they_are_struck_and_not_before() -> None:
    blow = np.zeros((1, 200), np.complex128)
    blow[0, 10] = 1.0
    made = rung(blow)[0]
    assert np.abs(made[:12]).max() < 1e-9
    assert np.allclose(made[10 : 10 + RINGS], hoop())
    assert (np.abs(hoop()) ** 2).sum() == pytest.approx(1.0)
    assert np.abs(hoop()[-1]) < 0.02 * np.abs(hoop()).max()


def test_buzzes_are_tones_of_power_one() -> None:
    tone = buzzed(np.random.default_rng(3), 40)
    assert (np.abs(tone) ** 2).mean() == pytest.approx(1.0, abs=0.05)
    sizes = np.abs(np.fft.fft(tone, 4096, axis=1))
    at = 2 * np.pi * np.arange(4096) / 4096
    within = (at > BUZZES[0] - 0.15) & (at < BUZZES[1] + 0.15)
    assert (sizes[:, within] ** 2).sum() > 0.95 * (sizes**2).sum()


def test_noise_is_said_by_how_sizes_scatter_and_parts_are_kept_in_steps() -> None:
    noise = creaking(np.random.default_rng(4), 400)
    assert scattering(3 * noise) == pytest.approx(3 * scattering(noise))
    kept = in_steps(3 * noise, 0.4)
    for part in (kept.real / 0.4, kept.imag / 0.4):
        assert np.allclose(part, np.rint(part), atol=1e-9)
    assert np.abs((kept - 3 * noise).real).max() <= 0.2 + 1e-9


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    rng = np.random.default_rng(6)
    sizes, begin = 1 + 10 * rng.random((3, 160)), np.array([20, 33, 90])
    for made in (laid_of_three, winched, among_sevens):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    laid = laid_of_three(np.arange(24.0)[None], np.array([12]))[0, 12:]
    assert laid.tolist() == [12, 16, 20, 13, 17, 21, 14, 18, 22, 15, 19, 23]
    slow = winched(sizes, begin)
    most = PACE * sizes[0, 20:].mean()
    assert np.abs(np.diff(slow[0, 19:])).max() <= most + 1e-9
    places = among_sevens(sizes, begin)[2, 100] / (0.25 * sizes[2, 97:104].mean())
    assert places == pytest.approx((sizes[2, 97:104] <= sizes[2, 100]).sum())
    assert ABOUT == 7
