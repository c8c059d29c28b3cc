"""The pottery's cones and the forms of its effects on waveforms: against known laws."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.pottery_cone import (
    AHEAD,
    ALIKE,
    LIGHT_M_NS,
    OF_SIZES,
    SAMPLE_NS,
    WIDE_SAMPLES,
    Cone,
    blunging,
    cast_later,
    fallen,
    levels_db,
    lull,
    slumped,
    slumps,
    thuds,
)
from bench.challenge.families.pottery_effects import (
    TILES,
    by_the_kiln,
    off_the_tiles,
    returned,
    told_of_both,
)
from bench.challenge.families.pottery_floor import Firing
from bench.challenge.families.pottery_wave_effects import (
    SOME,
    brick_returns,
    by_faces,
    drummed,
    in_steps,
    reading,
    shading,
    stretched,
    sweeping,
)
from bench.challenge.families.pottery_waves import ECHOES, SOONEST, echoes
from tests.bench.challenge import shown

_known = partial(shown.known_of, "pottery")


def _firing() -> Firing:
    return Firing(_known(), 0, np.random.default_rng(0))


def test_what_floors_and_bricks_return_is_as_fresnel_has_it_and_by_images() -> None:
    made = returned(TILES, np.array([1e-7, 1.0, 1.0]), np.array([0.3, 0.0, np.pi / 2]))
    straight = (1 - np.sqrt(TILES)) / (1 + np.sqrt(TILES))
    assert made[0] == pytest.approx(-1.0, abs=1e-3)
    assert made[1] == pytest.approx(straight)
    assert made[2] == pytest.approx(-straight)
    assert brick_returns(np.array([0.0, 1.0])).tolist() == pytest.approx(
        [1.0, (np.sqrt(3.8) - 1) / (np.sqrt(3.8) + 1)]
    )
    firing = _firing()
    longer, share = off_the_tiles(firing, 1.0)
    image = firing.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + firing.far, np.linalg.norm(image - firing.purlin_m, axis=1))
    assert 0.3 < np.abs(share).max() <= 0.78 + 1e-9


def test_ways_by_faces_and_the_kiln_are_longer_than_straight_ones() -> None:
    firing = _firing()
    longer, share = by_faces(firing)
    assert longer.shape == share.shape == (6, firing.rows)
    assert longer[share > 0].min() > 0
    assert 0 <= share.min() < share.max() < 1
    image = firing.purlin_m * np.array([-1.0, 1.0, 1.0])
    assert np.allclose(longer[0], np.linalg.norm(image - firing.tag_m, axis=1) - firing.far)
    assert by_the_kiln(firing).min() > -1e-9


def test_what_ranges_have_of_two_pulses_is_what_cones_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0]).astype(np.complex128)
    late, high = told_of_both(np.full(4, 0.35), share)
    each_m, top = LIGHT_M_NS * SAMPLE_NS, np.full(4, 92.2)
    both = thuds(top) + share[:, None] * thuds(top + 0.35 / each_m)
    assert np.allclose(late, each_m * (slumped(both) - top + AHEAD), atol=0.02)
    assert late[0] > 0.005 > -0.005 > late[1]
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)


def test_pulses_are_even_and_as_wide_as_a_dw1000s() -> None:
    off = np.linspace(-9.0, 9.0, 3601)
    over = off[slumps(off) >= 0.5]
    assert 2.0 < (over[-1] - over[0]) * SAMPLE_NS < 2.6
    assert np.allclose(slumps(off), slumps(-off))
    assert slumps(np.zeros(1))[0] == 1.0


def test_noise_is_alike_as_measured_and_told_whatever_it_is() -> None:
    noise = 3.0 * blunging(np.random.default_rng(2), 2000)
    beside = [(noise[:, k:] * noise[:, : -k or None].conj()).real.mean() / 18 for k in range(5)]
    assert np.allclose(beside, [*ALIKE, 0.0], atol=0.01)
    assert np.abs(noise).std() == pytest.approx(3.0 * OF_SIZES, rel=0.01)
    assert lull(noise).mean() == pytest.approx(18.0, rel=0.03)
    assert np.allclose(lull(noise + 40.0), lull(noise))


def test_pulses_that_come_later_are_as_they_were() -> None:
    wave = np.asarray(2.0j * thuds(np.array([60.25])), np.complex128)
    twice = cast_later(cast_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * thuds(np.full(1, 61.25))).max() < 0.02
    whole = cast_later(wave, np.full(1, 7.0))
    assert np.allclose(whole[:, 7:], wave[:, :-7], atol=1e-6)


def test_first_paths_are_read_however_high_and_never_sooner_if_cold() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = thuds(top).astype(np.complex128)
    at = slumped(one)
    assert np.allclose(top - at, AHEAD, atol=2e-3)
    assert np.allclose(slumped(30.0j * one), at, atol=1e-6)
    weak = 0.3 * one + thuds(top + 14.2)
    keen, cold = slumped(weak), slumped(weak, 1.0)
    assert np.allclose(keen, at, atol=0.02)
    assert np.allclose(cold - keen, 14.2, atol=0.03)
    assert (np.abs(fallen(weak, 0.0) - top) <= 1.0).all()


def test_what_follows_first_pulses_hardly_moves_these() -> None:
    top, turn = np.full(48, 90.3), np.exp(2j * np.pi * np.arange(48) / 48)
    for late, most in ((5.0, 0.05), (6.5, 0.01)):
        both = thuds(top) + 0.5 * turn[:, None] * thuds(top + late)
        assert np.abs(slumped(both) - top + AHEAD).max() < most


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (20.0, 80.0):
        off = slumped(high * thuds(top) + blunging(np.random.default_rng(2), 1000)) - top + AHEAD
        assert abs(np.median(off)) < 0.03
        assert (np.abs(off) > 0.7).mean() < 0.02
        assert off[np.abs(off) < 0.7].std() < 2.6 / high


def test_levels_are_those_of_pulses() -> None:
    top, still = 90 + np.linspace(0, 1, 65), np.full(65, 1e-4)
    wave = (2.0 * thuds(top) + 1.0 * thuds(top + 30.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, still)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.02)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.05)


@pytest.mark.parametrize("period_ns", [SAMPLE_NS, 1.0016])
def test_samples_are_as_long_as_tables_say(period_ns: float) -> None:
    top = 60 + np.random.default_rng(3).random(40)
    wave = 4000.0 * thuds(top) + 60.0 * blunging(np.random.default_rng(4), 40)
    rows = _known().head(40).assign(
        range_m=10.0, error_m=0.0, rx_power_dbm=-80.0, first_path_power_dbm=-82.0,
        noise_std=60.0 * OF_SIZES, preamble_count=200.0, first_path_index=top - AHEAD,
        cir_i=[*wave.real], cir_q=[*wave.imag], true_range_m=10.0, sample_period_ns=period_ns,
    )  # fmt: skip
    cone = Cone(rows, 0, np.random.default_rng(0))
    cone.wave = cast_later(cone.wave, np.full(cone.rows, 2.0))
    late = np.median(cone.told()["range_m"] - rows["range_m"])
    assert late == pytest.approx(2 * LIGHT_M_NS * period_ns, abs=3e-3)


def test_echoes_come_one_by_one_and_fall() -> None:
    table: Any = SimpleNamespace(far=np.ones(4000), rng=np.random.default_rng(2))
    table.each_link = lambda draws: draws(4000)
    late, high = echoes(table)
    assert late.shape == high.shape == (ECHOES, 4000)
    assert (late[0] == SOONEST).all()
    assert np.diff(late, axis=0).min() >= 0.4
    means = np.median(high, axis=1)
    assert means[0] == pytest.approx(1.0, abs=0.03)
    assert means[-1] < 0.15


def test_fades_have_power_one_and_tails_are_long_in_going() -> None:
    made = shading(np.random.default_rng(2), 2000)
    assert made.shape == (2000, WIDE_SAMPLES)
    assert (made**2).mean() == pytest.approx(1.0)
    assert np.corrcoef(made[:, 50], made[:, 51])[0, 1] > 0.5
    assert abs(np.corrcoef(made[:, 50], made[:, 130])[0, 1]) < 0.1
    assert (made**4).mean() > 2.4  # heavier than Rayleigh's, which is 2
    tail = stretched(np.linspace(-3.0, 200.0, 2031))
    assert tail[:30].max() == 0.0
    assert tail.argmax() < 150
    assert (np.diff(tail[150:]) < 0).all()


def test_lids_ring_after_pulses_and_die() -> None:
    rang = drummed(thuds(np.full(1, 60.0)).astype(np.complex128))[0]
    assert abs(rang[60]) < 0.12
    assert np.abs(rang[100:]).max() < 0.03
    assert np.abs(rang[63:80]).max() > 0.4


def test_tones_have_size_one_and_sweep_and_steps_are_whole() -> None:
    tones = sweeping(np.random.default_rng(3), 40)
    assert np.allclose(np.abs(tones), 1.0)
    pitch = np.unwrap(np.diff(np.unwrap(np.angle(tones), axis=1), axis=1), axis=1)
    assert np.abs(pitch[:, -1] - pitch[:, 0]).min() > 0.9
    assert reading(3 * SOME) == pytest.approx(3 * reading(SOME))
    made = in_steps(SOME, 0.4)
    assert np.allclose(made.real / 0.4, np.rint(made.real / 0.4))
    assert np.allclose(made.imag / 0.5, np.rint(made.imag / 0.5))
    assert np.abs((made - SOME).imag).max() <= 0.25 + 1e-9
