"""The hangar: what is particular to it, and what its receivers leave alone."""

from __future__ import annotations

from functools import partial

import numpy as np
import pytest

from bench.challenge.families.case import Tables
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "hangar"), partial(shift_of, "hangar")


def _lifted(made: Tables) -> np.ndarray:
    return np.asarray(made.recorded["tx"].str.startswith("lift"), bool)


def test_booms_droop_below_where_sensors_have_them_and_tugs_do_not() -> None:
    made, shift = _tables("booms-droop"), _shift("booms-droop")
    lifted = _lifted(made)
    assert not shift[~lifted].any()
    assert (np.abs(shift) <= 0.0034 * 10.5**2 + 1e-9).all()
    below = lifted & (made.recorded["tx_z_m"] + 1 < made.recorded["rx_z_m"]).to_numpy()
    assert below.any()
    assert (shift[below] > -1e-9).all()  # lower is farther from what hangs above


def test_a_tag_on_the_towbar_is_off_along_the_way_a_tug_drives() -> None:
    """What a tug comes closer by, it is closer by already: both go by the same angle."""
    made, shift = _tables("tags-on-the-towbar"), _shift("tags-on-the-towbar")
    lifted, rows = _lifted(made), made.recorded
    assert not shift[lifted].any()
    assert np.abs(shift).max() < 0.5 + 1e-9
    onward = rows.groupby("link")["true_range_m"].diff().to_numpy()
    drives = ~lifted & (np.abs(np.nan_to_num(onward)) > 0.15)
    assert (np.sign(shift[drives]) == np.sign(onward[drives])).mean() > 0.9


@pytest.mark.parametrize("ratio", [1, 3])
def test_torn_words_have_new_high_digits_and_the_low_ones_of_the_range_before(ratio: int) -> None:
    made = _tables("words-torn-in-reading", 1.0, ratio=ratio)
    for kept, plain in ((made.recorded, made.clean), (made.truth, made.simulated)):
        assert plain is not None
        copy = kept.groupby(["link", "time_s"]).cumcount()
        links = plain.assign(copy=copy).groupby(["link", "copy"], sort=False)
        before = links["range_m"].shift(1).fillna(plain["range_m"])
        torn = 0.6 * np.floor(plain["range_m"] / 0.6) + np.mod(before, 0.6)
        there = kept["rx"].str[-1].astype(int) % 3 != 1
        assert np.allclose(kept["range_m"], np.where(there, torn, plain["range_m"]))


def test_what_is_rounded_twice_is_in_whole_steps_and_more_often_up() -> None:
    steps = _tables("range-rounding").recorded["range_m"].to_numpy() / 0.13
    assert np.allclose(steps, np.rint(steps))
    assert 0.01 < _shift("range-rounding").mean() < 0.03  # an eighth of a step


def test_tugs_keep_their_height_and_baskets_keep_to_their_booms() -> None:
    made = _tables("")
    rows, lifted = made.recorded, _lifted(made)
    jobs = rows["link"].str.extract(r"(\d+)")[0]
    climbs = rows.groupby(jobs)["tx_z_m"].transform(np.ptp)
    assert np.allclose(climbs[~lifted], 0.0)
    assert (climbs[lifted] > 0.01).mean() > 0.5
    assert rows["tx_z_m"][~lifted].between(1.0, 1.35).all()
    assert rows["tx_z_m"][lifted].max() < 1.9 + 10.5
    assert 0.2 < lifted.mean() < 0.8
    for axis, side_m in zip("xyz", (52, 38, 15), strict=True):
        assert rows[f"tx_{axis}_m"].between(0, side_m).all()


def test_slabs_with_echoes_inside_never_hurry_a_wave() -> None:
    shift = _shift("material-delay")
    through = _tables("").recorded["obstacles"].map(lambda some: bool({*some} - {"metal"}))
    assert (shift[through] > 0.02).all()
    assert not shift[~through].any()
