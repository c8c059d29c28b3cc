"""The forms that the mint's effects have, and its assays: against laws that are known."""

from __future__ import annotations

from functools import partial
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.challenge.families.mint_assay import (
    AHEAD,
    ALIKE,
    LIGHT_M_NS,
    OF_SIZES,
    REACH,
    SAMPLE_NS,
    SLOPES,
    Assay,
    assayed,
    coins,
    first_tops,
    heights,
    jingling,
    levels_db,
    planed,
    quiet,
    rolled_later,
    sloped,
)
from bench.challenge.families.mint_court import ROOM_M, Tally
from bench.challenge.families.mint_effects import (
    FLOOR,
    by_walls,
    of_warmth,
    off_marble,
    over_edges,
    slab,
    told_of_two,
    upright_waves,
)
from bench.challenge.families.mint_wave_effects import (
    DEAD,
    LONG,
    RING_AT,
    RING_EACH,
    RING_KEEPS,
    SOME,
    beating,
    by_faces,
    by_fives,
    by_size,
    clipped_off,
    dead,
    dispersed,
    evened,
    ninths_out,
    reversed_bits,
    ringing,
    slower,
    two_slopes,
    wavering,
)
from bench.challenge.families.mint_waves import BINS, THICK, thronged
from tests.bench.challenge import shown

Complexes = NDArray[np.complex128]
_known = partial(shown.known_of, "mint")


def _tally() -> Tally:
    return Tally(_known(), 0, np.random.default_rng(0))


def test_ovens_drift_ever_less() -> None:
    assert np.allclose(of_warmth(np.array([19.0, 27.0, 11.0])), [0.0, 1.0, -1.0])
    assert of_warmth(np.array([1e6]))[0] == pytest.approx(2.0, abs=1e-3)


def test_slabs_delay_by_their_root_and_more_if_aslant() -> None:
    straight, aslant = slab(4.0, np.full(2, 0.1), np.array([0.0, 0.8]))
    assert straight == pytest.approx(0.1)
    assert aslant == pytest.approx(0.1 * (np.sqrt(4 - 0.64) - 0.6))


def test_edges_take_6_db_if_grazed_and_as_lee_has_it_beyond() -> None:
    far, half = np.full(3, 10.0), np.full(3, 0.5)
    longer, lost = over_edges(far, half, np.array([1e-9, 0.4, 1.2]))
    assert np.allclose(longer, 2 * np.hypot(5.0, [0.0, 0.4, 1.2]) - 10.0)
    assert lost[0] == pytest.approx(6.0, abs=1e-3)
    assert lost[2] - lost[1] == pytest.approx(20 * np.log10(3.0), abs=1e-6)
    near = over_edges(np.full(400, 10.0), np.full(400, 0.5), np.linspace(0.0, 1.0, 400))[1]
    assert 0.0 <= np.diff(near).min() <= np.diff(near).max() < 0.4


def test_upright_waves_are_not_returned_at_brewsters_angle() -> None:
    steep = np.sin(np.arctan(1 / np.sqrt(FLOOR)))
    made = upright_waves(np.array([1e-7, steep, 1.0]), FLOOR)
    assert made[0] == pytest.approx(-1.0, abs=1e-3)
    assert abs(made[1]) < 1e-9
    root = np.sqrt(FLOOR)
    assert made[2] == pytest.approx((root - 1) / (root + 1))


def test_ways_by_floor_walls_and_vaults_are_as_long_as_images_are_far() -> None:
    tally = _tally()
    longer, share = off_marble(tally, 1.0)
    image = tally.tag_m * np.array([1.0, 1.0, -1.0])
    assert np.allclose(longer + tally.far, np.linalg.norm(image - tally.quoin_m, axis=1))
    assert np.abs(share).max() <= 0.76 + 1e-9
    every = np.stack([way for way, _ in by_faces(tally)]) - tally.far
    late = by_walls(tally)
    assert np.abs(every[:4].clip(0.6, 3.8) - late).min(axis=0).max() < 1e-9
    up = tally.tag_m * [1, 1, -1] + [0, 0, 2 * ROOM_M[2]]
    assert np.allclose(every[4] + tally.far, np.linalg.norm(up - tally.quoin_m, axis=1))


def test_what_ranges_have_of_two_pulses_is_what_assays_make_of_these() -> None:
    share = np.array([0.3, -0.3, 0.4j, 0.0]).astype(np.complex128)
    late, high = told_of_two(np.full(4, 0.35), share)
    each_m, top = LIGHT_M_NS * SAMPLE_NS, np.full(4, 92.2)
    both = coins(top) + share[:, None] * coins(top + 0.35 / each_m)
    assert np.allclose(late, each_m * (assayed(both) - top + AHEAD), atol=6e-3)
    assert late[0] > 0.02
    assert late[1] < -0.02
    assert late[3] == pytest.approx(0.0, abs=3e-3)
    assert high[3] == pytest.approx(1.0, abs=0.01)


