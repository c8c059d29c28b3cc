"""The generator families: deterministic, of the stated mix, and really hiding what they say."""

from __future__ import annotations

from collections import Counter
from dataclasses import replace
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.cases import drawn_of, make_case
from bench.challenge.families.case import (
    KEPT,
    MODES,
    RATIOS,
    SCHEDULE,
    Draw,
    decoyed,
    draw,
    mapped,
    turn_of,
    world_of,
)
from bench.physics.simulator import Simulator
from bench.recordings.clean import clean

WITH_BOTH = (
    "garage",
    "manege", "opera", "brickworks", "roundhouse",
    "aviary", "sawmill", "laundry", "bowls", "canal", "saltworks", "observatory", "baths",
    "circus", "colliery", "granary", "icerink", "breadworks", "shipyard",
    "ropewalk", "planetarium", "cathedral", "distillery", "mint", "watermill",
    "gasworks", "lighthouse", "tramshed", "pottery",
)  # fmt: skip
"""Those with ranges and with waveforms."""
NEW = (*WITH_BOTH, *(f"{name}_waves" for name in WITH_BOTH))
OWN = NEW  # own simulators
LATER = NEW


def _world(name: str) -> Any:
    """Return a family's module; `<family>_waves` is that for modes with waveforms."""
    family, _, waves = name.partition("_")
    return world_of(family, "CIR" if waves else "ranges")


def test_an_unknown_family_is_named() -> None:
    with pytest.raises(
        ValueError,
        match="unknown family 'x'; known: aviary, baths, bowls, breadworks",
    ):
        world_of("x")


def test_turns_number_every_mode_and_family_by_itself() -> None:
    turns = [turn_of(number) for number in range(360)]
    counts = Counter((turn.mode, turn.family) for turn in turns)
    assert set(counts) == set(SCHEDULE)
    for (mode, family), count in counts.items():
        own = [t.number for t in turns if (t.mode, t.family) == (mode, family)]
        assert own == list(range(count))
    assert {turn.family for turn in (turn_of(n, ("mint",)) for n in range(9))} == {"mint"}


def test_any_first_part_holds_all_modes_and_two_ninths_are_of_the_kept() -> None:
    turns = [turn_of(number) for number in range(360)]
    assert Counter(turn.mode for turn in turns) == dict.fromkeys(MODES, 90)
    assert {turn.family for turn in turns[:35]} == {turn.family for turn in turns}
    assert {turn.mode for turn in turns[:4]} == set(MODES)
    for part in (20, 100, 360):
        kept = [turn for turn in turns[:part] if turn.family in KEPT]
        assert len(kept) == pytest.approx(2 * part / 9, abs=1)
        assert len({turn.mode for turn in kept}) == 4


@pytest.mark.parametrize("family", OWN)
def test_of_twenty_cases_five_are_empty_and_four_outside(family: str) -> None:
    world = _world(family)
    turns = [t for t in map(turn_of, range(360)) if t.family == family.partition("_")[0]][:20]
    first = next((turn for turn in turns if not turn.mode.endswith("again")), turns[0])
    some = [replace(first, number=n) for n in range(40)]
    drawn = [draw(turn, 1, world.KNOWN, tuple(world.LAWS), world.RARELY) for turn in some]
    assert sum(not one.hidden for one in drawn) == 10
    assert sum(bool(set(one.hidden) & set(world.LAWS)) for one in drawn) == 8
    assert {one.ratio for one in drawn} == set(RATIOS)
    assert {len(one.hidden) for one in drawn} == {0, 1, 2, 3}
    assert sum(not one.same_mix for one in drawn) == 5 * (not first.mode.endswith("again"))


@pytest.mark.parametrize("family", OWN)
def test_tables_are_in_the_exchange_form_and_deterministic(family: str) -> None:
    world = _world(family)
    drawn = Draw((world.KNOWN[0],), 1.0, 1, paired=False)
    made, again = world.tables(drawn, 3), world.tables(drawn, 3)
    assert made.recorded["range_m"].equals(again.recorded["range_m"])
    assert not made.recorded["range_m"].equals(world.tables(drawn, 4).recorded["range_m"])
    for table in (made.recorded, made.simulated, made.truth):
        assert np.allclose(table["error_m"], table["range_m"] - table["true_range_m"])
        assert not clean(table, family).dropped
    assert not set(made.recorded["link"]) & set(made.simulated["link"])


