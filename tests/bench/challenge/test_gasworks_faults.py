"""What the gasworks hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.gasworks_effects import (
    BIAS_M,
    EACH_C2,
    LONGEST_M,
    MOST_DB,
    SLIP_M,
    SOONEST_M,
    STEPS_M,
    TURNS_C,
)
from bench.challenge.families.gasworks_faults import (
    DAMPED,
    DIAL_OFF_M,
    DRAGS_S,
    LEANS,
    QUENCH_M,
    ROOF_M,
    SHORT,
    SHRUNK,
    STROKE_S,
    WAITS_M,
    YARD_FT_M,
    dragged,
    floated,
    in_smoke_m,
    passes_m,
)
from bench.challenge.families.gasworks_yard import (
    FLIGHT_M,
    LIGHT_M_US,
    RETORTS_M,
    SLAMS_MBAR,
    TANKS_M,
    YARD_M,
    Charge,
)
from tests.bench.challenge import shown

_shift = partial(shown.shift_of, "gasworks")
_tables = partial(shown.tables_of, "gasworks")
_known = partial(shown.known_of, "gasworks")
_of = partial(shown.column_of, "gasworks")


def _charge() -> Charge:
    return Charge(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("gasworks", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        assert {*world.CAUSES.values()} <= {*shown.nothing_of("gasworks", 0, mode).recorded}
    for name, column, sign in (
        ("tar-clings-to-brackets", "tar_g", 1), ("scurf-thickens-on-mouthpieces", "scurf_mm", 1),
        ("naphthalene-grows-in-vents", "frost_d", 1), ("holder-lifts-before-brackets", "lift_m", 1),
        ("lime-spends-itself-in-purifiers", "lime_h", -1),
        ("jib-of-the-coke-crane-close", "jib_m", -1),
        ("governor-valve-slams-shut", "main_mbar", 1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    tar = _of("tar_g")
    assert np.allclose(_shift("tar-clings-to-brackets"), 0.23 * tar / (tar + 11.0))
    frost = 1.1 * np.expm1(_shift("naphthalene-grows-in-vents") / 0.062)
    assert np.allclose(frost, _of("frost_d"))
    assert np.allclose(_shift("scurf-thickens-on-mouthpieces"), 0.0155 * _of("scurf_mm"))
    lime = -0.15 * (_of("lime_h") / 40.0) ** 0.6
    assert np.allclose(_shift("lime-spends-itself-in-purifiers"), lime)
    assert np.allclose(_shift("jib-of-the-coke-crane-close") * _of("jib_m"), 0.1)
    lift = 0.19 * (_of("lift_m") / 6.0) ** 1.7
    assert np.allclose(_shift("holder-lifts-before-brackets"), lift)
    pace = 9.5e-5 * (_of("exhaust_rpm") - 74.0) ** 2
    assert np.allclose(_shift("exhauster-off-its-best-speed"), pace)
    turn = 2 * np.pi * _of("flights_m") / FLIGHT_M + 0.4
    assert np.allclose(_shift("flights-of-the-conveyor-pass"), 0.06 * np.sin(turn))
    shut = _of("main_mbar") > SLAMS_MBAR
    assert 0.2 < shut.mean() < 0.8
    assert np.allclose(_shift("governor-valve-slams-shut"), 0.094 * shut)


def test_smoke_counts_by_the_way_in_it_and_steam_by_how_close_ways_pass() -> None:
    charge, part = _charge(), (np.arange(4000) + 0.5)[:, None] / 4000
    within = in_smoke_m(charge.tag_m, charge.bracket_m)
    close = passes_m(charge.tag_m, charge.bracket_m, QUENCH_M)
    assert (within > 1.0).mean() > 0.05
    for k in range(0, charge.rows, 23):
        at = charge.tag_m[k] + part * (charge.bracket_m[k] - charge.tag_m[k])
        there = (at[:, 0] < RETORTS_M) & (at[:, 2] > ROOF_M)
        assert within[k] == pytest.approx(there.mean() * charge.far[k], abs=0.03)
        assert close[k] == pytest.approx(np.linalg.norm(at - QUENCH_M, axis=1).min(), abs=0.01)


def test_gauges_drag_and_floats_keep_where_they_were() -> None:
    made = dragged(np.array([0.0, DRAGS_S, 2 * DRAGS_S]), np.array([0.0, 1.0, 1.0]))
    assert np.allclose(made, [0.0, 1 - np.exp(-1), 1 - np.exp(-2)])
    assert floated(np.array([0.0, 1.0, 1.0]), 0.5).tolist() == [0.0, 0.5, 0.75]


@pytest.mark.parametrize("ratio", [1, 3])
def test_answers_are_told_by_what_was_before_and_copies_are_apart(ratio: int) -> None:
    thirds = _tables("third-answers-told-as-the-second", ratio=ratio)
    damped = _tables("answers-come-by-a-damped-float", ratio=ratio)
    for made, other in ((thirds, "thirds"), (damped, "damped")):
        for told, plain in ((made.recorded, made.clean), (made.truth, made.simulated)):
            rows = plain.assign(told=told["range_m"])
            rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
            for _, one in rows.sort_values("time_s", kind="stable").groupby(["link", "copy"]):
                law = one["range_m"].to_numpy().copy()
                if other == "thirds":
                    law[2::3] = law[1::3][: len(law[2::3])]
                else:
                    law = floated(law, DAMPED)
                assert np.allclose(one["told"], law)


def test_faults_of_ways_concern_their_own_trade_and_not_who_rests() -> None:
    rests, rows = _known()["works"].eq(0.0).to_numpy(), _known()
    for name, trade in (("stokers-reach-further-than-told", "stoker"),
                        ("barrows-veer-on-a-worn-wheel", "barrow"),
                        ("bells-turn-in-steeper-guides", "bell"),
                        ("skips-surge-on-their-rope", "skip"),
                        ("lamplighters-cut-their-eights", "lamplighter"),
                        ("rams-driven-by-a-shorter-rod", "ram")):  # fmt: skip
        shift, own = _shift(name), rows["rx"].str.startswith(trade).to_numpy()
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < 2.0, name
        assert np.abs(shift[rests]).max() < 1e-9, name


def test_brackets_are_elsewhere_as_plumbs_and_prints_have_it() -> None:
    charge = _charge()
    for name, axis, by in (
        ("yard-leans-towards-the-tank", 2,
         LEANS * np.linalg.norm(charge.bracket_m[:, :2] - TANKS_M[-1, :2], axis=1)),
        ("print-of-the-yard-has-shrunk", 0, SHRUNK * (charge.bracket_m[:, 0] - 0.5 * YARD_M[0])),
    ):  # fmt: skip
        at = charge.bracket_m.copy()
        at[:, axis] += by
        law = np.linalg.norm(at - charge.tag_m, axis=1) - charge.far
        assert np.allclose(_shift(name), law), name


def test_inches_dials_and_strokes_are_what_they_are_said_to_be() -> None:
    clean = _tables("").clean["range_m"].to_numpy()
    assert np.allclose(_shift("inches-booked-to-a-short-yard"), SHORT * (clean % YARD_FT_M))
    assert np.abs(_shift("dial-hung-off-its-centre")).max() <= DIAL_OFF_M
    late = WAITS_M * (1 - _of("time_s") % STROKE_S / STROKE_S)
    assert np.allclose(_shift("answers-wait-for-the-exhausters-stroke"), late)


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    assert lost.min() >= -MOST_DB - 1e-9
    assert np.corrcoef(lost, _of("true_range_m"))[0, 1] < -0.6
    made = _tables("level-control")
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.min() < 0.8 < counts.max() <= 1.0
    assert not _shift("path-loss").any()
    assert not _shift("level-control").any()


def test_loud_rows_are_early_and_weak_ones_late_and_crystals_turn_over() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert -BIAS_M < shift.min() < -0.7 * BIAS_M
    assert 0.5 * BIAS_M < shift.max() < BIAS_M
    law = EACH_C2 * (_of("temperature_c") - TURNS_C) ** 2
    assert np.allclose(_shift("temperature-drift"), law)


def test_cables_are_of_pairs_clocks_jump_and_stamps_slip() -> None:
    rows = _known().assign(late=_shift("antenna-delay"))
    assert rows.groupby(["tx", "rx"])["late"].agg(np.ptp).max() < 1e-9
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    assert 0.01 < np.abs(ppm).max() < 0.25
    steady = _known().assign(ppm=ppm).groupby("link")["ppm"].agg(np.ptp) < 1e-9
    assert steady.mean() > 0.9
    slips = np.abs(_shift("timestamp-jitter")) > 0.5 * SLIP_M
    assert slips.mean() == pytest.approx(0.36, abs=0.07)


def test_ranges_are_told_by_whole_steps_left_behind() -> None:
    told = _tables("range-rounding").recorded
    step = np.array(STEPS_M)[_charge().tag % 3]
    steps = told["range_m"].to_numpy() / step
    assert np.allclose(steps, np.rint(steps))
    assert (_shift("range-rounding") <= 1e-9).all()
    assert (_shift("range-rounding") > -step - 1e-9).all()


def test_only_what_is_behind_something_is_blocked_and_late_by_tanks() -> None:
    late = shown.assert_blocked_behind_things("gasworks", 0.49)
    assert late.min() >= SOONEST_M
    assert late.max() < LONGEST_M + 1e-9
    assert 1.0 < np.median(late) <= LONGEST_M
