"""What the distillery hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.distillery_effects import (
    BIAS_M,
    CABLE,
    COUNTED_M,
    CUT_C,
    CUT_M,
    FROM_DBM,
    LONGEST_M,
    MOST_DB,
    SOONEST_M,
    STEP_DB,
    STEPS_M,
)
from bench.challenge.families.distillery_faults import (
    DOOR_M,
    DOOR_S,
    HIGH_M,
    LOFT_M,
    MARK_M,
    NAIL_M,
    NARROWS,
    OPEN_S,
    QUEUE_S,
    RISES,
    SAG_M,
    TURN_RAD,
    VAPOUR_M,
    VATTED,
    WET,
    inside_m,
    one_before,
    turn_in_run,
)
from bench.challenge.families.distillery_house import (
    INNER_M,
    LIFTS_BAR,
    LIGHT_M_US,
    RAKE_M,
    STILLS_M,
    TAGS,
    Run,
)
from tests.bench.challenge import shown

_shift = partial(shown.shift_of, "distillery")
_tables = partial(shown.tables_of, "distillery")
_known = partial(shown.known_of, "distillery")
_of = partial(shown.column_of, "distillery")


def _run() -> Run:
    return Run(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("distillery", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        nothing = shown.nothing_of("distillery", 0, mode)
        assert {*world.CAUSES.values()} <= {*nothing.recorded}
    for name, column, sign in (
        ("peat-reek-clings-to-lintels", "reek_ppm", 1),
        ("angels-share-gone-from-casks", "cask_years", -1),
        ("worm-tubs-run-warm", "worm_c", 1), ("barley-swells-in-the-steep", "steep_h", 1),
        ("coppersmiths-stand-close", "smith_m", -1), ("draff-heaped-against-doors", "draff_t", 1),
        ("valve-lifts-at-high-steam", "steam_bar", -1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    reek = _shift("peat-reek-clings-to-lintels") / 0.19
    assert np.allclose(9.0 * reek / (1 - reek), _of("reek_ppm"))
    gone = np.expm1(_shift("angels-share-gone-from-casks") / -0.075)
    assert np.allclose(2.5 * gone, _of("cask_years"))
    assert np.allclose(_shift("worm-tubs-run-warm"), 0.0036 * _of("worm_c"))
    steep = (_shift("barley-swells-in-the-steep") / 0.18) ** 2
    assert np.allclose(60.0 * steep, _of("steep_h"))
    assert np.allclose(_shift("coppersmiths-stand-close") * _of("smith_m") ** 2, 0.098)
    draff = (_shift("draff-heaped-against-doors") / 0.18) ** (1 / 1.7)
    assert np.allclose(9.0 * draff, _of("draff_t"))
    turn = 2 * np.pi * _of("raked_m") / RAKE_M - 0.5
    assert np.allclose(_shift("teeth-of-mash-rakes-pass"), 0.057 * np.sin(turn))
    high = _of("steam_bar") > LIFTS_BAR
    assert 0.2 < high.mean() < 0.8
    assert np.allclose(_shift("valve-lifts-at-high-steam"), -0.092 * high)


def test_froth_is_highest_half_way() -> None:
    shift, hours = _shift("froth-rises-and-falls-in-washbacks"), _of("froth_h")
    assert shift.max() <= 0.17 + 1e-9
    assert abs(hours[shift.argmax()] - 27.0) < 6.0
    assert np.allclose(0.17 - shift, 0.68 * (hours / 54.0 - 0.5) ** 2)


def test_vapour_counts_by_the_way_within_the_still_house() -> None:
    run, part = _run(), (np.arange(4000) + 0.5)[:, None] / 4000
    for tag, lintel, within in zip(
        run.tag_m[::9], run.lintel_m[::9], inside_m(run.tag_m, run.lintel_m)[::9], strict=True
    ):
        at = tag + part * (lintel - tag)
        there = np.ones(4000, bool)
        for axis, (low, high) in enumerate(STILLS_M):
            there &= (at[:, axis] > low) & (at[:, axis] < high)
        assert within == pytest.approx(there.mean() * np.linalg.norm(lintel - tag), abs=0.02)
    law = VAPOUR_M * inside_m(run.tag_m, run.lintel_m) * _of("vapour_pct") / 12.0
    assert np.allclose(_shift("spirit-vapour-fills-the-still-house"), law)


def test_a_door_delays_while_it_is_shut_what_goes_from_hall_to_hall() -> None:
    run, shift = _run(), _shift("door-between-halls-shut-by-turns")
    assert {*np.unique(shift.round(9))} == {0.0, DOOR_M}
    late = shift > 0
    assert (_of("time_s")[late] % DOOR_S > OPEN_S).all()
    sides = [end[late, 0] > INNER_M[0] for end in (run.tag_m, run.lintel_m)]
    assert (sides[0] ^ sides[1]).all()


def test_faults_of_ways_concern_their_own_kind() -> None:
    rests, run = _known()["goes"].eq(0.0).to_numpy(), _run()
    for name, kind, most in (("casks-skid-as-they-roll", "cask", 1.4),
                             ("chains-of-rummagers-fly-out", "rummager", 0.5),
                             ("maltmen-tire-as-they-turn", "maltman", 2.4),
                             ("drays-sway-on-the-setts", "dray", 0.75),
                             ("hoists-bob-on-their-chains", "hoist", 0.56),
                             ("cats-close-in-sooner", "cat", 2.0)):  # fmt: skip
        shift, own = _shift(name), run.of(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        if kind != "rummager":
            assert np.abs(shift[rests]).max() < 1e-9, name


def test_places_queue_behind_all_answers_of_a_run() -> None:
    run = _run()
    turn = turn_in_run(run)
    of_run = run.table["link"].str.extract(r"run (\d+)")[0]
    assert turn.min() == 0.0
    counts = run.table.assign(turn=turn).groupby(of_run)["turn"]
    assert (counts.max() + 1 == counts.size()).all()
    assert np.allclose(_shift("places-queue-behind-answers"), run.draws_away(QUEUE_S * turn))


def _with_lintels_at(off: np.ndarray) -> np.ndarray:
    run = _run()
    return np.asarray(np.linalg.norm(run.lintel_m + off - run.tag_m, axis=1) - run.far)


def test_lintels_are_elsewhere_as_tapes_squares_and_lofts_have_it() -> None:
    at = _run().lintel_m
    off = np.zeros(at.shape)
    off[:, :2] = WET * (at[:, :2] - NAIL_M)
    assert np.allclose(_shift("tape-stretched-when-wet"), _with_lintels_at(off))
    off = np.zeros(at.shape)
    off[:, 2] = LOFT_M * (at[:, 2] > HIGH_M)
    assert np.allclose(_shift("upper-lintels-levelled-from-the-loft"), _with_lintels_at(off))
    part = at[:, 0] / 34.0
    off[:, 2] = -SAG_M * _of("loft_t") / 40.0 * 4 * part * (1 - part)
    assert np.allclose(_shift("loft-bends-under-barley"), _with_lintels_at(off))
    turned = np.array([[1.0, -TURN_RAD], [TURN_RAD, 1.0]])
    off = np.zeros(at.shape)
    off[:, :2] = (at[:, :2] - INNER_M) @ turned.T - (at[:, :2] - INNER_M)
    off[at[:, 1] <= INNER_M[1]] = 0.0
    assert np.allclose(_shift("still-house-laid-out-off-the-square"), _with_lintels_at(off))


def test_answers_overshoot_are_vatted_and_narrowed_as_said() -> None:
    made = _tables("answers-overshoot-by-what-they-rose")
    rise = made.clean.groupby("link")["range_m"].diff().fillna(0.0)
    assert np.allclose(made.recorded["range_m"], made.clean["range_m"] + RISES * rise)
    made = _tables("answers-vatted-over-a-run")
    mean = made.clean["range_m"].groupby(made.clean["link"].str.extract(r"run (\d+)")[0])
    vatted = (1 - VATTED) * made.clean["range_m"] + VATTED * mean.transform("mean")
    assert np.allclose(made.recorded["range_m"], vatted)
    made = _tables("gauge-narrows-past-a-mark")
    past = made.clean["range_m"] > MARK_M
    left = (made.recorded["range_m"] - MARK_M)[past] / (made.clean["range_m"] - MARK_M)[past]
    assert np.allclose(left, 1 - NARROWS)
    assert made.recorded["range_m"][~past].equals(made.clean["range_m"][~past])


def test_the_answer_before_is_that_of_the_same_telling() -> None:
    rows = _tables("").recorded
    often = pd.concat([rows, rows.assign(range_m=rows["range_m"] + 50.0)], ignore_index=True)
    found = one_before(Run(often, 0, np.random.default_rng(0)))
    once = one_before(Run(rows, 0, np.random.default_rng(0)))
    assert np.allclose(found[: len(rows)], once)
    assert np.allclose(found[len(rows) :], once + 50.0)


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    assert lost.min() >= -MOST_DB - 1e-9
    assert np.corrcoef(lost, _of("true_range_m"))[0, 1] < -0.7
    made = _tables("level-control")
    lost = made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]
    notches = lost / -STEP_DB
    assert np.allclose(notches, np.rint(notches))
    assert 3 <= len({*np.rint(notches)}) <= 7
    assert not lost[made.clean["rx_power_dbm"] < FROM_DBM].any()
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.min() < 0.8 < counts.max() <= 1.0
    assert not _shift("path-loss").any()
    assert not _shift("level-control").any()


def test_loud_rows_are_early_and_weak_ones_late() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert shift.min() == pytest.approx(-BIAS_M)
    assert shift.max() > 0.6 * BIAS_M


def test_cables_are_as_long_as_they_go_along_and_across() -> None:
    run, shift = _run(), _shift("antenna-delay")
    cable = CABLE * np.abs(run.lintel_m - COUNTED_M).sum(axis=1)
    rows = _known().assign(left=shift - cable)
    assert rows.groupby(["tx", "rx"])["left"].agg(np.ptp).max() < 1e-9
    assert rows["left"].between(-1e-9, 0.19).all()


def test_clocks_wander_and_crystals_drift_the_faster_the_farther_off() -> None:
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    assert 0.01 < np.abs(ppm).max() < 0.16
    links = _known().assign(ppm=ppm).groupby("link")["ppm"]
    assert links.agg(np.ptp).max() < 1e-3
    shift, warm = _shift("temperature-drift"), _of("temperature_c")
    assert (np.sign(shift) == np.sign(warm - CUT_C)).all()
    assert (np.diff(shift[np.argsort(warm)]) >= -1e-12).all()
    assert np.abs(shift).max() < 1.2 * CUT_M


def test_ranges_are_told_in_steps_of_tags() -> None:
    told = _tables("range-rounding").recorded
    step = np.array(STEPS_M)[[TAGS.index(tag) % 2 for tag in told["tx"]]]
    steps = told["range_m"].to_numpy() / step
    assert np.allclose(steps, np.rint(steps))
    assert (np.abs(_shift("range-rounding")) <= 0.5 * step + 1e-9).all()


def test_only_what_is_behind_something_is_blocked_and_late_by_pots() -> None:
    late = shown.assert_blocked_behind_things("distillery", 0.5)
    assert late.min() >= SOONEST_M
    assert late.max() < LONGEST_M + 1e-9
    assert 1.0 < np.median(late) < LONGEST_M + 1e-9
