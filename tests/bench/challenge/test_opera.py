"""The opera: what is particular to it, and what its consoles leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.opera_effects import screened_db
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "opera"), partial(shift_of, "opera")


def _flown() -> np.ndarray:
    return np.asarray(_tables("").recorded["tx"].str.startswith("bar"), bool)


def _up() -> np.ndarray:
    """Return how steeply ways go up from cleats to tags: sines [n]."""
    rows = _tables("").recorded
    return np.asarray((rows["tx_z_m"] - rows["rx_z_m"]) / rows["true_range_m"], np.float64)


def test_bars_sag_between_their_lines_by_no_more_than_they_can_and_wagons_do_not() -> None:
    shift, flown = _shift("bars-sag-between-lines"), _flown()
    assert not shift[~flown].any()
    assert (np.abs(shift) <= 0.2 * np.abs(_up()) + 0.02)[flown].all()
    between = np.sin(np.pi * (_tables("").recorded["tx_x_m"] - 2) / 6) ** 2
    steep = flown & (np.abs(_up()) > 0.2)
    assert np.corrcoef((shift / _up())[steep], between[steep])[0, 1] < -0.97


def test_a_rake_lifts_wagons_in_proportion_to_how_far_up_stage_they_are() -> None:
    shift, flown = _shift("rake-forgotten", 0.25), _flown()
    assert not shift[flown].any()
    higher = 0.25 * 0.055 * _tables("").recorded["tx_y_m"].to_numpy()
    assert np.allclose(shift[~flown], (higher * _up())[~flown], atol=0.01)


def test_a_revolve_that_slips_leaves_bars_and_what_rests_and_is_off_the_later_the_more() -> None:
    made, shift = _tables("revolve-slips"), np.abs(_shift("revolve-slips"))
    assert not shift[_flown()].any()
    still = made.recorded.groupby("link")["true_range_m"].transform(np.ptp).eq(0).to_numpy()
    alone = made.recorded.groupby("link")["link"].transform("size").eq(1).to_numpy()
    assert shift[still & ~alone].max() < 1e-9
    assert 0.02 < shift.max() < 0.09 * 0.5 * 11 * 1.4 + 0.01


def test_one_cleat_alone_is_of_another_moment() -> None:
    made, shift = _tables("one-cleat-of-another-clock"), _shift("one-cleat-of-another-clock")
    there = made.recorded["rx"].eq("cleat8").to_numpy()
    assert not shift[~there].any()
    assert 0.02 < np.abs(shift).max() < 0.7 * 1.8 + 0.01


def test_old_firmware_cuts_to_the_steps_that_new_firmware_goes_to_the_nearest_of() -> None:
    made, shift = _tables("range-rounding"), _shift("range-rounding")
    steps = made.recorded["range_m"] / 0.12
    assert np.allclose(steps, np.rint(steps))
    least = made.recorded.assign(shift=shift).groupby("rx")["shift"].agg(["min", "max"])
    old = least["max"] <= 1e-9
    assert old.sum() == 5
    assert least["min"][~old].min() > -0.06 - 1e-9


def test_only_what_has_no_line_of_sight_is_masked_or_goes_through_things() -> None:
    for mode in ("ranges", "CIR"):
        rows = _tables("", mode=mode).recorded
        assert (rows["los"] == rows["obstacles"].map(len).eq(0)).all()
        assert 0.35 < rows["los"].mean() < 0.75
    seen = _tables("").recorded["los"].to_numpy()
    assert not _shift("blocked-path")[seen].any()
    assert not _shift("material-delay")[seen].any()
    seen = _tables("", mode="CIR").recorded["los"].to_numpy()
    assert np.abs(_shift("obstructed-path", mode="CIR")[seen]).max() < 0.06


def test_bars_fly_straight_up_and_down_and_wagons_stay_on_the_deck() -> None:
    rows, flown = _tables("").recorded, _flown()
    cues = rows.groupby(rows["link"].str.extract(r"(\d+)")[0])
    assert cues["tx"].nunique().eq(1).all()
    assert cues["rx"].nunique().between(2, 7).all()
    assert cues["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    aside = rows.groupby("link")[["tx_x_m", "tx_y_m"]].transform(np.ptp).max(axis=1)
    assert aside[flown].max() == 0
    rise = rows.groupby("link")["tx_z_m"].transform(np.ptp)
    assert rise[~flown].max() == 0
    assert 0.4 < flown.mean() < 0.85
    for axis, side_m in zip("xyz", (28, 21, 27), strict=True):
        assert rows[f"tx_{axis}_m"].between(0, side_m).all()


def test_cleats_lose_rounds_now_and_then() -> None:
    rows = _tables("").recorded
    gaps = rows.groupby("link")["time_s"].diff().dropna() / 0.28
    assert np.allclose(gaps, np.rint(gaps), atol=0.03)
    assert {*np.rint(gaps)} == {1.0, 2.0}
    assert 0.08 < (gaps > 1.5).mean() < 0.25


def test_a_screen_that_only_touches_the_way_takes_five_db_and_more_the_deeper() -> None:
    lost = screened_db(np.array([0.0, 0.02, 0.2, 2.0]))
    assert lost[0] == pytest.approx(5.0, abs=0.05)
    assert (np.diff(lost) > 2).all()
    assert lost[3] - lost[2] == pytest.approx(10.0, abs=0.05)  # as the root, far in the shade
