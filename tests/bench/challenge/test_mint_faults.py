"""What the mint hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.mint_court import (
    FLUE_C,
    LIGHT_M_US,
    REED_M,
    TAGS,
    WAVE_M,
    Tally,
)
from bench.challenge.families.mint_effects import (
    BIAS_M,
    EVEN_C,
    FLATTER,
    FROM_DBM,
    LONGEST_M,
    MOST_DB,
    SOONEST_M,
    SPUR_M,
    STEPS_M,
)
from bench.challenge.families.mint_faults import (
    ASKEW_RAD,
    BENDS,
    COARSE_M,
    EACH_PA_M,
    FLAT,
    FROM_RAD,
    HUNG,
    LEAF_M,
    LEAKS_M,
    LEVEL_M,
    PASSAGE_M,
    RECOVERS_S,
    RIPPLES,
    SAGS_M,
    STATION_M,
    STRIKES_S,
    STUNS_S,
    caged_m,
    crowded,
    out_of_order,
    slowed,
)
from tests.bench.challenge import shown

_shift = partial(shown.shift_of, "mint")
_tables = partial(shown.tables_of, "mint")
_known = partial(shown.known_of, "mint")
_of = partial(shown.column_of, "mint")
UP = np.array([0.0, 0.0, 1.0])


def _tally() -> Tally:
    return Tally(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("mint", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        nothing = shown.nothing_of("mint", 0, mode)
        assert {*world.CAUSES.values()} <= {*nothing.recorded}
    for name, column, sign in (
        ("gold-dust-settles-on-quoins", "dust_mg", 1), ("strip-is-rolled-thick", "strip_mm", 1),
        ("pickle-fumes-eat-at-covers", "fume_ppm", -1),
        ("borax-creeps-since-fluxed", "fluxed_h", 1), ("coin-hopper-swung-close", "hopper_m", -1),
        ("bullion-piled-before-quoins", "bullion_t", 1),
        ("fan-thrown-in-at-a-hot-flue", "flue_c", 1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    dust = -11.0 * np.log1p(-_shift("gold-dust-settles-on-quoins") / 0.17)
    assert np.allclose(dust, _of("dust_mg"))
    fumes = 4.0 * np.expm1(-_shift("pickle-fumes-eat-at-covers") / 0.07)
    assert np.allclose(fumes, _of("fume_ppm"))
    assert np.allclose(_shift("strip-is-rolled-thick"), 0.021 * _of("strip_mm"))
    borax = 26.0 * (_shift("borax-creeps-since-fluxed") / 0.17) ** 2.5
    assert np.allclose(borax, _of("fluxed_h"))
    assert np.allclose(_shift("coin-hopper-swung-close") * _of("hopper_m") ** 2, 0.088)
    bullion = 6.0 * (_shift("bullion-piled-before-quoins") / 0.2) ** (1 / 1.6)
    assert np.allclose(bullion, _of("bullion_t"))
    part = _of("anneal_min") / 48.0
    assert np.allclose(0.175 - _shift("annealing-reddens-and-pales"), 0.7 * (part - 0.5) ** 2)
    turn = 2 * np.pi * _of("reed_m") / REED_M + 1.1
    assert np.allclose(_shift("ribs-of-reeding-wheels-pass"), 0.059 * np.cos(turn))
    hot = _of("flue_c") > FLUE_C
    assert 0.2 < hot.mean() < 0.8
    assert np.allclose(_shift("fan-thrown-in-at-a-hot-flue"), 0.096 * hot)


def test_cages_count_by_the_way_within_and_how_narrow_they_are() -> None:
    tally, part = _tally(), (np.arange(4000) + 0.5)[:, None] / 4000
    within = caged_m(tally.tag_m, tally.quoin_m)
    for tag, quoin, long_m in zip(tally.tag_m[::9], tally.quoin_m[::9], within[::9], strict=True):
        at = (tag + part * (quoin - tag))[:, :2]
        there = ((at > PASSAGE_M[0]) & (at < PASSAGE_M[1])).all(axis=1)
        assert long_m == pytest.approx(there.mean() * np.linalg.norm(quoin - tag), abs=0.02)
    assert slowed(np.array([1e3]))[0] == pytest.approx(0.0, abs=1e-9)
    assert slowed(np.array([WAVE_M]))[0] == pytest.approx(1 / np.sqrt(0.75) - 1)
    law = within * slowed(_of("gate_cm") / 100)
    assert np.allclose(_shift("caged-passage-guides-what-passes"), law)


def test_seals_leak_by_the_root_of_what_pressures_differ() -> None:
    shift, differ = _shift("seals-leak-by-what-pressures-differ"), _of("vault_pa") - _of("hall_pa")
    assert np.allclose((shift / LEAKS_M) ** 2, np.abs(differ))
    assert (np.sign(shift) == np.sign(differ)).all()


def test_faults_of_ways_concern_their_own_kind() -> None:
    rests, tally = _known()["moving"].eq(0.0).to_numpy(), _tally()
    for name, kind, most in (("presses-swing-further-than-told", "press", 1.0),
                             ("rails-bend-sooner-than-drawn", "truck", 1.5),
                             ("warders-hurry-across", "warder", 2.5),
                             ("coils-spring-open", "coil", 1.1),
                             ("ladles-hang-back-as-they-gain", "ladle", 0.8),
                             ("couriers-cut-across-sooner", "courier", 2.6)):  # fmt: skip
        shift, own = _shift(name), tally.are(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        assert np.abs(shift[rests]).max() < 1e-9, name


def _with_quoins_at(off: np.ndarray) -> np.ndarray:
    tally = _tally()
    return np.asarray(np.linalg.norm(tally.quoin_m + off - tally.tag_m, axis=1) - tally.far)


def test_quoins_are_elsewhere_as_circles_levels_and_doors_have_it() -> None:
    at = _tally().quoin_m
    from_station = at[:, :2] - STATION_M
    askew = ASKEW_RAD * np.sin(np.arctan2(from_station[:, 1], from_station[:, 0]) - FROM_RAD)
    off = np.zeros(at.shape)
    off[:, 0], off[:, 1] = -askew * from_station[:, 1], askew * from_station[:, 0]
    assert np.allclose(_shift("circle-of-the-theodolite-off-centre"), _with_quoins_at(off))
    high = BENDS * ((at[:, :2] - LEVEL_M) ** 2).sum(axis=1)
    assert np.allclose(
        _shift("levels-sighted-over-a-hot-floor"), _with_quoins_at(high[:, None] * UP)
    )
    angle = np.radians(_of("door_deg"))
    leaf = LEAF_M * np.column_stack([np.cos(angle) - 1, np.sin(angle), np.zeros(len(angle))])
    leaf[~np.isin(_tally().quoin, HUNG)] = 0.0
    assert np.allclose(_shift("strongroom-door-swings-its-quoins"), _with_quoins_at(leaf))


def test_tags_are_lower_while_fans_draw() -> None:
    low = EACH_PA_M * _of("fans_pa")[:, None] * UP
    assert np.allclose(_shift("heights-told-by-a-barometer"), _with_quoins_at(low))


def test_smoothed_places_matter_where_ways_bend() -> None:
    rows = _known().assign(shift=_shift("places-smoothed-both-ways"))
    bends, shifts = [], []
    for _, one in rows[rows["moving"] > 0].groupby("link"):
        if len(one) > 5:
            speed = np.gradient(one["true_range_m"], one["time_s"])
            bends.append(np.gradient(speed, one["time_s"])[2:-2])
            shifts.append(one["shift"].to_numpy()[2:-2])
    assert np.corrcoef(np.concatenate(bends), np.concatenate(shifts))[0, 1] < -0.7


def test_batteries_sag_by_answers_that_came_before() -> None:
    tally = _tally()
    own = tally.of_run == 3
    when = np.sort(tally["time_s"][own])
    left = 0.0
    wanted = [left := 0.0]
    for gap in np.diff(when):
        left = (left + 1.0) * np.exp(-gap / RECOVERS_S)
        wanted.append(left)
    order = np.argsort(tally["time_s"][own])
    assert np.allclose(crowded(tally)[own][order], wanted)
    assert np.allclose(_shift("batteries-sag-as-answers-crowd"), SAGS_M * crowded(tally))
    often = Tally(pd.concat([tally.table] * 2, ignore_index=True), 0, np.random.default_rng(0))
    assert np.allclose(crowded(often), np.tile(crowded(tally), 2))


def test_coarse_counts_are_lost_by_those_that_have_just_begun_one() -> None:
    made = _tables("coarse-count-read-before-it-ripples")
    begun = made.clean["range_m"] / COARSE_M % 1.0 < RIPPLES
    assert 0.1 < begun.mean() < 0.35
    lost = made.clean["range_m"] - made.recorded["range_m"]
    assert np.allclose(lost, COARSE_M * begun)


def test_bags_are_opened_the_last_first_and_tellings_are_apart() -> None:
    made = _tables("bags-of-answers-opened-out-of-order")
    for _, one in made.clean.assign(told=made.recorded["range_m"]).groupby("link"):
        put = one.sort_values("time_s")
        for at in range(0, len(put), 2):
            pair = put.iloc[at : at + 2]
            assert np.allclose(pair["told"], pair["range_m"].to_numpy()[::-1])
    often = pd.concat([made.clean, made.clean.assign(range_m=made.clean["range_m"] + 50.0)])
    found = out_of_order(Tally(often.reset_index(drop=True), 0, np.random.default_rng(0)), 2)
    assert np.allclose(found[len(made.clean) :], found[: len(made.clean)] + 50.0)


def test_answers_are_held_while_presses_strike() -> None:
    made = _tables("answers-held-while-presses-strike")
    struck = made.clean["time_s"] % STRIKES_S < STUNS_S
    assert made.recorded["range_m"][~struck].equals(made.clean["range_m"][~struck])
    both = made.clean.assign(told=made.recorded["range_m"], struck=struck).sort_values("time_s")
    for _, one in both.groupby("link"):
        last = np.nan
        for plain, told, held in zip(one["range_m"], one["told"], one["struck"], strict=True):
            last = last if held else plain
            assert told == pytest.approx(plain if np.isnan(last) else last)


def test_heights_are_left_out_in_part() -> None:
    tally = _tally()
    higher = tally.quoin_m[:, 2] - tally.tag_m[:, 2]
    flat = np.sqrt(tally.far**2 - FLAT * higher**2) - tally.far
    assert np.allclose(_shift("ranges-told-along-the-floor"), flat)


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    assert lost.min() >= -MOST_DB - 1e-9
    assert np.corrcoef(lost, np.log(_of("true_range_m")))[0, 1] < -0.7
    made = _tables("level-control")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    over = (made.clean["rx_power_dbm"].to_numpy() - FROM_DBM).clip(0.0, 18.0)
    assert np.allclose(lost, -FLATTER * over)
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.min() < 0.8 < counts.max() <= 1.0
    assert not _shift("path-loss").any()
    assert not _shift("level-control").any()


def test_loud_rows_are_early_and_weak_ones_late() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert -BIAS_M < shift.min() < -0.7 * BIAS_M
    assert 0.7 * BIAS_M < shift.max() < BIAS_M


def test_feeds_are_of_pairs_and_clocks_age() -> None:
    rows = _known().assign(late=_shift("antenna-delay"))
    assert rows.groupby(["tx", "rx"])["late"].agg(np.ptp).max() < 1e-9
    assert rows["late"].between(0.04, 0.33).all()
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    assert 0.01 < np.abs(ppm).max() < 0.09
    assert _known().assign(ppm=ppm).groupby("link")["ppm"].agg(np.ptp).max() < 1e-3


def test_warmth_drifts_ever_less_and_spurs_swing() -> None:
    shift, warm = _shift("temperature-drift"), _of("temperature_c")
    assert (np.sign(shift) == np.sign(warm - EVEN_C)).all()
    assert (np.diff(shift[np.argsort(warm)]) >= -1e-12).all()
    assert np.abs(shift).max() < 0.11
    swing = np.abs(_shift("timestamp-jitter"))
    assert swing.max() <= SPUR_M
    assert (swing > 0.7071 * SPUR_M).mean() == pytest.approx(0.5, abs=0.08)


def test_ranges_are_told_in_steps_of_three_makes() -> None:
    told = _tables("range-rounding").recorded
    step = np.array(STEPS_M)[[TAGS.index(tag) % 3 for tag in told["rx"]]]
    steps = told["range_m"].to_numpy() / step
    assert np.allclose(steps, np.rint(steps))
    assert (np.abs(_shift("range-rounding")) <= 0.5 * step + 1e-9).all()


def test_only_what_is_behind_something_is_blocked_and_late_by_walls() -> None:
    late = shown.assert_blocked_behind_things("mint", 0.5)
    assert late.min() >= SOONEST_M
    assert late.max() < LONGEST_M + 1e-9
    assert 1.0 < np.median(late) < LONGEST_M + 1e-9