@pytest.mark.parametrize("family", [name for name in OWN if not name.endswith("_waves")])
def test_what_is_hidden_is_all_that_differs_from_the_clean_rows(family: str) -> None:
    world = _world(family)
    plain = world.tables(Draw(ratio=1), 5)
    assert np.allclose(plain.recorded["error_m"], plain.clean["error_m"])
    for name in (*world.KNOWN, *world.LAWS):
        made = world.tables(Draw((name,), 2.0, 1), 5)
        assert _moved(made.clean, made.recorded) > 0.004, name
        assert made.clean["range_m"].equals(plain.clean["range_m"]), name
        if made.shifts_m is not None:
            change = made.recorded["error_m"] - made.clean["error_m"]
            assert np.allclose(change, made.shifts_m.sum(axis=0)), name


@pytest.mark.parametrize("family", [name for name in OWN if name.endswith("_waves")])
def test_all_that_waveforms_can_hide_moves_something_and_leaves_the_clean_rows(family: str) -> None:
    world = _world(family)
    wide = world.received(world.known(Draw(), 5), np.random.default_rng(5))
    plain = world.recorded(wide)
    for name in (*world.KNOWN, *world.LAWS):
        found = world.recorded(world.conceal(wide, Draw((name,), 2.0), 5))
        assert _moved(plain, found) > 0.004, name
        assert np.allclose(found["error_m"], found["range_m"] - found["true_range_m"])
        assert not clean(found, family).dropped, name
    assert world.recorded(wide)["range_m"].equals(plain["range_m"])


def _moved(clean_rows: pd.DataFrame, recorded: pd.DataFrame) -> float:
    """Return the largest mean change of an observable."""
    names = ("error_m", "rx_power_dbm", "noise_std", "preamble_count")
    seen = [name for name in names if name in recorded]
    largest = max(float(np.abs(recorded[n] - clean_rows[n]).mean()) for n in seen)
    if "cir" not in recorded:
        return largest
    cirs = (np.stack(list(table["cir"])) for table in (recorded, clean_rows))
    return max(largest, float(np.abs(np.subtract(*cirs)).mean()) / 1000)


def test_devices_keep_their_values_in_the_true_table() -> None:
    mint = _world("mint")
    made = mint.tables(Draw(("antenna-delay",), 4.0, 1), 5)
    means = [t.groupby(["tx", "rx"])["error_m"].mean() for t in (made.recorded, made.truth)]
    assert float((means[0] - means[1]).abs().median()) < 0.03
    assert float(means[0].std()) > 0.1


RARE = [(family, name) for family in WITH_BOTH for name in _world(family).RARELY]


@pytest.mark.parametrize(("family", "name"), RARE)
def test_a_rare_cause_touches_few_rows(family: str, name: str) -> None:
    made = _world(family).tables(Draw((name,), 1.0, 1, concealed="sparse"), 3)
    shift = np.abs(made.shifts_m[0])
    assert 0 < np.mean(shift > 0.02) <= 0.15


def test_aggregates_equal_the_simulators_and_decoys_correlate() -> None:
    mint = _world("mint")
    made = mint.tables(Draw(("temperature-drift",), 2.0, 1), 3)
    out = mapped(made)
    assert np.allclose(np.sort(out.recorded["error_m"]), np.sort(out.clean["error_m"]))
    column = decoyed(made, ("temperature-drift",), mint.CAUSES, 3).recorded
    seen = np.corrcoef(column["sensor_0"], column["temperature_c"])[0, 1]
    assert seen == pytest.approx(0.8, abs=0.06)


@pytest.mark.parametrize("family", LATER)
def test_without_obstacles_no_table_lists_them_and_the_rows_are_the_same(family: str) -> None:
    listed, not_listed = (
        _world(family).tables(Draw(("material-delay",), 1.0, 1, listed=one), 5)
        for one in (True, False)
    )
    for table in (not_listed.recorded, not_listed.clean, not_listed.simulated, not_listed.truth):
        assert "obstacles" not in table
    assert {*map(len, listed.simulated["obstacles"])} >= {0, 1}
    assert listed.recorded["range_m"].equals(not_listed.recorded["range_m"])


@pytest.mark.parametrize("family", LATER)
def test_nothing_hidden_tables_are_draws_of_one_process(family: str) -> None:
    made = _world(family).tables(Draw(ratio=1), 5)
    links = made.recorded["link"].nunique()
    for name in ("error_m", "rx_power_dbm", "first_path_power_dbm"):
        most = 3 * made.simulated[name].std() * np.sqrt(2 / links)
        means = [float(table[name].mean()) for table in (made.recorded, made.simulated)]
        assert abs(means[0] - means[1]) < most, name
        assert not made.recorded[name].equals(made.simulated[name])


