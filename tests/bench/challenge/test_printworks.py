"""The printworks: what is particular to it, and what its consoles leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.printworks_console import RISE, edges, pulses
from bench.challenge.families.printworks_effects import PAPER, edge_db
from bench.challenge.families.printworks_hall import LOOP_M, STANCHIONS_M, looped
from bench.challenge.families.printworks_wave_effects import differences, ladder
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "printworks"), partial(shift_of, "printworks")


def _rows() -> pd.DataFrame:
    return _tables("").recorded


def _carried_by(kind: str) -> np.ndarray:
    return np.asarray(_rows()["tx"].str.startswith(kind), bool)


def _runs() -> pd.Series:
    return _rows()["link"].str.extract(r"(\d+)")[0]


def _still() -> np.ndarray:
    spread = _rows().groupby(_runs())[["tx_x_m", "tx_y_m", "tx_z_m"]].transform(np.ptp)
    return np.asarray(spread.max(axis=1).eq(0))


def test_unlike_wheels_steer_trucks_alone_and_ever_farther_to_one_side() -> None:
    shift, trucks = _shift("wheels-of-unlike-size"), _carried_by("truck")
    assert not shift[~trucks].any()
    assert not shift[_still()].any()
    assert 0.05 < np.abs(shift).max() < 0.5 * 0.016 * 14**2
    seen = _rows().assign(shift=np.abs(shift))[trucks & ~_still()]
    since = seen["time_s"] - seen.groupby(_runs())["time_s"].transform("min")
    assert seen["shift"][since > 2].mean() > 1.5 * seen["shift"][since < 0.7].mean()


def test_a_worn_chain_moves_grippers_alone_and_by_no_more_than_it_is_longer() -> None:
    shift, grippers = _shift("chain-worn-long"), _carried_by("gripper")
    assert not shift[~grippers].any()
    assert 0.1 < np.abs(shift).max() < 0.0065 * LOOP_M + 1e-9


def test_the_loop_is_closed_as_long_as_it_is_said_and_without_corners() -> None:
    places = looped(np.linspace(0.0, LOOP_M, 20001))
    steps = np.linalg.norm(np.diff(places, axis=0)[:, :2], axis=1)
    assert steps.sum() == pytest.approx(LOOP_M, rel=1e-5)
    assert steps.std() < 1e-4 * steps.mean()
    assert np.allclose(places[0], places[-1])
    assert np.ptp(places[:, 2]) == pytest.approx(1.9, abs=1e-6)


def test_only_towers_shake_the_more_the_faster_the_press_is_and_each_row_by_itself() -> None:
    shift = _shift("towers-shake")
    on_towers = _rows()["rx"].isin([f"stanchion{k}" for k in range(4)]).to_numpy()
    fast = _rows()["copies_kh"].to_numpy() > 20
    assert not shift[~on_towers].any()
    assert shift[on_towers & fast].std() > 1.8 * shift[on_towers & ~fast].std()
    assert abs(shift[on_towers].mean()) < 0.02


def test_a_survey_from_one_to_the_next_leaves_the_first_where_it_is_and_errs_ever_more() -> None:
    shift = np.abs(_shift("surveyed-one-from-the-next", 0.5))
    reader = _rows()["rx"].str.extract(r"(\d+)")[0].astype(int).to_numpy()
    assert not shift[reader == 0].any()
    assert shift.max() < 0.5 * 0.062 * 3 * len(STANCHIONS_M)
    assert shift[reader >= 7].mean() > shift[reader <= 2].mean()


def test_tags_tire_from_a_runs_first_range_on_up_to_what_they_hold() -> None:
    shift = _shift("tags-tire")
    seen = _rows().assign(shift=shift)
    first = ~_runs().duplicated().to_numpy()
    assert not shift[first].any()
    assert (shift[~first] > 0).all()
    assert shift.max() < 0.128
    assert seen.groupby(_runs())["shift"].apply(lambda one: one.is_monotonic_increasing).all()


def test_ranges_are_whole_steps_of_logarithms() -> None:
    steps = np.log(_tables("range-rounding").recorded["range_m"]) / 0.0115
    assert np.allclose(steps, np.rint(steps))
    far = _rows()["range_m"].to_numpy()
    assert (np.abs(_shift("range-rounding")) <= 0.00577 * far).all()


def test_a_shrunk_plan_leaves_what_is_upright_and_is_longest_along_the_hall() -> None:
    rows, shift = _rows(), _shift("range-scale", 0.25)
    apart = np.abs(
        rows[[f"tx_{k}_m" for k in "xyz"]].to_numpy()
        - rows[[f"rx_{k}_m" for k in "xyz"]].to_numpy()
    )
    expected = 0.25 * 0.0112 * (apart[:, 0] ** 2 + 0.22 * apart[:, 1] ** 2)
    assert np.allclose(shift, expected / rows["true_range_m"], atol=0.002)


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    for mode in ("ranges", "CIR"):
        rows = _tables("", mode=mode).recorded
        free = rows["obstacles"].str.len().eq(0).to_numpy()
        assert 0.35 < free.mean() < 0.75
        assert "los" not in rows
    free = _rows()["obstacles"].str.len().eq(0).to_numpy()
    blocked = _shift("blocked-path")
    assert not blocked[free].any()
    assert (blocked[blocked != 0] > 0.449).all()
    assert blocked.max() < 3.31
    assert not _shift("material-delay")[free].any()
    free = _tables("", mode="CIR").recorded["obstacles"].str.len().eq(0).to_numpy()
    assert np.abs(_shift("obstructed-path", mode="CIR")[free]).max() < 0.06


def test_symbols_that_are_not_counted_take_their_noise_with_them_down_to_a_limit() -> None:
    made = _tables("level-control")
    counts, noise = (
        made.recorded[name] / made.clean[name] for name in ("preamble_count", "noise_std")
    )
    assert np.allclose(noise, np.sqrt(counts))
    assert 10 ** (-1.2 * 4.4 * np.pi / 40) < counts.min() < 0.8


def test_tags_stay_in_the_hall_trucks_in_aisles_grippers_on_their_loop_and_reels_roll() -> None:
    rows = _rows()
    for axis, long_m in (("x", 52.0), ("y", 28.0), ("z", 9.6)):
        assert rows[f"tx_{axis}_m"].between(0.1, long_m - 0.1).all()
        assert rows[f"room_{axis}_m"].eq(long_m).all()
    assert rows.groupby(_runs())["tx"].nunique().eq(1).all()
    assert rows.groupby(_runs())["rx"].nunique().between(3, 6).all()
    assert rows.groupby(_runs())["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert not rows[_carried_by("truck")]["tx_y_m"].between(12.0, 16.2).any()
    assert rows[_carried_by("gripper")]["tx_z_m"].between(5.9, 7.9).all()
    heights = rows[_carried_by("reel")]["tx_z_m"]
    assert heights.between(0.56 - 0.411, 0.56 + 0.411).all()
    assert {*rows["environment"]} == {"aisles", "chain", "reel store"}


def test_readers_keep_to_frames_of_which_they_leave_out_some() -> None:
    gaps = _rows().groupby("link")["time_s"].diff().dropna() / 0.31
    assert np.allclose(gaps, np.rint(gaps), atol=1e-6)
    assert 0.65 < np.isclose(gaps, 1).mean() < 0.83
    assert gaps.min() > 0.99


def test_an_edge_takes_6_db_where_it_is_grazed_and_27_db_deep_behind_it() -> None:
    lost = edge_db(np.array([-0.7, 0.0, 5.0]))
    assert lost == pytest.approx([0.5, 6.0, 26.8], abs=0.1)


def test_paper_is_less_dense_than_its_fibres_and_more_than_spheres_of_these() -> None:
    spheres = 1 + 3 * 0.62 * (2.4 / 5.4) / (1 - 0.62 * 2.4 / 5.4)
    assert spheres < PAPER < 1 + 0.62 * 2.4


def test_cells_hand_on_nothing_at_once_and_as_bessel_has_it() -> None:
    rung = ladder(np.array([0.0, 2.0 / 0.95, 5.0 / 0.95]))
    assert rung == pytest.approx([0.0, 0.35283, 0.04657], abs=1e-4)


def test_what_is_kept_of_differences_is_never_off_by_more_than_half_a_step() -> None:
    parts = np.random.default_rng(3).normal(scale=5, size=(2, 4, 300))
    off = differences(parts[0] + 1j * parts[1], 1.5) - (parts[0] + 1j * parts[1])
    assert 0.7 < max(np.abs(off.real).max(), np.abs(off.imag).max()) <= 0.75 + 1e-9


def test_edges_are_where_they_are_however_high_pulses_are_and_never_sooner_if_numb() -> None:
    top = 60 + np.linspace(0, 1, 20)
    low, high = (edges(size * pulses(top) + 0j, np.full(20, 0.002)) for size in (1.0, 40.0))
    assert np.allclose(low, high, atol=1e-9)
    assert np.allclose(top - low, RISE, atol=0.02)
    both = 0.3 * pulses(top) + pulses(top + 9.4) + 0j
    keen, numb = (edges(both, np.full(20, 0.002), numb) for numb in (0.0, 2.0))
    assert np.allclose(numb - keen, 9.4, atol=0.05)
    near = 0.5 * pulses(top) + pulses(top + 2.6) + 0j
    assert (edges(near, np.full(20, 0.02), 2.0) >= edges(near, np.full(20, 0.02))).all()
