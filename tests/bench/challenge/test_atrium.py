"""The atrium: what is particular to it, and what its receivers leave alone."""

from __future__ import annotations

from functools import partial
from typing import Any

import numpy as np
import pytest

from bench.challenge.families.case import Draw, Tables, world_of
from tests.bench.challenge.shown import shift_of, tables_of

_tables, _shift = partial(tables_of, "atrium"), partial(shift_of, "atrium")


def _rides_a_car(made: Tables) -> np.ndarray:
    return np.asarray(made.recorded["tx"].str.startswith("car"), bool)


def test_a_worn_wheel_lowers_cars_by_a_part_of_their_height_and_no_robots() -> None:
    made, shift = _tables("encoder-wheel-worn"), _shift("encoder-wheel-worn")
    cars, high_m = _rides_a_car(made), made.recorded["tx_z_m"] - 2.5
    assert not shift[~cars].any()
    assert (np.abs(shift) <= 0.0211 * high_m.clip(lower=0.0) + 1e-9).all()
    above = cars & (made.recorded["tx_z_m"] > made.recorded["rx_z_m"] + 1).to_numpy()
    assert (shift[above] <= 1e-9).all()
    assert np.abs(shift[cars]).mean() > 0.02


def test_ranges_that_are_snapped_are_right_at_landings() -> None:
    made, shift = _tables("snapped-to-landings"), _shift("snapped-to-landings")
    cars = _rides_a_car(made)
    storeys = (made.recorded["tx_z_m"].to_numpy() - 2.5) / 3.6
    off_m = 3.6 * np.abs(storeys - np.rint(storeys))
    assert (np.abs(shift[cars]) <= 0.23 * off_m[cars] + 1e-9).all()
    assert not shift[~cars].any()
    assert np.abs(shift[cars & (off_m > 1)]).mean() > 0.1


def test_rounded_ranges_are_whole_steps_and_a_quarter() -> None:
    steps = _tables("range-rounding").recorded["range_m"].to_numpy() / 0.125
    assert np.allclose(steps - 0.25, np.rint(steps - 0.25))


def test_cars_keep_to_their_wells_and_robots_to_floors() -> None:
    made = _tables("")
    rows, cars = made.recorded, _rides_a_car(made)
    wells = rows[cars].groupby("tx")[["tx_x_m", "tx_y_m"]].nunique()
    assert (wells == 1).all(axis=None)
    floors = (rows["tx_z_m"].to_numpy() - 0.9) / 3.6
    assert np.allclose(floors[~cars], np.rint(floors[~cars]))
    assert 0.3 < cars.mean() < 0.8


@pytest.mark.parametrize("name", ["small-scale-fading", "specular-reflections", "path-loss"])
def test_what_is_on_the_way_leaves_the_noise_of_receivers_as_large_as_it_was(name: str) -> None:
    """No echo repeats the noise, fading does not scale it, and a loss leaves all of it."""
    world: Any = world_of("atrium", "CIR")
    made = world.tables(Draw((name,), 2.0, 1), 9)
    found, plain = (np.stack(list(t["cir"]))[:, :8] for t in (made.recorded, made.clean))
    power = [np.median((one**2).mean(axis=1)) for one in (found, plain)]  # some lose first paths
    assert power[0] == pytest.approx(power[1], rel=0.06)
    assert made.recorded["noise_std"].equals(made.clean["noise_std"])


def test_the_truth_draws_chances_anew() -> None:
    world: Any = world_of("atrium", "CIR")
    for name in ("timestamp-jitter", "obstructed-path"):
        made = world.tables(Draw((name,), 1.0, 1), 9)
        shifts = [
            (made.recorded["error_m"] - made.clean["error_m"]).to_numpy(),
            (made.truth["error_m"] - made.clean["error_m"]).to_numpy(),
        ]
        assert np.corrcoef(*shifts)[0, 1] < 0.5
