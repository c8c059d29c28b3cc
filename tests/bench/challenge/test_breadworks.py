"""The breadworks: what is particular to it, and how large what it hides is."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest
from scipy.special import jv
from scipy.stats import ks_2samp

from bench.challenge.families.breadworks import (
    CAUSES,
    CORBEL_DB,
    FADES_DB,
    STRAIGHT,
    TAG_DB,
    backwards,
    strays,
)
from bench.challenge.families.breadworks_faults import open_dbm
from bench.challenge.families.breadworks_hall import (
    CORBELS,
    CORBELS_M,
    HALL_M,
    PITCH_M,
    PLACES,
    STANDS,
    TAGS,
    Bake,
    climbed,
    indexed,
    meandered,
    off_walls,
    rolled,
)
from bench.challenge.families.breadworks_night import CLOSEST_M, TURN_S, TURNS, called
from bench.challenge.families.case import Draw, world_of
from tests.bench.challenge import shown

_nothing: Any = partial(shown.nothing_of, "breadworks")
_tables = partial(shown.tables_of, "breadworks")
_rows = partial(shown.rows_of, "breadworks")
_known = partial(shown.known_of, "breadworks")


def _bake() -> Bake:
    return Bake(_known(), 0, np.random.default_rng(0))


def _batch(rows: pd.DataFrame) -> pd.Series:
    return rows["link"].str.extract(r"batch (\d+)")[0]


def _course(count: int, **more: float) -> dict[str, np.ndarray]:
    names = ("from_x", "from_y", "level", "toward", "speed", "swing", "fades", "reach")
    return {name: np.full(count, more.get(name, 0.0)) for name in names}


def test_trays_climb_a_helix_at_even_pace_either_way_round() -> None:
    when = np.linspace(0.0, 20.0, 2001)
    for pace in (-1.1, 1.1):
        there = climbed(_course(2001, reach=2.5, speed=pace, level=0.8), when)
        assert np.allclose(np.hypot(there[:, 0], there[:, 1]), 2.5)
        steps = np.linalg.norm(np.diff(there[:, :2], axis=0), axis=1)
        assert np.allclose(steps, 1.1 * when[1], rtol=1e-4)
        turns = 1.1 * 20.0 / (2 * np.pi * 2.5)
        assert there[-1, 2] - 0.8 == pytest.approx(PITCH_M * turns)


def test_racks_are_slowed_by_their_speed() -> None:
    when = np.linspace(0.0, 6.0, 1201)
    there = rolled(_course(1201, speed=2.4, fades=3.0, toward=0.4), when)
    way = np.hypot(there[:, 0], there[:, 1])
    speed = np.gradient(way, when)[1:-1]
    assert speed[0] == pytest.approx(2.4, rel=0.01)
    assert np.allclose(np.gradient(speed, when[1:-1])[2:-2], -speed[2:-2] / 3.0, rtol=1e-3)
    clogged = rolled(_course(1, speed=2.4, fades=3.0), np.full(1, 99.0), 0.5)
    assert clogged[0, 0] == pytest.approx(2.4 * 2.0)


def test_porters_meander_by_a_sine_of_the_way() -> None:
    when = np.linspace(0.0, 4.0, 801)
    there = meandered(_course(801, speed=1.5, swing=0.8, reach=6.0, toward=0.3), when)[:, :2]
    step = np.gradient(there, when, axis=0)[1:-1]
    assert np.allclose(np.hypot(*step.T), 1.5, rtol=1e-3)
    heading = np.arctan2(step[:, 1], step[:, 0])
    assert np.allclose(heading, 0.3 + 0.8 * np.sin(2 * np.pi * 1.5 * when[1:-1] / 6.0), atol=1e-3)
    gone = meandered(_course(1, speed=1.5, swing=0.8, reach=6.0), np.full(1, 4.0))[0]
    assert gone[0] == pytest.approx(6.0 * jv(0, 0.8), rel=1e-9)  # a whole bend and back
    assert gone[1] == pytest.approx(0.0, abs=1e-9)


def test_moulds_dwell_at_stands_and_go_on_by_a_cycloid() -> None:
    when = np.linspace(0.0, 4.0, 4001)
    there = indexed(_course(4001, speed=1.0, fades=2.0, reach=2.2), when)
    angle = np.unwrap(np.arctan2(there[:, 1], there[:, 0]))
    assert angle[-1] == pytest.approx(2 * 2 * np.pi / STANDS)
    assert angle[2000] == pytest.approx(2 * np.pi / STANDS)
    speed = np.gradient(angle, when)
    assert abs(speed[2000]) < 1e-4
    assert speed.max() == pytest.approx(2 * (2 * np.pi / STANDS) / 2.0, rel=1e-4)  # twice the mean
    worn = indexed(_course(3, speed=1.0, fades=2.0, reach=2.2), np.array([0.0, 0.5, 2.0]), 0.1)
    off = np.linalg.norm(worn - there[[0, 500, 2000]], axis=1)
    assert np.allclose(off, [0.0, 2 * 2.2 * np.sin(0.05), 0.0], atol=1e-9)


def test_tags_stay_in_the_hall_and_a_batch_has_one_tag_and_some_corbels() -> None:
    rows = _rows()
    assert off_walls(rows[["tx_x_m", "tx_y_m"]].to_numpy()).min() > 0.7
    assert off_walls(CORBELS_M).min() > 1.2
    for axis, most in zip("xyz", HALL_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.4, most).all()
        assert rows[f"rx_{axis}_m"].between(1.2, most - 1.2).all()
        assert rows[f"room_{axis}_m"].eq(most).all()
    assert rows["true_range_m"].min() > CLOSEST_M - 0.1
    batches = rows.groupby(_batch(rows))
    assert batches["tx"].nunique().eq(1).all()
    assert batches["rx"].nunique().between(2, 7).all()
    assert batches["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES.values()}
    assert {*rows["tx"]} == {*TAGS}
    kinds = rows.groupby("rx")["environment"].nunique()
    assert len(kinds) == CORBELS
    assert kinds.median() > 2


def test_no_two_corbels_answer_at_once_and_at_no_even_times() -> None:
    lengths = np.array([4, 11, 1, 5, 12, 15, 7])
    which, since_s = called(np.random.default_rng(3), lengths)
    assert np.bincount(which).tolist() == lengths.tolist()
    assert np.diff(since_s).min() > 0.005
    for number, length in enumerate(lengths):
        assert (which == number).sum() == length
        assert np.ptp(since_s[which == number]) < TURNS * TURN_S
    assert np.diff(since_s[which == 5]).std() > 0.05


def test_who_rests_stays_and_all_else_moves_as_fast_as_such_things_are() -> None:
    rows = _known()
    still = rows.groupby(_batch(rows))["goes"].first().eq(0.0)
    spread = _rows().groupby(_batch(_rows()))[["tx_x_m", "tx_y_m", "tx_z_m"]].agg(np.ptp)
    assert still.sum() == 6
    assert spread[still].to_numpy().max() == 0.0
    assert spread[~still].max(axis=1).median() > 0.3
    bake = _bake()
    fast = np.abs(bake.rolls_off(0.001)) / 0.001
    assert fast.max() < 3.0
    assert fast[bake.are("tray")].max() < 1.4
    assert fast[bake.are("porter")].max() < 2.0


def test_bits_run_backwards_and_strays_scatter_by_one() -> None:
    assert np.allclose(backwards(np.arange(5)), [0.0, 0.5, 0.25, 0.75, 0.125])
    made = strays(np.random.default_rng(4), 200_000)
    assert made.std() == pytest.approx(1.0, abs=0.01)
    assert made.mean() == pytest.approx(0.0, abs=0.01)
    assert (made**4).mean() == pytest.approx(3 * (1 + 1 / 6), rel=0.05)
    assert np.mean(FADES_DB) == pytest.approx(0.0, abs=1e-9)


def test_no_row_that_hides_nothing_loses_its_first_path() -> None:
    for seed in range(5):
        made = _nothing(seed, "CIR")
        for table in (made.recorded, made.simulated):
            assert table["error_m"].abs().max() < 0.12
            assert table["first_path_index"].between(19.0, 20.0).all()
            assert (table["rx_power_dbm"] - table["first_path_power_dbm"]).max() < 18


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
def test_nothing_hidden_is_equal_in_law_in_any_draw(mode: str) -> None:
    """Paired or not, at any ratio: of all that is measured, and of first paths' parts of it."""
    world: Any = world_of("breadworks", mode)
    for drawn in (Draw(ratio=3), Draw(ratio=1, paired=False), Draw(ratio=1, concealed="scatter")):
        made = [world.tables(drawn, seed) for seed in range(6)]
        for column in ("error_m", "rx_power_dbm", "first_path_power_dbm", "noise_std",
                       "preamble_count"):  # fmt: skip
            sides: list[Any] = [
                np.concatenate([getattr(one, side).groupby("link")[column].first() for one in made])
                for side in ("recorded", "simulated")
            ]
            assert ks_2samp(*sides).pvalue > 0.002, (drawn, column)


