"""The laundry: what is particular to it, and what its meters leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.laundry_effects import (
    EXTRACTORS_M,
    FRAMES,
    LEGENDRE,
    STEP_M,
    screened_db,
)
from bench.challenge.families.laundry_meter import RISE, lobes, onsets
from bench.challenge.families.laundry_plan import HALL_M, LOUVRES_M, PLACES
from bench.challenge.families.laundry_wave_effects import (
    foil,
    one_bit,
    sharpened,
    stuffed,
    unlike,
)
from tests.bench.challenge.shown import known_of, shift_of, tables_of

_tables, _shift = partial(tables_of, "laundry"), partial(shift_of, "laundry")
_known = partial(known_of, "laundry")


def _rows() -> pd.DataFrame:
    return _tables("").recorded


def _are(kind: str) -> np.ndarray:
    return np.asarray(_rows()["rx"].str.startswith(kind), bool)


def _errands() -> pd.Series:
    return _rows()["link"].str.extract(r"(\d+)")[0]


def _louvres() -> np.ndarray:
    return _rows()["tx"].str.removeprefix("louvre").astype(int).to_numpy()


def _stands() -> np.ndarray:
    spread = _rows().groupby(_errands())[["rx_x_m", "rx_y_m", "rx_z_m"]].transform(np.ptp)
    return np.asarray(spread.max(axis=1).eq(0))


def test_tags_stay_in_the_hall_and_an_errand_has_one_tag_and_some_louvres() -> None:
    rows = _rows()
    for axis, long_m in zip("xy", HALL_M, strict=False):
        assert rows[f"rx_{axis}_m"].between(0.8, long_m - 0.8).all()
    assert rows["rx_z_m"].between(0.7, 5.0).all()
    assert rows["true_range_m"].min() > 1.4
    errands = rows.groupby(_errands())
    assert errands["rx"].nunique().eq(1).all()
    assert errands["tx"].nunique().between(3, 6).all()
    assert errands["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES}
    assert rows["rx"].nunique() == 12


def test_each_louvre_keeps_a_beat_of_its_own_of_which_polls_are_lost() -> None:
    gaps = _rows().groupby("link")["time_s"].diff()
    beats = gaps.groupby(_rows()["link"]).transform("min")
    kept = beats < 0.371  # links that tell their beat
    times = (gaps / beats)[kept].dropna()
    assert gaps.min() > 0.289
    assert np.allclose(times, np.rint(times), atol=1e-6)
    assert 0.02 < (times > 1.5).mean() < 0.25


def test_shuttles_go_along_machines_and_bags_down_rails() -> None:
    runs = _rows()[_are("shuttle")].groupby(_errands())
    assert (runs["rx_y_m"].agg(np.ptp) < 1e-9).all()
    bags = _rows()[_are("bag") & ~_stands()].groupby(_errands())["rx_z_m"]
    assert bags.apply(lambda one: one.is_monotonic_decreasing).all()


def test_trolleys_keep_to_the_bar_that_they_are_on() -> None:
    """Who tows goes straight on: a trolley is as far from that way as its bar lets it be."""
    rows = _known()[_are("trolley")]
    off = np.stack([rows["rx_x_m"] - rows["from_x"], rows["rx_y_m"] - rows["from_y"]])
    aside = off[1] * np.cos(rows["toward"]) - off[0] * np.sin(rows["toward"])
    begun = rows["extra"] * np.sin(rows["lever"])
    assert (np.abs(aside - begun) <= rows["extra"] + 1e-9).all()
    assert np.abs(aside).max() > 0.3


def test_only_laden_trolleys_sink_and_only_folders_warm_their_tags() -> None:
    sinks, warm = _shift("springs-sink-laden"), _shift("hands-warm-tags")
    assert not sinks[~_are("trolley")].any()
    assert (sinks[_are("trolley")] > -1e-9).all()  # louvres are above
    assert (np.abs(sinks) <= 0.0048 * _rows()["linen_kg"] + 1e-9).all()
    assert not warm[~_are("folder")].any()
    rises = pd.Series(warm[_are("folder")]).groupby(_errands()[_are("folder")].to_numpy())
    assert rises.apply(lambda one: one.is_monotonic_increasing).all()
    assert rises.first().abs().max() < 1e-9


def test_bags_lean_back_while_they_speed_up_and_not_where_they_hang() -> None:
    shift = _shift("bags-lean-back-at-first")
    assert not shift[~_are("bag") | _stands()].any()
    assert 0.04 < np.abs(shift).max() < 1.2


def test_polls_that_collide_are_late_and_first_ones_of_errands_do_not() -> None:
    shift = _shift("polls-collide")
    gaps = _rows()["time_s"].groupby(_errands()).diff().to_numpy()
    near = gaps < 0.046
    assert np.allclose(shift, np.where(near, 0.115, 0.0))
    assert 0.1 < near.mean() < 0.45


def test_heights_are_off_by_a_slope_that_all_louvres_share() -> None:
    shift = _shift("heights-off-a-sloping-floor", 0.1)
    up = (_rows()["tx_z_m"] - _rows()["rx_z_m"]) / _rows()["true_range_m"]
    sinks = -shift / up.to_numpy()
    line = np.polyfit(_rows()["tx_x_m"], sinks, 1)
    assert line[0] == pytest.approx(0.1 * 0.0125, rel=0.05)
    assert np.abs(sinks - np.polyval(line, _rows()["tx_x_m"])).max() < 0.004


def test_words_are_whole_steps_and_even_ones_reach_farther() -> None:
    written = _tables("range-rounding").recorded["range_m"].to_numpy() / STEP_M
    word = np.rint(written)
    assert np.allclose(written, word)
    off = np.abs(_shift("range-rounding")) / STEP_M
    even = np.mod(word, 2) == 0
    assert off[even].max() <= 0.62 + 1e-9
    assert off[~even].max() <= 0.38 + 1e-9
    assert even.mean() > 0.52


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    for mode in ("ranges", "CIR"):
        rows = _tables("", mode=mode).recorded
        assert np.array_equal(rows["los"], rows["obstacles"].str.len().eq(0))
        assert 0.25 < rows["los"].mean() < 0.65
        assert {"room_x_m", "room_y_m", "room_z_m"} <= {*rows}
    free = _rows()["los"].to_numpy()
    blocked = _shift("blocked-path")
    assert not blocked[free].any()
    assert (blocked[blocked != 0] > 0.439).all()
    assert blocked.max() < 3.31
    assert np.mean(blocked[blocked != 0] > 3.29) < 0.5
    assert not _shift("material-delay")[free].any()
    free = _tables("", mode="CIR").recorded["los"].to_numpy()
    assert np.abs(_shift("obstructed-path", mode="CIR")[free]).max() < 0.06


def test_crystals_shift_nothing_without_a_reply_and_settle() -> None:
    rows = _rows()
    ppm = _shift("clock-offset") / rows["reply_time_s"].to_numpy()
    hours = rows["time_s"].to_numpy() / 5400.0
    design = np.exp(-hours)
    for _, one in rows.assign(ppm=ppm, fades=design).groupby(["tx", "rx"]):
        if len(one) > 2:
            line = np.stack([np.ones(len(one)), one["fades"]], axis=1)
            left = one["ppm"] - line @ np.linalg.lstsq(line, one["ppm"], rcond=None)[0]
            assert np.abs(left).max() < 1e-6


def test_extractors_are_heard_near_the_washers_and_in_turn() -> None:
    made = _tables("noise-floor")
    db = 20 * np.log10((made.recorded["noise_std"] / made.clean["noise_std"]).to_numpy())
    own = pd.Series(db).groupby(_rows()["rx"].to_numpy()).transform("min").to_numpy()
    assert (db > 0.45).all()
    assert db.max() < 1.4 + 8.4
    off = _rows()[["rx_x_m", "rx_y_m"]].to_numpy()[:, None] - EXTRACTORS_M
    near = np.hypot(*off.transpose(2, 0, 1)).min(axis=1)
    assert (db - own <= 8.4 * np.arctan(6.0 / near.clip(0.5)) * 2 / np.pi + 1e-9).all()
    assert (db - own).max() > 1.0


def test_symbols_that_are_not_counted_take_their_noise_with_them() -> None:
    made = _tables("level-control")
    counts, noise = (
        made.recorded[name] / made.clean[name] for name in ("preamble_count", "noise_std")
    )
    assert np.allclose(noise, np.sqrt(counts))
    assert 10 ** (-1.12 * 5.9 / 20) <= counts.min() < 0.75


def test_the_east_and_the_west_are_surveyed_with_a_tape_each() -> None:
    part = _shift("range-scale") / _rows()["true_range_m"].to_numpy()
    east = LOUVRES_M[_louvres(), 0] > 23.0
    assert np.allclose(part, np.where(east, 0.0118, 0.0068))


@pytest.mark.parametrize("name", ["time-lag", "exchange-motion"])
def test_what_goes_away_is_read_long_meanwhile(name: str) -> None:
    rows = _rows().assign(shift=_shift(name))
    speeds, shifts = [], []
    for _, one in rows.groupby("link"):
        if len(one) > 2:
            speeds.append(np.gradient(one["true_range_m"], one["time_s"])[1:-1])
            shifts.append(one["shift"].to_numpy()[1:-1])
    assert np.corrcoef(np.concatenate(speeds), np.concatenate(shifts))[0, 1] > 0.6


def test_frames_and_places_weigh_one_and_are_exact_for_powers() -> None:
    assert sum(by for by, _ in FRAMES) == pytest.approx(1.0)
    assert sum(by * old for by, old in FRAMES) == pytest.approx(1.0)
    for power in range(6):
        assert sum(by * at**power for by, at in LEGENDRE) == pytest.approx(1 / (1 + power))


def test_a_screen_takes_more_the_higher_and_the_thicker_it_is() -> None:
    lets = screened_db(np.array([0.0, 0.01, 0.05, 0.05]), np.array([0.5, 0.5, 0.5, 1.4]))
    assert lets[0] == pytest.approx(10 * np.log10(3))
    assert (np.diff(lets) > 0).all()


def test_foil_returns_all_that_grazes_it() -> None:
    assert foil(np.array([0.0, 1.0]), 188.365) == pytest.approx([1.0, 0.5])


def test_codes_of_both_parts_are_whole_steps_of_their_own() -> None:
    parts = np.random.default_rng(3).normal(scale=5, size=(2, 4, 300))
    kept = unlike(parts[0] + 1j * parts[1], 1.0)
    assert np.allclose(kept.real / 1.5, np.rint(kept.real / 1.5))
    assert np.allclose(kept.imag, np.rint(kept.imag))
    assert 0.7 < np.abs(kept.real - parts[0]).max() <= 0.75 + 1e-9


def test_pairs_are_twice_as_large_and_one_bit_keeps_means() -> None:
    sizes = np.random.default_rng(4).rayleigh(size=(3, 250))
    made = stuffed(sizes)
    assert not made[:, 1::2].any()
    assert np.allclose((made**2).sum(axis=1), 4 * (sizes**2).sum(axis=1))
    high = np.full(3, 3.0)
    bits = one_bit(sizes.clip(max=3.0), high)
    assert {*np.unique(bits)} == {0.0, 3.0}
    assert np.abs((bits - sizes.clip(max=3.0)).sum(axis=1)).max() <= 1.5 + 1e-9
    assert np.allclose(sharpened(np.ones((2, 40))), 1.0)


def test_onsets_are_where_they_are_however_high_pulses_are_and_never_sooner_if_deaf() -> None:
    top = 60 + np.linspace(0, 1, 20)
    pulse, later, soon = (lobes(top + off).astype(np.complex128) for off in (0.0, 9.4, 3.1))
    low, high = (onsets(size * pulse, np.full(20, 0.002)) for size in (1.0, 40.0))
    assert np.allclose(low, high, atol=1e-9)
    assert np.allclose(top - low, RISE, atol=0.02)
    both = 0.3 * pulse + later
    sharp, deaf = (onsets(both, np.full(20, 0.002), much) for much in (0.0, 2.0))
    assert np.allclose(deaf - sharp, 9.4, atol=0.05)
    near = 0.5 * pulse + soon
    assert (onsets(near, np.full(20, 0.02), 2.0) >= onsets(near, np.full(20, 0.02))).all()