def test_pulses_are_even_and_none_where_they_end_and_slopes_are_theirs() -> None:
    off = np.linspace(-6.0, 6.0, 2401)
    high = planed(off)
    assert np.allclose(high, high[::-1])
    assert high.min() == 0.0
    assert not high[np.abs(off) >= REACH].any()
    over = off[high >= 0.5]
    assert 2.3 < over[-1] - over[0] < 2.7  # of a DW1000 about 2.5
    rises = np.gradient(planed(off, SLOPES), off)
    assert np.allclose(sloped(off)[1:-1], rises[1:-1], atol=1e-4)


def test_noise_is_alike_as_measured_and_told_whatever_it_is() -> None:
    noise = 3.0 * jingling(np.random.default_rng(2), 3000)
    beside = [(noise[:, k:] * noise[:, : -k or None].conj()).real.mean() / 18 for k in range(5)]
    assert np.allclose(beside, [*ALIKE, 0.0], atol=0.01)
    assert np.abs(noise).std() == pytest.approx(3.0 * OF_SIZES, rel=0.01)
    assert np.median(quiet(noise)) == pytest.approx(18.0, rel=0.05)
    noise[:, 10:13] *= 20.0
    assert np.median(quiet(noise)) < 3.5 * 18.0 < (np.abs(noise[:, 2:36]) ** 2).mean()


def test_pulses_that_come_later_are_as_they_were() -> None:
    wave = np.asarray(2.0j * coins(np.array([60.25])), np.complex128)
    twice = rolled_later(rolled_later(wave, np.full(1, 0.5)), np.full(1, 0.5))
    assert np.abs(twice - 2.0j * coins(np.full(1, 61.25))).max() < 0.05
    whole = rolled_later(wave, np.full(1, 7.0))
    assert np.allclose(whole[:, 7:], wave[:, :-7])
    assert not whole[:, :7].any()


def test_first_paths_are_read_however_high_and_never_sooner_if_dull() -> None:
    top = 80 + np.linspace(0, 1, 33)
    one = coins(top).astype(np.complex128)
    at = assayed(one)
    assert np.allclose(top - at, AHEAD, atol=0.01)
    assert np.allclose(assayed(30.0j * one), at, atol=1e-6)
    weak = 0.25 * one + coins(top + 11.2)
    sharp, dull = assayed(weak), assayed(weak, 1.0)
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(dull - sharp, 11.2, atol=0.03)
    assert (assayed(0.5 * one + coins(top + 3.4), 2.0) >= at - 0.2).all()
    assert (np.abs(first_tops(weak, 0.0) - top) <= 1.0).all()


def test_what_follows_first_pulses_hardly_moves_these() -> None:
    top, turn = np.full(48, 90.3), np.exp(2j * np.pi * np.arange(48) / 48)
    for late, most in ((3.2, 0.06), (4.2, 0.01)):
        both = coins(top) + 0.5 * turn[:, None] * coins(top + late)
        assert np.abs(assayed(both) - top + AHEAD).max() < most


def test_noise_moves_first_paths_to_neither_side_and_hardly_more_than_it_must() -> None:
    top = 90 + np.random.default_rng(1).random(1000)
    for high in (20.0, 80.0):
        off = assayed(high * coins(top) + jingling(np.random.default_rng(2), 1000)) - top + AHEAD
        assert abs(np.median(off)) < 0.01
        assert (np.abs(off) > 0.5).mean() < 0.003
        assert off[np.abs(off) < 0.5].std() < 2.1 / high


def test_levels_are_those_of_pulses() -> None:
    top, still = 90 + np.linspace(0, 1, 9), np.full(9, 1e-4)
    wave = (2.0 * coins(top) + 1.0 * coins(top + 20.0)).astype(np.complex128)
    every, first = levels_db(wave, top - AHEAD, still)
    assert np.allclose(first, 20 * np.log10(2.0), atol=0.03)
    assert np.allclose(every, 10 * np.log10(5.0), atol=0.03)
    noisy = 9.0 * coins(np.full(4000, 90.4)) + jingling(np.random.default_rng(8), 4000)
    high = heights(noisy, np.full(4000, 90.4 - AHEAD), np.ones(4000))
    assert (high**2).mean() == pytest.approx(81.0, rel=0.01)


def test_samples_are_as_long_as_tables_say() -> None:
    def told(period_ns: float) -> float:
        made: Any = Assay.__new__(Assay)
        table = _waves().assign(sample_period_ns=period_ns)
        made.__init__(table, 0, np.random.default_rng(0))
        made.wave = rolled_later(made.wave, np.full(made.rows, 2.0))
        return float(np.median(made.told()["range_m"] - table["range_m"]))

    assert told(SAMPLE_NS) == pytest.approx(2 * LIGHT_M_NS * SAMPLE_NS, abs=2e-3)
    assert told(1.0016) == pytest.approx(2 * LIGHT_M_NS * 1.0016, abs=2e-3)


