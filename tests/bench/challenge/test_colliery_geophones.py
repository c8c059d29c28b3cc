"""The forms that the colliery's effects have, and its geophones: against laws that are known."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.special import fresnel, sici

from bench.challenge.families.colliery_effects import (
    FLOOR,
    RIM,
    STIFF,
    buckled,
    grown,
    of_both,
    off_the_floor,
    raised,
    relaxed,
    sine_integral,
    takahasi,
    through_gap,
    to_rim,
)
from bench.challenge.families.colliery_geophone import (
    HALF,
    LEFT,
    METRES,
    TO_TOP,
    booms,
    first_paths,
    hauled_back,
    levels_db,
    picked,
    trickling,
)
from bench.challenge.families.colliery_pit import Tally
from bench.challenge.families.colliery_wave_effects import (
    BARKER,
    CHIP,
    MODES,
    PITCH,
    SIDES,
    WEAK,
    barker,
    boxed,
    by_side,
    by_steps,
    double_exponential,
    hexagonal,
    swapped,
    switched,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "colliery")


def _tally() -> Tally:
    return Tally(_known(), 0, np.random.default_rng(0))


def test_places_by_tanh_and_sinh_are_right_for_low_powers() -> None:
    at, by = takahasi(3, 0.62)
    assert ((at > 0) & (at < 1)).all()
    assert np.allclose([(by * at**k).sum() for k in range(4)], 1 / np.arange(1, 5), atol=3e-3)


def test_discs_give_by_a_cubic_and_helmets_have_rims_of_a_circle() -> None:
    warm = np.linspace(-1.2, 1.2, 99)
    give = buckled(warm)
    assert np.allclose(give**3 + STIFF * give, warm)
    round_ = np.linspace(0, 2 * np.pi, 361)[:-1]
    far = to_rim(round_) - to_rim(np.zeros(1)) + 1 + RIM
    x, y = far * np.cos(round_) - RIM, far * np.sin(round_)
    assert np.allclose(np.hypot(x, y), 1.0)
    assert to_rim(round_).mean() == pytest.approx(0.0, abs=1e-12)


def test_sine_integrals_are_what_they_should_be_and_gompertz_is_slow_at_last() -> None:
    at = np.linspace(-12.0, 12.0, 97)
    assert np.allclose(sine_integral(at), sici(at)[0], atol=1e-6)
    assert np.allclose(grown(np.array([-9.0, 0.0, 20.0])), [0.0, np.exp(-1), 1.0], atol=1e-8)


def test_chances_of_a_raised_cosine_scatter_as_they_should() -> None:
    made = raised(np.random.default_rng(1).random(40000))
    assert made.std() == pytest.approx(np.sqrt(1 / 3 - 2 / np.pi**2), rel=0.02)
    assert np.abs(made).max() <= 1.0


def test_gaps_let_through_what_fresnels_integrals_say_and_all_where_there_is_no_edge() -> None:
    low, high = np.linspace(-1.0, 1.5, 26), np.linspace(1.0, 6.0, 26)
    (s, c), (other_s, other_c) = fresnel(high), fresnel(low)
    assert np.allclose(through_gap(low, high), np.hypot(s - other_s, c - other_c) / np.sqrt(2))
    assert through_gap(np.full(1, -5.0), np.full(1, 5.0))[0] == pytest.approx(1.0, abs=0.1)


def test_water_makes_waves_slower_in_what_holds_it() -> None:
    index = relaxed(np.linspace(0.0, 0.3, 20), 3.8)
    assert index[0] == pytest.approx(np.sqrt(3.8))
    assert (np.diff(index) > 0).all()


def test_the_way_by_the_floor_is_an_images_and_level_waves_are_returned_the_more_aslant() -> None:
    longer, share = off_the_floor(_tally(), 1.0)
    up = _known()["rx_z_m"] + _known()["tx_z_m"]
    flat = _known()["true_range_m"] ** 2 - (_known()["rx_z_m"] - _known()["tx_z_m"]) ** 2
    assert np.allclose(longer + _known()["true_range_m"], np.sqrt(flat + up**2))
    assert np.abs(share).max() <= 0.78 + 1e-9
    sines = np.linspace(1e-6, 1.0, 400)
    root = np.sqrt(FLOOR - 1 + sines**2)
    back = np.abs((sines - root) / (sines + root))
    assert back[0] == pytest.approx(1.0, abs=1e-4)
    assert (np.diff(back) < 0).all()


def test_what_ranges_have_of_two_pulses_is_what_geophones_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late_m = np.full(4, 0.35)
    late, height = of_both(late_m, share)
    both = booms(np.full(4, 80.3)) + share[:, None] * booms(80.3 + late_m / METRES)
    told = METRES * (first_paths(both, np.full(4, 1e-6)) - 80.3 + TO_TOP)
    assert np.allclose(late, told, atol=0.012)
    assert late[3] == pytest.approx(0.0, abs=1e-12)
    assert height[3] == pytest.approx(1.0)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_sides_are_heard_by_images_and_none_returns_more_than_came() -> None:
    tally = _tally()
    for side in SIDES:
        way, left = by_side(tally, side)
        assert (way > tally.far).all()
        assert 0.0 < left.min() <= left.max() < 1.0


def test_pulses_are_as_long_as_measured() -> None:
    at = np.linspace(0.0, 1.0, 2001)
    high = np.concatenate([booms(np.full(1, 70.0 + HALF * k))[:, 70] for k in at])
    half = HALF * np.interp(-0.5, -high, at)
    assert 2.1 < 2 * half < 2.7
    assert booms(np.full(1, 70.0)).max() == 1.0


def test_first_steps_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = booms(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, TO_TOP, atol=0.04)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + booms(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(deaf - sharp, 11.2, atol=0.08)
    soon, late = (first_paths(0.5 * one + booms(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_noise_moves_first_steps_to_neither_side() -> None:
    top = 90 + np.random.default_rng(1).random(1500)
    for high in (25.0, 80.0):
        wave = high * booms(top) + trickling(np.random.default_rng(2), 1500)
        off = first_paths(wave, np.ones(1500)) - top + TO_TOP
        assert abs(off.mean()) < 4 * off.std() / np.sqrt(1500)
        assert off.std() < 3.6 / high


def test_pulses_come_later_between_samples_too() -> None:
    top = np.full(21, 60.0)
    late = np.linspace(2.0, 3.0, 21)
    moved = hauled_back(booms(top).astype(np.complex128), late)
    assert np.allclose(moved, booms(top + late), atol=0.015)


def test_levels_are_those_of_lone_pulses_and_noise_is_taken_off() -> None:
    top = np.full(3000, 100.4)
    noise = trickling(np.random.default_rng(4), 3000)
    assert (np.abs(picked(noise, top)) ** 2).mean() == pytest.approx(LEFT, rel=0.08)
    every, first = levels_db(20.0 * booms(top) + noise, top - TO_TOP, np.ones(3000))
    assert every.mean() == pytest.approx(20 * np.log10(20.0), abs=0.15)
    assert first.mean() == pytest.approx(20 * np.log10(20.0), abs=0.15)


def test_fades_are_of_laplaces_law_at_knots_and_of_power_one() -> None:
    sizes = double_exponential(np.random.default_rng(2), 600)
    assert np.mean(sizes**2) == pytest.approx(1.0)
    knots = 20 * np.log10(sizes[:, ::6] / np.median(sizes[:, ::6]))
    even = 0.5 + 0.5 * np.sign(knots) * -np.expm1(-np.abs(knots) * np.sqrt(2) / 3.1)
    assert np.allclose(np.quantile(even, [0.25, 0.5, 0.75]), [0.25, 0.5, 0.75], atol=0.02)


def test_boxes_ring_at_roots_of_two_three_and_five_after_they_are_fed() -> None:
    blow = np.zeros((1, 200), np.complex128)
    blow[0, 10] = 1.0
    made = boxed(blow, 1.0)[0]
    assert not made[:13].any()
    assert np.abs(made[13]) == pytest.approx(sum(share for _, share, _ in MODES))
    assert np.abs(made[-12:]).max() < 0.01
    pitch = np.angle(np.vdot(made[60:120], made[61:121]))  # the lowest mode lasts longest
    assert pitch == pytest.approx(PITCH * np.sqrt(2.0), abs=0.02)


def test_the_feeders_bits_are_spread_by_eleven_chips() -> None:
    tone = barker(np.random.default_rng(3), 40)
    assert np.allclose(np.abs(tone), 1.0)
    alike = np.correlate(BARKER, BARKER, "full")
    assert alike.max() == 11.0
    assert np.abs(np.delete(alike, 10)).max() == 1.0
    turns = np.diff(np.sign((tone * np.exp(-0.9j * np.arange(tone.shape[1]))
                             / (tone[:, :1])).real), axis=1)  # fmt: skip
    for row in turns:
        assert (np.diff(np.flatnonzero(row)) % CHIP == 0).all()


def test_lattices_keep_the_nearest_points_of_triangles() -> None:
    rng = np.random.default_rng(5)
    at = rng.uniform(-6, 6, (1, 4000)) + 1j * rng.uniform(-6, 6, (1, 4000))
    kept = hexagonal(at, 1.0)
    assert np.abs(kept - at).max() <= 1 / np.sqrt(3) + 1e-9
    assert np.mean(np.abs(kept - at) ** 2) == pytest.approx(5 / 36, rel=0.05)
    assert np.allclose(hexagonal(kept, 1.0), kept)


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    wave = np.abs(10 + 5 * np.sin(np.arange(60.0) / 6))[None]
    begin = np.array([[15]])
    coded = by_steps(wave, begin, np.array([1.5]))[0]
    assert np.array_equal(coded[:15], wave[0, :15])
    assert np.allclose(np.abs(np.diff(coded[14:])), 1.5)
    assert np.abs(coded - wave[0]).max() < 4.0
    words = np.array([[0x12, 0x12, 0xF0, 0x0F, 300.0]])
    turned = swapped(words, np.array([[1]]), np.ones((1, 1)))[0]
    assert turned.tolist() == [0x12, 0x21, 0x0F, 0xF0, 0xFF]
    weak = switched(np.array([[9.0, 9.0, 2.0]]), np.array([[1]]), np.full((1, 1), 5.0))[0]
    assert np.allclose(weak, [9.0, WEAK * 9.0, 2.0])
