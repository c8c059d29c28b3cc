"""The forms that the shipyard's effects have, and its lookouts: against laws that are known."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.special import fresnel
from scipy.stats import invgauss, levy

from bench.challenge.families.shipyard_effects import (
    APART,
    DECK,
    LAID_M,
    RADAU,
    broken,
    crest_of_two,
    left_past,
    of_both,
    of_dipoles,
    off_a_ball,
    off_the_deck,
    past_two_db,
    planks,
    saturated_hpa,
    semicircle,
)
from bench.challenge.families.shipyard_lookout import (
    AHEAD,
    ALIKE,
    BROAD,
    ENDS,
    GUARD,
    LEADING,
    METRES,
    MODEL_POWER,
    STEEP,
    came_before,
    combers,
    first_paths,
    heights,
    hove_to,
    levels_db,
    met,
    surf,
)
from bench.challenge.families.shipyard_slip import DOCK_M, TANK_M, TANKS_M, WAVE_M, Berth
from bench.challenge.families.shipyard_wave_effects import (
    GATES,
    KEYS,
    KNOTS,
    PEAKS,
    RINGS,
    SECTORS,
    SKEWED,
    TRIPS,
    by_sheet,
    by_things,
    in_sectors,
    inked,
    keyed,
    of_walks,
    plate,
    ranging,
    running,
    struck,
    tripped,
    wald,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "shipyard")


def _berth() -> Berth:
    return Berth(_known(), 0, np.random.default_rng(0))


def test_radaus_places_give_the_mean_of_quartics() -> None:
    for power in range(5):
        assert sum(by * at**power for at, by in RADAU) == pytest.approx(1 / (1 + power))


def test_parts_of_a_stick_are_of_one_and_unlike() -> None:
    made = np.array([broken(np.random.default_rng(k), 12) for k in range(400)])
    assert np.allclose(made.sum(axis=1), 1.0)
    assert made.min() > 0
    assert made.std() == pytest.approx(np.sqrt(11 / (12**2 * 13)), rel=0.05)


def test_air_holds_the_vapour_that_tables_say() -> None:
    assert np.allclose(saturated_hpa(np.array([0.0, 10.0, 20.0, 30.0])),
                       [6.11, 12.27, 23.37, 42.43], rtol=0.005)  # fmt: skip


def test_three_dipoles_add_up_ahead_and_by_their_phases_elsewhere() -> None:
    turn = np.linspace(0.0, 2 * np.pi, 50)
    path = 2 * np.pi * APART * (1 - np.cos(turn))
    whole = sum(np.exp(1j * k * path) for k in range(3))
    assert np.allclose(of_dipoles(turn), np.abs(whole / 3) ** 2)


def test_half_circles_scatter_by_one() -> None:
    made = semicircle(np.random.default_rng(1), 100_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert (made**4).mean() == pytest.approx(2.0, rel=0.02)  # of Catalan's numbers
    assert np.abs(made).max() <= 2.0


def test_edges_leave_what_fresnels_integrals_say_on_either_side() -> None:
    v = np.linspace(-4.0, 6.0, 101)
    sine, cosine = fresnel(v)
    whole = 0.5 * (1 + 1j) * ((0.5 - cosine) - 1j * (0.5 - sine))
    assert np.allclose(left_past(v), whole, atol=1e-6)
    assert past_two_db(np.zeros(1), np.zeros(1))[0] == pytest.approx(20 * np.log10(4.0))


def test_mixtures_are_bruggemans() -> None:
    part = np.array([0.0, 0.1, 0.4, 1.0])
    made = of_both(1.9, 76.0, part)
    assert np.allclose(made[[0, -1]], [1.9, 76.0])
    rest = (1 - part) * (1.9 - made) / (1.9 + 2 * made) + part * (76 - made) / (76 + 2 * made)
    assert np.allclose(rest, 0.0)


def test_balls_return_the_shortest_way_that_touches_them() -> None:
    berth = _berth()
    rng = np.random.default_rng(2)
    for ball in TANKS_M:
        one, other = berth.tag_m[:40], berth.top_m[:40]
        way = np.sum(off_a_ball(one, other, ball), axis=0)
        out = rng.standard_normal((6000, 1, 3))
        at = ball + TANK_M * out / np.linalg.norm(out, axis=2, keepdims=True)
        tried = np.linalg.norm(at - one, axis=2) + np.linalg.norm(at - other, axis=2)
        least = tried.min(axis=0)
        run = other - one
        part = ((ball - one) * run).sum(axis=1) / (run**2).sum(axis=1)
        near = one + part.clip(0.0, 1.0)[:, None] * run
        free = np.linalg.norm(near - ball, axis=1) > TANK_M + 0.3
        assert (way[free] <= least[free] + 1e-6).all()
        assert np.allclose(way[free], least[free], atol=0.03)


def test_planks_return_all_of_level_waves_and_less_of_steep_ones() -> None:
    sines = np.linspace(1e-5, 0.9, 200)
    left = planks(sines)
    assert left[0] == pytest.approx(-1.0, abs=1e-3)
    root = np.sqrt(DECK - 1 + 0.81)
    heights_m = np.linspace(-LAID_M, LAID_M, 4001)
    over = np.exp(4j * np.pi * heights_m * 0.9 / WAVE_M).mean()
    assert left[-1] == pytest.approx((0.9 - root) / (0.9 + root) * over, abs=2e-3)
    assert (np.diff(np.abs(left)) < 0).all()


def test_the_way_by_the_planks_is_an_images() -> None:
    longer, share = off_the_deck(_berth(), 1.0)
    rows = _known()
    flat = rows["true_range_m"] ** 2 - (rows["rx_z_m"] - rows["tx_z_m"]) ** 2
    image = np.sqrt(flat + (rows["rx_z_m"] + rows["tx_z_m"]) ** 2)
    assert np.allclose(longer + rows["true_range_m"], image)
    assert np.abs(share).max() <= 0.77 + 1e-9


def test_what_ranges_have_of_two_pulses_is_what_lookouts_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late, height = crest_of_two(np.full(4, 0.35), share)
    top = np.full(4, 79.1)
    both: Any = combers(top) + share[:, None] * combers(top + 0.35 / METRES)
    told = METRES * (first_paths(both, np.full(4, 1e-6)) - top + AHEAD)
    assert np.allclose(late, told, atol=0.015)
    assert late[3] == pytest.approx(0.0, abs=2e-3)
    assert height[3] == pytest.approx(1.0, abs=1e-3)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_pulses_are_exponentials_of_a_cosh_as_long_as_measured() -> None:
    at = np.linspace(0.0, 1.0, 1001)
    high = np.concatenate([combers(np.full(1, 70.0 + ENDS * k))[:, 70] for k in at])
    assert 2.1 < 2 * ENDS * np.interp(-0.5, -high, at) < 2.7
    assert high[0] == pytest.approx(1.0)
    assert (np.diff(high) < 1e-12).all()
    bend = np.log(high[:-1]) / STEEP - 1
    assert np.allclose(-bend, np.cosh(ENDS * at[:-1] / BROAD))


def test_noise_is_beside_itself_as_asked_and_fits_are_by_least_squares() -> None:
    noise = surf(np.random.default_rng(2), 2000)
    for apart, alike in enumerate([*ALIKE, 0.0]):
        there = (noise[:, apart:] * noise[:, : noise.shape[1] - apart].conj()).real.mean() / 2
        assert there == pytest.approx(alike, abs=0.01)
    wave: Any = 2.0j * combers(np.full(1, 60.0))
    assert met(wave.astype(np.complex128))[0, 60] == pytest.approx(2.0j, abs=1e-3)
    assert pytest.approx(float((np.abs(wave / 2) ** 2).sum()), abs=1e-3) == MODEL_POWER
    twice = hove_to(hove_to(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * combers(np.full(1, 61.0))).max() < 0.02


def test_what_came_before_is_a_mean_of_what_there_was() -> None:
    sizes = np.arange(80.0)[None, :] ** 2
    made = came_before(sizes)[0]
    at = 40
    assert made[at] == pytest.approx(sizes[0, at - GUARD - LEADING + 1 : at - GUARD + 1].mean())
    assert not made[: GUARD - 1].any()
    assert made[GUARD + 2] == pytest.approx(sizes[0, :3].mean())


def test_crests_are_where_pulses_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = combers(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.01)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-6)
    weak = 0.3 * one + combers(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(deaf - sharp, 11.2, atol=0.08)
    soon, late = (first_paths(0.5 * one + combers(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_what_is_no_higher_than_what_came_is_not_seen() -> None:
    top, quiet = np.full(1, 60.0), np.full(1, 0.003)
    plain = sum(0.2 * combers(top - 30.0 + k) for k in range(22))
    wave: Any = plain + combers(top + 20.0)
    began = first_paths(wave.astype(np.complex128), quiet)[0] + AHEAD
    assert 29.0 < began < 40.0  # on the plain, of which nothing is over what came before
    lone: Any = plain * 0.05 + combers(top + 20.0)
    assert first_paths(lone.astype(np.complex128), quiet)[0] + AHEAD == pytest.approx(
        80.0, abs=0.05
    )


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (25.0, 80.0):
        wave = high * combers(top) + surf(np.random.default_rng(2), 1000)
        off = first_paths(wave, np.ones(1000)) - top + AHEAD
        assert abs(off.mean()) < 4 * off.std() / np.sqrt(1000)
        assert off.std() < 2.5 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-3)
    wave = (2.0 * combers(top) + 1.0 * combers(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.1)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.3)
    assert np.allclose(heights(wave, top - AHEAD), 2.0)


def test_sheets_are_heard_by_images_and_balls_the_less_the_farther() -> None:
    berth = _berth()
    image = berth.tag_m.copy()
    image[:, 0] = 2 * DOCK_M[0] - image[:, 0]
    assert np.allclose(by_sheet(berth, (0, DOCK_M[0])), np.linalg.norm(image - berth.top_m, axis=1))
    made = by_things(berth)
    assert len(made) == 7
    for way, share in made:
        assert (way >= berth.far - 1e-6).all()
        assert share.max() <= max(GATES, 1.0)
    legs = off_a_ball(berth.tag_m, berth.top_m, TANKS_M[0])
    seen = made[0][1] > 0
    given = 0.5 * TANK_M * berth.far / (legs[0] * legs[1])
    assert 0.4 < seen.mean() <= 1.0
    assert np.allclose(made[0][1][seen], given[seen])


def test_fades_have_walds_law_and_power_one() -> None:
    made = wald(np.random.default_rng(2), 800)
    assert (made**2).mean() == pytest.approx(1.0, abs=0.02)
    law, knots = invgauss(1 / SKEWED, scale=SKEWED), made[:, ::KNOTS] ** 2
    for low, high in ((0.25, 0.5), (0.5, 0.75)):
        ratio = np.quantile(knots, high) / np.quantile(knots, low)
        assert ratio == pytest.approx(law.ppf(high) / law.ppf(low), rel=0.05)


def test_tails_are_levys() -> None:
    since = np.linspace(0.5, 120.0, 400)
    law = levy(scale=3 * PEAKS)
    assert np.allclose(of_walks(since), law.pdf(since) / law.pdf(PEAKS))
    assert of_walks(np.array([PEAKS]))[0] == pytest.approx(1.0)
    assert not of_walks(np.array([-3.0, 0.0])).any()


def test_plates_ring_ever_lower_after_they_are_struck() -> None:
    blow = np.zeros((1, 200), np.complex128)
    blow[0, 10] = 1.0
    made = struck(blow)[0]
    assert np.abs(made[:13]).max() < 1e-9
    assert np.allclose(made[10 : 10 + RINGS], plate())
    assert (np.abs(plate()) ** 2).sum() == pytest.approx(1.0)
    pitch = np.diff(np.unwrap(np.angle(plate()[3:60])))
    assert (np.diff(pitch) < 0).all()
    assert 0.1 < pitch[-1] < pitch[0] < np.pi


def test_keys_are_two_tones_of_power_one() -> None:
    tone = keyed(np.random.default_rng(3), 40)
    assert (np.abs(tone) ** 2).mean() == pytest.approx(1.0, abs=0.05)
    sizes = np.abs(np.fft.fft(tone, 4096, axis=1))
    at = 2 * np.pi * np.arange(4096) / 4096
    within = (at > KEYS[0][0] - 0.1) & (at < KEYS[1][1] + 0.1)
    assert (sizes[:, within] ** 2).sum() > 0.95 * (sizes**2).sum()


def test_noise_is_told_by_how_sizes_range() -> None:
    noise = surf(np.random.default_rng(4), 400)
    assert ranging(3 * noise) == pytest.approx(3 * ranging(noise))
    assert ranging(noise) == pytest.approx(2.06 * np.abs(noise).std(), rel=0.2)  # of four (Tippett)


def test_sizes_are_kept_in_steps_and_phases_amid_sectors() -> None:
    rng = np.random.default_rng(5)
    wave = 3 * (rng.normal(size=(3, 200)) + 1j * rng.normal(size=(3, 200)))
    kept = in_sectors(wave, 0.4)
    assert np.allclose(np.abs(kept) / 0.4, np.rint(np.abs(kept) / 0.4), atol=1e-9)
    assert np.abs(np.abs(kept) - np.abs(wave)).max() <= 0.2 + 1e-9
    there = np.abs(kept) > 0
    turned = np.abs(np.angle(kept[there] / wave[there]))
    assert turned.max() <= np.pi / SECTORS + 1e-9


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    rng = np.random.default_rng(6)
    sizes, begin = 1 + 10 * rng.random((3, 160)), np.array([20, 33, 90])
    for made in (running, inked, tripped):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    assert running(sizes, begin)[1, 60] == pytest.approx(sizes[1, 33:61].mean())
    ink = np.zeros((1, 160))
    ink[0, [24, 120]] = 1.0
    spread = inked(ink, np.array([20]))[0]
    assert spread.sum() == pytest.approx(2.0)
    assert spread[24] > 1.5 * spread[120]
    fell = np.full((1, 160), 1.0)
    fell[0, 60:70], fell[0, 90:] = 2.5, 0.5
    up = tripped(fell, np.array([20]))[0]
    assert np.allclose(up[20:60], 1.0)
    assert np.allclose(up[60:70], TRIPS[2] * 2.5)
    assert np.allclose(up[70:90], TRIPS[2])
    assert np.allclose(up[90:], 0.5)
