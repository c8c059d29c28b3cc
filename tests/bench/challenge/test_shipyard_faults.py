"""What the shipyard hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import Draw, world_of
from bench.challenge.families.shipyard_effects import (
    ASIDE_M,
    BASES_M,
    COMBS_M,
    SHORT_M,
    aside_m,
    at_either,
    off_tanks,
)
from bench.challenge.families.shipyard_faults import (
    KEEL_M,
    LEEWAY,
    LISTS_RAD,
    MIST,
    RAKE,
    RIDES,
    in_mist,
    listed_m,
)
from bench.challenge.families.shipyard_slip import (
    AFLOAT,
    AFLOAT_M,
    DOCK_M,
    ON_DECK,
    PPM_MS_M,
    RIB_M,
    TANKS_M,
    Berth,
)
from tests.bench.challenge import shown

_nothing = partial(shown.nothing_of, "shipyard")
_shift = partial(shown.shift_of, "shipyard")
_tables = partial(shown.tables_of, "shipyard")
_rows = partial(shown.rows_of, "shipyard")
_known = partial(shown.known_of, "shipyard")
_of = partial(shown.column_of, "shipyard")


def _berth() -> Berth:
    return Berth(_known(), 0, np.random.default_rng(0))


def test_causes_have_columns_and_what_has_one_acts_by_it() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("shipyard", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
        assert {*world.CAUSES.values()} <= {*_nothing(0, mode).recorded}
    for name, column, sign in (
        ("salt-crusts-on-covers", "salt_g", 1), ("weed-grows-on-fenders", "weed_cm", 1),
        ("shackles-heaped-beside", "shackles", 1), ("caisson-floats-at-a-draught", "draught_m", 1),
        ("anvil-dragged-close-by", "anvil_gap_m", -1),
        ("caulking-dries-since-wetted", "wetted_h", -1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name


def test_laws_of_one_column_are_what_they_are_said_to_be() -> None:
    salt = _shift("salt-crusts-on-covers") / 0.19
    assert np.allclose(salt / np.sqrt(1 - salt**2), _of("salt_g") / 5.0)
    weed = np.log(_shift("weed-grows-on-fenders") / 0.165)
    assert np.allclose(weed, 0.55 * np.log(_of("weed_cm") / 20.0))
    anvil = _shift("anvil-dragged-close-by") ** 2 * _of("anvil_gap_m") ** 3
    assert np.allclose(anvil, 0.125**2)
    wet = np.expm1(_shift("caulking-dries-since-wetted") / -0.047)
    assert np.allclose(wet, _of("wetted_h") / 0.45)
    assert np.allclose(_shift("shackles-heaped-beside"), 0.0098 * _of("shackles"))
    turn = 2 * np.pi * _of("keel_m") / RIB_M + 0.4
    assert np.allclose(_shift("ribs-of-the-hull-pass"), 0.06 * np.sin(turn))
    assert np.allclose(_shift("caisson-floats-at-a-draught"), 0.098 * (_of("draught_m") > AFLOAT_M))


def test_mist_is_on_what_part_of_the_way_it_lies() -> None:
    low, high = np.array([1.0, 1.0, 1.0, 5.0]), np.array([5.0, 5.0, 5.0, 1.0])
    part = in_mist(low, high, np.array([0.5, 2.0, 9.0, 2.0]))
    assert np.allclose(part, [0.0, 0.25, 1.0, 0.25])
    berth, steps = _berth(), (np.arange(2000) + 0.5) / 2000
    up = berth.tag_m[:, 2:] + steps * (berth.top_m - berth.tag_m)[:, 2:]
    below = (up < _of("fog_m")[:, None]).mean(axis=1)
    assert np.allclose(_shift("mist-lies-up-to-a-height"), MIST * berth.far * below, atol=2e-4)


def test_faults_of_ways_concern_their_own_kind_and_are_as_large_as_is_said() -> None:
    rests, berth = _known()["goes"].eq(0.0).to_numpy(), _berth()
    for name, kind, most in (("grease-stiffens-on-the-ways", "cradle", 1.6),
                             ("drums-roll-on-thinner-flanges", "drum", 1.8),
                             ("punts-make-leeway", "punt", 1.0)):  # fmt: skip
        shift, own = _shift(name), berth.of(kind)
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < most, name
        assert np.abs(shift[rests]).max() < 1e-9
    gone_s = berth.course["goes"] * berth.course["into_s"]
    most_m = np.linalg.norm(LEEWAY) * gone_s + 1e-9
    assert (np.abs(_shift("punts-make-leeway")) <= most_m).all()


def test_the_pontoon_and_its_derricks_ride_up_and_down_by_a_part_of_the_tide() -> None:
    berth, shift = _berth(), _shift("pontoon-rides-the-tide")
    afloat = np.isin(berth.derrick, AFLOAT)
    assert not shift[~afloat].any()
    up = RIDES * (_of("tide_m") - 2.7)
    flat = np.linalg.norm((berth.top_m - berth.tag_m)[:, :2], axis=1)
    rise = (berth.top_m - berth.tag_m)[:, 2]
    assert np.allclose((berth.far + shift)[afloat], np.hypot(flat, rise + up)[afloat])


def test_the_hull_lists_about_its_keel_and_keeps_its_shape() -> None:
    at = np.array([[3.0, 19.0, 8.5], [9.0, 25.0, 2.0]])
    turned = at + listed_m(at, np.array([0.3, 0.3]))
    arms = [np.hypot(one[:, 1] - KEEL_M[0], one[:, 2] - KEEL_M[1]) for one in (at, turned)]
    assert np.allclose(arms[0], arms[1])
    assert np.linalg.norm(turned[1] - turned[0]) == pytest.approx(np.linalg.norm(at[1] - at[0]))
    assert turned[0, 1] < 19.0
    berth, shift = _berth(), _shift("hull-lists-with-its-ballast")
    on_deck = np.isin(berth.derrick, ON_DECK)
    assert not shift[~on_deck].any()
    toward = (berth.tag_m[:, 1] - 19.0) * np.sign(_of("ballast_t"))
    aside = on_deck & (np.abs(toward) > 8.0) & (np.abs(_of("ballast_t")) > 15.0)
    assert aside.sum() > 10
    assert (np.sign(shift[aside]) == np.sign(toward[aside])).all()
    assert np.abs(shift).max() < 1.1 * LISTS_RAD * (8.9 - KEEL_M[1])


def test_heights_above_a_raking_keel_are_wrong_by_how_far_along_it_they_are() -> None:
    berth, shift = _berth(), _shift("heights-told-above-a-raking-keel")
    up = RAKE * (berth.top_m[:, 0] - 33.0)
    flat = np.linalg.norm((berth.top_m - berth.tag_m)[:, :2], axis=1)
    rise = (berth.top_m - berth.tag_m)[:, 2]
    assert np.allclose(berth.far + shift, np.hypot(flat, rise + up))
    assert np.abs(up).max() < 1.0


def test_medians_are_of_three_in_a_row_of_a_link_and_some_are_sent() -> None:
    name = "medians-of-three-sent"
    for strength, part in ((1.0, 0.45), (2.0, 0.9)):
        made, shift = _tables(name, strength), _shift(name, strength)
        links = made.clean.groupby("link", sort=False)["range_m"]
        three = np.column_stack([links.shift(k) for k in range(3)])
        middle = np.median(three, axis=1)
        sent = np.abs(shift) > 1e-12
        assert np.allclose(made.recorded["range_m"][sent], middle[sent])
        could = np.isfinite(middle) & (np.abs(middle - made.clean["range_m"]) > 1e-9)
        assert sent[could].mean() == pytest.approx(part, abs=0.08)
        assert not sent[~could].any()
    world: Any = world_of("shipyard")
    truth = world.tables(Draw((name,), ratio=3), 9)
    moved = (truth.truth["error_m"] - truth.simulated["error_m"]).abs()
    assert moved.max() < 6.0  # no row has those of another link before it


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
    assert np.corrcoef(lost, np.exp(-_of("true_range_m") / 27.0))[0, 1] > 0.6


def test_loud_rows_are_early_and_weak_ones_late() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    order = np.argsort(level)
    assert (np.diff(shift[order]) <= 1e-12).all()
    assert np.allclose(np.sinh(shift / 0.031), (-87.0 - level) / 3.6)
    assert shift.min() < -0.03 < 0.03 < shift.max()


def test_clocks_count_by_ppm_and_by_how_long_replies_take() -> None:
    ppm = _shift("clock-offset") / (PPM_MS_M * 1e3 * _of("reply_time_s"))
    rows = _rows().assign(ppm=ppm)
    assert np.abs(ppm).max() < 0.15
    for _, one in rows.groupby(["tx", "rx"]):
        if len(one) > 4 and np.ptp(one["time_s"]) < 60:
            assert np.ptp(one["ppm"]) < 1e-3


def test_scales_are_one_over_bases() -> None:
    part = _shift("range-scale") / _of("true_range_m")
    by = pd.Series(part).groupby(_berth().derrick).agg(["mean", np.ptp])
    assert by["ptp"].max() < 1e-12
    assert (SHORT_M / by["mean"]).between(*BASES_M).all()
    assert by["mean"].nunique() == len(by)


def test_ranges_are_read_at_marks_of_either_of_two_scales() -> None:
    ranges = _tables("range-rounding").recorded["range_m"].to_numpy()
    off = [np.abs(ranges / comb - np.rint(ranges / comb)) * comb for comb in COMBS_M]
    assert np.minimum(*off).max() < 1e-6
    assert (off[0] > 1e-3).mean() > 0.2
    assert (off[1] > 1e-3).mean() > 0.3
    assert np.abs(_shift("range-rounding")).max() <= COMBS_M[0] / 2 + 1e-9
    made = at_either(np.array([4.4, 5.1, 6.3, 7.4]), (2.0, 3.0))
    assert np.allclose(made, [4.0, 6.0, 6.0, 8.0])


def test_only_what_is_behind_something_is_blocked_and_by_the_soonest_way_there_is() -> None:
    late = shown.assert_blocked_behind_things("shipyard", 0.5)
    assert late.max() < 6.0 + 1e-9
    berth = _berth()
    longer = off_tanks(berth)
    flat = np.linalg.norm((berth.top_m - berth.tag_m)[:, :2], axis=1)
    roof = np.hypot(flat, 2 * DOCK_M[2] - berth.tag_m[:, 2] - berth.top_m[:, 2])
    assert (longer > 0.0).all()
    assert (longer <= roof - berth.far + 1e-9).all()
    beside = np.min([aside_m(berth, ball) for ball in TANKS_M], axis=0)
    assert (beside < ASIDE_M).any()
    assert (longer < roof - berth.far - 0.1).mean() > 0.5
