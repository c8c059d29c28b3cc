"""The brickworks: what is particular to it, and what its readers leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.brickworks_effects import edge_db
from bench.challenge.families.brickworks_reader import RISE, edges, pulses
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "brickworks"), partial(shift_of, "brickworks")


def _is(kind: str) -> np.ndarray:
    return np.asarray(_tables("").recorded["tx"].str.startswith(kind), bool)


def _toward(axis: str) -> np.ndarray:
    """Return what part of ways from readers to tags is along an axis [n]."""
    rows = _tables("").recorded
    apart = rows[f"tx_{axis}_m"] - rows[f"rx_{axis}_m"]
    return np.asarray(apart / rows["true_range_m"], np.float64)


def test_grabs_alone_trail_behind_and_by_no_more_than_ropes_can() -> None:
    shift, grabs = _shift("grabs-trail-behind"), _is("grab")
    assert np.abs(shift[~grabs]).max() < 1e-9
    most = 5.2 / 9.81 * 1.7**2 * (np.pi / 5.5 / 2 + 1 / 2.4)  # along the way, and outward
    assert 0.05 < np.abs(shift).max() < most
    half = np.abs(_shift("grabs-trail-behind", 0.5)).mean()
    assert half == pytest.approx(0.5 * np.abs(shift).mean(), rel=0.05)


def test_a_kilns_bed_lifts_cars_and_the_more_the_nearer_its_hottest_place_they_are() -> None:
    shift, cars = _shift("kiln-bed-heaves", 0.25), _is("car")
    assert not shift[~cars].any()
    off = (_tables("").recorded["tx_x_m"].to_numpy() - 24) / 7
    higher = 0.25 * 0.19 * np.exp(-0.5 * off**2)
    assert np.allclose(shift[cars], (higher * _toward("z"))[cars], atol=0.002)


def test_strokes_that_count_long_leave_what_rests_and_what_is_no_car() -> None:
    made, shift = _tables("strokes-counted-long"), np.abs(_shift("strokes-counted-long"))
    assert not shift[~_is("car")].any()
    push = made.recorded["link"].str.extract(r"(\d+)")[0]
    moves = made.recorded.groupby(push)["tx_x_m"].transform(np.ptp).gt(0).to_numpy()
    assert shift[~moves].max() < 1e-9
    assert 0.05 < shift.max() < 0.05 * 0.4 * 10.5 * 2.2 + 0.01


def test_one_buckstay_alone_is_of_another_second() -> None:
    made, shift = (
        _tables("one-buckstay-of-another-second"),
        _shift("one-buckstay-of-another-second"),
    )
    there = made.recorded["rx"].eq("buckstay4").to_numpy()
    assert not shift[~there].any()
    assert 0.02 < np.abs(shift).max() < 0.45 * 2.3


def test_steps_that_have_begun_are_counted() -> None:
    made, shift = _tables("range-rounding"), _shift("range-rounding")
    steps = made.recorded["range_m"] / 0.11
    assert np.allclose(steps, np.rint(steps))
    assert shift.min() > -1e-9
    assert shift.max() < 0.11 + 1e-9


def test_only_what_has_no_line_of_sight_is_blocked_or_goes_through_things() -> None:
    for mode in ("ranges", "CIR"):
        rows = _tables("", mode=mode).recorded
        assert (rows["los"] == rows["obstacles"].map(len).eq(0)).all()
        assert 0.35 < rows["los"].mean() < 0.75
    seen = _tables("").recorded["los"].to_numpy()
    assert not _shift("blocked-path")[seen].any()
    assert not _shift("material-delay")[seen].any()
    seen = _tables("", mode="CIR").recorded["los"].to_numpy()
    assert np.abs(_shift("obstructed-path", mode="CIR")[seen]).max() < 0.06


def test_symbols_that_are_not_summed_take_their_noise_with_them() -> None:
    made = _tables("level-control")
    counts, noise = (
        made.recorded[name] / made.clean[name] for name in ("preamble_count", "noise_std")
    )
    assert np.allclose(noise, np.sqrt(counts))
    assert counts.min() < 0.8


def test_cars_stay_on_their_tracks_traversers_on_theirs_and_all_in_the_hall() -> None:
    rows = _tables("").recorded
    runs = rows.groupby(rows["link"].str.extract(r"(\d+)")[0])
    assert runs["tx"].nunique().eq(1).all()
    assert runs["rx"].nunique().between(2, 8).all()
    assert runs["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    spread = {axis: runs[f"tx_{axis}_m"].transform(np.ptp) for axis in "xyz"}
    assert spread["y"][_is("car")].max() == spread["z"][_is("car")].max() == 0
    assert spread["x"][_is("traverser")].max() == spread["z"][_is("traverser")].max() == 0
    assert spread["z"][_is("grab")].max() > 0.3
    for axis, side_m in zip("xyz", (44, 23, 8.6), strict=True):
        assert rows[f"tx_{axis}_m"].between(0, side_m).all()
    assert {*rows["environment"]} == {"kiln", "transfer", "setting"}


def test_readers_skip_turns_now_and_then() -> None:
    rows = _tables("").recorded
    gaps = rows.groupby("link")["time_s"].diff().dropna() / 0.31
    assert np.allclose(gaps, np.rint(gaps), atol=0.03)
    assert {*np.rint(gaps)} == {1.0, 2.0}
    assert 0.07 < (gaps > 1.5).mean() < 0.22


def test_an_edge_takes_six_db_where_the_way_touches_it_and_more_the_deeper_it_is() -> None:
    lost = edge_db(np.array([-0.8, 0.0, 1.0, 2.4, 10.0, 20.0]))
    assert lost[1] == pytest.approx(6.02, abs=0.05)
    assert abs(lost[0]) < 0.1
    assert (np.diff(lost) > 2).all()
    assert lost[5] - lost[4] == pytest.approx(6.02, abs=0.05)  # as one over it, far in the shade


def test_a_constant_fraction_is_where_it_is_however_high_pulses_are() -> None:
    top = 60 + np.linspace(0, 1, 20)
    low, high = (edges(size * pulses(top) + 0j, np.full(20, 0.01)) for size in (1.0, 40.0))
    assert np.allclose(low, high, atol=1e-9)
    assert np.allclose(top - low, RISE, atol=0.08)
