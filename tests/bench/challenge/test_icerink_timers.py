"""The forms that the ice rink's effects have, and its timers: against laws that are known."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.special import fresnel, jv
from scipy.stats import f as snedecors
from scipy.stats import hypsecant

from bench.challenge.families.icerink_effects import (
    LOBATTO,
    TRUNK_M,
    WATER,
    of_both,
    of_snow,
    off_the_ice,
    over_edge_db,
    platinum,
    secant,
    slab,
    spins,
    through_trunk,
    wet_ice,
)
from bench.challenge.families.icerink_rink import PANE_M, Period
from bench.challenge.families.icerink_timer import (
    AHEAD,
    ALIKE,
    HALF,
    METRES,
    ROOT,
    SHAPE_POWER,
    first_paths,
    fits,
    heights,
    levels_db,
    scraping,
    shouts,
    skated_late,
)
from bench.challenge.families.icerink_wave_effects import (
    FED,
    SHAPES,
    SIDES,
    STEEL,
    SWINGS,
    TONE,
    TUNE,
    WORD,
    bessel,
    by_sheet,
    cut_off,
    exclusive,
    ladder,
    late_means,
    past_edges_m,
    riffled,
    rung,
    snedecor,
    softly,
    swept,
    whistled,
)
from bench.challenge.families.icerink_wave_effects import (
    HALF as HALF_DECK,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "icerink")


def _period() -> Period:
    return Period(_known(), 0, np.random.default_rng(0))


def test_lobattos_rule_is_right_up_to_fifth_powers() -> None:
    at, by = np.array(LOBATTO).T
    assert np.allclose([(by * at**k).sum() for k in range(6)], 1 / np.arange(1, 7))


def test_three_stages_are_late_by_three_of_one() -> None:
    at, by = np.polynomial.laguerre.laggauss(10)
    part = 0.5 * by * at**2
    assert part.sum() == pytest.approx(1.0)
    assert (part * at).sum() == pytest.approx(3.0)
    assert (part * (at - 3) ** 2).sum() == pytest.approx(3.0)


def test_spins_are_means_of_three_ways_to_be() -> None:
    field = np.linspace(-9.0, 9.0, 60)
    half = 1.5 / np.tanh(1.5 * field) - 0.5 / np.tanh(0.5 * field)
    assert np.allclose(spins(field), half, atol=1e-6)
    assert np.allclose(spins(field), -spins(-field))


def test_secants_scatter_by_one_and_have_their_law() -> None:
    even = (np.arange(100_000) + 0.5) / 100_000
    assert secant(even).std() == pytest.approx(1.0, abs=0.01)
    assert np.allclose(hypsecant.cdf(np.pi / 2 * secant(even)), even, atol=1e-9)


def test_wires_are_of_platinum() -> None:
    at = platinum(np.array([-40.0, 0.0, 20.0, 100.0]))
    assert np.allclose(at, [0.8427, 1.0, 1.0779, 1.3851], atol=1e-4)  # IEC 60751


def test_trunks_are_ellipses() -> None:
    at = np.linspace(-np.pi, np.pi, 721)
    far = through_trunk(at)
    x, y = far * np.sin(at), TRUNK_M[1] + far * np.cos(at)
    assert np.allclose((x / TRUNK_M[0]) ** 2 + (y / TRUNK_M[1]) ** 2, 1.0)
    assert not far[np.abs(at) < np.pi / 2].any()
    assert far[0] == pytest.approx(2 * TRUNK_M[1])


def test_edges_take_what_fresnels_integrals_say() -> None:
    v = np.linspace(0.0, 6.0, 61)
    sine, cosine = fresnel(v)
    size = np.hypot(0.5 - cosine, 0.5 - sine) / np.sqrt(2)
    assert np.allclose(over_edge_db(v), -20 * np.log10(size), atol=0.3)


def test_snow_and_slabs_slow_waves_by_what_is_known() -> None:
    assert np.allclose(of_snow(np.array([0.0, 0.917])), [1.0, 1.78], atol=0.03)  # air, and ice
    straight, aslant = slab(np.full(2, 0.1), 5.24, np.array([0.0, 0.8]))
    assert straight == pytest.approx(0.129, abs=1e-3)
    assert aslant > straight


def test_wet_ice_returns_all_of_level_waves_and_dry_ice_what_fresnel_has() -> None:
    sines = np.linspace(1e-5, 1.0, 200)
    dry, wet = (wet_ice(sines, np.full(200, film)) for film in (0.0, 1e-3))
    within = 3.17 - 0.004j
    root = np.sqrt(within - 1 + sines**2)
    assert np.allclose(dry, (within * sines - root) / (within * sines + root))
    assert np.allclose(wet[0], -1.0, atol=1e-2)
    assert np.abs(wet).max() <= 1.0
    assert np.abs(wet[-1]) > np.abs(dry[-1])
    deep = wet_ice(np.ones(1), np.full(1, 0.5))
    assert np.allclose(deep, (np.sqrt(WATER) - 1) / (np.sqrt(WATER) + 1), atol=1e-6)


def test_the_way_by_the_ice_is_an_images() -> None:
    longer, share = off_the_ice(_period(), 1.0)
    rows = _known()
    flat = rows["true_range_m"] ** 2 - (rows["rx_z_m"] - rows["tx_z_m"]) ** 2
    image = np.sqrt(flat + (rows["rx_z_m"] + rows["tx_z_m"]) ** 2)
    assert np.allclose(longer + rows["true_range_m"], image)
    assert np.abs(share).max() <= 0.78 + 1e-9


def test_what_ranges_have_of_two_pulses_is_what_timers_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late, height = of_both(np.full(4, 0.35), share)
    both: Any = shouts(np.full(4, 80.1)) + share[:, None] * shouts(np.full(4, 80.1) + 0.35 / METRES)
    told = METRES * (first_paths(both, np.full(4, 1e-6)) - 80.1 + AHEAD)
    assert np.allclose(late, told, atol=0.03)
    assert late[3] == pytest.approx(0.0, abs=1e-3)
    assert height[3] == pytest.approx(1.0, abs=1e-3)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_pulses_are_as_long_as_measured_and_end() -> None:
    at = np.linspace(0.0, 1.0, 1001)
    high = np.concatenate([shouts(np.full(1, 70.0 + HALF * k))[:, 70] for k in at])
    assert 2.1 < 2 * HALF * np.interp(-0.5, -high, at) < 2.7
    assert high[0] == pytest.approx(1.0)
    assert (np.diff(high) < 1e-12).all()
    assert high[-1] == 0.0


def test_noise_is_beside_itself_as_asked_and_fits_are_by_least_squares() -> None:
    alike = ROOT @ ROOT.T
    assert np.allclose([alike[60, 60 + k] for k in range(5)], [*ALIKE, 0.0], atol=1e-9)
    wave: Any = 2.0j * shouts(np.full(1, 60.0))
    assert fits(wave.astype(np.complex128))[0, 60] == pytest.approx(2.0j)
    assert pytest.approx(float((np.abs(wave / 2) ** 2).sum())) == SHAPE_POWER
    twice = skated_late(skated_late(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * shouts(np.full(1, 61.0))).max() < 0.04


def test_first_tops_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = shouts(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.01)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-6)
    weak = 0.3 * one + shouts(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(deaf - sharp, 11.2, atol=0.08)
    soon, late = (first_paths(0.5 * one + shouts(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_noise_moves_first_tops_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (25.0, 80.0):
        wave = high * shouts(top) + scraping(np.random.default_rng(2), 1000)
        off = first_paths(wave, np.ones(1000)) - top + AHEAD
        assert abs(off.mean()) < 4 * off.std() / np.sqrt(1000)
        assert off.std() < 2.5 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-3)
    wave = (2.0 * shouts(top) + 1.0 * shouts(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.1)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.3)
    assert np.allclose(heights(wave, top - AHEAD), 2.0)


def test_sheets_are_heard_by_images_and_return_the_less_the_more_squarely_they_are_met() -> None:
    period = _period()
    for side in SIDES:
        way, left = by_sheet(period, side)
        assert (way > period.far).all()
        assert 0.0 < left.min() <= left.max() <= STEEL
        image = np.abs(side[1] - period.ends[0][:, side[0]]) + np.abs(
            side[1] - period.ends[1][:, side[0]]
        )
        assert (np.diff(left[np.argsort(image / way)]) <= 1e-9).all()


def test_edges_are_a_pane_apart_and_ever_later() -> None:
    ways = past_edges_m(np.full(3, 1.2), np.full(3, 12.0))
    off = np.sqrt((ways[:, 0] + 12.0) ** 2 / 4 - 36.0)
    assert np.allclose(np.diff(off), PANE_M)
    assert off[0] == pytest.approx(1.2)
    assert (np.diff(ways[:, 0], 2) > 0).all()


def test_fades_have_fishers_and_snedecors_law_and_power_one() -> None:
    made = snedecor(np.random.default_rng(2), 600) ** 2
    assert made.mean() == pytest.approx(1.0, rel=0.02)
    law = snedecors(2 * SHAPES[0], 2 * SHAPES[1])
    knots = made[:, ::6]
    for low, high in ((0.25, 0.5), (0.5, 0.75)):
        ratio = np.quantile(knots, high) / np.quantile(knots, low)
        assert ratio == pytest.approx(law.ppf(high) / law.ppf(low), rel=0.06)


def test_tails_rise_softly_and_die_away() -> None:
    since = np.linspace(-5.0, 90.0, 951)
    power = softly(since)
    assert not power[since <= 0].any()
    assert 3.0 < since[power.argmax()] < 12.0
    assert power.max() == pytest.approx(0.9, abs=0.3)
    assert np.log(power[-1] / power[-101]) == pytest.approx(-10 / 17.0, rel=0.01)


def test_ladders_ring_by_bessels_function_after_they_are_fed() -> None:
    at = np.linspace(0.0, 30.0, 61)
    for order in (0, 1):
        assert np.allclose(bessel(order, at), jv(order, at), atol=1e-9)
    blow = np.zeros((1, 232), np.complex128)
    blow[0, 10] = 1.0
    made = rung(blow)[0]
    assert np.abs(made[: 10 + FED]).max() < 1e-9
    assert np.allclose(made[10:110], ladder())
    assert (ladder() ** 2).sum() == pytest.approx(1.0)
    assert np.abs(ladder()[-10:]).max() < 0.05 * np.abs(ladder()).max()


def test_whistles_are_of_size_one_and_swing_about_a_carrier() -> None:
    tone = whistled(np.random.default_rng(3), 40)
    assert np.allclose(np.abs(tone), 1.0)
    turn = np.diff(np.unwrap(np.angle(tone), axis=1), axis=1)
    assert np.abs(turn - TUNE).max() <= SWINGS * TONE + 1e-9
    assert turn.mean() == pytest.approx(TUNE, abs=0.02)


def test_steps_are_cut_toward_nothing() -> None:
    rng = np.random.default_rng(5)
    wave = rng.normal(size=(3, 200)) + 1j * rng.normal(size=(3, 200))
    kept = cut_off(wave, 0.4)
    assert np.allclose(kept.real / 0.4, np.rint(kept.real / 0.4))
    assert (np.abs(kept.real) <= np.abs(wave.real) + 1e-12).all()
    assert np.abs(kept - wave).max() < 0.4 * np.sqrt(2)


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    rng = np.random.default_rng(6)
    sizes, begin = 10 * rng.random((3, 160)), np.array([20, 33, 90])
    for made in (swept, exclusive, riffled):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    up_db = 20 * np.log10(swept(sizes, begin)[0] / sizes[0])
    assert np.allclose(np.diff(up_db)[21:60], 0.16)
    assert up_db.max() == pytest.approx(9.0)
    deck = riffled(sizes, begin)[0, 20 : 20 + 2 * HALF_DECK]
    assert np.array_equal(deck[::2], sizes[0, 20 : 20 + HALF_DECK])
    assert np.array_equal(np.sort(deck), np.sort(sizes[0, 20 : 20 + 2 * HALF_DECK]))
    unit = late_means(sizes, begin)[0] / WORD
    words, packed = (np.rint(one[0] / unit - 0.5 * k).astype(int)
                     for k, one in ((1, sizes), (0, exclusive(sizes, begin))))  # fmt: skip
    back = words[:21].tolist()
    for one in packed[21:]:
        back.append(int(one) ^ back[-1])
    assert back == words.tolist()
