"""The manege: what is particular to it, and what its receivers leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np

from bench.challenge.families.case import Tables
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "manege"), partial(shift_of, "manege")


def _ridden(made: Tables) -> np.ndarray:
    return np.asarray(made.recorded["rx"].str.startswith("horse"), bool)


def test_riders_crouch_no_lower_than_half_a_metre_and_harrows_do_not() -> None:
    made, shift = _tables("riders-crouch-at-speed"), _shift("riders-crouch-at-speed")
    horses, rows = _ridden(made), made.recorded
    assert not shift[~horses].any()
    up = (rows["tx_z_m"] - rows["rx_z_m"]).to_numpy() / rows["true_range_m"].to_numpy()
    assert (np.abs(shift) <= 0.55 * np.abs(up) + 0.05).all()
    assert (shift[up > 0] >= -1e-9).all()  # letters hang above riders: lower is farther
    still = rows.groupby("link")["true_range_m"].transform(np.ptp).eq(0).to_numpy()
    alone = rows.groupby("link")["link"].transform("size").eq(1).to_numpy()
    assert np.abs(shift[still & ~alone]).max() < 1e-9


def test_letters_of_short_sides_are_where_they_were_set_and_others_are_farther_in() -> None:
    made, shift = _tables("letters-along-a-slack-cord"), _shift("letters-along-a-slack-cord")
    ends = made.recorded["tx"].isin(["letter0", "letter6"]).to_numpy()
    assert not shift[ends].any()
    assert (np.abs(shift) <= 0.34 + 1e-9).all()
    middle = made.recorded["tx"].isin(["letter3", "letter9"]).to_numpy()
    assert np.abs(shift[middle]).mean() > 0.1
    assert (shift[~ends] < 1e-9).mean() > 0.95  # nearer to what is between them


def test_antennas_take_turns_so_that_ranges_are_long_in_one_round_and_short_in_the_next() -> None:
    made, shift = _tables("antennas-by-turns"), _shift("antennas-by-turns")
    horses, rows = _ridden(made), made.recorded
    assert not shift[~horses].any()
    assert np.abs(shift).max() < 0.23 + 1e-9
    seen = rows[horses].assign(shift=shift[horses])
    turned = seen.groupby("link")["shift"].transform(lambda one: one * one.shift(1)).dropna()
    loud = np.abs(turned) > 0.05**2
    assert (turned[loud] < 0).mean() > 0.97


def test_ranges_are_cut_down_from_an_end_that_every_letter_has() -> None:
    made = _tables("range-rounding")
    turn = np.cos(2 * np.pi * made.recorded["range_m"] / 0.128)
    by_letter = turn.groupby(made.recorded["tx"])
    assert by_letter.agg(np.ptp).max() < 1e-6
    assert by_letter.first().nunique() == 12
    assert (_shift("range-rounding") <= 0).all()


def test_horses_and_harrows_keep_to_the_arena_and_letters_take_turns() -> None:
    rows = _tables("").recorded
    assert rows["rx_x_m"].between(1, 63).all()
    assert rows["rx_y_m"].between(1, 22).all()
    assert (rows["rx_z_m"] > 1.2).equals(rows["rx"].str.startswith("horse"))
    lessons = rows.groupby(rows["link"].str.extract(r"(\d+)")[0])
    assert lessons["tx"].nunique().between(3, 7).all()
    assert lessons["rx"].nunique().eq(1).all()
    assert lessons["time_s"].apply(lambda one: one.is_monotonic_increasing).all()
    tall = rows["rx"].str.startswith("horse")
    assert 0.4 < tall.mean() < 0.95
    assert lessons["true_range_m"].agg(lambda one: one.mean()).std() > 2
