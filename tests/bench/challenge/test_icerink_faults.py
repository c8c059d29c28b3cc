"""What the ice rink hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.icerink_effects import (
    ASIDE_M,
    FOIL_M,
    ROOTS,
    by_roots,
    off_things,
    posts_m,
    round_ice,
)
from bench.challenge.families.icerink_faults import (
    ICE_C,
    IN_M,
    MELTS_RAD,
    SAGS_M,
    STATION_M,
    dew_c,
    melted_m,
)
from bench.challenge.families.icerink_rink import (
    BELOW_ROOF,
    MULLIONS_M,
    PANE_M,
    PER_PPM_MS_M,
    WARM_BRINE_C,
    Period,
    off_boards,
)
from tests.bench.challenge import shown

_are = partial(shown.are_of, "icerink")
_nothing = partial(shown.nothing_of, "icerink")
_shift = partial(shown.shift_of, "icerink")
_tables = partial(shown.tables_of, "icerink")
_rows = partial(shown.rows_of, "icerink")
_known = partial(shown.known_of, "icerink")
_of = partial(shown.column_of, "icerink")


def _period() -> Period:
    return Period(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("icerink", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        assert {*world.CAUSES.values()} <= {*_nothing(0, mode).recorded}
    of_one = {
        "frost-grows-on-mullions": "frost_mm", "slush-heaps-on-boards": "slush_cm",
        "film-spreads-since-flooded": "flooded_min", "carbon-sticks-in-the-rack": "sticks",
        "compressor-runs-on-warm-brine": "brine_c",
    }  # fmt: skip
    for name, column in of_one.items():
        order = np.argsort(_of(column), kind="stable")
        assert (np.diff(_shift(name)[order]) > -1e-9).all(), name
    order = np.argsort(_of("cube_gap_m"))
    assert (np.diff(_shift("scoreboard-let-down-close-by")[order]) < 1e-9).all()


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    frost = -np.log1p(-_shift("frost-grows-on-mullions") / 0.2)
    assert np.allclose(frost, _of("frost_mm") / 4.5)
    slush = np.log(_shift("slush-heaps-on-boards") / 0.19)
    assert np.allclose(slush, 1.7 * np.log(_of("slush_cm") / 11.0))
    assert np.allclose(_shift("scoreboard-let-down-close-by") * _of("cube_gap_m"), 0.125)
    film = np.expm1(_shift("film-spreads-since-flooded") / 0.047)
    assert np.allclose(film, _of("flooded_min") / 4.0)
    assert np.allclose(_shift("carbon-sticks-in-the-rack"), 0.0122 * _of("sticks"))
    turn = 2 * np.pi * _of("glide_m") / PANE_M + 1.3
    assert np.allclose(_shift("panes-pass-alongside"), 0.059 * np.sin(turn))
    runs = _of("brine_c") > WARM_BRINE_C
    assert np.allclose(_shift("compressor-runs-on-warm-brine"), 0.096 * runs)


def test_air_dews_by_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("air-dews-above-ice")
    warm, humid = _of("temperature_c"), _of("humid_pct")
    assert np.allclose(shift, 0.0125 * (dew_c(warm, humid) - ICE_C).clip(0.0))
    for column in (warm, humid):
        assert abs(np.corrcoef(shift, column)[0, 1]) < 0.97


def test_faults_of_ways_concern_their_own_sort_and_are_as_large_as_is_said() -> None:
    rests = _known()["goes"].eq(0.0).to_numpy()
    for name, sort, most in (
        ("skaters-lean-in-more-than-told", "skater", 1.2),
        ("penguins-rub-on-wet-ice", "penguin", 1.0),
        ("resurfacers-lap-further-in", "resurfacer", IN_M + 1e-6),
        ("pairs-hold-gives-as-they-turn", "pair", 0.6),
    ):
        shift, own = _shift(name), _are(sort)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        if sort in ("skater", "penguin"):
            assert np.abs(shift[rests]).max() < 1e-9


def test_the_truss_sags_and_nothing_else_does() -> None:
    shift, below = _shift("truss-sags-under-snow"), np.isin(_period().mullion, BELOW_ROOF)
    assert not shift[~below].any()
    assert (shift[below] <= 0).all()  # all tags are lower
    steep = (_of("rx_z_m") - _of("tx_z_m"))[below] / _of("true_range_m")[below]
    down = -shift[below] / steep
    assert np.corrcoef(down, (_of("snow_cm")[below] / 50.0) ** 1.25)[0, 1] > 0.995
    assert down.max() < 1.2 * SAGS_M


def test_a_tripod_that_melts_in_turns_all_about_itself_ever_more() -> None:
    off = melted_m(1.0)
    arms = MULLIONS_M - np.array(STATION_M)
    assert not off[0].any()
    assert np.allclose((off * arms).sum(axis=1), 0.0)
    assert np.allclose(off @ np.array(MELTS_RAD), 0.0)
    rate = np.linalg.norm(off, axis=1) / np.linalg.norm(arms, axis=1)
    assert 0.1 < np.linalg.norm(off, axis=1).max() < 0.7
    assert rate[1:].min() > 0
    assert np.allclose(melted_m(2.0), 2 * off)


def test_answers_sent_twice_are_the_ones_before_and_some_of_them() -> None:
    for strength, part in ((1.0, 0.3), (2.0, 0.6)):
        made, shift = (
            _tables("answers-sent-twice", strength),
            _shift("answers-sent-twice", strength),
        )
        last = made.clean.groupby("link", sort=False)["range_m"].shift(1)
        again = np.abs(shift) > 1e-12
        assert np.allclose(made.recorded["range_m"][again], last[again])
        assert again[last.notna()].mean() == pytest.approx(part, abs=0.06)
        assert not again[last.isna()].any()
    world: Any = world_of("icerink")
    truth = world.tables(Draw(("answers-sent-twice",), ratio=3), 9)
    moved = (truth.truth["error_m"] - truth.simulated["error_m"]).abs()
    assert moved.max() < 12.0  # no row has that of another link before it


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    for name, low, high in (("path-loss", -6.0, -1.5), ("level-control", -3.2, -0.6)):
        made = _tables(name)
        lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
        assert low < lost.mean() < high
        assert not _shift(name).any()
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert counts.max() <= 1.0
    far = _tables("path-loss")
    lost = far.recorded["rx_power_dbm"] - far.clean["rx_power_dbm"]
    assert np.corrcoef(lost, np.log(_of("true_range_m")))[0, 1] < -0.6


def test_loud_rows_are_early_and_weak_ones_late_and_both_come_to_an_end() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    order = np.argsort(level)
    assert (np.diff(shift[order]) <= 1e-12).all()
    assert shift.max() < 0.08
    assert shift.min() > -0.11


def test_clocks_count_by_ppm_and_by_how_long_replies_take() -> None:
    ppm = _shift("clock-offset") / (PER_PPM_MS_M * 1e3 * _of("reply_time_s"))
    rows = _rows().assign(ppm=ppm)
    assert np.abs(ppm).max() < 0.15
    for _, one in rows.groupby(["tx", "rx"]):
        if len(one) > 4 and np.ptp(one["time_s"]) < 60:
            assert np.ptp(one["ppm"]) < 1e-3


def test_scales_are_each_mullions_own_and_grow_round_the_ice() -> None:
    part = _shift("range-scale") / _of("true_range_m")
    by = pd.Series(part).groupby(_period().mullion).agg(["mean", np.ptp])
    assert by["ptp"].max() < 1e-12
    order = by["mean"].to_numpy()[np.argsort(round_ice())]
    assert np.allclose(np.diff(order), np.diff(order)[0])
    assert 0.004 < order.min() < order.max() < 0.012


def test_ranges_are_written_as_roots() -> None:
    roots = np.sqrt(_tables("range-rounding").recorded["range_m"].to_numpy()) / ROOTS
    assert np.allclose(roots, np.rint(roots), atol=1e-6)
    assert np.abs(_shift("range-rounding")).max() <= ROOTS * np.sqrt(60.0)
    assert np.allclose(by_roots(np.array([4.1, 9.2]), 1.0), [4.0, 9.0])


def test_only_what_is_behind_something_is_blocked_and_by_the_soonest_way_there_is() -> None:
    late = shown.assert_blocked_behind_things("icerink", 0.5)
    assert late.max() < 14.0
    period = _period()
    longer = off_things(period)
    assert longer.min() > 0.0
    flat = np.hypot(*(period.ends[1] - period.ends[0])[:, :2].T)
    foil = np.hypot(flat, 2 * FOIL_M - period.ends[0][:, 2] - period.ends[1][:, 2]) - period.far
    assert (longer <= foil + 1e-9).all()
    least = 2 * np.hypot(0.5 * period.far, ASIDE_M) - period.far  # of what is so far aside
    assert (longer >= np.minimum(least, foil) - 1e-6).all()
    at = posts_m()
    assert np.abs(off_boards(at[:, 0], at[:, 1])).max() < 1e-6
