"""The lighthouse's lenses and the forms of its effects on waveforms: against known laws."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.lighthouse_effects import (
    ROCK,
    by_walls,
    mirrored,
    off_the_rock,
    told_with,
)
from bench.challenge.families.lighthouse_lens import (
    AHEAD,
    ALIKE,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    TAPS,
    WIDE_SAMPLES,
    Lens,
    breaking,
    ebbed,
    first_crest,
    focused,
    gleams,
    levels_db,
    murmur,
    shone,
)
from bench.challenge.families.lighthouse_station import ROCK_M, Entries
from bench.challenge.families.lighthouse_wave_effects import (
    SOME,
    dimming,
    dying,
    humming,
    in_ticks,
    of_noise,
    paned,
)
from bench.challenge.families.lighthouse_waves import ECHOES, SOONEST, echoes
from tests.bench.challenge import shown

_known = partial(shown.known_of, "lighthouse")


def _entries() -> Entries:
    return Entries(_known(), 0, np.random.default_rng(0))


def test_what_the_ground_returns_is_whole_if_grazing_and_by_images() -> None:
    made = mirrored(ROCK, np.array([1e-7, 1.0]))
    assert made[0] == pytest.approx(-1.0, abs=1e-3)
    assert made[1] == pytest.approx((1 - np.sqrt(ROCK)) / (1 + np.sqrt(ROCK)))
    entries = _entries()
    longer, share = off_the_rock(entries, 1.0)
    image = entries.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + entries.far, np.linalg.norm(image - entries.cresset_m, axis=1))
    assert 0.3 < np.abs(share).max() <= 0.8 + 1e-9


def test_ways_by_walls_and_corners_are_longer_and_weaker_than_straight_ones() -> None:
    entries = _entries()
    longer, share = by_walls(entries)
    assert longer.shape == share.shape == (8, entries.rows)
    assert longer.min() > 0
    assert 0 < share.min() < share.max() < 1
    image = entries.cresset_m * np.array([-1.0, 1.0, 1.0])
    west = np.linalg.norm(image - entries.tag_m, axis=1) - entries.far
    assert np.allclose(longer[0], west)
    assert (longer[4] > np.maximum(longer[0], longer[2]) - 1e-9).all()
    assert np.ptp(longer[1]) < 2 * ROCK_M[0]


def test_what_ranges_have_of_two_pulses_is_what_lenses_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0]).astype(np.complex128)
    late, high = told_with(np.full(4, 0.35), share)
    each_m, top = LIGHT_M_NS * SAMPLE_NS, np.full(4, 92.2)
    both = gleams(top) + share[:, None] * gleams(top + 0.35 / each_m)
    assert np.allclose(late, each_m * (focused(both) - top + AHEAD), atol=0.02)
    assert late[0] > 0.005 > -0.005 > late[1]
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)


def test_pulses_rise_sooner_than_they_fall_and_are_as_wide_as_a_dw1000s() -> None:
    off = np.linspace(-9.0, 9.0, 3601)
    over = off[shone(off) >= 0.5]
    assert 2.0 < (over[-1] - over[0]) * SAMPLE_NS < 2.6
    assert over[-1] > -1.1 * over[0]
    assert shone(np.zeros(1))[0] == 1.0


def test_noise_is_alike_as_measured_and_told_whatever_it_is() -> None:
    assert (TAPS**2).sum() == pytest.approx(1.0, abs=1e-6)
    noise = 3.0 * breaking(np.random.default_rng(2), 2000)
    beside = [(noise[:, k:] * noise[:, : -k or None].conj()).real.mean() / 18 for k in range(5)]
    assert np.allclose(beside, [*ALIKE, 0.0], atol=0.01)
    assert np.abs(noise).std() == pytest.approx(3.0 * OF_SIZES, rel=0.01)
    assert np.median(murmur(noise)) == pytest.approx(18.0, rel=0.07)


def test_pulses_that_come_later_are_as_they_were() -> None:
    wave = np.asarray(2.0j * gleams(np.array([60.25])), np.complex128)
    twice = ebbed(ebbed(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * gleams(np.full(1, 61.25))).max() < 0.04
    whole = ebbed(wave, np.full(1, 7.0))
    assert np.allclose(whole[:, 7:], wave[:, :-7], atol=0.03)


def test_first_paths_are_read_however_high_and_never_sooner_if_dim() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = gleams(top).astype(np.complex128)
    at = focused(one)
    assert np.allclose(top - at, AHEAD, atol=3e-3)
    assert np.allclose(focused(30.0j * one), at, atol=1e-6)
    weak = 0.3 * one + gleams(top + 14.2)
    keen, dim = focused(weak), focused(weak, 1.0)
    assert np.allclose(keen, at, atol=0.02)
    assert np.allclose(dim - keen, 14.2, atol=0.03)
    assert (np.abs(first_crest(weak, 0.0) - top) <= 1.0).all()


def test_what_follows_first_pulses_hardly_moves_these() -> None:
    top, turn = np.full(48, 90.3), np.exp(2j * np.pi * np.arange(48) / 48)
    for late, most in ((5.0, 0.1), (6.4, 0.04)):
        both = gleams(top) + 0.5 * turn[:, None] * gleams(top + late)
        assert np.abs(focused(both) - top + AHEAD).max() < most


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (20.0, 80.0):
        off = focused(high * gleams(top) + breaking(np.random.default_rng(2), 1000)) - top + AHEAD
        assert abs(np.median(off)) < 0.03
        assert (np.abs(off) > 0.7).mean() < 0.01
        assert off[np.abs(off) < 0.7].std() < 3.6 / high


def test_levels_are_those_of_pulses() -> None:
    top, still = 90 + np.linspace(0, 1, 65), np.full(65, 1e-4)
    wave = (2.0 * gleams(top) + 1.0 * gleams(top + 30.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, still)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.02)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.05)


@pytest.mark.parametrize("period_ns", [SAMPLE_NS, 1.0016])
def test_samples_are_as_long_as_tables_say(period_ns: float) -> None:
    top = 60 + np.random.default_rng(3).random(40)
    wave = 4000.0 * gleams(top) + 60.0 * breaking(np.random.default_rng(4), 40)
    rows = _known().head(40).assign(
        range_m=10.0, error_m=0.0, rx_power_dbm=-80.0, first_path_power_dbm=-82.0,
        noise_std=60.0 * OF_SIZES, preamble_count=300.0, first_path_index=top - AHEAD,
        cir_i=[*wave.real], cir_q=[*wave.imag], true_range_m=10.0, sample_period_ns=period_ns,
    )  # fmt: skip
    lens = Lens(rows, 0, np.random.default_rng(0))
    lens.wave = ebbed(lens.wave, np.full(lens.rows, 2.0))
    late = np.median(lens.told()["range_m"] - rows["range_m"])
    assert late == pytest.approx(2 * LIGHT_M_NS * period_ns, abs=3e-3)


def test_echoes_come_one_after_another_and_fall() -> None:
    table: Any = SimpleNamespace(far=np.ones(4000), rng=np.random.default_rng(2))
    table.per_link = lambda draws: draws(4000)
    late, high = echoes(table)
    assert late.shape == high.shape == (ECHOES, 4000)
    assert late.min() == SOONEST
    assert (np.diff(late, axis=0) > 0).all()
    assert high[0].min() >= 1.0
    assert high[-1].max() < 0.8


def test_fades_have_power_one_and_tails_die_after_they_began() -> None:
    made = dimming(np.random.default_rng(2), 2000)
    assert made.shape == (2000, WIDE_SAMPLES)
    assert (made**2).mean() == pytest.approx(1.0)
    assert np.corrcoef(made[:, 50], made[:, 51])[0, 1] > 0.5
    assert abs(np.corrcoef(made[:, 50], made[:, 90])[0, 1]) < 0.1
    tail = dying(np.linspace(-3.0, 120.0, 1231))
    assert tail[:30].max() == 0.0
    assert (np.diff(tail[40:]) < 0).all()


def test_panes_ring_after_pulses_and_die() -> None:
    rung = paned(gleams(np.full(1, 60.0)).astype(np.complex128))[0]
    assert abs(rung[60]) < 0.12
    assert np.abs(rung[100:]).max() < 0.03
    assert np.abs(rung[63:80]).max() > 0.5


def test_tones_have_power_one_and_noise_is_said_by_fives() -> None:
    tones = humming(np.random.default_rng(3), 40)
    assert np.allclose((np.abs(tones) ** 2).mean(axis=1), 1.0)
    assert np.abs(tones).std() > 0.2
    assert of_noise(3 * SOME) == pytest.approx(3 * of_noise(SOME))
    made = in_ticks(SOME, 0.4)
    assert np.allclose(made.real / 0.4, np.rint(made.real / 0.4))
    assert np.abs((made - SOME).imag).max() <= 0.2 + 1e-9
