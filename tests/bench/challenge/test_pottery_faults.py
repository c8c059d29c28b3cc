"""What the pottery hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.pottery_effects import (
    EXCESS_M,
    FARTHEST,
    LAPLACE_M,
    LONG_M,
    LOT,
    SHORT_M,
    STEPS_M,
    TABLE_M,
    damped,
    edge_db,
    round_racks,
    slabbed,
)
from bench.challenge.families.pottery_faults import (
    BOARD_M,
    CREEPS_M,
    DRAGS,
    DRAWN,
    FALL,
    FILED,
    FILLED_M,
    FILLS_S,
    GIVES_M,
    JOINT_M,
    LEVER_M,
    MEALS_S,
    SLOW_M,
    SLOW_S,
    STAYS_S,
    WORN_M,
    WORN_OVER_M,
    bulged,
    by_the_kiln_m,
    in_glaze_m,
    stayed,
)
from bench.challenge.families.pottery_floor import (
    DAY_S,
    GLAZE_X,
    KILN_M,
    PURLINS_M,
    WORKS_M,
    Firing,
)
from tests.bench.challenge import shown

_shift = partial(shown.shift_of, "pottery")
_tables = partial(shown.tables_of, "pottery")
_known = partial(shown.known_of, "pottery")
_of = partial(shown.column_of, "pottery")


def _firing() -> Firing:
    return Firing(_known(), 0, np.random.default_rng(0))


def test_causes_are_of_what_is_hidden_and_laws_grow_or_fall_by_theirs() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("pottery", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
    assert {*world.CAUSES.values()} <= {*_tables("").recorded}
    for name, column, sign in (
        ("slip-cakes-on-aerials-until-it-falls", "slip_g", 1),
        ("soot-settles-on-purlins-since-swept", "swept_h", 1),
        ("glaze-runs-down-over-tags", "glaze_um", 1),
        ("weak-draught-lets-smoke-linger", "draught_pa", -1),
        ("rack-truck-parked-beside", "rack_m", -1),
        ("elements-load-the-mains", "load_ka", 1),
        ("lid-of-the-clay-silo-shuts", "clay_t", -1),
    ):
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name
        assert np.ptp(_shift(name)) > 0.05, name


def test_ways_in_the_glaze_shop_and_by_the_kiln_are_what_their_points_say() -> None:
    firing, part = _firing(), (np.arange(4000) + 0.5)[:, None] / 4000
    inside = in_glaze_m(firing.tag_m, firing.purlin_m)
    near = by_the_kiln_m(firing.tag_m, firing.purlin_m)
    for k in range(0, firing.rows, 23):
        at = firing.tag_m[k] + part * (firing.purlin_m[k] - firing.tag_m[k])
        assert inside[k] == pytest.approx((at[:, 0] > GLAZE_X).mean() * firing.far[k], abs=0.03)
        off = np.hypot(at[:, 0] - KILN_M[0], at[:, 1] - KILN_M[1]).min() - KILN_M[2]
        assert near[k] == pytest.approx(max(off, 0.0), abs=0.05)


def test_heat_stays_and_fades_and_mains_and_meals_go_by_the_clock() -> None:
    left = stayed(np.array([0.0, STAYS_S, 2 * STAYS_S]), np.array([100.0, 10.0, 7.0]))
    assert np.allclose(left, [0.0, 100 / np.e, 100 / np.e**2 + 10 / np.e])
    when = _of("time_s")
    assert np.allclose(_shift("slip-main-fills-and-empties"), FILLED_M * (when % FILLS_S) / FILLS_S)
    since = when - np.array(MEALS_S)[np.searchsorted(MEALS_S, when, side="right") - 1]
    law = SLOW_M * np.maximum(1 - since / SLOW_S, 0.0)
    assert np.allclose(_shift("answers-slow-after-each-meal"), law)


def test_faults_of_ways_concern_their_own_trade_and_not_who_rests() -> None:
    rests, rows = _known()["stirs"].eq(0.0).to_numpy(), _known()
    for name, trade in (("boards-turned-tighter-than-told", "board"),
                        ("trucks-roll-on-on-oiled-axles", "truck"),
                        ("fettlers-step-further-out-each-round", "fettler"),
                        ("paddles-geared-by-another-pinion", "pug"),
                        ("saggars-slip-on-a-greasy-rope", "saggar"),
                        ("dippers-reach-further-across", "dipper")):  # fmt: skip
        shift = _shift(name)
        own = rows["tx"].str.rstrip("0123456789").eq(trade).to_numpy()
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < 2.5, name
        assert np.abs(shift[rests]).max() < 1e-9, name
    for name in ("tags-told-where-their-bearers-walk", "answers-drawn-to-their-links-mean"):
        assert np.abs(_shift(name)[rests]).max() < (1e-9 if "tags" in name else 0.05)
    assert np.abs(_shift("tags-told-where-their-bearers-walk")).max() <= LEVER_M + 1e-9


def test_ends_are_elsewhere_as_plans_floors_boards_and_beams_have_it() -> None:
    firing, up = _firing(), np.array([0.0, 0.0, 1.0])
    down = FALL * (PURLINS_M[:, 1] - 0.25 * WORKS_M[1])
    creeps = CREEPS_M * np.sqrt(_of("time_s") / DAY_S)
    for name, off in (
        ("plan-photographed-by-a-bulging-lens", bulged(PURLINS_M)[firing.purlin]),
        ("heights-levelled-from-a-falling-floor", -np.outer(down, up)[firing.purlin]),
        ("beams-creep-down-through-the-day", -np.outer(creeps, up)),
        ("tags-ride-up-on-stacked-boards", -np.outer(BOARD_M * _of("boards_n"), up)),
    ):
        law = np.linalg.norm(firing.purlin_m + off - firing.tag_m, axis=1) - firing.far
        assert np.allclose(_shift(name), law), name
    middle = np.array([[0.5 * WORKS_M[0], 0.5 * WORKS_M[1], 1.0]])
    assert np.allclose(bulged(middle), 0.0)


def test_rules_are_what_they_are_said_to_be() -> None:
    clean = _tables("").clean["range_m"].to_numpy()
    joints = np.floor(clean / JOINT_M)
    assert np.allclose(_shift("folding-rule-gives-at-each-joint"), GIVES_M * joints)
    assert np.allclose(_shift("worn-end-of-the-rule"), -WORN_M * np.exp(-clean / WORN_OVER_M))


@pytest.mark.parametrize("ratio", [1, 3])
def test_answers_are_filed_and_drawn_by_links_and_copies_are_apart(ratio: int) -> None:
    for name, part in (("answers-filed-shortest-first", FILED),
                       ("answers-drawn-to-their-links-mean", DRAWN)):  # fmt: skip
        made = _tables(name, ratio=ratio)
        for told, plain in ((made.recorded, made.clean), (made.truth, made.simulated)):
            assert plain is not None
            rows = plain.assign(told=told["range_m"])
            rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
            for _, one in rows.sort_values("time_s", kind="stable").groupby(["link", "copy"]):
                clean = one["range_m"].to_numpy()
                goal = np.sort(clean) if part == FILED else clean.mean()
                assert np.allclose(one["told"], clean + part * (goal - clean))


def test_the_loudest_of_a_round_is_told_as_it_is_and_drags_all_others() -> None:
    name = "loudest-answer-of-a-round-drags-the-rest"
    rows = _tables(name).clean.assign(shift=_shift(name))
    for _, one in rows.groupby(rows["link"].str.rpartition(" at ")[0]):
        loud = one.loc[one["rx_power_dbm"].idxmax()]
        assert loud["shift"] == pytest.approx(0.0, abs=1e-12)
        assert np.allclose(one["shift"], DRAGS * (loud["range_m"] - one["range_m"]))


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    assert lost.max() < -0.5
    assert np.corrcoef(lost, _of("true_range_m"))[0, 1] < -0.6
    made = _tables("level-control")
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.min() < 0.85 < counts.max() <= 1.0
    made = _tables("noise-floor")
    louder = made.recorded["noise_std"] / made.clean["noise_std"]
    assert louder.min() >= 1.0
    assert np.corrcoef(np.log(louder), _of("kiln_kw"))[0, 1] > 0.6


def test_loud_rows_are_early_stubs_are_of_pairs_and_lots_are_as_fast() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert np.abs(shift).max() <= max(np.abs(TABLE_M)) + 1e-12
    rows = _known().assign(late=_shift("antenna-delay"))
    assert rows.groupby(["tx", "rx"])["late"].agg(np.ptp).max() < 1e-9
    fast = _shift("range-scale") / _of("true_range_m")
    assert rows.assign(fast=fast).groupby(_firing().purlin // LOT)["fast"].agg(np.ptp).max() < 1e-9
    assert np.abs(_shift("timestamp-jitter")).max() <= LAPLACE_M * FARTHEST + 1e-9
    warm = _of("temperature_c")
    late = _shift("temperature-drift")[np.argsort(warm)]
    assert (np.diff(late) >= -1e-12).all()


def test_ranges_are_told_as_steps_before_or_after() -> None:
    told = _tables("range-rounding").recorded["range_m"].to_numpy()
    wide = np.array(STEPS_M)[_firing().purlin % 3]
    assert np.allclose(told / wide, np.rint(told / wide))
    assert (np.abs(_shift("range-rounding")) <= wide + 1e-9).all()
    assert (np.abs(_shift("range-rounding")) > 0.5 * wide + 1e-9).any()


def test_only_what_is_behind_something_is_blocked_and_late() -> None:
    late = shown.assert_blocked_behind_things("pottery", SHORT_M - 1e-9)
    assert late.max() < LONG_M + 1e-9
    assert EXCESS_M > 0


def test_edges_racks_and_slabs_are_as_books_have_them() -> None:
    made = edge_db(np.array([-1.5, 0.0, 1.0, 3.0]))
    assert np.allclose(made, [0.0, 6.02, 14.27, 22.5], atol=0.05)
    bends = edge_db(np.linspace(-0.9, 5.0, 500))
    assert (np.diff(bends) > -0.8).all()  # where one part of his formula gives way to the next
    assert damped(4.0, np.zeros(1))[0] == pytest.approx(4.0)
    assert damped(4.0, np.ones(1))[0] == pytest.approx(79.0)
    assert slabbed(np.ones(1), np.full(1, 4.0), np.zeros(1))[0] == pytest.approx(1.0)
    longer, lost = round_racks(np.full(2, 12.0), np.full(2, 0.5),
                               np.array([[1e-6, 1.0], [1e-6, 2.0]]))  # fmt: skip
    assert longer[0] == pytest.approx(0.0)
    assert longer[1] == pytest.approx(2 * np.hypot(6.0, 1.0) - 12.0)
    assert lost[0] == pytest.approx(3.01, abs=0.05)
    assert lost[1] > 12.0
