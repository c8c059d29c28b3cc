"""The chairlift: what is particular to it, and what its receiver leaves alone."""

from __future__ import annotations

from typing import Any

import numpy as np
import pytest

from bench.challenge.families.case import Draw, world_of
from tests.bench.challenge.shown import shift_of, tables_of

FAMILY = "chairlift"


def test_wind_blows_chairs_aside_and_no_groomers() -> None:
    made, shift = (
        tables_of("chairlift", "chairs-blown-aside"),
        shift_of("chairlift", "chairs-blown-aside"),
    )
    rows = made.recorded
    chairs = rows["tx"].str.startswith("chair").to_numpy()
    assert not shift[~chairs].any()
    aside = 0.0056 * rows["wind_mps"] ** 2
    assert (np.abs(shift) <= 1.05 * aside + 1e-9).all()
    assert np.abs(shift[chairs]).mean() > 0.01


def test_a_loaded_rope_is_lower_amid_spans_and_not_at_its_saddles() -> None:
    made, shift = (
        tables_of("chairlift", "rope-hangs-lower"),
        shift_of("chairlift", "rope-hangs-lower"),
    )
    rows = made.recorded
    chairs = rows["tx"].str.startswith("chair").to_numpy()
    assert not shift[~chairs].any()
    saddle = np.array([4.0, 27.0, 51.0, 74.0, 99.0, 120.0])
    off = np.abs(rows["tx_x_m"].to_numpy()[:, None] - saddle).min(axis=1)
    assert np.abs(shift[chairs & (off > 5)]).mean() > 2 * np.abs(shift[chairs & (off < 2)]).mean()
    below = chairs & (rows["tx_z_m"] < rows["rx_z_m"] - 1).to_numpy()
    assert (shift[below] >= -1e-9).all()
    assert np.abs(shift).max() < 0.00095 * 25.0**2 + 0.02


@pytest.mark.parametrize("ratio", [1, 3])
def test_a_leading_filter_goes_on_by_a_part_of_the_last_change(ratio: int) -> None:
    made = tables_of("chairlift", "lead-in-the-filter", 1.0, ratio=ratio)
    assert made.simulated is not None
    for kept, plain in ((made.recorded, made.clean), (made.truth, made.simulated)):
        copy = plain.groupby(["link", "time_s"]).cumcount()
        change = plain["range_m"].groupby([plain["link"], copy]).diff().fillna(0.0)
        own = plain["rx"].str[5:].astype(int) % 2
        assert np.allclose(kept["range_m"], plain["range_m"] + 0.55 * change * own)


def test_pylons_of_two_makes_round_to_steps_of_their_own() -> None:
    rows = tables_of("chairlift", "range-rounding").recorded
    step = np.where(rows["rx"].str[5:].astype(int) % 4 < 2, 0.14, 0.085)
    steps = rows["range_m"].to_numpy() / step
    assert np.allclose(steps, np.rint(steps))


def test_chairs_keep_to_their_side_below_the_rope_and_groomers_to_the_snow() -> None:
    rows = tables_of("chairlift", "").recorded
    chairs = rows["tx"].str.startswith("chair")
    over = rows["tx_z_m"] - 0.3 * rows["tx_x_m"]
    assert rows["tx_y_m"][chairs].abs().between(2.2, 3.2).all()
    assert over[chairs].between(5.0, 7.0).all()
    assert np.allclose(over[~chairs], 2.9)
    assert 0.2 < (~chairs).mean() < 0.5


@pytest.mark.parametrize("name", ["small-scale-fading", "specular-reflections", "path-loss"])
def test_what_is_on_the_way_leaves_the_noise_of_receivers_as_large_as_it_was(
    name: str,
) -> None:
    """No echo repeats the noise, fading does not scale it, and a loss leaves all of it."""
    world: Any = world_of(FAMILY, "CIR")
    made = world.tables(Draw((name,), 2.0, 1), 9)
    found, plain = (np.stack(list(t["cir"]))[:, :8] for t in (made.recorded, made.clean))
    power = [np.median((one**2).mean(axis=1)) for one in (found, plain)]  # some lose first paths
    assert power[0] == pytest.approx(power[1], rel=0.06)
    assert made.recorded["noise_std"].equals(made.clean["noise_std"])


def test_the_truth_draws_chances_anew() -> None:
    world: Any = world_of(FAMILY, "CIR")
    for name in ("timestamp-jitter", "obstructed-path"):
        made = world.tables(Draw((name,), 1.0, 1), 9)
        shifts = [
            (made.recorded["error_m"] - made.clean["error_m"]).to_numpy(),
            (made.truth["error_m"] - made.clean["error_m"]).to_numpy(),
        ]
        assert np.corrcoef(*shifts)[0, 1] < 0.5
