"""What the lighthouse hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.lighthouse_effects import (
    BIAS_M,
    DIVISIONS_M,
    LONGEST_M,
    MOST_DB,
    SOONEST_M,
    SWEPT_M,
    knife_db,
    over_rocks,
    through,
)
from bench.challenge.families.lighthouse_faults import (
    KNOT_M,
    LINE_M2,
    SHEARS,
    STRETCHED,
    TOO_LARGE_M,
    VERNIER_M,
    WRONG,
    in_tower_m,
    stuck,
)
from bench.challenge.families.lighthouse_station import LIGHT_M_US, ROCK_M, TOWER_M, Entries
from tests.bench.challenge import shown

_shift = partial(shown.shift_of, "lighthouse")
_tables = partial(shown.tables_of, "lighthouse")
_known = partial(shown.known_of, "lighthouse")
_of = partial(shown.column_of, "lighthouse")


def _entries() -> Entries:
    return Entries(_known(), 0, np.random.default_rng(0))


def test_causes_are_of_what_is_hidden_and_laws_grow_or_fall_by_theirs() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("lighthouse", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
    assert {*world.CAUSES.values()} <= {*_tables("").recorded}
    for name, column, sign in (
        ("salt-crusts-on-cressets", "salt_g", 1), ("guano-thickens-on-ledges", "guano_mm", 1),
        ("verdigris-creeps-over-lanterns", "green_d", 1),
        ("swell-lifts-before-the-landing", "swell_m", 1),
        ("mercury-of-the-lens-bath-dwindles", "mercury_kg", -1),
        ("boom-of-the-boat-derrick-close", "boom_m", -1),
        ("fog-bells-relay-closes", "sight_km", -1),
    ):  # fmt: skip
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name
        assert np.ptp(_shift(name)) > 0.05, name


def test_ways_in_the_tower_are_as_long_as_their_points_say() -> None:
    entries, part = _entries(), (np.arange(4000) + 0.5)[:, None] / 4000
    within = in_tower_m(entries.tag_m, entries.cresset_m)
    assert (within > 1.0).mean() > 0.05
    for k in range(0, entries.rows, 23):
        at = entries.tag_m[k] + part * (entries.cresset_m[k] - entries.tag_m[k])
        there = np.hypot(*(at[:, :2] - TOWER_M[:2]).T) < TOWER_M[2]
        assert within[k] == pytest.approx(there.mean() * entries.far[k], abs=0.03)


def test_floats_stick_until_what_moves_them_is_far_enough() -> None:
    made = stuck(np.array([0.0, 2.0, 5.0, 4.0, 1.0]), 3.0)
    assert made.tolist() == [0.0, 0.0, 5.0, 5.0, 1.0]


def test_faults_of_ways_concern_their_own_calling_and_not_who_rests() -> None:
    rests, rows = _known()["stirs"].eq(0.0).to_numpy(), _known()
    for name, calling in (("keepers-cut-their-corners", "keeper"),
                          ("tenders-carry-their-way-longer", "tender"),
                          ("gulls-wheel-wider-than-told", "gull"),
                          ("cans-sway-wider-on-the-hoist", "hoist"),
                          ("lenses-stick-twice-a-turn", "lens"),
                          ("donkeys-wind-rope-in-sooner", "donkey")):  # fmt: skip
        shift, own = _shift(name), rows["tx"].str.startswith(calling).to_numpy()
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < 2.5, name
        assert np.abs(shift[rests]).max() < 1e-9, name


def test_cressets_are_elsewhere_as_lines_and_charts_have_it() -> None:
    entries = _entries()
    for name, axis, by in (
        ("heights-sounded-by-a-stretched-line", 2, STRETCHED * entries.cresset_m[:, 2]),
        ("chart-of-the-rock-sheared", 0, SHEARS * (entries.cresset_m[:, 1] - 0.5 * ROCK_M[1])),
    ):  # fmt: skip
        at = entries.cresset_m.copy()
        at[:, axis] += by
        law = np.linalg.norm(at - entries.tag_m, axis=1) - entries.far
        assert np.allclose(_shift(name), law), name


def test_lines_knots_and_verniers_are_what_they_are_said_to_be() -> None:
    clean = _tables("").clean["range_m"].to_numpy()
    assert np.allclose(_shift("heaving-line-stretches-by-its-own-weight"), LINE_M2 * clean**2)
    knots = TOO_LARGE_M * np.floor(clean / KNOT_M)
    assert np.allclose(_shift("knots-of-the-line-counted-too-large"), knots)
    rest = WRONG * (VERNIER_M - 2 * (clean % VERNIER_M))
    assert np.allclose(_shift("vernier-read-from-its-wrong-end"), rest)


@pytest.mark.parametrize("ratio", [1, 3])
def test_answers_lean_to_the_first_and_copies_are_apart(ratio: int) -> None:
    made = _tables("answers-lean-to-the-watchs-first", ratio=ratio)
    for told, plain in ((made.recorded, made.clean), (made.truth, made.simulated)):
        rows = plain.assign(told=told["range_m"])
        rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
        for _, one in rows.sort_values("time_s", kind="stable").groupby(["link", "copy"]):
            clean = one["range_m"].to_numpy()
            assert np.allclose(one["told"], 0.8 * clean + 0.2 * clean[0])


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    assert lost.min() >= -MOST_DB - 1e-9
    assert np.corrcoef(lost, _of("true_range_m"))[0, 1] < -0.6
    made = _tables("level-control")
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.min() < 0.85 < counts.max() <= 1.0


def test_loud_rows_are_early_leads_are_of_pairs_and_clocks_swing_slowly() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert np.abs(shift).max() < BIAS_M
    rows = _known().assign(late=_shift("antenna-delay"))
    assert rows.groupby(["tx", "rx"])["late"].agg(np.ptp).max() < 1e-9
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    assert _known().assign(ppm=ppm).groupby("link")["ppm"].agg(np.ptp).max() < 1e-3
    assert 0.01 < np.abs(ppm).max() < 0.25
    assert np.abs(_shift("timestamp-jitter")).max() < 1.6 * SWEPT_M


def test_ranges_are_told_by_divisions_of_dials() -> None:
    told = _tables("range-rounding").recorded["range_m"].to_numpy()
    step = np.array(DIVISIONS_M)[_entries().cresset % 2]
    parts = told / step - 1 / 3
    assert np.allclose(parts, np.rint(parts))
    assert (np.abs(_shift("range-rounding")) <= 0.5 * step + 1e-9).all()


def test_only_what_is_behind_something_is_blocked_and_late_by_walls() -> None:
    late = shown.assert_blocked_behind_things("lighthouse", 0.59)
    assert late.min() >= SOONEST_M
    assert late.max() < LONGEST_M + 1e-9


def test_edges_slabs_and_round_rocks_are_as_books_have_them() -> None:
    made = knife_db(np.array([0.0, 0.999999, 1.000001, 2.399999, 2.400001]))
    assert made[0] == pytest.approx(6.02, abs=0.01)
    assert np.abs(np.diff(made)[[1, 3]]).max() < 0.9  # pieces nearly meet
    none = through(4.0, np.full(1, 0.1), np.zeros(1))
    assert none[0] == pytest.approx(0.1)
    sharp, _ = over_rocks(np.full(1, 10.0), np.full(1, 0.5), np.full(1, 1.0), np.full(1, 1e-9))
    round_, _ = over_rocks(np.full(1, 10.0), np.full(1, 0.5), np.full(1, 1.0), np.full(1, 1.0))
    assert sharp[0] == pytest.approx(2 * np.hypot(5.0, 1.0) - 10.0)
    assert 0 < round_[0] < sharp[0]
