"""The forms that the granary's effects have, and its sieves: against laws that are known."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.special import fresnel, i0, i1

from bench.challenge.families.granary_bins import Docket
from bench.challenge.families.granary_effects import (
    FLOOR,
    OFF_CRATE,
    gradual,
    gregory,
    locked,
    of_both,
    off_the_grain,
    on_a_lattice,
    past_edge_db,
    through_lens,
    to_crate,
)
from bench.challenge.families.granary_sieve import (
    AHEAD,
    HALF,
    METRES,
    POURS,
    SHARES,
    first_paths,
    levels_db,
    measured,
    pouring,
    swells,
    trickled_later,
)
from bench.challenge.families.granary_wave_effects import (
    EIGHT,
    FED,
    LONG,
    SIDES,
    TUNE,
    by_lot,
    catalan,
    chebyshev,
    evened,
    haar,
    in_order,
    off_side,
    on_stone,
    planck,
    rung,
    walked,
    zadoff,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "granary")


def _docket() -> Docket:
    return Docket(_known(), 0, np.random.default_rng(0))


def test_gregorys_rule_is_right_for_low_powers() -> None:
    at, by = gregory()
    assert by.sum() == pytest.approx(1.0)
    assert np.allclose([(by * at**k).sum() for k in range(4)], 1 / np.arange(1, 5), atol=2e-3)


def test_phases_are_locked_by_a_ratio_of_bessels_functions() -> None:
    at = np.linspace(-12.0, 12.0, 97)
    assert np.allclose(locked(at), i1(at) / i0(at), atol=1e-9)


def test_crates_sides_are_those_of_a_square() -> None:
    round_ = np.linspace(0.01, 2 * np.pi, 361)
    far = to_crate(round_)
    x, y = OFF_CRATE + far * np.cos(round_), far * np.sin(round_)
    assert np.allclose(np.maximum(np.abs(x), np.abs(y)), 1.0)


def test_edges_take_what_fresnels_integrals_say() -> None:
    v = np.linspace(0.0, 6.0, 61)
    sine, cosine = fresnel(v)
    size = np.hypot(0.5 - cosine, 0.5 - sine) / np.sqrt(2)
    assert np.allclose(past_edge_db(v), -20 * np.log10(size), atol=0.2)
    assert past_edge_db(np.zeros(1))[0] == pytest.approx(6.02, abs=0.02)


def test_few_balls_on_a_lattice_are_as_clausius_and_mossotti_have_them_and_more_hold_more() -> None:
    fill = np.linspace(0.01, 0.5, 40)
    made = on_a_lattice(np.full(40, 3.0), fill)
    thin = (3.0 - 1) / (3.0 + 2)
    assert made[0] == pytest.approx((1 + 2 * 0.01 * thin) / (1 - 0.01 * thin), rel=1e-6)
    assert (np.diff(made) > 0).all()
    assert made[-1] < 1 + 0.5 * 2.0  # less than by a mean of both


def test_lenses_draw_out_the_rim_and_leave_the_middle_and_heights() -> None:
    places = np.array([(27.0, 18.0, 4.0), (52.0, 18.0, 4.0), (39.5, 18.0, 9.0)])
    off = through_lens(places)
    assert not off[0].any()
    assert not off[:, 2].any()
    assert off[1, 0] > 2 * off[2, 0] > 0


def test_grain_that_begins_softly_returns_less_and_level_waves_all() -> None:
    sines = np.linspace(1e-6, 1.0, 300)
    back = np.abs(gradual(sines))
    root = np.sqrt(FLOOR - 1 + sines**2)
    sharp = np.abs((sines - root) / (sines + root))
    assert back[0] == pytest.approx(1.0, abs=1e-4)
    assert (back <= sharp + 1e-9).all()
    assert (np.diff(back) < 0).all()


def test_the_way_by_the_grain_is_an_images() -> None:
    longer, share = off_the_grain(_docket(), 1.0)
    rows = _known()
    flat = rows["true_range_m"] ** 2 - (rows["rx_z_m"] - rows["tx_z_m"]) ** 2
    image = np.sqrt(flat + (rows["rx_z_m"] + rows["tx_z_m"]) ** 2)
    assert np.allclose(longer + rows["true_range_m"], image)
    assert np.abs(share).max() <= 0.78 + 1e-9


def test_what_ranges_have_of_two_pulses_is_what_sieves_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late_m = np.full(4, 0.35)
    late, height = of_both(late_m, share)
    both = swells(np.full(4, 80.1)) + share[:, None] * swells(80.1 + late_m / METRES)
    told = METRES * (first_paths(both, np.full(4, 1e-6)) - 80.1 + AHEAD)
    assert np.allclose(late, told, atol=0.03)
    assert late[3] == pytest.approx(0.0, abs=1e-3)
    assert height[3] == pytest.approx(1.0, abs=1e-3)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_pulses_are_as_long_as_measured_and_smooth_to_their_ends() -> None:
    at = np.linspace(0.0, 1.0, 1001)
    high = np.concatenate([swells(np.full(1, 70.0 + HALF * k))[:, 70] for k in at])
    assert 2.1 < 2 * HALF * np.interp(-0.5, -high, at) < 2.7
    assert high[0] == 1.0
    assert high[-50:].max() < 1e-12


def test_noise_is_made_of_four_shares_and_later_parts_of_a_band() -> None:
    assert (SHARES**2).sum() == pytest.approx(1.0)
    wave = swells(np.full(3, 60.0)).astype(np.complex128)
    twice = trickled_later(trickled_later(wave, np.full(3, 0.5)), np.full(3, 0.5))
    assert np.abs(twice - swells(np.full(3, 61.0))).max() < 0.04
    power = np.abs(measured(pouring(np.random.default_rng(4), 800), np.full(800, 90.0))) ** 2
    assert power.mean() == pytest.approx(POURS, rel=0.15)


def test_first_tops_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = swells(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.01)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + swells(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(deaf - sharp, 11.2, atol=0.08)
    soon, late = (first_paths(0.5 * one + swells(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_noise_moves_first_tops_to_neither_side() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (25.0, 80.0):
        wave = high * swells(top) + pouring(np.random.default_rng(2), 1000)
        off = first_paths(wave, np.ones(1000)) - top + AHEAD
        assert abs(off.mean()) < 4 * off.std() / np.sqrt(1000)
        assert off.std() < 3.0 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-3)
    wave = 2.0 * swells(top) + 1.0 * swells(top + 20.0)
    every, first = levels_db(wave.astype(np.complex128), top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.05)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.3)


def test_sides_are_heard_by_images_between_windows_and_none_returns_more_than_came() -> None:
    docket = _docket()
    for side in SIDES:
        way, left = off_side(docket, side)
        assert (way > docket.far).all()
        assert 0.0 <= left.min() <= left.max() < 1.0
        stone = on_stone(docket, side).mean()
        assert stone == 1.0 if side[0] == 2 else 0.4 < stone < 0.9


def test_walks_are_back_for_the_first_time_as_catalan_has_it() -> None:
    assert np.allclose(catalan(4), [1 / 2, 1 / 8, 1 / 16, 5 / 128])
    assert catalan(4000).sum() == pytest.approx(1.0, abs=0.01)


def test_walks_of_four_steps_have_power_one_and_no_more_than_four_steps() -> None:
    made = np.abs(walked(np.random.default_rng(2), 400))
    assert np.mean(made**2) == pytest.approx(1.0, rel=0.05)
    assert made.max() <= 2.0 + 1e-9


def test_tails_swell_and_die_away_as_planck_has_it() -> None:
    of = np.linspace(0.01, 12.0, 2400)
    power = planck(of)
    assert power.max() == pytest.approx(1.0, abs=1e-4)
    assert of[power.argmax()] == pytest.approx(2.821, abs=0.01)  # Wien's


def test_filters_ring_after_they_are_fed_and_let_through_ripples() -> None:
    blow = np.zeros((1, 236), np.complex128)
    blow[0, 10] = 1.0
    made = rung(blow)[0]
    assert np.abs(made[: 10 + FED]).max() < 1e-9
    assert np.allclose(made[10:90], chebyshev()[:80])
    passed = np.abs(np.fft.fft(chebyshev(), 4096))[:2048]  # its edge is at the 274th
    assert passed[:250].min() > 5 * passed[800:].max()
    assert np.abs(made[-100:]).max() < 0.05 * np.abs(made).max()


def test_sequences_are_of_size_one_and_like_none_of_their_own_later_ones() -> None:
    tone = zadoff(np.random.default_rng(3), 6)
    assert np.allclose(np.abs(tone), 1.0)
    still = tone * np.exp(-1j * TUNE * np.arange(tone.shape[1]))
    one = still[0, ::2][:LONG]
    alike = [abs(np.vdot(one, np.roll(one, k))) for k in range(LONG)]
    assert alike[0] == pytest.approx(LONG)
    assert max(alike[1:]) < 1e-6


def test_steps_by_lot_are_right_on_average() -> None:
    rng = np.random.default_rng(5)
    wave = np.full((1, 20000), 0.3 - 0.7j)
    kept = by_lot(wave, 1.0, rng)
    assert {*np.unique(kept.real)} == {0.0, 1.0}
    assert kept.mean() == pytest.approx(0.3 - 0.7j, abs=0.02)


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    rng = np.random.default_rng(6)
    sizes, begin = rng.random((3, 100)), np.array([20, 33, 90])
    for made in (in_order, evened, haar):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    eights = in_order(sizes, begin)[0, 20:100].reshape(-1, EIGHT)
    assert (np.diff(eights, axis=1) >= 0).all()
    assert np.allclose(np.sort(sizes[0, 20:100]), np.sort(eights.ravel()))
    ranks = evened(sizes, begin)[0, 20:92]
    assert np.allclose(np.diff(np.sort(ranks)), np.diff(np.sort(ranks))[0])
    assert ranks.mean() == pytest.approx(sizes[0, 20:92].mean())
    assert np.array_equal(ranks.argsort(), sizes[0, 20:92].argsort())
    pairs = haar(sizes, begin)[0, 20:100].reshape(-1, 2)
    assert np.allclose(pairs[:, 0] + pairs[:, 1] / 2, sizes[0, 20:100].reshape(-1, 2).max(axis=1))
