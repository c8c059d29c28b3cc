"""The roundhouse: what is particular to it, and what its recorders leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.roundhouse_effects import roofs_db
from bench.challenge.families.roundhouse_recorder import RISE, edges, pulses
from bench.challenge.families.roundhouse_wave_effects import hexagons
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "roundhouse"), partial(shift_of, "roundhouse")


def _rides(kind: str) -> np.ndarray:
    return np.asarray(_tables("").recorded["tx"].str.startswith(kind), bool)


def _toward() -> np.ndarray:
    """Return which way it is from readers to tags, of length 1 [n, 3]."""
    rows = _tables("").recorded
    ends = [rows[[f"{end}_{axis}_m" for axis in "xyz"]].to_numpy() for end in ("tx", "rx")]
    return np.asarray((ends[0] - ends[1]) / rows["true_range_m"].to_numpy()[:, None])


def _polar() -> tuple[np.ndarray, np.ndarray]:
    """Return how far tags are from the turntable's middle in m, and where round it [n]."""
    rows = _tables("").recorded
    x, y = rows["tx_x_m"] - 38, rows["tx_y_m"] - 11
    return np.hypot(x, y).to_numpy(), np.arctan2(y, x).to_numpy()


def _still() -> np.ndarray:
    rows = _tables("").recorded
    shunt = rows["link"].str.extract(r"(\d+)")[0]
    spread = rows.groupby(shunt)[["tx_x_m", "tx_y_m", "tx_z_m"]].transform(np.ptp)
    return np.asarray(spread.max(axis=1).eq(0))


def test_play_of_its_gear_moves_ends_of_the_turntable_alone_and_by_no_more_than_it_is() -> None:
    shift = _shift("table-gear-has-play")
    ends = _rides("end")
    assert not shift[~ends].any()
    assert not shift[_still()].any()
    assert 0.05 < np.abs(shift).max() < 0.024 * 8.4 + 0.01
    once = _tables("table-gear-has-play").recorded.assign(shift=shift)[ends & ~_still()]
    across = 0.024 * 8.4 * (_toward()[:, :2] * _rightward()).sum(axis=1)[once.index]
    assert np.abs(np.corrcoef(np.abs(once["shift"]), np.abs(across))[0, 1]) > 0.99


def _rightward() -> np.ndarray:
    """Return which way tags go that go round, of length 1 [n, 2]."""
    return np.stack([-np.sin(_polar()[1]), np.cos(_polar()[1])], axis=1)


def test_roads_are_splayed_from_the_middle_one_on_and_the_more_the_farther_out() -> None:
    shift, engines = _shift("roads-splayed-wider", 0.25), _rides("engine")
    assert not shift[~engines].any()
    out_m, rad = _polar()
    across = 0.25 * 0.0085 * (rad - np.pi / 2) * out_m
    expected = across * (_toward()[:, :2] * _rightward()).sum(axis=1)
    assert np.allclose(shift[engines], expected[engines], atol=0.002)


def test_hoists_alone_hang_lower_and_the_more_the_more_rope_is_out() -> None:
    shift, hoists = _shift("second-layer-on-the-drum", 0.25), _rides("hoist")
    assert not shift[~hoists].any()
    lower = 0.25 * 0.17 * (6.2 - _tables("").recorded["tx_z_m"].to_numpy()).clip(0)
    assert np.allclose(shift[hoists], (-lower * _toward()[:, 2])[hoists], atol=0.006)


def test_stamps_are_right_when_a_shunt_begins_and_fall_behind_by_the_same_part_of_its_time() -> (
    None
):
    made, shift = _tables("stamps-fall-behind"), _shift("stamps-fall-behind")
    shunt = made.recorded["link"].str.extract(r"(\d+)")[0]
    first = ~shunt.duplicated().to_numpy()
    assert np.abs(shift[first | _still()]).max() < 1e-9
    since = made.recorded["time_s"] - made.recorded.groupby(shunt)["time_s"].transform("min")
    speeds = np.abs(shift / (0.16 * since).clip(lower=1e-9))
    assert np.abs(shift).max() > 0.05
    assert speeds[~first].max() < 2.3


def test_squares_of_ranges_are_whole_steps() -> None:
    steps = _tables("range-rounding").recorded["range_m"] ** 2 / 2.8
    assert np.allclose(steps, np.rint(steps))
    far = _tables("").recorded["true_range_m"].to_numpy()
    assert (np.abs(_shift("range-rounding")) <= 1.4 / (2 * far - 0.4) + 1e-3).all()


