"""Devices that round to steps of their own, or count them from ends of their own."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.base import Base
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.units import Floats

ANCHORS = np.arange(60) % 4  # of links, at the end that rounds
LINKS = np.repeat(np.arange(60), 5)
OF = ANCHORS[LINKS]


def rows(steps_m: Floats, origins_m: Floats, after_m: float = 0.0) -> pd.DataFrame:
    """Return rows whose ranges are cut down to grids of anchors, which may scatter afterwards."""
    rng = np.random.default_rng(8)
    true = rng.uniform(3, 28, 60)[LINKS] + rng.uniform(-0.3, 0.3, len(LINKS))
    read = true + rng.normal(0, 0.04, len(LINKS))
    step, origin = steps_m[OF], origins_m[OF]
    read = np.floor((read - origin) / step) * step + origin + rng.normal(0, after_m, len(LINKS))
    names = {"link": LINKS, "tx": [f"tag{i % 7}" for i in LINKS], "rx": [f"a{i}" for i in OF]}
    return pd.DataFrame({**names, "true_range_m": true, "range_m": read})


SAME: Floats = np.full(4, 0.13)
TWO: Floats = np.array([0.07, 0.0425, 0.07, 0.0425])
PRINTED: Floats = np.array([0.28, 0.17, 0.28, 0.17])  # of whole centimetres, which all lie on
ORIGINS: Floats = np.array([0.01, 0.047, -0.031, 0.055])


@pytest.mark.parametrize(
    ("steps_m", "origins_m"), [(SAME, ORIGINS), (TWO, 0 * ORIGINS), (PRINTED, 0 * ORIGINS)]
)
def test_grids_of_devices_are_found_and_what_they_do(steps_m: Floats, origins_m: Floats) -> None:
    table = rows(steps_m, origins_m)
    read, true = (table[name].to_numpy() for name in ("range_m", "true_range_m"))
    made = RangeRounding.fit_values(table, read - true)
    assert isinstance(made, RangeRounding)
    assert (made.of, made.lean, sorted(made.devices)) == ("rx", -0.5, ["a0", "a1", "a2", "a3"])
    steps = dict(zip(made.devices, made.steps_m, strict=True))
    assert [steps[f"a{i}"] for i in range(4)] == pytest.approx(list(steps_m), rel=1e-4)
    assert sorted(made.values()) == [f"step_m[a{i}]" for i in range(4)]
    given = scene(table.drop(columns=["range_m"]))
    whole = Simulator(Base(), (made,), 0).observe(given, 0, cir=False).range_m
    assert whole is not None
    place = (np.asarray(whole) - origins_m[OF]) / steps_m[OF]
    assert np.abs(place - np.rint(place)).max() < 0.01


def test_devices_that_scatter_after_have_no_grids() -> None:
    table = rows(SAME, ORIGINS, 0.02)
    left = table["range_m"].to_numpy() - table["true_range_m"].to_numpy()
    assert RangeRounding.fit_values(table, left) is None


def test_one_device_with_a_grid_is_no_rounding_of_all() -> None:
    table, plain = rows(SAME, ORIGINS), rows(SAME, ORIGINS, 0.02)
    table.loc[OF != 2, "range_m"] = plain["range_m"][OF != 2]
    left = table["range_m"].to_numpy() - table["true_range_m"].to_numpy()
    assert RangeRounding.fit_values(table, left) is None


def test_what_is_printed_to_centimetres_has_no_grids_of_devices() -> None:
    table = rows(SAME, ORIGINS, 0.02).round({"range_m": 2})
    left = table["range_m"].to_numpy() - table["true_range_m"].to_numpy()
    made = RangeRounding.fit_values(table, left)
    assert isinstance(made, RangeRounding)
    assert (made.of, made.step_m) == ("", pytest.approx(0.01))