def test_another_mix_has_the_same_law_given_how_far_it_is() -> None:
    """Levels over those in the open, and errors, are alike though distances are not."""
    world: Any = world_of("breadworks")
    made = [world.tables(Draw(ratio=1, paired=False, same_mix=False), s) for s in range(8)]
    rows = [pd.concat([getattr(one, side).assign(case=k) for k, one in enumerate(made)])
            for side in ("recorded", "simulated")]  # fmt: skip
    over: list[Any] = []
    error: list[Any] = []
    for table in rows:
        first = table.groupby(["case", "link"]).first().reset_index()
        bake = Bake(first, 0, np.random.default_rng(0))
        own = open_dbm(bake.far) + CORBEL_DB[bake.corbel] + TAG_DB[bake.tag]
        over.append(first["rx_power_dbm"] - own)
        weak = 10 ** ((-92.0 - first["rx_power_dbm"]) / 20).clip(upper=3.0)
        error.append(first["error_m"] / np.hypot(0.0105 + 0.0045 * weak, 0.011 / np.sqrt(6)))
    assert rows[1]["true_range_m"].mean() > 1.2 * rows[0]["true_range_m"].mean()
    assert ks_2samp(*over).pvalue > 0.002
    assert ks_2samp(*error).pvalue > 0.002


