"""The tram shed's bells and the forms of its effects on waveforms: against known laws."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.tramshed_bell import (
    AHEAD,
    ALIKE,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_SAMPLES,
    Bell,
    arcing,
    hush,
    levels_db,
    peals,
    rung,
    strokes,
    struck,
    tolled_later,
)
from bench.challenge.families.tramshed_depot import SHED_M, Fares
from bench.challenge.families.tramshed_effects import (
    SETTS,
    by_arches,
    flat_back,
    off_the_setts,
    told_of_both,
)
from bench.challenge.families.tramshed_wave_effects import (
    SOME,
    beating,
    by_faces,
    hung,
    in_treads,
    reading,
    shading,
    swelling,
)
from bench.challenge.families.tramshed_waves import CLUSTERS, RAYS, SOONEST, echoes
from tests.bench.challenge import shown

_known = partial(shown.known_of, "tramshed")


def _fares() -> Fares:
    return Fares(_known(), 0, np.random.default_rng(0))


def test_what_the_floor_returns_is_whole_if_grazing_and_by_images() -> None:
    made = flat_back(SETTS, np.array([1e-7, 1.0, 1.0]), np.array([0.3, 0.0, np.pi / 2]))
    straight = (1 - np.sqrt(SETTS)) / (1 + np.sqrt(SETTS))
    assert made[0] == pytest.approx(-1.0, abs=1e-3)
    assert made[1] == pytest.approx(straight)
    assert made[2] == pytest.approx(-straight)
    fares = _fares()
    longer, share = off_the_setts(fares, 1.0)
    image = fares.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + fares.far, np.linalg.norm(image - fares.rosette_m, axis=1))
    assert 0.3 < np.abs(share).max() <= 0.8 + 1e-9


def test_ways_by_faces_and_arches_are_longer_than_straight_ones() -> None:
    fares = _fares()
    longer, share = by_faces(fares)
    assert longer.shape == share.shape == (5, fares.rows)
    assert longer.min() > 0
    assert 0 < share.min() < share.max() < 1
    image = fares.rosette_m * [1.0, 1.0, -1.0] + [0.0, 0.0, 2 * SHED_M[2]]
    assert np.allclose(longer[4], np.linalg.norm(image - fares.tag_m, axis=1) - fares.far)
    assert by_arches(fares).min() > -1e-9


def test_what_ranges_have_of_two_pulses_is_what_bells_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0]).astype(np.complex128)
    late, high = told_of_both(np.full(4, 0.35), share)
    each_m, top = LIGHT_M_NS * SAMPLE_NS, np.full(4, 92.2)
    both = peals(top) + share[:, None] * peals(top + 0.35 / each_m)
    assert np.allclose(late, each_m * (rung(both) - top + AHEAD), atol=0.02)
    assert late[0] > 0.005 > -0.005 > late[1]
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)


def test_pulses_are_even_and_as_wide_as_a_dw1000s() -> None:
    off = np.linspace(-9.0, 9.0, 3601)
    over = off[strokes(off) >= 0.5]
    assert 2.0 < (over[-1] - over[0]) * SAMPLE_NS < 2.6
    assert np.allclose(strokes(off), strokes(-off))
    assert strokes(np.zeros(1))[0] == 1.0


def test_noise_is_alike_as_measured_and_told_whatever_it_is() -> None:
    noise = 3.0 * arcing(np.random.default_rng(2), 2000)
    beside = [(noise[:, k:] * noise[:, : -k or None].conj()).real.mean() / 18 for k in range(5)]
    assert np.allclose(beside, [*ALIKE, 0.0], atol=0.01)
    assert np.abs(noise).std() == pytest.approx(3.0 * OF_SIZES, rel=0.01)
    assert np.median(hush(noise)) == pytest.approx(3.0, rel=0.03)


def test_pulses_that_come_later_are_as_they_were() -> None:
    wave = np.asarray(2.0j * peals(np.array([60.25])), np.complex128)
    twice = tolled_later(tolled_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * peals(np.full(1, 61.25))).max() < 0.01
    whole = tolled_later(wave, np.full(1, 7.0))
    assert np.allclose(whole[:, 7:], wave[:, :-7], atol=1e-6)


def test_first_paths_are_read_however_high_and_never_sooner_if_deaf() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = peals(top).astype(np.complex128)
    at = rung(one)
    assert np.allclose(top - at, AHEAD, atol=1e-3)
    assert np.allclose(rung(30.0j * one), at, atol=1e-6)
    weak = 0.3 * one + peals(top + 14.2)
    keen, deaf = rung(weak), rung(weak, 1.0)
    assert np.allclose(keen, at, atol=0.02)
    assert np.allclose(deaf - keen, 14.2, atol=0.03)
    assert (np.abs(struck(weak, 0.0) - top) <= 1.0).all()


def test_what_follows_first_pulses_hardly_moves_these() -> None:
    top, turn = np.full(48, 90.3), np.exp(2j * np.pi * np.arange(48) / 48)
    for late, most in ((5.0, 0.05), (6.5, 0.01)):
        both = peals(top) + 0.5 * turn[:, None] * peals(top + late)
        assert np.abs(rung(both) - top + AHEAD).max() < most


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (20.0, 80.0):
        off = rung(high * peals(top) + arcing(np.random.default_rng(2), 1000)) - top + AHEAD
        assert abs(np.median(off)) < 0.03
        assert (np.abs(off) > 0.7).mean() < 0.02
        assert off[np.abs(off) < 0.7].std() < 2.4 / high


def test_levels_are_those_of_pulses() -> None:
    top, still = 90 + np.linspace(0, 1, 65), np.full(65, 1e-4)
    wave = (2.0 * peals(top) + 1.0 * peals(top + 30.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, still)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.02)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.05)


@pytest.mark.parametrize("period_ns", [SAMPLE_NS, 1.0016])
def test_samples_are_as_long_as_tables_say(period_ns: float) -> None:
    top = 60 + np.random.default_rng(3).random(40)
    wave = 4000.0 * peals(top) + 60.0 * arcing(np.random.default_rng(4), 40)
    rows = _known().head(40).assign(
        range_m=10.0, error_m=0.0, rx_power_dbm=-80.0, first_path_power_dbm=-82.0,
        noise_std=60.0 * OF_SIZES, preamble_count=300.0, first_path_index=top - AHEAD,
        cir_i=[*wave.real], cir_q=[*wave.imag], true_range_m=10.0, sample_period_ns=period_ns,
    )  # fmt: skip
    bell = Bell(rows, 0, np.random.default_rng(0))
    bell.wave = tolled_later(bell.wave, np.full(bell.rows, 2.0))
    late = np.median(bell.told()["range_m"] - rows["range_m"])
    assert late == pytest.approx(2 * LIGHT_M_NS * period_ns, abs=3e-3)


def test_echoes_come_in_groups_that_fall() -> None:
    table: Any = SimpleNamespace(far=np.ones(4000), rng=np.random.default_rng(2))
    table.each_link = lambda draws: draws(4000)
    late, high = echoes(table)
    assert late.shape == high.shape == (CLUSTERS * RAYS, 4000)
    assert late.min() == SOONEST
    assert (high[0] == 1.0).all()
    for group in range(CLUSTERS):
        own = slice(group * RAYS, (group + 1) * RAYS)
        assert (np.diff(late[own], axis=0) > 0).all()
        assert (np.diff(high[own], axis=0) < 0).all()
    assert (np.diff(high[::RAYS], axis=0) < 0).all()


def test_fades_have_power_one_and_tails_swell_and_die() -> None:
    made = shading(np.random.default_rng(2), 2000)
    assert made.shape == (2000, WIDE_SAMPLES)
    assert (made**2).mean() == pytest.approx(1.0)
    assert np.corrcoef(made[:, 50], made[:, 51])[0, 1] > 0.5
    assert abs(np.corrcoef(made[:, 50], made[:, 90])[0, 1]) < 0.1
    tail = swelling(np.linspace(-3.0, 200.0, 2031))
    assert tail[:30].max() == 0.0
    assert 31 < tail.argmax() < 250
    assert (np.diff(tail[400:]) < 0).all()


def test_wires_ring_after_pulses_and_die() -> None:
    rang = hung(peals(np.full(1, 60.0)).astype(np.complex128))[0]
    assert abs(rang[60]) < 0.12
    assert np.abs(rang[100:]).max() < 0.03
    assert np.abs(rang[63:80]).max() > 0.4


def test_tones_have_power_one_and_beat_and_treads_have_no_nought() -> None:
    tones = beating(np.random.default_rng(3), 40)
    assert np.allclose((np.abs(tones) ** 2).mean(axis=1), 1.0)
    assert np.abs(tones).std() > 0.2
    assert reading(3 * SOME) == pytest.approx(3 * reading(SOME))
    made = in_treads(SOME, 0.4)
    assert np.allclose(made.real / 0.4 % 1.0, 0.5)
    assert np.abs((made - SOME).imag).max() <= 0.2 + 1e-9
