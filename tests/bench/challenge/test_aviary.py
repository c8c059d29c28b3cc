"""The aviary: what is particular to it, and what its listeners leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.aviary_effects import STEP_M, WEDDLE, lee_db
from bench.challenge.families.aviary_grounds import GROVE_M, NESTBOXES_M, Watch
from bench.challenge.families.aviary_listener import UP, arrivals, calls
from bench.challenge.families.aviary_wave_effects import panes, rock, sticky
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "aviary"), partial(shift_of, "aviary")


def _rows() -> pd.DataFrame:
    return _tables("").recorded


def _worn_by(kind: str) -> np.ndarray:
    return np.asarray(_rows()["tx"].str.startswith(kind), bool)


def _watches() -> pd.Series:
    return _rows()["link"].str.extract(r"(\d+)")[0]


def _rests() -> np.ndarray:
    spread = _rows().groupby(_watches())[["tx_x_m", "tx_y_m", "tx_z_m"]].transform(np.ptp)
    return np.asarray(spread.max(axis=1).eq(0))


def _boxes() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("nestbox").astype(int).to_numpy()


def test_only_storks_bank_and_by_no_more_than_their_legs() -> None:
    shift = _shift("storks-bank")
    assert not shift[~_worn_by("stork") | _rests()].any()
    assert 0.05 < np.abs(shift).max() < 0.38


def test_winds_drift_what_flies_ever_farther_and_no_keeper() -> None:
    shift = np.abs(_shift("wind-drifts-flyers"))
    assert not shift[_worn_by("keeper") | _rests()].any()
    flies = ~(_worn_by("keeper") | _rests())
    since = _rows()["time_s"] - _rows()["time_s"].groupby(_watches()).transform("min")
    assert shift[flies & (since > 1.5)].mean() > 1.2 * shift[flies & (since < 0.5)].mean()
    assert shift.max() < 0.052 * 10.0


def test_only_masts_lean_and_by_the_square_of_the_wind() -> None:
    shift, wind = _shift("masts-lean-downwind", 0.25), _rows()["wind_ms"].to_numpy()
    assert not shift[_boxes() >= 4].any()
    assert (np.abs(shift) <= 0.25 * 0.115 * (wind / 6.0) ** 2 + 1e-9).all()


def test_a_sheared_plan_moves_nestboxes_the_more_the_farther_north_they_are() -> None:
    shift = _shift("plan-sheared", 0.25)
    north = np.abs(NESTBOXES_M[_boxes(), 1] - 11.0)
    assert (np.abs(shift) <= 0.25 * 0.0104 * north + 1e-9).all()
    assert np.abs(shift)[north > 25].mean() > 2 * np.abs(shift)[north < 5].mean()


def test_tags_are_late_at_first_and_ever_less() -> None:
    shift = _shift("tags-wake-slowly")
    first = ~_watches().duplicated().to_numpy()
    assert np.allclose(shift[first], 0.152)
    seen = _rows().assign(shift=-shift)
    assert seen.groupby(_watches())["shift"].apply(lambda one: one.is_monotonic_increasing).all()


def test_of_codes_every_fourth_is_never_written() -> None:
    codes = _tables("range-rounding").recorded["range_m"] / STEP_M
    assert np.allclose(codes, np.rint(codes))
    assert {*(np.rint(codes).astype(int) % 4)} == {0, 1, 3}
    assert np.abs(_shift("range-rounding")).max() <= STEP_M + 1e-9


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    for mode in ("ranges", "CIR"):
        rows = _tables("", mode=mode).recorded
        free = rows["obstacles"].str.len().eq(0).to_numpy()
        assert 0.3 < free.mean() < 0.6
        assert not {"los", "room_x_m"} & {*rows}
    free = _rows()["obstacles"].str.len().eq(0).to_numpy()
    blocked = _shift("blocked-path")
    assert not blocked[free].any()
    assert (blocked[blocked != 0] > 0.419).all()
    assert blocked.max() < 3.41
    assert not _shift("material-delay")[free].any()
    free = _tables("", mode="CIR").recorded["obstacles"].str.len().eq(0).to_numpy()
    assert np.abs(_shift("obstructed-path", mode="CIR")[free]).max() < 0.06


def test_symbols_that_are_not_counted_take_their_noise_with_them_down_to_a_limit() -> None:
    made = _tables("level-control")
    counts, noise = (
        made.recorded[name] / made.clean[name] for name in ("preamble_count", "noise_std")
    )
    assert np.allclose(noise, np.sqrt(counts))
    assert 10 ** (-1.1 * 6.2 / 20) < counts.min() < 0.7


def test_tags_stay_below_the_net_and_a_watch_has_one_tag_and_some_nestboxes() -> None:
    rows = _rows()
    for axis, long_m in (("x", 66.0), ("y", 44.0), ("z", 15.0)):
        assert rows[f"tx_{axis}_m"].between(0.1, long_m - 0.1).all()
    assert rows["tx_z_m"][_worn_by("keeper")].between(0.9, 1.5).all()
    assert rows["tx_z_m"].min() > 0.3
    assert rows.groupby(_watches())["tx"].nunique().eq(1).all()
    assert rows.groupby(_watches())["rx"].nunique().between(3, 6).all()
    assert rows.groupby(_watches())["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {"thermal", "perches", "paths"}


def test_storks_keep_their_distance_from_what_they_soar_about() -> None:
    soars = _rows()[_worn_by("stork") & ~_rests()]
    for _, one in soars.groupby(_watches()):
        at = one[["tx_x_m", "tx_y_m"]].to_numpy()
        known = np.linalg.lstsq(np.c_[2 * at, np.ones(len(at))], (at**2).sum(axis=1), rcond=None)
        radius = np.linalg.norm(at - known[0][:2], axis=1)
        assert np.ptp(radius) < 1e-6
        assert 4.4 < radius[0] < 8.6


def test_ways_are_amid_crowns_as_far_as_these_reach() -> None:
    x_m, y_m, radius, low, high = GROVE_M
    ends = {"tx": (x_m - 20, y_m, 4.0), "rx": NESTBOXES_M[8]}
    told = {f"{end}_{axis}_m": at[k] for end, at in ends.items() for k, axis in enumerate("xyz")}
    far = float(np.linalg.norm(np.subtract(*ends.values())))
    rows = pd.DataFrame([told | {"rx": "nestbox8", "true_range_m": far}])
    known = Watch(rows, 0, np.random.default_rng(0)).amid_m[0]
    along = np.linspace(0, 1, 200001)[:, None]
    at = np.array(ends["tx"]) + along * np.subtract(ends["rx"], ends["tx"])
    amid = np.hypot(at[:, 0] - x_m, at[:, 1] - y_m) < radius
    amid &= (at[:, 2] > low) & (at[:, 2] < high)
    assert known == pytest.approx(far * amid.mean(), abs=1e-3)


def test_weddles_weights_give_what_goes_on_by_the_fifth_power() -> None:
    assert (WEDDLE * (np.arange(7) / 6) ** 5).sum() == pytest.approx(1 / 6)


def test_an_edge_leaves_a_half_of_what_grazes_it_and_ever_less_behind_it() -> None:
    assert lee_db(np.array([-2.0, 0.0, 5.0])) == pytest.approx([0.0, -6.02, -26.94], abs=0.01)
    steps = np.diff(lee_db(np.linspace(-1, 5, 6001)))
    assert (steps > 0.01).sum() == 2  # where Lee's pieces meet
    assert steps.max() < 0.8


def test_rock_and_panes_return_all_that_grazes_them_and_rock_less_of_what_is_straight() -> None:
    assert panes(np.array([1e-4]))[0] == pytest.approx(1.0, abs=1e-2)
    assert rock(np.array([1e-4]))[0] == pytest.approx(1.0, abs=1e-2)
    assert rock(np.array([1.0]))[0] < (np.sqrt(6.8) - 1) / (np.sqrt(6.8) + 1)
    assert (panes(np.linspace(0.01, 1, 50)) <= 1.0).all()


def test_sticky_steps_are_whole_ones_and_never_off_by_more_than_they_stick() -> None:
    parts = np.random.default_rng(3).normal(scale=5, size=(2, 4, 300))
    kept = sticky(parts[0] + 1j * parts[1], 1.5)
    assert np.allclose(kept.real / 1.5, np.rint(kept.real / 1.5))
    off = kept - (parts[0] + 1j * parts[1])
    assert 0.75 < max(np.abs(off.real).max(), np.abs(off.imag).max()) <= 0.82 * 1.5 + 1e-9


def test_arrivals_are_where_they_are_however_high_pulses_are_and_never_sooner_if_drowsy() -> None:
    top = 60 + np.linspace(0, 1, 20)
    low, high = (arrivals(size * calls(top) + 0j, np.full(20, 0.002)) for size in (1.0, 40.0))
    assert np.allclose(low, high, atol=1e-9)
    assert np.allclose(top - low, UP, atol=0.02)
    both = 0.3 * calls(top) + calls(top + 9.4) + 0j
    keen, drowsy = (arrivals(both, np.full(20, 0.002), much) for much in (0.0, 2.0))
    assert np.allclose(drowsy - keen, 9.4, atol=0.05)
    near = 0.5 * calls(top) + calls(top + 2.6) + 0j
    assert (arrivals(near, np.full(20, 0.02), 2.0) >= arrivals(near, np.full(20, 0.02))).all()