def _waves() -> Any:
    top = 60 + np.random.default_rng(3).random(40)
    wave = 4000.0 * coins(top) + 60.0 * jingling(np.random.default_rng(4), 40)
    rows = _known().head(40).assign(
        range_m=10.0, error_m=0.0, rx_power_dbm=-80.0, first_path_power_dbm=-82.0,
        noise_std=60.0 * OF_SIZES, preamble_count=500.0, first_path_index=top - AHEAD,
        cir_i=[*wave.real], cir_q=[*wave.imag],
    )  # fmt: skip
    return rows.assign(true_range_m=10.0)


def test_echoes_come_in_throngs() -> None:
    table: Any = SimpleNamespace(rows=3000, rng=np.random.default_rng(2))
    table.links = lambda draws: draws(3000)
    made = thronged(table)
    assert made.shape == (BINS, 3000)
    after = made[1:6][made[:5] > 0].mean()
    alone = made[1:6][made[:5] == 0].mean()
    assert alone == pytest.approx(THICK, abs=0.03)
    assert after > 1.9 * alone
    assert made[-10:].mean() < made[5:15].mean()


def test_fades_have_power_one_and_forget() -> None:
    made = wavering(np.random.default_rng(2), 3000)
    assert (made**2).mean() == pytest.approx(1.0, abs=0.02)
    assert np.corrcoef(made[:, 50], made[:, 51])[0, 1] > 0.6
    assert abs(np.corrcoef(made[:, 50], made[:, 90])[0, 1]) < 0.1


def test_tails_have_two_slopes_and_holders_ring_less_each_time() -> None:
    made = two_slopes(np.array([-3.0, 0.1, 100.0, 100.0 + LONG]))
    assert made[0] == 0.0
    assert made[1] == pytest.approx(1.0, abs=0.02)
    assert made[3] / made[2] == pytest.approx(np.exp(-1.0), rel=1e-3)
    rung = ringing(coins(np.full(1, 60.0)).astype(np.complex128))[0]
    power = (np.abs(rung) ** 2).sum() / (coins(np.full(1, 60.0)) ** 2).sum()
    assert 0.3 < power < 3.0
    assert np.abs(rung[: 60 + int(RING_AT - REACH)]).max() < 0.02
    last = 60 + RING_AT + 6 * RING_EACH
    assert np.abs(rung[int(last + REACH + 4) :]).max() < 0.02
    assert RING_KEEPS < 1


def test_tones_beat_and_have_power_one() -> None:
    tone = beating(np.random.default_rng(3), 400)
    assert (np.abs(tone) ** 2).mean() == pytest.approx(1.0, abs=0.02)
    assert np.abs(tone).max() == pytest.approx(1.6 / np.sqrt(1.36), rel=1e-3)
    assert np.abs(tone).min() == pytest.approx(0.4 / np.sqrt(1.36), rel=0.02)


def test_noise_is_said_by_fives_and_steps_are_clipped_towards_nought() -> None:
    assert by_fives(3 * SOME) == pytest.approx(3 * by_fives(SOME))
    assert 0.85 * OF_SIZES < by_fives(SOME) < 1.05 * OF_SIZES
    made = clipped_off(SOME, 0.4)
    assert np.allclose(made.real / 0.4, np.rint(made.real / 0.4))
    assert (np.abs(made.real) <= np.abs(SOME.real)).all()
    assert np.abs((made - SOME).imag).max() < 0.4


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    tens = np.arange(20.0)
    assert reversed_bits(tens)[:9].tolist() == [0, 4, 2, 6, 1, 5, 3, 7, 8]
    assert reversed_bits(tens)[16:].tolist() == [16, 17, 18, 19]
    assert by_size(tens[::-1])[:7].tolist() == [14, 15, 16, 17, 18, 19, 8]
    assert ninths_out(tens).tolist() == [*range(8), *range(9, 17), 18, 19, 18, 19]
    assert np.allclose(slower(tens), 0.9 * tens)
    crests = np.array([1.0, 5.0, 2.0, 1.0, 1.0, 1.0])
    assert dead(crests).tolist() == [1.0, 5.0, 2 * DEAD, DEAD, 1.0, 1.0]
    falling = np.exp(-np.arange(100.0) / 20)
    flat = evened(falling)
    assert flat.mean() == pytest.approx(falling.mean())
    assert flat[80] / flat[20] == pytest.approx((falling[80] / falling[20]) ** 0.3, rel=0.05)


def test_grilles_put_off_pitches_by_how_far_off_these_are() -> None:
    place = np.arange(244.0)
    bell = np.exp(-0.5 * ((place - 120) / 12) ** 2)
    for pitch in (0.0, 0.6, -1.2):
        wave = (bell * np.exp(1j * pitch * place))[None]
        made = np.abs(dispersed(wave, 20.0)[0]) ** 2
        late = (place * made).sum() / made.sum() - 120
        wanted = 20.0 * abs(pitch) if pitch else 20.0 * 0.047
        assert late == pytest.approx(wanted, abs=0.6)
        assert made.sum() == pytest.approx((np.abs(wave) ** 2).sum(), rel=1e-3)
