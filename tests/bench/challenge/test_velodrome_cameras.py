"""The forms that the velodrome's effects have, and its cameras: against laws that are known."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pytest
from scipy.special import fresnel, wrightomega

from bench.challenge.families.velodrome_camera import (
    AHEAD,
    HALF,
    bulges,
    dropped_back,
    first_paths,
    humming,
    seen,
)
from bench.challenge.families.velodrome_effects import (
    EGG,
    FLOOR,
    along_grain,
    beyond,
    divided,
    eased,
    fejer,
    lambert,
    off_the_floor,
    oval,
    through_slit,
)
from bench.challenge.families.velodrome_track import Race
from bench.challenge.families.velodrome_wave_effects import (
    BIT,
    SHEETS,
    STRING,
    bent,
    by_sheet,
    fisk,
    frames_before,
    interlaced,
    plucked,
    shaved,
    split_bits,
    with_play,
)
from tests.bench.challenge import shown

_known = partial(shown.known_of, "velodrome")


def _race() -> Race:
    return Race(_known(), 0, np.random.default_rng(0))


def test_fejers_rule_of_five_is_right_for_fourth_powers() -> None:
    at, by = fejer(5)
    assert ((at > 0) & (at < 1)).all()
    assert np.allclose([(by * at**k).sum() for k in range(5)], 1 / np.arange(1, 6))


def test_lamberts_function_solves_what_it_should() -> None:
    of = np.linspace(-8.0, 9.0, 200)
    assert np.allclose(lambert(of), wrightomega(of))


def test_ovals_are_longest_along_and_have_no_mean_and_dividers_are_level_amid() -> None:
    round_ = np.linspace(0, 2 * np.pi, 361)[:-1]
    assert oval(round_).mean() == pytest.approx(0.0, abs=1e-12)
    far = oval(round_) - oval(np.zeros(1)) + np.sqrt(1 + EGG**2)
    ends = [np.abs(far * np.exp(1j * round_) - end) for end in (1, -1)]
    assert np.allclose(ends[0] * ends[1], EGG**2)  # that makes it Cassini's
    assert divided(np.array([21.0]))[0] == pytest.approx(0.0, abs=1e-9)
    assert (np.diff(divided(np.linspace(5.0, 40.0, 30))) > 0).all()


def test_waves_by_edges_are_fresnels() -> None:
    v = np.linspace(-5.0, 5.0, 201)
    s, c = fresnel(v)
    exact = (0.5 - c + 1j * (0.5 - s)) * (1 - 1j) / 2
    assert np.abs(beyond(v) - exact).max() < 0.003
    assert abs(beyond(np.zeros(1))[0]) == pytest.approx(0.5)


def test_wood_is_between_what_it_is_along_and_across_grain() -> None:
    turned = np.linspace(0.0, np.pi / 2, 20)
    index = along_grain(2.4, 1.8, turned)
    assert index[0] == pytest.approx(np.sqrt(1.8))
    assert index[-1] == pytest.approx(np.sqrt(2.4))
    assert (np.diff(index) > 0).all()
    assert np.allclose(eased(np.array([-1.0, 0.0, 0.5, 1.0, 3.0])), [0, 0, 0.5, 1, 1])


def test_the_way_by_the_floor_is_an_images_and_upright_waves_have_brewsters_angle() -> None:
    longer, share = off_the_floor(_race(), 1.0)
    up = _known()["rx_z_m"] + _known()["tx_z_m"]
    flat = _known()["true_range_m"] ** 2 - (_known()["rx_z_m"] - _known()["tx_z_m"]) ** 2
    assert np.allclose(longer + _known()["true_range_m"], np.sqrt(flat + up**2))
    assert np.abs(share).max() <= 0.78 + 1e-9
    sines = np.linspace(1e-6, 1.0, 400)
    root = np.sqrt(FLOOR - 1 + sines**2)
    back = np.abs((FLOOR * sines - root) / (FLOOR * sines + root))
    tangent = np.sqrt(1 / np.real(FLOOR))
    assert sines[back.argmin()] == pytest.approx(tangent / np.hypot(1, tangent), abs=0.03)


def test_slits_let_less_through_the_later_it_is() -> None:
    part = through_slit(np.linspace(0.0, 8.0, 30))
    assert part[0] == pytest.approx(1.0)
    assert (np.diff(part) <= 1e-9).all()
    assert part[-1] == 0.0


def test_group_delays_of_two_pulses_are_what_is_taken_of_them_in_ranges() -> None:
    for share in (0.3, -0.3, 0.4j):
        late = np.full(1, 0.35)
        one = bulges(np.full(1, 80.2)).astype(np.complex128)
        both = one + share * bulges(80.2 + late)
        moved = first_paths(both, np.full(1, 1e-5)) - first_paths(one, np.full(1, 1e-5))
        part = share * through_slit(late)
        assert moved[0] == pytest.approx(float((late * np.real(part / (1 + part)))[0]), abs=0.03)


def test_sheets_are_heard_by_images_and_none_returns_more_than_it_can() -> None:
    for sheet in SHEETS:
        way, left = by_sheet(_race(), sheet)
        assert (way > _race().far).all()
        assert 0.0 < left.min() <= left.max() <= sheet[2]


def test_pulses_are_as_long_as_measured() -> None:
    at = np.linspace(0.0, 1.0, 4001)
    half = HALF * np.interp(-0.5, -((1 - at**2) ** 5), at)
    assert 2.1 < 2 * half < 2.7
    assert bulges(np.full(1, 70.0)).max() == 1.0


def test_first_pulses_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    top, quiet = 70 + np.linspace(0, 1, 33), np.full(33, 0.003)
    one = bulges(top).astype(np.complex128)
    at = first_paths(one, quiet)
    assert np.allclose(top - at, AHEAD, atol=0.02)
    assert np.allclose(first_paths(30.0j * one, quiet), at, atol=1e-9)
    weak = 0.3 * one + bulges(top + 11.2)
    sharp, deaf = (first_paths(weak, quiet, by) for by in (0.0, 2.0))
    assert np.allclose(sharp, at, atol=0.02)
    assert np.allclose(deaf - sharp, 11.2, atol=0.06)
    soon, late = (first_paths(0.5 * one + bulges(top + 3.4), 8 * quiet, by) for by in (0.0, 2.0))
    assert (late >= soon).all()


def test_pulses_come_later_between_samples_too() -> None:
    top = np.full(21, 60.0)
    late = np.linspace(2.0, 3.0, 21)
    moved = dropped_back(bulges(top).astype(np.complex128), late)
    assert np.allclose(moved, bulges(top + late), atol=0.012)


def test_noise_alone_lets_as_much_through_slits_as_is_taken_off() -> None:
    through = seen(humming(np.random.default_rng(4), 3000), np.full(3000, 100.4), 0.0)
    assert (np.abs(through) ** 2).mean() == pytest.approx(6.7, rel=0.08)


def test_fades_are_of_fisks_law_at_knots_and_of_power_one() -> None:
    sizes = fisk(np.random.default_rng(2), 500)
    assert np.mean(sizes**2) == pytest.approx(1.0)
    knots = np.log(sizes[:, ::5] / np.median(sizes[:, ::5]))
    even = 1 / (1 + np.exp(-3.4 * knots))
    assert np.allclose(np.quantile(even, [0.25, 0.5, 0.75]), [0.25, 0.5, 0.75], atol=0.02)


def test_strings_hand_on_what_they_have_had_and_die_away() -> None:
    blow = np.zeros((1, 90), np.complex128)
    blow[0, 10] = 1.0
    made = plucked(blow, 1.0)[0].real
    assert not made[: 10 + STRING].any()
    assert made[10 + STRING] == made[11 + STRING] > 0.2
    second = made[10 + 2 * STRING : 13 + 2 * STRING]
    assert np.allclose(second / second[0], [1, 2, 1])
    assert np.abs(made[-12:]).max() < 0.01


def test_chips_send_in_one_half_of_each_bit() -> None:
    tone = np.abs(split_bits(np.random.default_rng(3), 40)) ** 2
    assert np.isclose(tone, 2.0).mean() == pytest.approx(0.5, abs=0.03)
    for row in tone:
        runs = np.diff(np.flatnonzero(np.diff(row > 1.0)))
        assert {*runs} <= {BIT, 2 * BIT}


def test_codes_go_up_and_get_wider_off_nought() -> None:
    at = np.linspace(-30.0, 30.0, 6001)
    codes = bent(at, 1.0, 0.09)
    assert (np.diff(codes) >= 0).all()
    assert np.allclose(codes, -codes[::-1])
    assert {*np.round(bent(codes, 1.0, 0.09) - codes, 9)} == {0.0}
    steps = np.diff(np.unique(codes.round(9)))
    assert (np.diff(steps[len(steps) // 2 :]) > 0).all()


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes = np.stack([np.arange(60.0), 100 + np.arange(60.0)])
    begin = np.array([[10], [12]])
    mixed = interlaced(sizes, begin, np.array([0, 0]))
    assert np.array_equal(mixed[0], sizes[0])
    assert mixed[1, 11:17].tolist() == [111, 112, 11, 114, 13, 116]
    peaks = np.ones((1, 40))
    peaks[0, [5, 20, 30, 31, 32]] = 9.0
    flat = shaved(peaks, np.array([[12]]))[0]
    assert np.flatnonzero(flat > 1).tolist() == [5, 30, 31, 32]
    wave = np.abs(10 + 5 * np.sin(np.arange(60.0) / 4))[None]
    drawn = with_play(wave, np.array([[15]]), np.array([2.0]))[0]
    assert np.array_equal(drawn[:15], wave[0, :15])
    assert np.abs(drawn - wave[0]).max() <= 2.0 + 1e-12
    moved = np.diff(drawn)[15:] != 0
    assert 0.3 < moved.mean() < 0.95  # it rests where the way turns


def test_frames_before_are_of_the_same_link() -> None:
    table = pd.DataFrame({"link": ["a", "b", "a", "a", "b"]})
    assert frames_before(table).tolist() == [0, 1, 0, 2, 1]
