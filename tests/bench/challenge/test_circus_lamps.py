"""The forms that the circus' effects have, and its lamps: against laws that are known."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest
from scipy.special import jv

from bench.challenge.families.circus_effects import (
    EIGHTHS,
    SAND,
    crank,
    hastens,
    off_the_sand,
    poisson,
    pressed,
    rounded_db,
)
from bench.challenge.families.circus_lamp import (
    AHEAD,
    ITSELF,
    REACH,
    crest,
    first_paths,
    flashes,
    window,
)
from bench.challenge.families.circus_tent import Act
from bench.challenge.families.circus_wave_effects import (
    DWELL,
    HOPS,
    OPENS,
    SHUT,
    SHUTS,
    bessel,
    by_columns,
    by_sides,
    gapped,
    hopped,
    ladder,
    not_foretold,
    spangled,
    wowed,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "circus")


def _act() -> Act:
    return Act(_known(), 0, np.random.default_rng(0))


def test_three_eighths_are_right_for_cubes_and_sound_hastens_as_it_is_known_to() -> None:
    at, by = np.arange(4) / 3, np.array(EIGHTHS) / 8
    assert np.allclose([(by * at**k).sum() for k in range(4)], [1, 1 / 2, 1 / 3, 1 / 4])
    assert 343.2 * (1 + hastens(0.0)) == pytest.approx(331.3, abs=0.1)  # m/s


def test_kernels_have_a_mean_of_one_and_cranks_come_to_rest() -> None:
    turn = np.linspace(0, 2 * np.pi, 720, endpoint=False)
    assert poisson(turn, 0.52).mean() == pytest.approx(1.0)
    assert poisson(turn, 0.52).max() == pytest.approx(1.52 / 0.48)
    assert np.allclose(crank(np.array([-3.0, -1.0, 0.0, 1.0, 9.0])), [-1, -1, 0, 1, 1])


def test_what_is_pressed_is_denser_and_nothing_is_as_air_is() -> None:
    assert np.allclose(pressed(np.zeros(1), 0.5), 1.0)
    wood = pressed(np.array([0.5, 0.7]), 0.53)
    assert 1.8 < wood[0] < wood[1] < 3.2


def test_round_tops_take_more_than_edges_and_edges_six_db_where_they_touch() -> None:
    legs, none = (np.full(1, 7.0), np.full(1, 9.0)), np.zeros(1)
    sharp = rounded_db(none, np.full(1, 1e-6), legs)[0]
    assert sharp == pytest.approx(6.0, abs=0.15)
    assert sharp < rounded_db(none, np.full(1, 0.5), legs)[0] < sharp + 8.0


def test_sand_returns_all_that_grazes_it_and_the_way_by_it_is_an_images() -> None:
    longer, share = off_the_sand(_act(), 1.0)
    up = _known()["rx_z_m"] + _known()["tx_z_m"]
    flat = _known()["true_range_m"] ** 2 - (_known()["rx_z_m"] - _known()["tx_z_m"]) ** 2
    assert np.allclose(longer + _known()["true_range_m"], np.sqrt(flat + up**2))
    assert np.abs(share).max() <= 0.82 + 1e-9
    sines = np.linspace(1e-6, 1.0, 50)
    root = np.sqrt(SAND - 1 + sines**2)
    back = np.abs((sines - root) / (sines + root))
    assert back[0] == pytest.approx(1.0, abs=1e-4)
    assert (np.diff(back) < 0).all()  # flat waves have no angle of Brewster


def test_sides_are_heard_by_images_and_none_returns_more_than_it_does_head_on() -> None:
    for sides in ((0,), (4,), (2, 3)):
        way, left = by_sides(_act(), sides)
        assert (way > _act().far).all()
        assert 0.0 <= left.min() < left.max() <= 0.56


def test_pulses_are_as_long_as_measured_and_fit_themselves() -> None:
    at = np.linspace(0.0, 1.0, 4001)
    half = 3.6 * np.interp(-0.5, -window(at), at)
    assert 2.1 < 2 * half < 2.7
    assert window(np.zeros(1))[0] == pytest.approx(1.0)
    assert ITSELF.argmax() == REACH
    assert ITSELF[REACH] == pytest.approx(1.0, abs=1e-6)


def test_first_pulses_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = flashes(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.02)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + flashes(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(deaf - sharp, 11.2, atol=0.06)
    soon, late = (first_paths(0.5 * one + flashes(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_skirts_of_a_strong_pulse_are_no_first_path() -> None:
    rng = np.random.default_rng(5)
    strong = flashes(np.full(40, 90.3)).astype(np.complex128)
    for late in (1.1, 1.9, 2.8):
        beside = (
            0.6 * np.exp(2j * np.pi * rng.random(40))[:, None] * flashes(np.full(40, 90 + late))
        )
        at = first_paths(strong + beside, np.full(40, 1e-4)) + AHEAD
        assert (np.abs(at - 90.3) < 2.5).all()


def test_crests_of_parabolas_are_where_they_are() -> None:
    place = np.arange(30.0)
    sizes = np.sqrt((100 - (place - 14.3) ** 2).clip(0))[None]
    assert crest(sizes, np.array([14]))[0] == pytest.approx(14.3)


def test_spangles_are_open_as_often_as_their_odds_have_it() -> None:
    sizes = spangled(np.random.default_rng(2), 400)
    assert {SHUT, 1.0} <= {*np.round(np.unique(sizes), 9)}
    opened = (sizes.mean() - SHUT) / (1 - SHUT)
    assert opened == pytest.approx(OPENS / (OPENS + SHUTS), abs=0.02)


def test_ladders_ring_by_bessels_second_order_and_pay_out() -> None:
    at = np.linspace(0.0, 38.0, 60)
    assert np.allclose(bessel(2, at), jv(2, at), atol=1e-6)
    taps = ladder()
    assert np.abs(taps[:2]).max() < 1e-12
    assert 0.2 < np.abs(taps).max() < 0.6
    assert np.abs(taps[-8:]).max() < 0.03


def test_microphones_keep_a_size_and_hop_between_pitches() -> None:
    tone = hopped(np.random.default_rng(2), 60)
    assert np.allclose(np.abs(tone), 1.0)
    steps = np.angle(tone[:, 1:] / tone[:, :-1])
    assert np.isclose(steps[..., None], HOPS).any(axis=2).all()
    hops = (np.abs(np.diff(steps, axis=1)) > 1e-6).mean()
    assert hops == pytest.approx(2 / 3 / DWELL, rel=0.2)


def test_codes_go_up_and_some_never_come() -> None:
    codes = gapped(np.linspace(-9.0, 9.0, 3001), 1.0)
    assert (np.diff(codes) >= 0).all()
    assert not (np.mod(codes, 3) == 2).any()
    assert (codes - np.linspace(-9.0, 9.0, 3001)).mean() == pytest.approx(1 / 3, abs=0.03)


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes, begin = np.arange(60.0)[None] + 1.0, np.array([[10]])
    read = by_columns(sizes, begin)[0]
    assert np.array_equal(read[:10], sizes[0, :10])
    assert read[10:16].tolist() == [11, 15, 19, 12, 16, 20]
    assert sorted(read[10:58]) == sizes[0, 10:58].tolist()
    lifted = not_foretold(sizes, begin)[0]
    assert np.array_equal(lifted[:11], sizes[0, :11])
    assert not lifted[11:59:2].any()  # a straight line foretells itself
    assert np.array_equal(lifted[12:58:2], sizes[0, 12:58:2])
    tape = wowed(sizes, begin)[0]
    assert np.array_equal(tape[:11], sizes[0, :11])
    assert 2.5 < np.abs(tape - sizes[0])[10:50].max() <= 3.41
