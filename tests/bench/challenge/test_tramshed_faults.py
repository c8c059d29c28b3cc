"""What the tram shed hides in ranges: laws, faults and effects, and how large these are."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.case import world_of
from bench.challenge.families.tramshed_depot import LIGHT_M_US, ROSETTES, ROSETTES_M, SHED_M, Fares
from bench.challenge.families.tramshed_effects import (
    BIAS_M,
    BIN_M,
    EDGES_M,
    LONGEST_M,
    MOST_DB,
    SOONEST_M,
    STEPS_M,
    edge_db,
    mixed,
    over_roofs,
)
from bench.challenge.families.tramshed_faults import (
    CURVE_M,
    DRAWN,
    DROPS_KPA,
    FED_M,
    FED_S,
    HEAVES,
    MERGED,
    MISSED_M,
    PICKS_KPA,
    PITS_Y,
    SAGS_M,
    SECTIONS,
    SMEARED,
    SPLICE_M,
    SPLICED_M,
    held,
    in_pits_m,
)
from tests.bench.challenge import shown

_shift = partial(shown.shift_of, "tramshed")
_tables = partial(shown.tables_of, "tramshed")
_known = partial(shown.known_of, "tramshed")
_of = partial(shown.column_of, "tramshed")


def _fares() -> Fares:
    return Fares(_known(), 0, np.random.default_rng(0))


def test_causes_are_of_what_is_hidden_and_laws_grow_or_fall_by_theirs() -> None:
    for mode in ("ranges", "CIR"):
        world: Any = world_of("tramshed", mode)
        assert {*world.CAUSES} <= {*world.KNOWN, *world.LAWS}
    assert {*world.CAUSES.values()} <= {*_tables("").recorded}
    for name, column, sign in (
        ("sand-packs-in-its-boxes", "sand_kg", 1),
        ("carbon-films-rosettes-since-wiped", "wiped_d", 1),
        ("varnish-lies-thick-on-tags", "varnish_um", 1),
        ("slack-wire-lets-rosettes-hang", "tension_kn", -1),
        ("tower-wagon-parked-close", "wagon_m", -1),
        ("feeders-warm-by-their-current", "feeder_ka", 1),
        ("air-governor-lets-the-compressor-run", "tank_bar", -1),
    ):
        order = np.argsort(_of(column), kind="stable")
        assert (sign * np.diff(_shift(name)[order]) > -1e-9).all(), name
        assert np.ptp(_shift(name)) > 0.05, name


def test_ways_over_pits_are_as_long_as_their_points_say() -> None:
    fares, part = _fares(), (np.arange(4000) + 0.5)[:, None] / 4000
    over = in_pits_m(fares.tag_m, fares.rosette_m)
    for k in range(0, fares.rows, 23):
        at = fares.tag_m[k] + part * (fares.rosette_m[k] - fares.tag_m[k])
        there = (at[:, 1] > PITS_Y[0]) & (at[:, 1] < PITS_Y[1])
        assert over[k] == pytest.approx(there.mean() * fares.far[k], abs=0.03)


def test_relays_hold_by_what_was_before_and_sections_are_fed_by_turns() -> None:
    amid = 0.5 * (PICKS_KPA + DROPS_KPA)
    assert held(np.array([amid, 99.0, amid, 0.0, amid])).tolist() == [0, 1, 1, 0, 0]
    fed = (_of("time_s") // FED_S).astype(int) % SECTIONS == _fares().rosette % SECTIONS
    assert np.allclose(_shift("feeder-sections-fed-by-turns"), FED_M * fed)


def test_faults_of_ways_concern_their_own_duty_and_not_who_rests() -> None:
    rests, rows = _known()["goes"].eq(0.0).to_numpy(), _known()
    for name, duty in (("trams-turn-out-at-later-blades", "tram"),
                       ("traversers-overrun-their-lever", "traverser"),
                       ("sweepers-weave-broader-than-told", "sweeper"),
                       ("jacks-sink-between-strokes", "jack"),
                       ("blocks-hang-on-longer-falls", "block"),
                       ("poles-trail-behind-their-rope", "pole")):  # fmt: skip
        shift = _shift(name)
        own = rows["rx"].str.rstrip("0123456789").eq(duty).to_numpy()
        assert not shift[~own].any(), name
        assert 0.05 < np.abs(shift).max() < 2.5, name
        assert np.abs(shift[rests]).max() < 1e-9, name
    assert np.abs(_shift("places-drawn-to-the-middle-of-a-turn")[rests]).max() < 1e-9


def test_ends_are_elsewhere_as_surveys_spans_and_frost_have_it() -> None:
    fares = _fares()
    sag = SAGS_M * (1 - (2 * ROSETTES_M[:, 0] / SHED_M[0] - 1) ** 2)
    part = np.linspace(0.0, 1.0, ROSETTES)[:, None]
    for name, off in (
        ("rosettes-hang-low-amid-their-spans", np.outer(-sag, [0, 0, 1])),
        ("survey-closed-without-its-misclosure", part * MISSED_M),
    ):
        at = fares.rosette_m + off[fares.rosette]
        law = np.linalg.norm(at - fares.tag_m, axis=1) - fares.far
        assert np.allclose(_shift(name), law), name
    up = HEAVES * _of("frost_mm") * (0.5 + fares.tag_m[:, 0] / SHED_M[0])
    higher = fares.tag_m + np.outer(up, [0, 0, 1])
    law = np.linalg.norm(higher - fares.rosette_m, axis=1) - fares.far
    assert np.allclose(_shift("setts-heave-with-frost"), law)
    assert 0 < DRAWN < 1


def test_tapes_and_chords_are_what_they_are_said_to_be() -> None:
    clean = _tables("").clean["range_m"].to_numpy()
    assert np.allclose(_shift("tape-spliced-past-a-mark"), SPLICED_M * (clean > SPLICE_M))
    chord = 2 * CURVE_M * np.sin(clean / (2 * CURVE_M))
    assert np.allclose(clean + _shift("ranges-told-as-chords-of-a-curve"), chord)


@pytest.mark.parametrize("ratio", [1, 3])
def test_answers_are_merged_with_the_next_and_copies_are_apart(ratio: int) -> None:
    made = _tables("answers-merged-with-the-next", ratio=ratio)
    for told, plain in ((made.recorded, made.clean), (made.truth, made.simulated)):
        assert plain is not None
        rows = plain.assign(told=told["range_m"])
        rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
        for _, one in rows.sort_values("time_s", kind="stable").groupby(["link", "copy"]):
            clean = one["range_m"].to_numpy()
            law = clean + MERGED * (np.append(clean[1:], clean[-1]) - clean)
            assert np.allclose(one["told"], law)


def test_first_answers_alone_are_smeared_by_what_their_rosette_told_last() -> None:
    made, shift = _tables("first-answers-smeared-by-the-last-caller"), None
    shift = _shift("first-answers-smeared-by-the-last-caller")
    rows = made.clean.assign(shift=shift).sort_values("time_s", kind="stable")
    first = ~rows["link"].duplicated()
    assert not rows["shift"][~first].any()
    before = rows.groupby("tx")["range_m"].shift(1)
    law = SMEARED * (before - rows["range_m"])
    there = first & before.notna()
    assert np.allclose(rows["shift"][there], law[there])


def test_levels_fall_where_they_should_and_fewer_symbols_have_less_noise() -> None:
    made = _tables("path-loss")
    lost = (made.recorded["rx_power_dbm"] - made.clean["rx_power_dbm"]).to_numpy()
    assert lost.min() >= -MOST_DB - 1e-9
    assert np.corrcoef(lost, _of("true_range_m"))[0, 1] < -0.6
    made = _tables("level-control")
    counts = made.recorded["preamble_count"] / made.clean["preamble_count"]
    assert np.allclose((made.recorded["noise_std"] / made.clean["noise_std"]) ** 2, counts)
    assert counts.min() < 0.85 < counts.max() <= 1.0


def test_loud_rows_are_early_leads_are_of_pairs_and_clocks_age_slowly() -> None:
    shift, level = _shift("power-bias"), _of("rx_power_dbm")
    assert (np.diff(shift[np.argsort(level)]) <= 1e-12).all()
    assert np.abs(shift).max() < BIAS_M
    rows = _known().assign(late=_shift("antenna-delay"))
    assert rows.groupby(["tx", "rx"])["late"].agg(np.ptp).max() < 1e-9
    ppm = _shift("clock-offset") / (0.5 * LIGHT_M_US * _of("reply_time_s"))
    assert _known().assign(ppm=ppm).groupby("link")["ppm"].agg(np.ptp).max() < 1e-3
    assert 0.01 < np.abs(ppm).max() < 0.25
    assert np.abs(_shift("timestamp-jitter")).max() <= EDGES_M + BIN_M + 1e-9


def test_ranges_are_told_as_middles_of_steps() -> None:
    told = _tables("range-rounding").recorded["range_m"].to_numpy()
    wide = np.array(STEPS_M)[_fares().tag % 2]
    assert np.allclose(told / wide % 1.0, 0.5)
    assert (np.abs(_shift("range-rounding")) <= 0.5 * wide + 1e-9).all()


def test_only_what_is_behind_something_is_blocked_and_late() -> None:
    late = shown.assert_blocked_behind_things("tramshed", SOONEST_M - 1e-9)
    assert late.max() < LONGEST_M + 1e-9


def test_edges_roofs_and_moist_things_are_as_books_have_them() -> None:
    made = edge_db(np.array([0.0, 1.0, 2.4]))
    assert np.allclose(made, [6.03, 13.93, 20.53], atol=0.05)
    assert mixed(4.0, np.zeros(1))[0] == pytest.approx(2.0)
    assert mixed(4.0, np.full(1, 0.1))[0] == pytest.approx(1.8 + 0.89)
    longer, lost = over_roofs(np.full(2, 12.0), np.full(2, 0.5), np.array([0.0, 1.0]),
                              np.full(2, 2.0))  # fmt: skip
    assert longer[0] == pytest.approx(0.0)
    assert longer[1] == pytest.approx(2 * np.hypot(5.0, 1.0) - 10.0)
    assert 5.5 < lost[0] < 6.5 < lost[1]
