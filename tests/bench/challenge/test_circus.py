"""The circus: what is particular to it, and how large what it hides is."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.circus_effects import CUPOLA_M, HOOP_M, MARK_M, by_the_hoop
from bench.challenge.families.circus_faults import BOWS, DIPS_M, GIVES, RACKED
from bench.challenge.families.circus_show import PRIME, ROUND_S, SLOT_S, slot_of
from bench.challenge.families.circus_tent import (
    DIP_M,
    PLACES,
    POLES,
    POLES_M,
    TAGS,
    TENT_M,
    WIRE_M,
    Act,
)
from tests.bench.challenge import shown

_are = partial(shown.are_of, "circus")
_nothing = partial(shown.nothing_of, "circus")
_shift = partial(shown.shift_of, "circus")
_tables = partial(shown.tables_of, "circus")
_rows = partial(shown.rows_of, "circus")
_known = partial(shown.known_of, "circus")
_of = partial(shown.column_of, "circus")


def _poles() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("pole").astype(int).to_numpy()


def _act(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"act (\d+)")[0]


def test_tags_stay_in_the_tent_and_an_act_has_one_tag_and_some_poles() -> None:
    rows = _rows()
    for axis, most in zip("xyz", TENT_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.5, most - 0.5).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > 1.8
    acts = rows.groupby(_act(rows))
    assert acts["tx"].nunique().eq(1).all()
    assert acts["rx"].nunique().between(3, 8).all()
    assert acts["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}


def test_no_two_rounds_have_two_poles_as_far_apart_in_slots_and_poles() -> None:
    pole = np.arange(PRIME - 1)
    slots = slot_of(pole, np.zeros(PRIME - 1, np.int64))
    assert sorted(slots) == [*range(1, PRIME)]
    for apart in range(1, PRIME - 1):
        steps = slots[apart:] - slots[:-apart]
        assert len({*steps}) == len(steps)
    rows = _rows()
    waits = rows.groupby("link")["time_s"].diff() - ROUND_S
    slots_on = (waits.dropna() / SLOT_S).to_numpy()
    assert len(slots_on) > 300
    assert np.allclose(slots_on, np.rint(slots_on), atol=1e-5)
    assert {*np.abs(np.rint(slots_on)).astype(int)} == {1, 2, 3, 4, 5, 6}


def test_fliers_hang_by_their_ropes_and_walkers_walk_along_a_wire_that_dips() -> None:
    one = _known()
    off = one[["tx_x_m", "tx_y_m", "tx_z_m"]].to_numpy() - one[["hung_x", "hung_y", "hung_z"]]
    hangs = one["tx"].str.startswith(("flier", "spinner"))
    assert np.allclose(np.linalg.norm(off[hangs], axis=1), one["reach"][hangs])
    assert np.abs(off[hangs]["hung_z"]).min() > 1.9
    walks = one["tx"].str.startswith("walker")
    part = off[walks]["hung_x"] / WIRE_M
    assert part.between(0.0, 1.0).all()
    assert np.allclose(off[walks]["hung_z"], -4 * DIP_M * part * (1 - part))
    rides = one["tx"].str.startswith("cyclist")
    out = np.hypot(off[rides]["hung_x"], off[rides]["hung_y"])
    assert (np.abs(out - one["reach"][rides]) <= one["throw"][rides] + 1e-9).all()


def test_who_stays_still_stays_and_all_else_moves() -> None:
    still = _known().groupby(_act(_known()))["goes"].first().eq(0.0)
    spread = _rows().groupby(_act(_rows()))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).min() > 0.01


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(8):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(18.0, 19.0).all()
            gap = table["rx_power_dbm"] - table["first_path_power_dbm"]
            assert gap.max() < 18


def test_deaf_lamps_lose_some_first_paths_in_any_day() -> None:
    world: Any = world_of("circus", "CIR")
    for seed in range(4):
        made = world.tables(Draw(("late-detection",), 1.0, 1), seed)
        later = made.recorded["error_m"] - made.clean["error_m"]
        assert 0.015 < (later > 0.3).mean() < 0.3
        assert (later >= -1e-9).all()


def test_ropes_that_give_and_wires_that_dip_move_their_own_tags_alone() -> None:
    ropes, flies = _shift("trapezes-ropes-give", 0.1), _are("flier")
    assert not ropes[~flies].any()
    assert 0.01 < np.abs(ropes[flies]).max() < 0.1 * GIVES * 3 * 5.6
    wires, walks = _shift("wire-dips-under-walkers", 0.1), _are("walker")
    assert not wires[~walks].any()
    rise = (_of("rx_z_m") - _of("tx_z_m")) / _of("true_range_m")
    assert (np.sign(wires) == np.sign(rise))[walks & (np.abs(rise) > 0.05)].all()
    assert (np.abs(wires) <= 0.1 * DIPS_M + 1e-9).all()


def test_gusts_rack_their_own_poles_and_canvas_bows_the_highest_the_most() -> None:
    gusts, own = _shift("gusts-rack-their-poles"), np.isin(_poles(), RACKED)
    assert not gusts[~own].any()
    assert 0.15 < own.mean() < 0.7
    calm = _of("gust_ms") < 3.0
    assert np.abs(gusts[own & calm]).max() < 0.03
    bows = np.abs(_shift("poles-bow-under-canvas", 0.1))
    assert (bows <= 0.1 * BOWS * POLES_M[_poles(), 2] ** 2 + 1e-9).all()
    assert bows.max() > 0.04


def test_smoke_is_of_two_columns_of_which_neither_alone_tells_it() -> None:
    shift = _shift("smoke-under-lamps")
    assert np.allclose(shift, 0.31 * _of("smoke_pct") / 100 * np.sqrt(_of("lamp_kw") / 12))
    for name in ("smoke_pct", "lamp_kw"):
        assert abs(np.corrcoef(shift, _of(name))[0, 1]) < 0.97


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    assert np.allclose(
        np.log1p(-_shift("chalk-dusts-the-poles") / 0.19), -_of("chalk_mg") / 36.0, atol=1e-6
    )
    assert np.allclose(np.expm1(_shift("rosin-on-tags") / 0.062), _of("rosin_g") / 0.9)
    assert np.allclose(_shift("lions-cage-close-by") * _of("cage_m"), 0.27)
    rain = np.log(_shift("rain-soaks-the-canvas") / 0.21)
    assert np.allclose(rain, 1.6 * np.log(_of("rain_mm") / 9.0))


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    for name, low, high in (("path-loss", -6.5, -2.0), ("level-control", -3.0, -1.0)):
        made = _tables(name)
        lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
        assert low < lost.mean() < high
        assert not _shift(name).any()
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    noise = made.recorded["noise_std"] / made.clean["noise_std"]
    assert np.allclose(noise**2, counts)
    assert len({*counts.round(6)}) < 10  # an attenuator has steps
    assert counts.max() <= 1.0


def test_either_mark_is_written_and_on_average_ranges_are_as_they_were() -> None:
    told = _tables("range-rounding").recorded["range_m"] / MARK_M
    assert np.allclose(told, np.rint(told))
    shift = _shift("range-rounding")
    assert np.abs(shift).max() < MARK_M
    assert abs(shift.mean()) < 4 * MARK_M / np.sqrt(6 * len(shift))


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = shown.assert_blocked_behind_things("circus", 0.499)
    assert np.mean(late > 4.59) < 0.5


def test_a_hoop_returns_something_that_is_late_enough_to_every_row() -> None:
    act = Act(_known(), 0, np.random.default_rng(0))
    more = by_the_hoop(act)
    assert np.isfinite(more).all()
    assert (more > 0.5).all()
    middle = [np.linalg.norm(end - np.array(CUPOLA_M), axis=1) for end in (act.there, act.post)]
    assert (more <= middle[0] + middle[1] + 2 * HOOP_M - act.far).all()


def test_all_poles_hear_and_each_hears_tags_of_more_than_one_kind() -> None:
    kinds = _rows().groupby("rx")["environment"].nunique()
    assert len(kinds) == POLES
    assert kinds.min() > 1
