"""The bowls green: what is particular to it, and what its dials leave alone."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.bowls_dial import AHEAD, first_paths, pulses
from bench.challenge.families.bowls_effects import (
    FOOT_M,
    HARDY,
    INCHES,
    layered,
    of_wood,
    past_an_edge,
)
from bench.challenge.families.bowls_match import GAPS_S, TURN_S
from bench.challenge.families.bowls_rinks import GREEN_M, KNOTS_M, PLACES, on_the_skin
from bench.challenge.families.bowls_wave_effects import (
    GALLERY_M,
    chords_m,
    film,
    in_polar_steps,
    slowed,
    summits,
    windowed,
)
from bench.challenge.families.case import Draw, world_of
from tests.bench.challenge.shown import (
    are_of,
    assert_blocked_behind_things,
    known_of,
    moved_of,
    rows_of,
    shift_of,
    tables_of,
    with_speed,
)

_tables, _shift = partial(tables_of, "bowls"), partial(shift_of, "bowls")
_known = partial(known_of, "bowls")
_rows, _are = partial(rows_of, "bowls"), partial(are_of, "bowls")


def _ends() -> pd.Series:
    return _rows()["link"].str.extract(r"(\d+)")[0]


def _knots() -> np.ndarray:
    return _rows()["rx"].str.removeprefix("knot").astype(int).to_numpy()


def _up() -> np.ndarray:
    """Return which part of a way is upward [n]."""
    rise = _rows()["rx_z_m"] - _rows()["tx_z_m"]
    return (rise / _rows()["true_range_m"]).to_numpy()


def test_tags_stay_on_the_green_and_an_end_has_one_tag_and_some_knots() -> None:
    rows = _rows()
    for axis, long_m in zip("xy", GREEN_M, strict=True):
        assert rows[f"tx_{axis}_m"].between(1.0, long_m - 1.0).all()
    assert rows["tx_z_m"].between(0.05, 1.5).all()
    assert rows["true_range_m"].min() > 1.5
    ends = rows.groupby(_ends())
    assert ends["tx"].nunique().eq(1).all()
    assert ends["rx"].nunique().between(3, 7).all()
    assert ends["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    assert {*rows["environment"]} == {*PLACES}
    assert rows["tx"].nunique() == 13
    assert "room_x_m" not in rows


def test_knots_are_on_a_skin_that_is_half_an_ellipse() -> None:
    off = (KNOTS_M[:, 1] / 13.0 - 1) ** 2 + (KNOTS_M[:, 2] / 9.2) ** 2
    assert np.allclose(off, 1.0, atol=0.003)
    assert np.allclose(on_the_skin(np.array([0.0, np.pi / 2])), [[26.0, 0.0], [13.0, 9.2]])


def test_knots_answer_a_blink_in_turn_and_gaps_are_of_a_register() -> None:
    """What is no whole number of turns apart is gaps apart, a few of them at most."""
    gaps = _rows().groupby("link")["time_s"].diff().dropna().to_numpy()
    units = gaps / 0.09 - 17.0 / 9.0  # a gap is 0.17 s and whole parts of 0.09 s
    sums = [(gaps - 0.17 * k) / 0.09 for k in range(1, 20)]
    whole = np.min([np.abs(one - np.rint(one)) for one in sums], axis=0)
    assert units.min() > -1e-6
    assert whole.max() < 1e-6
    assert np.allclose(np.diff(GAPS_S), 0.09)
    near = _rows().groupby(_ends())["time_s"].diff()
    near = near[near < 0.03] / TURN_S
    assert np.allclose(near, np.rint(near), atol=1e-6)
    assert 0.3 < len(near) / len(_rows()) < 0.8


def test_bowls_slow_down_evenly_and_turn_the_faster_the_slower_they_are() -> None:
    rows = _known()
    one = rows[rows["tx"].str.startswith("bowl") & rows["runs"].eq(1.0)]
    ways = np.hypot(one["tx_x_m"] - one["from_x"], one["tx_y_m"] - one["from_y"])
    longest = one["quick"] * one["into_s"] - 0.5 * one["wide"] * one["into_s"] ** 2
    assert (ways <= longest + 1e-9).all()
    assert (ways > 0.97 * longest).all()
    into = np.linspace(0.0, 9.0, 10)
    world: Any = world_of("bowls")
    some = one.iloc[:1].loc[one.index[:1].repeat(10)].assign(into_s=into).reset_index(drop=True)
    end = world.End(some, 5, np.random.default_rng(5))
    assert np.ptp(end.stretches_in(0.4)) > 0.1
    moved = [end.stretches_in(step) for step in (0.0, 1e-6)]
    assert np.allclose(moved[0], 0.0)
    assert np.abs(moved[1]).max() < 1e-5


def test_rollers_stay_on_their_rinks_and_what_lies_does_not_move() -> None:
    rows = _rows()[_are("roller")]
    assert rows.groupby(_ends())["tx_y_m"].agg(np.ptp).max() < 0.5
    lies = _known().groupby(_ends())["runs"].first().eq(0.0)
    spread = _rows().groupby(_ends())[["tx_x_m", "tx_y_m"]].agg(np.ptp).max(axis=1)
    assert lies.sum() == 5
    assert spread[lies].max() == 0.0
    assert spread[~lies].min() > 0.05


def test_only_rollers_have_tags_on_drums_and_these_turn() -> None:
    shift = _shift("tag-on-the-rollers-drum")
    assert not shift[~_are("roller")].any()
    own = shift[_are("roller")]
    assert np.abs(own).max() <= 0.36 * 1.01
    assert own.min() < -0.1 < 0.1 < own.max()


def test_the_skin_rises_with_its_pressure_and_most_where_it_is_high() -> None:
    shift = _shift("skin-breathes", 0.1)
    over = _rows()["inside_pa"].to_numpy() - 245.0
    rises = shift / over / 0.1
    assert (rises[(np.abs(over) > 5) & (_up() > 0.1)] > -1e-4).mean() > 0.9
    assert np.abs(rises[np.abs(over) > 5]).max() < 0.0025
    crown = (KNOTS_M[_knots(), 2] > 8.5) & (_up() > 0.5) & (np.abs(over) > 5)
    assert np.median(rises[crown] / _up()[crown]) == pytest.approx(0.0023, rel=0.1)


def test_a_crown_brings_all_tags_closer_and_those_amid_the_green_most() -> None:
    shift = _shift("crown-of-the-green-left-out", 0.05)
    part = 1 - (2 * _rows()[["tx_x_m", "tx_y_m"]].to_numpy() / np.array(GREEN_M) - 1) ** 2
    assert np.allclose(shift, -0.05 * 0.34 * part.prod(axis=1) * _up(), atol=2e-4)


def test_tapes_that_lean_with_the_skin_read_too_long() -> None:
    shift = _shift("heights-taped-down-the-slope", 0.05)
    less = pd.Series(-shift / _up() / 0.05)[_up() > 0.1].groupby(_knots()[_up() > 0.1])
    lower = less.median()
    assert less.std().max() < 0.01
    assert lower.between(0.0, 0.4).all()
    crown = KNOTS_M[lower.index.to_numpy(), 2] > 8.5
    assert lower[crown].max() < 0.08 < lower[~crown].min()


@pytest.mark.parametrize("ratio", [1, 3])
def test_converters_remember_what_was_read_just_before(ratio: int) -> None:
    world: Any = world_of("bowls")
    made = world.tables(Draw(("converter-remembers-last-answer",), ratio=ratio), 9)
    for kept, plain in ((made.recorded, made.clean), (made.truth, made.simulated)):
        rows = plain.assign(shift=kept["error_m"] - plain["error_m"])
        rows["end"] = rows["link"].str.extract(r"(\d+)")[0]
        rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
        ends = rows.groupby(["copy", "end"], sort=False)
        since, before = ends["time_s"].diff(), ends["range_m"].shift(1)
        wanted = 0.02 * np.exp(-since / 0.012) * (before - rows["range_m"])
        assert np.allclose(rows["shift"], wanted.fillna(0.0), atol=1e-9)


SEEN = (
    "skin-breathes", "crown-of-the-green-left-out", "tag-on-the-rollers-drum",
    "heights-taped-down-the-slope", "converter-remembers-last-answer",
    "knot-dragged-by-a-floodlight",
)  # fmt: skip


@pytest.mark.parametrize("mode", ["ranges", "CIR"])
@pytest.mark.parametrize("name", SEEN)
def test_faults_move_ranges_by_more_than_these_scatter(name: str, mode: str) -> None:
    share, times = moved_of("bowls", name, mode)
    assert share > 0.1
    assert times > 1.5


def test_words_are_feet_and_none_or_five_or_ten_inches() -> None:
    written = _tables("range-rounding").recorded["range_m"].to_numpy() / FOOT_M
    left = np.abs(np.mod(written, 1.0)[:, None] - INCHES).min(axis=1)
    assert left.max() < 1e-9
    assert np.abs(_shift("range-rounding")).max() <= 2.5 * FOOT_M / 12 + 1e-9


def test_only_what_is_behind_something_is_blocked_or_goes_through_things() -> None:
    late = assert_blocked_behind_things("bowls", 0.459)
    assert np.mean(late > 4.39) < 0.4


def test_the_blower_is_heard_by_near_knots_and_by_a_fans_law() -> None:
    made = _tables("noise-floor")
    db = 20 * np.log10((made.recorded["noise_std"] / made.clean["noise_std"]).to_numpy())
    fan = (_rows()["inside_pa"].to_numpy() / 245.0) ** 2.5
    near: list[float] = []
    for knot in range(len(KNOTS_M)):
        here = _knots() == knot
        line, left = np.linalg.lstsq(np.stack([np.ones(here.sum()), fan[here]], 1), db[here])[:2]
        assert left.sum() < 1e-9
        near.append(float(line[1]))
    far = np.linalg.norm(KNOTS_M - np.array([0.5, 17.0, 1.0]), axis=1)
    assert np.allclose(near, 6.5 * np.exp(-far / 14.0))


def test_symbols_that_are_not_counted_take_their_noise_with_them() -> None:
    made = _tables("level-control")
    counts, noise = (
        made.recorded[name] / made.clean[name] for name in ("preamble_count", "noise_std")
    )
    assert np.allclose(noise, np.sqrt(counts))
    assert 0.35 < counts.min() < 0.75


def test_cells_pull_crystals_the_more_the_emptier_they_are() -> None:
    ppm = _shift("clock-offset") / _rows()["reply_time_s"].to_numpy()
    cubes = (_rows()["time_s"].to_numpy() / (8.2 * 3600)) ** 3
    for _, one in _rows().assign(ppm=ppm, spent=cubes).groupby(["tx", "rx"]):
        if len(one) > 2:
            line = np.stack([np.ones(len(one)), one["spent"]], axis=1)
            left = one["ppm"] - line @ np.linalg.lstsq(line, one["ppm"])[0]
            assert np.abs(left).max() < 1e-6


@pytest.mark.parametrize("name", ["time-lag", "exchange-motion"])
def test_what_goes_away_is_read_long_meanwhile(name: str) -> None:
    assert with_speed("bowls", name) > 0.6


def test_hardys_rule_is_exact_for_powers_up_to_the_fifth() -> None:
    for power in range(6):
        assert sum(by / 6 * at**power for by, at in HARDY) == pytest.approx(1 / (1 + power))


def test_edges_take_six_db_where_they_touch_and_ever_more_above() -> None:
    over = np.linspace(0.0, 5.0, 60)
    lost = past_an_edge(over)
    assert lost[0] == pytest.approx(6.02, abs=0.01)
    assert (np.diff(lost) > -0.85).all()  # where pieces are joined
    assert (np.diff(lost[::12]) > 0.5).all()


def test_carpets_return_all_that_grazes_them_and_films_the_more_the_thicker() -> None:
    for upright in (True, False):
        assert np.abs(layered(np.array([1e-6]), (1.9 - 0.1j, 5.0), upright)) == pytest.approx(
            1.0, abs=1e-4
        )
    alone = (np.sqrt(5.0) - 1) / (np.sqrt(5.0) + 1)
    straight = layered(np.ones(1), (5.0 + 0j, 5.0 + 0j), False)
    assert np.abs(straight) == pytest.approx(alone)
    back = film(np.ones(3), np.array([0.0, 1e-4, 1e-3]))
    assert back[0] == 0.0
    assert (np.diff(back) > 0).all()
    assert back.max() < 1.0
    assert of_wood(np.array([0.0, 1.53])) == pytest.approx([1.0, 4.3])


def test_chords_along_the_skin_crowd_towards_its_arc() -> None:
    arc = np.array([1.6])
    ways = np.array([float(chords_m(arc, k)[0]) for k in range(1, 12)])
    assert (np.diff(ways) > 0).all()
    assert (np.diff(ways, 2) < 0).all()
    assert GALLERY_M * 1.6 - ways[-1] < 0.02


def test_oddities_of_late_sizes_do_what_they_say() -> None:
    sizes = np.random.default_rng(4).rayleigh(size=(3, 240))
    slow = slowed(sizes, np.array([20.0, 20.0, 30.0]), 0.5)
    assert np.allclose(slow[0, 20::2], sizes[0, 20 : 20 + len(slow[0, 20::2])])
    assert np.allclose(slow[2, :30], sizes[2, :30])
    framed = windowed(np.ones((1, 32)))
    assert np.allclose(framed[:, :16], framed[:, 16:])
    assert (framed**2).mean() == pytest.approx(1.0)
    kept = summits(sizes)
    assert np.isclose(kept, sizes).mean() == pytest.approx(1 / 3, abs=0.06)
    waves = in_polar_steps(sizes * np.exp(1j * np.arange(240)), 0.25)
    assert np.allclose(np.abs(waves) / 0.25, np.rint(np.abs(waves) / 0.25))
    turned = np.angle(waves[np.abs(waves) > 0]) * 16 / (2 * np.pi)
    assert np.allclose(turned, np.rint(turned))


def test_first_paths_are_where_they_are_however_high_and_never_sooner_if_deaf() -> None:
    top = 60 + np.linspace(0, 1, 20)
    pulse, later, soon = (pulses(top + off).astype(np.complex128) for off in (0.0, 9.4, 3.3))
    low, high = (first_paths(size * pulse, np.full(20, 0.002)) for size in (1.0, 40.0))
    assert np.allclose(low, high, atol=1e-9)
    assert np.allclose(top - low, AHEAD, atol=0.02)
    both = 0.3 * pulse + later
    sharp, deaf = (first_paths(both, np.full(20, 0.002), much) for much in (0.0, 2.0))
    assert np.allclose(deaf - sharp, 9.4, atol=0.05)
    near = 0.5 * pulse + soon
    assert (first_paths(near, np.full(20, 0.02), 2.0) >= first_paths(near, np.full(20, 0.02))).all()
