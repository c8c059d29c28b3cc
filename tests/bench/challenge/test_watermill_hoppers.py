"""The forms that the watermill's effects have, and its hoppers: against laws that are known."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.watermill_day import storey
from bench.challenge.families.watermill_effects import (
    FLAGS,
    RODS_M,
    STOREYS_M,
    by_rods,
    lying_waves,
    off_the_floor,
    panes,
    round_casings,
    told_of_both,
)
from bench.challenge.families.watermill_faults import BREAK_M, open_dbm
from bench.challenge.families.watermill_hopper import (
    AHEAD,
    BESIDE,
    FALLS,
    LIGHT_M_NS,
    OF_SIZES,
    RISES,
    SAMPLE_NS,
    WIDE_SAMPLES,
    Hopper,
    begun,
    grains,
    ground_later,
    heaped,
    heights,
    hush,
    levels_db,
    trundling,
    weighed,
)
from bench.challenge.families.watermill_race import ROOM_M, WALL_M, WAVE_M, Grist
from bench.challenge.families.watermill_wave_effects import (
    BACK,
    BEGINS,
    JOINTS,
    LINGERS,
    SOME,
    STEEP,
    by_walls,
    jointed,
    lingering,
    of_noise,
    shimmer,
    stepped,
    sweeping,
    swelling,
)
from bench.challenge.families.watermill_waves import GAP, PATHS, SHAPE, SOONEST, arrivals
from tests.bench.challenge import shown

_known = partial(shown.known_of, "watermill")


def _grist() -> Grist:
    return Grist(_known(), 0, np.random.default_rng(0))


def test_levels_fall_more_steeply_past_a_break() -> None:
    near, far = (open_dbm(np.array([d, 10 * d])) for d in (0.1, 100 * BREAK_M))
    assert near[0] - near[1] == pytest.approx(17.5, abs=0.01)
    assert far[0] - far[1] == pytest.approx(17.5 + 8.0, abs=0.01)


def test_panes_delay_by_their_root_and_more_if_aslant() -> None:
    straight, aslant = panes(4.0, np.full(2, 0.1), np.array([0.0, 0.6]))
    assert straight == pytest.approx(0.1)
    assert aslant == pytest.approx(0.1 * (np.sqrt(4 - 0.36) - 0.8))


def test_ways_round_casings_are_tangents_and_an_arc() -> None:
    far, half = np.full(3, 10.0), np.full(3, 0.5)
    longer, lost = round_casings(far, half, np.array([1e-6, 0.4, 0.8]))
    angle = np.pi - 2 * np.arccos(0.4 / 5)
    assert longer[1] == pytest.approx(2 * np.sqrt(25 - 0.16) + 0.4 * angle - 10)
    assert longer[0] == pytest.approx(0.0, abs=1e-6)
    assert (np.diff(lost) > 0).all()
    shed = 1.019 * np.cos(np.pi / 6) * (0.5 * 2 * np.pi / WAVE_M * 0.4) ** (1 / 3) * angle
    assert lost[1] == pytest.approx(8.686 * shed, rel=1e-3)


def test_waves_that_lie_are_returned_whole_if_grazing() -> None:
    made = lying_waves(np.array([1e-7, 1.0]), FLAGS)
    assert made[0] == pytest.approx(-1.0, abs=1e-3)
    root = np.sqrt(FLAGS)
    assert made[1] == pytest.approx((1 - root) / (1 + root))
    assert (np.diff(np.abs(lying_waves(np.linspace(0.0, 1.0, 99), FLAGS))) < 0).all()


def test_ways_by_floors_walls_and_shingles_are_as_long_as_images_are_far() -> None:
    grist = _grist()
    longer, share = off_the_floor(grist, 1.0)
    lower = np.minimum(grist.tag_m[:, 2], grist.hatch_m[:, 2])
    floor = np.array(STOREYS_M)[storey(lower)]
    floor[np.maximum(grist.tag_m[:, 0], grist.hatch_m[:, 0]) > WALL_M] = 0.0
    image = grist.tag_m.copy()
    image[:, 2] = 2 * floor - image[:, 2]
    assert np.allclose(longer + grist.far, np.linalg.norm(image - grist.hatch_m, axis=1))
    assert np.abs(share).max() <= 0.78 + 1e-9
    for number, (way, part) in enumerate(by_walls(grist)):
        image = grist.tag_m.copy()
        if number == 4:
            image[:, 2] = 2 * ROOM_M[2] - image[:, 2]
        else:
            y = image[:, 1]
            image[:, 1] = [-y, 2 * ROOM_M[1] - y, y + 2 * ROOM_M[1], y - 2 * ROOM_M[1]][number]
        assert np.allclose(way, np.linalg.norm(image - grist.hatch_m, axis=1))
        assert (way > grist.far).all()
        assert 0 < part.min() < part.max() < 1


def test_ways_by_shafts_are_the_shortest_by_any_point_of_one() -> None:
    grist = _grist()
    late = by_rods(grist)
    across = np.linspace(-40.0, 70.0, 11001)
    for row in range(0, grist.rows, 97):
        ways = []
        for rod in RODS_M:
            at = np.column_stack(
                [across, np.full(len(across), rod[0]), np.full_like(across, rod[1])]
            )
            both = sum(
                np.linalg.norm(at - end[row], axis=1) for end in (grist.tag_m, grist.hatch_m)
            )
            ways.append(np.min(both) - grist.far[row])
        nearest = np.sort(ways)[:3].clip(0.52, 5.5)
        assert np.abs(nearest - late[row]).min() < 1e-3


def test_what_ranges_have_of_two_pulses_is_what_hoppers_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0]).astype(np.complex128)
    late, high = told_of_both(np.full(4, 0.35), share)
    each_m, top = LIGHT_M_NS * SAMPLE_NS, np.full(4, 92.2)
    both = grains(top) + share[:, None] * grains(top + 0.35 / each_m)
    assert np.allclose(late, each_m * (weighed(both) - top + AHEAD), atol=0.012)
    assert late[0] > 0.02
    assert late[1] < -0.02
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)


def test_pulses_rise_sooner_than_they_fall() -> None:
    off = np.linspace(-9.0, 9.0, 3601)
    high = heaped(off)
    assert high.max() == pytest.approx(1.0)
    assert off[high.argmax()] == pytest.approx(0.0, abs=0.01)
    over = off[high >= 0.5]
    assert 2.3 < over[-1] - over[0] < 2.7  # of a DW1000 about 2.5
    slope = np.gradient(np.log(high), off)
    assert slope[20] == pytest.approx(1 / RISES, rel=1e-3)
    assert slope[-20] == pytest.approx(-1 / FALLS, rel=1e-3)
    assert RISES < FALLS


def test_noise_is_alike_as_measured_and_told_whatever_it_is() -> None:
    noise = 3.0 * trundling(np.random.default_rng(2), 3000)
    beside = [(noise[:, k:] * noise[:, : -k or None].conj()).real.mean() / 18 for k in range(5)]
    assert np.allclose(beside, [1.0, *BESIDE, 0.0], atol=0.01)
    assert np.abs(noise).std() == pytest.approx(3.0 * OF_SIZES, rel=0.01)
    assert np.median(hush(noise)) == pytest.approx(18.0, rel=0.07)
    noise[:, 10:13] *= 20.0
    assert np.median(hush(noise)) < 1.3 * 18.0


def test_pulses_that_come_later_are_as_they_were() -> None:
    wave = np.asarray(2.0j * grains(np.array([60.25])), np.complex128)
    twice = ground_later(ground_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * grains(np.full(1, 61.25))).max() < 0.05
    whole = ground_later(wave, np.full(1, 7.0))
    assert np.allclose(whole[:, 7:], wave[:, :-7], atol=1e-12)
    assert np.abs(whole[:, :7]).max() < 1e-12


def test_first_paths_are_read_however_high_and_never_sooner_if_blunt() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = grains(top).astype(np.complex128)
    at = weighed(one)
    assert np.allclose(top - at, AHEAD, atol=1e-3)
    assert np.allclose(weighed(30.0j * one), at, atol=1e-6)
    weak = 0.3 * one + grains(top + 11.2)
    keen, blunt = weighed(weak), weighed(weak, 1.0)
    assert np.allclose(keen, at, atol=0.02)
    assert np.allclose(blunt - keen, 11.2, atol=0.03)
    assert (weighed(0.5 * one + grains(top + 3.4), 2.0) >= at - 0.2).all()
    assert (np.abs(begun(weak, 0.0) - top) <= 1.0).all()


def test_what_follows_first_pulses_hardly_moves_these() -> None:
    top, turn = np.full(48, 90.3), np.exp(2j * np.pi * np.arange(48) / 48)
    for late, most in ((2.4, 0.07), (3.2, 0.03), (4.2, 0.01)):
        both = grains(top) + 0.5 * turn[:, None] * grains(top + late)
        assert np.abs(weighed(both) - top + AHEAD).max() < most


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (20.0, 80.0):
        off = weighed(high * grains(top) + trundling(np.random.default_rng(2), 1000)) - top + AHEAD
        assert abs(np.median(off)) < 0.01
        assert (np.abs(off) > 0.5).mean() < 0.003
        assert off[np.abs(off) < 0.5].std() < 2.4 / high


def test_levels_are_those_of_pulses() -> None:
    top, still = 90 + np.linspace(0, 1, 65), np.full(65, 1e-4)
    wave = (2.0 * grains(top) + 1.0 * grains(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, still)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.35)  # of three samples, as chips have it
    assert first.mean() == pytest.approx(20 * np.log10(2.0), abs=0.03)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.03)
    noisy = 9.0 * grains(np.full(4000, 90.4)) + trundling(np.random.default_rng(8), 4000)
    alone = heights(grains(np.full(1, 90.4)).astype(np.complex128), np.full(1, 90.4 - AHEAD),
                    np.full(1, 1e-6))  # fmt: skip
    high = heights(noisy, np.full(4000, 90.4 - AHEAD), np.ones(4000))
    assert (high**2).mean() == pytest.approx(81.0 * alone[0] ** 2, rel=0.01)


def _waves() -> Any:
    top = 60 + np.random.default_rng(3).random(40)
    wave = 4000.0 * grains(top) + 60.0 * trundling(np.random.default_rng(4), 40)
    rows = _known().head(40).assign(
        range_m=10.0, error_m=0.0, rx_power_dbm=-80.0, first_path_power_dbm=-82.0,
        noise_std=60.0 * OF_SIZES, preamble_count=300.0, first_path_index=top - AHEAD,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip
    return rows.assign(true_range_m=10.0)


def _hopper(period_ns: float = SAMPLE_NS) -> Hopper:
    return Hopper(_waves().assign(sample_period_ns=period_ns), 0, np.random.default_rng(0))


@pytest.mark.parametrize("period_ns", [SAMPLE_NS, 1.0016])
def test_samples_are_as_long_as_tables_say(period_ns: float) -> None:
    hopper = _hopper(period_ns)
    hopper.wave = ground_later(hopper.wave, np.full(hopper.rows, 2.0))
    late = np.median(hopper.told()["range_m"] - hopper.table["range_m"])
    assert late == pytest.approx(2 * LIGHT_M_NS * period_ns, abs=2e-3)


def test_echoes_come_by_weibulls_gaps() -> None:
    table: Any = SimpleNamespace(rows=4000, rng=np.random.default_rng(2))
    table.each = lambda draws: draws(4000)
    made = arrivals(table)
    assert made.shape == (PATHS, 4000)
    gaps = np.diff(made, axis=0, prepend=SOONEST)
    assert gaps.min() >= 0.0
    assert (gaps > GAP).mean() == pytest.approx(np.exp(-1.0), abs=0.01)
    assert (gaps > 3 * GAP).mean() == pytest.approx(np.exp(-(3.0**SHAPE)), abs=0.01)


def test_fades_have_power_one_and_bend_from_knot_to_knot() -> None:
    made = shimmer(np.random.default_rng(2), 3000)
    assert made.shape == (3000, WIDE_SAMPLES)
    assert (made**2).mean() == pytest.approx(1.0, abs=1e-9)
    assert np.corrcoef(made[:, 50], made[:, 51])[0, 1] > 0.7
    assert abs(np.corrcoef(made[:, 50], made[:, 90])[0, 1]) < 0.1


def test_tails_die_by_a_power_cracks_swell_and_joints_return_less_each_time() -> None:
    made = lingering(np.array([-3.0, 1e-9, LINGERS, 9 * LINGERS]))
    assert np.allclose(made, [0.0, 1.0, 2.0**-STEEP, 10.0**-STEEP])
    assert BEGINS > 0
    swells = swelling(np.linspace(0.0, 12.0, 400))
    assert 0.02 < swells.argmax() / 400 < 0.2
    assert swells.max() == pytest.approx(1.0, abs=0.35)
    assert swells[-1] < 0.05
    rung = jointed(grains(np.full(1, 60.0)).astype(np.complex128))[0]
    power = (np.abs(rung) ** 2).sum() / (grains(np.full(1, 60.0)) ** 2).sum()
    assert 0.5 < power < 3.0
    assert abs(rung[60]) < 0.12
    assert np.abs(rung[100:]).max() < 0.01
    assert max(map(abs, BACK)) < 1 < min(JOINTS)


def test_tones_sweep_evenly_and_have_power_one() -> None:
    tone = sweeping(np.random.default_rng(3), 400)
    assert np.allclose(np.abs(tone), 1.0)
    pitch = np.angle(tone[:, 1:] * tone[:, :-1].conj())
    assert np.abs(np.angle(np.exp(1j * np.diff(pitch, n=2, axis=1)))).max() < 1e-6
    assert np.abs(np.angle(np.exp(1j * np.diff(pitch, axis=1)))).max() < 0.0121


def test_noise_is_said_by_sixes_and_steps_have_no_nought() -> None:
    assert of_noise(3 * SOME) == pytest.approx(3 * of_noise(SOME))
    assert 0.85 * OF_SIZES < of_noise(SOME) < 1.05 * OF_SIZES
    made = stepped(SOME, 0.4)
    assert np.allclose(made.real / 0.4 - 0.5, np.rint(made.real / 0.4 - 0.5))
    assert np.abs((made - SOME).real).max() <= 0.2 + 1e-9
    assert np.abs(made.imag).min() >= 0.2 - 1e-9