def test_deaf_balances_lose_some_first_paths_on_any_night_and_more_the_deafer_they_are() -> None:
    world: Any = world_of("breadworks", "CIR")
    sizes = []
    for strength in (0.25, 0.5, 1.0, 2.0):
        late = []
        for seed in range(4):
            made = world.tables(Draw(("late-detection",), strength, 1), seed)
            later = made.recorded["error_m"] - made.clean["error_m"]
            assert (later > 0.3).mean() < 0.35
            assert (later >= -1e-9).all()
            late.append(later.mean())
        sizes.append(np.mean(late))
    assert (np.diff(sizes) > 0).all()
    assert sizes[2] > 0.04


def test_what_comes_straight_is_as_large_a_part_with_waveforms_as_without() -> None:
    part, off = [], []
    for seed in range(6):
        rows = _nothing(seed, "CIR").recorded
        bake = Bake(rows, 0, np.random.default_rng(0))
        gap = rows["rx_power_dbm"] - rows["first_path_power_dbm"]
        part.append((10 ** (-gap / 10)).mean())
        own = open_dbm(bake.far) + CORBEL_DB[bake.corbel] + TAG_DB[bake.tag]
        off.append((rows["rx_power_dbm"] - own)[bake.behind("metal") == 0].mean())
    assert np.mean(part) == pytest.approx(STRAIGHT, abs=0.025)
    assert np.mean(off) == pytest.approx(0.0, abs=0.3)


@pytest.mark.parametrize("name", ["antenna-delay", "clock-offset", "plan-fed-askew"])
def test_waveforms_and_ranges_carry_the_same(name: str) -> None:
    """What devices, clocks and plans do to ranges is a law of rows, whatever else is kept."""
    ranges, waves = (_tables(name, mode=mode) for mode in ("ranges", "CIR"))
    sizes = [float(np.abs(t.recorded["error_m"] - t.clean["error_m"]).mean())
             for t in (ranges, waves)]  # fmt: skip
    assert sizes[0] == pytest.approx(sizes[1], rel=0.5)
    assert all(map(np.array_equal, waves.recorded["cir"], waves.clean["cir"]))


def test_in_the_clean_tables_nothing_goes_by_what_is_written_down() -> None:
    """Over 20 nights, errors go with no column more than chance has it."""
    made = [_nothing(seed) for seed in range(20)]
    columns = {c for c in CAUSES.values() if c not in ("time_s", "true_range_m")}
    first: pd.DataFrame = pd.concat(
        [t.groupby("link").first() for one in made for t in (one.recorded, one.simulated)]
    )
    for column in columns:
        by = np.corrcoef(first["error_m"], first[column])[0, 1]
        assert abs(by) * np.sqrt(len(first)) < 3.9, column
