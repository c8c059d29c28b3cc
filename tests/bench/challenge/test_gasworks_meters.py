"""The forms that the gasworks' effects have, and its meters: against laws that are known."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.gasworks_effects import (
    BREEZE,
    BRICK,
    by_tanks,
    damp,
    edge_db,
    of_layers,
    off_the_ground,
    over_heaps,
    told_with,
)
from bench.challenge.families.gasworks_meter import (
    AHEAD,
    ALIKE,
    LIGHT_M_NS,
    OF_SIZES,
    PART,
    SAMPLE_NS,
    WIDE_SAMPLES,
    Meter,
    first_top,
    hissing,
    levels_db,
    lull,
    metered,
    piped_later,
    puffs,
    skirted,
)
from bench.challenge.families.gasworks_wave_effects import (
    SOME,
    SWELLS,
    in_steps,
    of_noise,
    stemmed,
    swelling,
    waning,
    wobbling,
)
from bench.challenge.families.gasworks_waves import EACH, GROUPS, SOONEST, arrivals
from bench.challenge.families.gasworks_yard import TANKS_M, Charge
from tests.bench.challenge import shown

_known = partial(shown.known_of, "gasworks")


def _charge() -> Charge:
    return Charge(_known(), 0, np.random.default_rng(0))


def test_damp_stuff_is_slower_and_dry_stuff_by_its_root() -> None:
    made = damp(4.0, np.array([0.0, 0.1]))
    assert made[0] == pytest.approx(1.0)
    assert made[1] == pytest.approx(0.9 * 2 + 0.1 * np.sqrt(78.0) - 1)


def test_edges_take_six_db_at_grazing_and_ways_over_heaps_are_three_straight_lines() -> None:
    one = np.full(3, 5.0)
    assert edge_db(one, one, np.zeros(3))[0] == pytest.approx(6.0, abs=0.1)
    assert (np.diff(edge_db(one, one, np.array([0.0, 0.3, 0.9]))) > 0).all()
    longer, _ = over_heaps(np.full(1, 11.0), np.full(1, 0.5), np.full(1, 1.0), np.full(1, 1.0))
    assert longer[0] == pytest.approx(2 * np.hypot(5.0, 1.0) + 1.0 - 11.0)


def test_what_the_ground_returns_is_whole_if_grazing_and_that_of_one_layer_if_all_are_alike() -> (
    None
):
    made = of_layers(np.array([1e-7, 1.0]))
    assert made[0] == pytest.approx(-1.0, abs=1e-3)
    thin, thick = ((1 - np.sqrt(one)) / (1 + np.sqrt(one)) for one in (BRICK, BREEZE))
    assert abs(made[1]) < abs(thin) + abs(thick)


def test_ways_by_the_ground_are_as_long_as_images_are_far() -> None:
    charge = _charge()
    longer, share = off_the_ground(charge, 1.0)
    image = charge.tag_m * np.array([1.0, 1.0, -1.0])
    way = np.linalg.norm(image - charge.bracket_m, axis=1)
    assert np.allclose(longer + charge.far, way)
    assert np.abs(share).max() <= 0.77 + 1e-9


def test_ways_by_tanks_leave_these_as_they_come() -> None:
    charge = _charge()
    longer, share = by_tanks(charge)
    assert longer.shape == share.shape == (len(TANKS_M), charge.rows)
    heard = np.isfinite(longer)
    assert 0.5 < heard.mean() < 1.0
    assert longer[heard].min() > 0.0
    assert not share[~heard].any()
    assert 0 < share[heard].max() < 1.0
    for tank in (0, 3):
        for row in range(0, charge.rows, 149):
            if not heard[tank, row]:
                continue
            turn = np.linspace(-np.pi, np.pi, 20001)
            east, north, radius = TANKS_M[tank]
            at = np.column_stack([east + radius * np.cos(turn), north + radius * np.sin(turn)])
            legs = sum(np.linalg.norm(at - end[row, :2], axis=1)
                       for end in (charge.tag_m, charge.bracket_m))  # fmt: skip
            rise = charge.tag_m[row, 2] - charge.bracket_m[row, 2]
            assert np.hypot(np.min(legs), rise) - charge.far[row] == pytest.approx(
                longer[tank, row], abs=0.01
            )


def test_what_ranges_have_of_two_pulses_is_what_meters_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0]).astype(np.complex128)
    late, high = told_with(np.full(4, 0.35), share)
    each_m, top = LIGHT_M_NS * SAMPLE_NS, np.full(4, 92.2)
    both = puffs(top) + share[:, None] * puffs(top + 0.35 / each_m)
    assert np.allclose(late, each_m * (metered(both) - top + AHEAD), atol=0.012)
    assert late[0] > 0.01
    assert late[1] < -0.01
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)


def test_pulses_have_skirts_and_are_as_wide_as_a_dw1000s() -> None:
    off = np.linspace(-9.0, 9.0, 3601)
    over = off[skirted(off) >= 0.5]
    assert 2.0 < (over[-1] - over[0]) * SAMPLE_NS < 2.6
    assert skirted(np.zeros(1))[0] == 1.0


def test_noise_is_alike_as_measured_and_told_whatever_it_is() -> None:
    noise = 3.0 * hissing(np.random.default_rng(2), 2000)
    beside = [(noise[:, k:] * noise[:, : -k or None].conj()).real.mean() / 18 for k in range(5)]
    assert np.allclose(beside, [*ALIKE, 0.0], atol=0.01)
    assert np.abs(noise).std() == pytest.approx(3.0 * OF_SIZES, rel=0.01)
    assert np.median(lull(noise)) == pytest.approx(18.0, rel=0.07)


def test_pulses_that_come_later_are_as_they_were() -> None:
    wave = np.asarray(2.0j * puffs(np.array([60.25])), np.complex128)
    twice = piped_later(piped_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * puffs(np.full(1, 61.25))).max() < 0.02
    whole = piped_later(wave, np.full(1, 7.0))
    assert np.allclose(whole[:, 7:], wave[:, :-7], atol=0.02)


def test_first_paths_are_read_however_high_and_never_sooner_if_deaf() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = puffs(top).astype(np.complex128)
    at = metered(one)
    assert np.allclose(top - at, AHEAD, atol=2e-3)
    assert np.allclose(metered(30.0j * one), at, atol=1e-6)
    assert skirted(np.array([-AHEAD]))[0] / skirted(np.array([2 - AHEAD]))[0] == pytest.approx(
        PART, abs=0.05
    )
    weak = 0.3 * one + puffs(top + 14.2)
    keen, deaf = metered(weak), metered(weak, 1.0)
    assert np.allclose(keen, at, atol=0.02)
    assert np.allclose(deaf - keen, 14.2, atol=0.03)
    assert (np.abs(first_top(weak, 0.0) - top) <= 1.0).all()


def test_what_follows_first_pulses_hardly_moves_these() -> None:
    top, turn = np.full(48, 90.3), np.exp(2j * np.pi * np.arange(48) / 48)
    for late, most in ((5.0, 0.1), (6.4, 0.03)):
        both = puffs(top) + 0.5 * turn[:, None] * puffs(top + late)
        assert np.abs(metered(both) - top + AHEAD).max() < most


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (20.0, 80.0):
        off = metered(high * puffs(top) + hissing(np.random.default_rng(2), 1000)) - top + AHEAD
        assert abs(np.median(off)) < 0.02
        assert (np.abs(off) > 0.7).mean() < 0.01
        assert off[np.abs(off) < 0.7].std() < 3.6 / high


def test_levels_are_those_of_pulses() -> None:
    top, still = 90 + np.linspace(0, 1, 65), np.full(65, 1e-4)
    wave = (2.0 * puffs(top) + 1.0 * puffs(top + 30.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, still)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.02)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.03)


def _meter(period_ns: float) -> Meter:
    top = 60 + np.random.default_rng(3).random(40)
    wave = 4000.0 * puffs(top) + 60.0 * hissing(np.random.default_rng(4), 40)
    rows = _known().head(40).assign(
        range_m=10.0, error_m=0.0, rx_power_dbm=-80.0, first_path_power_dbm=-82.0,
        noise_std=60.0 * OF_SIZES, preamble_count=300.0, first_path_index=top - AHEAD,
        cir_i=[*wave.real], cir_q=[*wave.imag], true_range_m=10.0, sample_period_ns=period_ns,
    )  # fmt: skip
    return Meter(rows, 0, np.random.default_rng(0))


@pytest.mark.parametrize("period_ns", [SAMPLE_NS, 1.0016])
def test_samples_are_as_long_as_tables_say(period_ns: float) -> None:
    meter = _meter(period_ns)
    meter.wave = piped_later(meter.wave, np.full(meter.rows, 2.0))
    late = np.median(meter.told()["range_m"] - meter.table["range_m"])
    assert late == pytest.approx(2 * LIGHT_M_NS * period_ns, abs=3e-3)


def test_echoes_come_in_groups_that_fade() -> None:
    table: Any = SimpleNamespace(far=np.ones(4000), rng=np.random.default_rng(2))
    table.per_link = lambda draws: draws(4000)
    late, high = arrivals(table)
    assert late.shape == high.shape == (GROUPS * EACH, 4000)
    assert late.min() == SOONEST
    begins = late.reshape(GROUPS, EACH, -1)[:, 0]
    assert (np.diff(begins, axis=0) > 0).all()
    assert (np.diff(high.reshape(GROUPS, EACH, -1), axis=1) < 0).all()


def test_fades_have_power_one_and_tails_swell_before_they_die() -> None:
    made = waning(np.random.default_rng(2), 2000)
    assert made.shape == (2000, WIDE_SAMPLES)
    assert (made**2).mean() == pytest.approx(1.0)
    assert np.corrcoef(made[:, 50], made[:, 51])[0, 1] > 0.7
    assert abs(np.corrcoef(made[:, 50], made[:, 90])[0, 1]) < 0.1
    tail = swelling(np.linspace(-3.0, 120.0, 1231))
    assert tail[:30].max() == 0.0
    assert tail.argmax() == pytest.approx(30 + 10 * SWELLS, abs=1)
    assert tail.max() == pytest.approx(1.0)


def test_stems_ring_after_pulses_and_die() -> None:
    rung = stemmed(puffs(np.full(1, 60.0)).astype(np.complex128))[0]
    assert abs(rung[60]) < 0.12
    assert np.abs(rung[90:]).max() < 0.02
    assert np.abs(rung[64:80]).max() > 0.5


def test_tones_have_power_one_and_noise_is_said_by_fives() -> None:
    assert np.allclose(np.abs(wobbling(np.random.default_rng(3), 40)), 1.0)
    assert of_noise(3 * SOME) == pytest.approx(3 * of_noise(SOME))
    made = in_steps(SOME, 0.4)
    assert np.allclose(np.abs(made) / 0.4, np.rint(np.abs(made) / 0.4))
    assert np.abs(made - SOME).max() <= 0.2 + 1e-9