@pytest.mark.parametrize("family", WITH_BOTH)
def test_the_radial_speed_that_moves_rows_is_that_of_the_positions(family: str) -> None:
    rows = _world(family).known(Draw(), 5)
    lag = _world(family).tables(Draw(("time-lag",), 1.0, 1), 5)
    assert {*rows} - {*lag.recorded} == {*rows} - {*lag.truth} > set()  # what makes them is hidden
    links = rows[rows.groupby("link")["link"].transform("size") > 1].groupby("link")
    derived = np.concatenate([np.gradient(one["true_range_m"], one["time_s"]) for _, one in links])
    order = np.concatenate([one.index for _, one in links])
    assert abs(np.corrcoef(derived, lag.shifts_m[0][order])[0, 1]) > 0.95


@pytest.mark.parametrize("family", [f"{name}_waves" for name in WITH_BOTH])
@pytest.mark.parametrize("name", ["noise-floor", "narrowband-interference", "quantisation"])
def test_reported_noise_is_that_of_the_samples(family: str, name: str) -> None:
    made = _world(family).tables(Draw((name,), 2.0, 1), 5)
    both = (made.recorded, made.clean)
    quiet = [np.stack(list(t["cir"]))[:, :5].var(axis=1, ddof=1).mean() for t in both]
    reported = [(t["noise_std"] ** 2).mean() for t in both]
    assert reported[0] / reported[1] == pytest.approx(quiet[0] / quiet[1], rel=0.35)


@pytest.mark.parametrize("family", KEPT)
def test_an_empty_case_run_again_has_the_waveforms_of_the_clean_rows(family: str) -> None:
    number = next(n for n in range(20) if turn_of(n, (family,)).mode == "CIR again")
    case = make_case(number, 5, (family,))
    assert (case.drawn.hidden, case.strength_z) == ((), 0)
    cirs = [np.stack(list(table["cir"])) for table in (case.recorded.frame, case.clean)]
    assert np.array_equal(*cirs)


@pytest.mark.parametrize("mode", ["ranges again", "CIR again"])
@pytest.mark.parametrize("family", KEPT)
def test_the_kept_run_again_in_both_modes(mode: str, family: str) -> None:
    number = next(n for n in range(20) if turn_of(n, (family,)).mode == mode)
    case = make_case(number, 2, (family,))
    assert isinstance(case.simulated, Simulator)
    assert case.recorded.frame["link"].nunique() > 90
    assert set(case.recorded.frame) == set(case.truth.frame)


@pytest.mark.parametrize("family", KEPT)
def test_a_deaf_receiver_loses_weak_first_paths_and_those_of_few_links(family: str) -> None:
    made = _world(f"{family}_waves").tables(Draw(("late-detection",), 2.0, 1), 5)
    later = made.recorded["error_m"] - made.clean["error_m"]
    gap = made.clean["rx_power_dbm"] - made.clean["first_path_power_dbm"]
    assert (later >= -1e-9).all()
    assert 0.02 < (later > 0.3).mean() < 0.5
    assert gap[later > 0.3].mean() > gap[later < 0.01].mean() + 1


@pytest.mark.parametrize("family", KEPT)
def test_the_kept_have_every_mode_and_four_causes_that_no_other_family_has(family: str) -> None:
    assert {mode for mode, one in SCHEDULE if one == family} == set(MODES)
    others = {name for one in OWN if not one.startswith(family) for name in _world(one).LAWS}
    for name in (family, f"{family}_waves"):
        laws = _world(name).LAWS
        own = [law for law in laws if law not in others]
        assert len(own) >= 4
        assert sum("position" in one.forms or "swap" in one.forms for one in laws.values()) == 2


@pytest.mark.parametrize("family", KEPT)
def test_what_leaves_waveforms_alone_is_as_loud_as_the_shape_it_gives_to_ranges(
    family: str,
) -> None:
    alone = Draw(("timestamp-jitter",), 2.0, 1)
    world = world_of(family, "CIR")
    made = world.tables(alone, 5)
    assert all(map(np.array_equal, made.recorded["cir"], made.clean["cir"]))
    number = next(n for n in range(4, 40000) if _ranges_alone(n, family))
    assert make_case(number, 6, (family,)).strength_z > 3


def _ranges_alone(number: int, family: str) -> bool:
    turn, drawn = drawn_of(number, 6, (family,))
    loud = drawn.hidden in (("timestamp-jitter",), ("range-scale",)) and drawn.strength >= 1
    return turn.mode == "CIR" and loud