def test_only_what_has_no_line_of_sight_is_blocked_or_goes_through_things() -> None:
    for mode in ("ranges", "CIR"):
        rows = _tables("", mode=mode).recorded
        assert (rows["los"] == rows["obstacles"].map(len).eq(0)).all()
        assert 0.35 < rows["los"].mean() < 0.75
    seen = _tables("").recorded["los"].to_numpy()
    blocked = _shift("blocked-path")
    assert not blocked[seen].any()
    assert (blocked[blocked != 0] >= 0.4).all()
    assert blocked.max() <= 3.6
    assert not _shift("material-delay")[seen].any()
    seen = _tables("", mode="CIR").recorded["los"].to_numpy()
    assert np.abs(_shift("obstructed-path", mode="CIR")[seen]).max() < 0.06


def test_symbols_that_are_not_summed_take_their_noise_with_them_down_to_a_limit() -> None:
    made = _tables("level-control")
    counts, noise = (
        made.recorded[name] / made.clean[name] for name in ("preamble_count", "noise_std")
    )
    assert np.allclose(noise, np.sqrt(counts))
    assert 10 ** (-1.15 * 7 / 20) < counts.min() < 0.8


def test_engines_stay_on_rays_ends_on_their_circle_and_hoists_on_the_ring() -> None:
    out_m, rad = _polar()
    rows = _tables("").recorded.assign(out=out_m, rad=rad)
    shunts = rows.groupby(rows["link"].str.extract(r"(\d+)")[0])
    assert shunts["tx"].nunique().eq(1).all()
    assert shunts["rx"].nunique().between(2, 7).all()
    assert shunts["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    spread = {name: shunts[name].transform(np.ptp) for name in ("out", "rad", "tx_z_m")}
    assert spread["rad"][_rides("engine")].max() < 1e-9
    assert spread["tx_z_m"][~_rides("hoist")].max() == 0
    assert np.allclose(rows["out"][_rides("end")], 8.4)
    assert np.allclose(rows["out"][_rides("hoist")], 25.4)
    assert rows["out"][_rides("engine")].between(16.4, 33.6).all()
    assert rows["tx_z_m"].between(0.5, 7.0).all()
    assert {*rows["environment"]} == {"stalls", "turntable", "ring"}


def test_readers_wait_as_long_as_it_happens() -> None:
    gaps = _tables("").recorded.groupby("link")["time_s"].diff().dropna()
    assert gaps.mean() == pytest.approx(0.33, rel=0.1)
    assert gaps.std() == pytest.approx(0.062 * np.sqrt(5), rel=0.15)
    assert gaps.min() > 0.02


def test_roofs_take_18_db_for_a_tenth_of_a_glance_and_nothing_where_it_is_steep() -> None:
    lost = roofs_db(np.array([0.002, 0.02, 0.5]))
    assert lost[0] - lost[1] == pytest.approx(18.0)
    assert lost[2] == 0


def test_rises_are_where_they_are_however_high_pulses_are_and_later_for_none_that_is_numb() -> None:
    top = 60 + np.linspace(0, 1, 20)
    low, high = (edges(size * pulses(top) + 0j, np.full(20, 0.002)) for size in (1.0, 40.0))
    assert np.allclose(low, high, atol=1e-9)
    assert np.allclose(top - low, RISE, atol=0.06)
    both = 0.3 * pulses(top) + pulses(top + 9.4) + 0j
    keen, numb = (edges(both, np.full(20, 0.002), numb) for numb in (0.0, 2.0))
    assert np.allclose(numb - keen, 9.4, atol=0.15)
    weak = edges(pulses(top) + 0j, np.full(20, 0.02), 2.0)
    assert ((weak - top + RISE > 0.1) & (weak < top)).all()


def test_middles_ofhexagons_are_no_farther_than_corners() -> None:
    parts = np.random.default_rng(3).normal(scale=5, size=(2, 1, 4000))
    off = np.abs(hexagons(parts[0] + 1j * parts[1], 1.5) - (parts[0] + 1j * parts[1]))
    assert 0.95 * 1.5 / np.sqrt(3) < off.max() <= 1.5 / np.sqrt(3)
