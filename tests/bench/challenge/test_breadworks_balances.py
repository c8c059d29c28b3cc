"""The forms that the breadworks's effects have, and its balances: against laws that are known."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest
from scipy.special import fresnel, iv
from scipy.stats import gengamma, kurtosis

from bench.challenge.families.breadworks_balance import (
    AHEAD,
    ALIKE,
    HALF,
    METRES,
    SECANT,
    SHAPE_POWER,
    first_paths,
    fitting,
    heights,
    kneading,
    levels_db,
    loaves,
    proved_later,
)
from bench.challenge.families.breadworks_effects import (
    KEPT,
    THREE,
    TILE,
    TWO,
    UNEVEN_M,
    latitude,
    mixture,
    of_two,
    of_two_pulses,
    off_the_floor,
    past_edge,
    through_rack,
    tiles,
)
from bench.challenge.families.breadworks_hall import HALL_M, WAVE_M, Bake
from bench.challenge.families.breadworks_wave_effects import (
    ALPHA,
    BEATS,
    DEALT,
    DRIFTS,
    FED,
    MU,
    PRIME,
    ROOMS,
    STEEP,
    TILED,
    TUNE,
    amid_steps,
    beating,
    by_images,
    companded,
    dealt,
    drifting,
    of_rooms,
    pumped,
    rung,
    spread,
    yacoub,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "breadworks")


def _bake() -> Bake:
    return Bake(_known(), 0, np.random.default_rng(0))


def test_three_messages_and_kept_places_weigh_one_and_are_late_by_what_is_said() -> None:
    at, by = np.array(THREE).T
    assert by.sum() == pytest.approx(1.0)
    assert (by * at).sum() == pytest.approx(1.15)
    assert np.average(np.arange(len(KEPT)), weights=KEPT) == pytest.approx(2.0)
    assert np.allclose(KEPT, np.convolve(np.ones(3), np.ones(3)))


def test_latitudes_are_gudermanns() -> None:
    of = np.linspace(-6.0, 6.0, 61)
    assert np.allclose(latitude(of), 2 / np.pi * np.arcsin(np.tanh(of)))
    assert np.allclose(latitude(of), -latitude(-of))


def test_edges_of_two_scatter_by_one_and_have_two_peaks() -> None:
    made = of_two(np.random.default_rng(1), 100_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert made.mean() == pytest.approx(0.0, abs=0.015)
    assert kurtosis(made) == pytest.approx(-2 * TWO**4, abs=0.05)


def test_racks_are_no_later_in_the_mean() -> None:
    assert through_rack(np.linspace(0.0, 2 * np.pi, 721)[:-1]).mean() == pytest.approx(0.375)


def test_edges_leave_what_fresnels_integrals_say() -> None:
    v = np.linspace(0.0, 6.0, 61)
    sine, cosine = fresnel(v)
    size = np.hypot(0.5 - cosine, 0.5 - sine) / np.sqrt(2)
    assert np.allclose(past_edge(v), size, atol=3e-3)
    assert past_edge(np.zeros(1))[0] == pytest.approx(0.5)


def test_mixtures_add_up_by_logarithms() -> None:
    assert np.allclose(mixture(16.0, np.array([0.0, 0.5, 1.0])), [1.0, 4.0, 16.0])


def test_tiles_return_all_of_level_waves_and_less_of_steep_ones() -> None:
    sines = np.linspace(1e-5, 1.0, 200)
    left = tiles(sines)
    assert left[0] == pytest.approx(-1.0, abs=1e-3)
    smooth = (1 - np.sqrt(TILE)) / (1 + np.sqrt(TILE))
    g = 0.5 * (4 * np.pi * UNEVEN_M / WAVE_M) ** 2
    assert left[-1] == pytest.approx(smooth * np.exp(-g) * iv(0, g))
    assert (np.diff(np.abs(left)) < 0).all()


def test_the_way_by_the_floor_is_an_images() -> None:
    longer, share = off_the_floor(_bake(), 1.0)
    rows = _known()
    flat = rows["true_range_m"] ** 2 - (rows["rx_z_m"] - rows["tx_z_m"]) ** 2
    image = np.sqrt(flat + (rows["rx_z_m"] + rows["tx_z_m"]) ** 2)
    assert np.allclose(longer + rows["true_range_m"], image)
    assert np.abs(share).max() <= 0.78 + 1e-9


def test_what_ranges_have_of_two_pulses_is_what_balances_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0])
    late, height = of_two_pulses(np.full(4, 0.35), share)
    both: Any = loaves(np.full(4, 80.1)) + share[:, None] * loaves(np.full(4, 80.1) + 0.35 / METRES)
    told = METRES * (first_paths(both, np.full(4, 1e-6)) - 80.1 + AHEAD)
    assert np.allclose(late, told, atol=0.01)
    assert late[3] == pytest.approx(0.0, abs=1e-3)
    assert height[3] == pytest.approx(1.0, abs=1e-3)
    assert late[0] > 0.01
    assert late[1] < -0.01


def test_pulses_are_solitons_as_long_as_measured_and_end() -> None:
    at = np.linspace(0.0, 1.0, 1001)
    high = np.concatenate([loaves(np.full(1, 70.0 + HALF * k))[:, 70] for k in at])
    assert 2.1 < 2 * HALF * np.interp(-0.5, -high, at) < 2.7
    assert high[0] == pytest.approx(1.0)
    assert (np.diff(high) < 1e-12).all()
    assert high[-1] == pytest.approx(0.0, abs=1e-12)
    assert np.allclose(high, 1 / np.cosh(HALF * at / SECANT) ** 2, atol=0.003)


def test_noise_is_beside_itself_as_asked_and_fits_are_by_least_squares() -> None:
    noise = kneading(np.random.default_rng(2), 2000)
    for apart, alike in enumerate([*ALIKE, 0.0]):
        there = (noise[:, apart:] * noise[:, : noise.shape[1] - apart].conj()).real.mean() / 2
        assert there == pytest.approx(alike, abs=0.01)
    wave: Any = 2.0j * loaves(np.full(1, 60.0))
    assert fitting(wave.astype(np.complex128))[0, 60] == pytest.approx(2.0j, abs=1e-3)
    assert pytest.approx(float((np.abs(wave / 2) ** 2).sum()), abs=1e-3) == SHAPE_POWER
    twice = proved_later(proved_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * loaves(np.full(1, 61.0))).max() < 0.02


def test_pans_stay_where_pulses_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = loaves(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.01)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-6)
    weak = 0.3 * one + loaves(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(deaf - sharp, 11.2, atol=0.08)
    soon, late = (first_paths(0.5 * one + loaves(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_one_goes_back_across_short_lulls_alone() -> None:
    top, quiet = np.full(3, 60.0), np.full(3, 0.003)
    off = np.array([20.0, 40.0, 70.0])
    wave = (0.4 * loaves(top) + loaves(top + off)).astype(np.complex128)
    back = first_paths(wave, quiet) + AHEAD - top
    assert np.allclose(back, [0.0, 0.0, 70.0], atol=0.05)


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (25.0, 80.0):
        wave = high * loaves(top) + kneading(np.random.default_rng(2), 1000)
        off = first_paths(wave, np.ones(1000)) - top + AHEAD
        assert abs(off.mean()) < 4 * off.std() / np.sqrt(1000)
        assert off.std() < 2.5 / high


def test_levels_are_those_of_pulses() -> None:
    top, quiet = 90 + np.linspace(0, 1, 9), np.full(9, 1e-3)
    wave = (2.0 * loaves(top) + 1.0 * loaves(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, quiet)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.1)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.3)
    assert np.allclose(heights(wave, top - AHEAD), 2.0)


def test_tiled_walls_are_heard_by_images_and_corners_by_images_of_images() -> None:
    bake = _bake()
    made = by_images(bake)
    assert len(made) == 9
    corner = np.array([0.0, 0.0])
    way, left = made[5]
    over = bake.tag_m[:, :2] + bake.corbel_m[:, :2] - 2 * corner
    up = bake.tag_m[:, 2] - bake.corbel_m[:, 2]
    assert np.allclose(way, np.sqrt((over**2).sum(axis=1) + up**2))
    assert np.allclose(left * way / bake.far, TILED**2)
    ceiling = np.hypot(2 * HALL_M[2] - bake.tag_m[:, 2] - bake.corbel_m[:, 2],
                       np.hypot(*(bake.tag_m - bake.corbel_m)[:, :2].T))  # fmt: skip
    assert np.allclose(made[4][0], ceiling)


def test_fades_have_yacoubs_law_and_power_one() -> None:
    made = yacoub(np.random.default_rng(2), 600)
    assert (made**2).mean() == pytest.approx(1.0)
    law, knots = gengamma(MU, ALPHA), made[:, ::5]
    for low, high in ((0.25, 0.5), (0.5, 0.75)):
        ratio = np.quantile(knots, high) / np.quantile(knots, low)
        assert ratio == pytest.approx(law.ppf(high) / law.ppf(low), rel=0.04)


def test_of_two_rooms_the_damp_one_is_still_first() -> None:
    since = np.linspace(0.0, 120.0, 1201)
    power = of_rooms(since)
    assert power[0] == pytest.approx(sum(share for share, _ in ROOMS))
    fall = -np.gradient(np.log(power), since)
    assert (np.diff(fall)[2:-2] < 0).all()
    assert fall[-2] == pytest.approx(1 / ROOMS[1][1], rel=0.01)
    assert fall[1] > 1 / 15.0


def test_bowls_beat_after_they_are_fed() -> None:
    blow = np.zeros((1, 240), np.complex128)
    blow[0, 10] = 1.0
    made = rung(blow)[0]
    assert np.abs(made[: 10 + FED]).max() < 1e-9
    assert np.allclose(made[10:110], beating())
    assert (np.abs(beating()) ** 2).sum() == pytest.approx(1.0)
    still = FED + np.rint(np.pi / BEATS).astype(int)  # all is back in the other
    assert np.abs(beating()[still]) < 0.05 * np.abs(beating()).max()
    assert np.abs(beating()[-10:]).max() < 0.05 * np.abs(beating()).max()


def test_dryers_drift_evenly_at_size_one() -> None:
    tone = drifting(np.random.default_rng(3), 40)
    assert np.allclose(np.abs(tone), 1.0)
    pitch = np.angle(tone[:, 1:] * tone[:, :-1].conj())
    assert np.allclose(np.diff(pitch, axis=1), DRIFTS)
    assert TUNE[0] <= pitch[:, 0].min() <= pitch[:, 0].max() <= TUNE[1] + DRIFTS


def test_noise_is_told_by_how_sizes_differ() -> None:
    noise = kneading(np.random.default_rng(4), 400)
    assert spread(3 * noise) == pytest.approx(3 * spread(noise))
    assert spread(noise) == pytest.approx(np.abs(noise).std(), rel=0.1)


def test_of_steps_the_middles_are_kept() -> None:
    rng = np.random.default_rng(5)
    wave = rng.normal(size=(3, 200)) + 1j * rng.normal(size=(3, 200))
    kept = amid_steps(wave, 0.4)
    assert np.allclose(kept.real / 0.4 - 0.5, np.rint(kept.real / 0.4 - 0.5))
    assert np.abs(kept.real - wave.real).max() <= 0.2 + 1e-12
    assert np.abs(kept.imag).min() == pytest.approx(0.2)


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    rng = np.random.default_rng(6)
    sizes, begin = 1 + 10 * rng.random((3, 160)), np.array([20, 33, 90])
    for made in (dealt, companded, pumped):
        odd = made(sizes, begin)
        for row, first in enumerate(begin):
            assert np.array_equal(odd[row, :first], sizes[row, :first])
    deck, was = dealt(sizes, begin)[0, 20 : 20 + PRIME], sizes[0, 20 : 20 + PRIME]
    assert np.array_equal(np.sort(deck), np.sort(was))
    assert np.array_equal(deck[:5], was[DEALT * np.arange(5)])
    late = sizes[0, 21:]
    back = np.expm1(companded(sizes, begin)[0, 21:] / late.max() * np.log1p(STEEP)) / STEEP
    assert np.allclose(back * late.max(), late)
    fell = np.full((1, 160), 9.0)
    fell[0, 60:] = 1.0
    evened = pumped(fell, np.array([20]))[0]
    assert np.allclose(evened[:60], 9.0)
    assert evened[60] < 1.2
    assert evened[-1] == pytest.approx(9.0**0.6, rel=0.02)
