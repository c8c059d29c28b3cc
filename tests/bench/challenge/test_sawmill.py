"""The saw mill: what is particular to it, and what its decoders leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.sawmill_decoder import RISE, humps, onsets
from bench.challenge.families.sawmill_effects import CELLS_M, CURTIS, screen_db
from bench.challenge.families.sawmill_wave_effects import begun_anew, bessel, by_turns, walsh
from bench.challenge.families.sawmill_yard import BRACES_M, SHIFT_S, SITE_M
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "sawmill"), partial(shift_of, "sawmill")


def _rows() -> pd.DataFrame:
    return _tables("").recorded


def _of_kind(kind: str) -> np.ndarray:
    return np.asarray(_rows()["tx"].str.startswith(kind), bool)


def _stints() -> pd.Series:
    return _rows()["link"].str.extract(r"(\d+)")[0]


def _stands() -> np.ndarray:
    spread = _rows().groupby(_stints())[["tx_x_m", "tx_y_m", "tx_z_m"]].transform(np.ptp)
    return np.asarray(spread.max(axis=1).eq(0))


def _braces() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("brace").astype(int).to_numpy()


def test_only_logs_on_carriages_that_turn_slide() -> None:
    shift = _shift("logs-slide-at-turns")
    assert not shift[~_of_kind("carriage") | _stands()].any()
    assert 0.05 < np.abs(shift).max() < 0.15 * 3.6 * 0.75**2


def test_masts_of_forklifts_lean_by_their_loads() -> None:
    shift, load = _shift("masts-tilt-laden"), _rows()["load_t"].to_numpy()
    assert not shift[~_of_kind("forklift")].any()
    assert np.abs(shift).max() > 0.1
    assert (np.abs(shift) <= 0.16 * np.hypot(1.0, 0.35) * load + 0.02).all()


def test_only_braces_at_kilns_swell_and_the_more_the_damper_it_is() -> None:
    shift = _shift("kiln-braces-swell")
    at = _braces() >= 10
    assert not shift[~at].any()
    assert (shift[at] > 0).all()
    damp = _rows()["humidity_pct"].to_numpy()
    assert np.ptp(np.round(shift[at] / (damp[at] - 30.0), 9)[_braces()[at] == 11]) < 1e-8


def test_the_halls_braces_are_all_off_by_one_vector() -> None:
    shift = _shift("hall-surveyed-from-another-corner", 0.25)
    there = (_braces() >= 4) & (_braces() < 10)
    assert not shift[~there].any()
    ends = [_rows()[[f"{end}_{a}_m" for a in "xyz"]].to_numpy() for end in ("rx", "tx")]
    toward = (ends[0] - ends[1]) / np.linalg.norm(ends[0] - ends[1], axis=1)[:, None]
    vector = np.linalg.lstsq(toward[there], shift[there], rcond=None)[0]
    assert np.linalg.norm(vector) == pytest.approx(0.25 * 0.17, rel=0.03)


def test_what_asks_first_is_late_and_nothing_after_it_in_a_round() -> None:
    shift = _shift("first-of-a-round-is-late")
    assert np.allclose(np.unique(shift.round(9)), [0.0, 0.104])
    first = ~_stints().duplicated().to_numpy()
    assert np.allclose(shift[first], 0.104)
    gaps = _rows()["time_s"].groupby(_stints()).diff().to_numpy()
    late = shift > 0.05
    assert not late[gaps < 0.054].any()
    assert 0.15 < late.mean() < 0.7


def test_firmware_is_changed_once_and_ranges_are_longer_from_then_on() -> None:
    shift, time = _shift("firmware-changed-at-noon"), _rows()["time_s"].to_numpy()
    assert np.array_equal(shift > 0.01, time > 0.47 * SHIFT_S)


def test_a_fine_gain_goes_round_with_the_level_alone() -> None:
    shift, level = _shift("fine-gain-cycles"), _rows()["rx_power_dbm"].to_numpy()
    again = np.argsort(np.mod(level, 6.0))
    assert np.abs(np.diff(shift[again])).max() < 0.02
    assert abs(np.corrcoef(shift, level)[0, 1]) < 0.4


def test_ranges_are_written_as_middles_of_cells_of_three_widths() -> None:
    written = _tables("range-rounding").recorded["range_m"].to_numpy()
    middles = np.cumsum(CELLS_M) - 0.5 * CELLS_M
    rest = np.mod(written, CELLS_M.sum())
    assert (np.abs(rest[:, None] - middles).min(axis=1) < 1e-9).all()
    assert np.abs(_shift("range-rounding")).max() <= 0.5 * CELLS_M.max() + 1e-9


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    for mode in ("ranges", "CIR"):
        rows = _tables("", mode=mode).recorded
        free = rows["obstacles"].str.len().eq(0).to_numpy()
        assert np.array_equal(rows["los"], free)
        assert 0.25 < free.mean() < 0.6
        assert "room_x_m" not in rows
    free = _rows()["los"].to_numpy()
    blocked = _shift("blocked-path")
    assert not blocked[free].any()
    assert (blocked[blocked != 0] > 0.459).all()
    assert blocked.max() < 3.31
    assert not _shift("material-delay")[free].any()
    free = _tables("", mode="CIR").recorded["los"].to_numpy()
    assert np.abs(_shift("obstructed-path", mode="CIR")[free]).max() < 0.06


def test_crystals_are_others_after_each_break_and_shift_nothing_without_a_reply() -> None:
    rows = _rows()
    part = rows["time_s"].to_numpy() / SHIFT_S
    after = (part > 0.31).astype(int) + (part > 0.68)
    ppm = _shift("clock-offset") / rows["reply_time_s"].to_numpy()
    groups = pd.Series(ppm).groupby([rows["tx"], rows["rx"], after])
    assert groups.agg(np.ptp).max() < 1e-9
    means = groups.first().unstack()
    apart = (means.max(axis=1) - means.min(axis=1))[means.count(axis=1) > 1]
    assert len(apart) > 5
    assert (apart > 1e-4).all()


def test_what_is_louder_in_bursts_is_so_near_the_saw_and_goes_by_time() -> None:
    made = _tables("noise-floor")
    db = 20 * np.log10((made.recorded["noise_std"] / made.clean["noise_std"]).to_numpy())
    own = pd.Series(db).groupby(_braces()).transform("min").to_numpy()
    near = np.hypot(*(BRACES_M[_braces(), :2] - [43.5, 20.2]).T) < 14.0
    assert 0.1 < (db > own + 1.0)[near].mean() < 0.9
    assert (db > 0.4).all()
    assert (db - own)[np.hypot(*(BRACES_M[_braces(), :2] - [43.5, 20.2]).T) > 30].max() < 1.6


def test_symbols_that_are_not_counted_take_their_noise_with_them() -> None:
    made = _tables("level-control")
    counts, noise = (
        made.recorded[name] / made.clean[name] for name in ("preamble_count", "noise_std")
    )
    assert np.allclose(noise, np.sqrt(counts))
    assert 10 ** (-1.15 * 5.6 / 20) < counts.min() < 0.75


def test_tags_stay_on_the_site_and_a_stint_has_one_tag_and_some_braces() -> None:
    rows = _rows()
    for axis, long_m in zip("xy", SITE_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(0.9, long_m - 0.9).all()
    assert rows["tx_z_m"].between(0.8, 5.3).all()
    assert rows["true_range_m"].min() > 1.5
    stints = rows.groupby(_stints())
    assert stints["tx"].nunique().eq(1).all()
    assert stints["rx"].nunique().between(3, 6).all()
    assert stints["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {"log yard", "saw line", "lumber yard", "gangways"}


def test_carriages_run_along_saws_and_a_link_hears_rounds_in_a_row() -> None:
    runs = _rows()[_of_kind("carriage")].groupby(_stints())
    assert (runs[["tx_y_m", "tx_z_m"]].agg(np.ptp) == 0).all(axis=None)
    gaps = _rows().groupby("link")["time_s"].diff().dropna()
    assert gaps.between(0.349, 0.411).all()


@pytest.mark.parametrize("name", ["time-lag", "exchange-motion"])
def test_what_goes_away_is_read_long_meanwhile(name: str) -> None:
    rows = _rows().assign(shift=_shift(name))
    speeds, shifts = [], []
    for _, one in rows.groupby("link"):
        if len(one) > 2:
            speeds.append(np.gradient(one["true_range_m"], one["time_s"])[1:-1])
            shifts.append(one["shift"].to_numpy()[1:-1])
    assert np.corrcoef(np.concatenate(speeds), np.concatenate(shifts))[0, 1] > 0.75


def test_curtis_weights_are_those_of_clenshaw_and_exact_for_fifth_powers() -> None:
    places = 0.5 - 0.5 * np.cos(np.pi * np.arange(5) / 4)
    for power in range(6):
        assert (CURTIS * places**power).sum() == pytest.approx(1 / (1 + power))


def test_an_edge_takes_more_the_more_it_turns_waves_and_no_less_than_a_half() -> None:
    lets_by = screen_db(np.array([1e-3, 0.1, 0.3, 0.9]), np.full(4, 0.4))
    assert lets_by[0] == pytest.approx(-6.02, abs=0.01)
    assert (np.diff(lets_by) < 0).all()


def test_ribs_return_all_that_grazes_them_as_bessels_function_has_it() -> None:
    assert bessel(np.array([0.0, 1.0, 2.404826])) == pytest.approx([1.0, 0.765198, 0.0], abs=1e-6)


def test_codes_of_two_converters_are_whole_steps_and_whole_double_steps() -> None:
    parts = np.random.default_rng(3).normal(scale=5, size=(2, 4, 300))
    kept = by_turns(parts[0] + 1j * parts[1], 1.5)
    assert np.allclose(kept.real[:, ::2] / 1.5, np.rint(kept.real[:, ::2] / 1.5))
    assert np.allclose(kept.imag[:, 1::2] / 3.0, np.rint(kept.imag[:, 1::2] / 3.0))
    assert 1.3 < np.abs(kept.real - parts[0]).max() <= 1.5 + 1e-9


def test_walshs_steps_double_energy_and_dozens_begin_anew() -> None:
    sizes = np.random.default_rng(4).rayleigh(size=(3, 50))
    made = walsh(sizes)
    assert np.allclose((made[:, :48] ** 2).sum(axis=1), 2 * (sizes[:, :48] ** 2).sum(axis=1))
    assert np.allclose(walsh(np.ones((1, 8))), [[4.0] + [0.0] * 7])
    sums = begun_anew(sizes)
    assert np.array_equal(sums[:, ::12], sizes[:, ::12])
    assert np.allclose(sums[:, 11], sizes[:, :12].sum(axis=1) / np.sqrt(12.0))


def test_onsets_are_where_they_are_however_high_pulses_are_and_never_sooner_if_dull() -> None:
    top = 60 + np.linspace(0, 1, 20)
    pulse, later, soon = (humps(top + off).astype(np.complex128) for off in (0.0, 9.4, 2.6))
    low, high = (onsets(size * pulse, np.full(20, 0.002)) for size in (1.0, 40.0))
    assert np.allclose(low, high, atol=1e-9)
    assert np.allclose(top - low, RISE, atol=0.02)
    both = 0.3 * pulse + later
    sharp, dull = (onsets(both, np.full(20, 0.002), much) for much in (0.0, 2.0))
    assert np.allclose(dull - sharp, 9.4, atol=0.05)
    near = 0.5 * pulse + soon
    assert (onsets(near, np.full(20, 0.02), 2.0) >= onsets(near, np.full(20, 0.02))).all()
