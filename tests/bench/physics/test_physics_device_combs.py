"""Devices that round to steps of their own, or count them from ends of their own."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.base import Base
from bench.physics.comb import comb
from bench.physics.device_combs import _of_device
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


def test_how_devices_with_steps_of_their_own_round_is_asked_beside_their_delays() -> None:
    """Delays of devices made up for the half step, and no interval of theirs held the truth."""
    table = rows(TWO, 0 * ORIGINS)
    late = table["range_m"].to_numpy() - table["true_range_m"].to_numpy() + 0.035
    made = RangeRounding.fit_values(table, late)
    assert isinstance(made, RangeRounding)
    forms = made.forms()
    assert [one.lean for one in forms] == [0.0, -0.5, 0.5]  # type: ignore[attr-defined]
    assert forms[0].not_told_from(forms).untold == (-0.5, 0.5)  # type: ignore[attr-defined]


def test_devices_that_scatter_after_have_no_grids() -> None:
    table = rows(SAME, ORIGINS, 0.02)
    left = table["range_m"].to_numpy() - table["true_range_m"].to_numpy()
    assert RangeRounding.fit_values(table, left) is None


def test_one_device_with_a_grid_rounds_and_the_others_do_not() -> None:
    table, plain = rows(SAME, ORIGINS), rows(SAME, ORIGINS, 0.02)
    table.loc[OF != 2, "range_m"] = plain["range_m"][OF != 2]
    read, true = (table[name].to_numpy() for name in ("range_m", "true_range_m"))
    made = RangeRounding.fit_values(table, read - true)
    assert isinstance(made, RangeRounding)
    assert (made.of, made.lean) == ("rx", -0.5)
    assert made.values() == pytest.approx({"step_m[a2]": 0.13})
    given = scene(table.drop(columns=["range_m"]))
    whole, bare = (
        np.asarray(Simulator(Base(), some, 0).observe(given, 0, cir=False).range_m)
        for some in ((made,), ())
    )
    assert np.array_equal(whole[OF != 2], bare[OF != 2])
    place = (whole[OF == 2] - ORIGINS[2]) / SAME[2]
    assert np.abs(place - np.rint(place)).max() < 0.01


def test_places_of_few_links_do_not_hide_an_exact_grid() -> None:
    rng = np.random.default_rng(5)
    links = np.repeat(np.arange(6), 20)
    true = rng.uniform(3, 15, 6)[links]
    for kind in ("cut", "free"):
        read = true + rng.normal(0, 0.02, len(links))
        read = np.floor(read / 0.1) * 0.1 if kind == "cut" else read
        made = comb(read, true + rng.normal(0, 0.02, len(links)), links)
        assert (made is not None and made.step_m == pytest.approx(0.1)) == (kind == "cut")


def test_centimetres_lie_on_a_grid_of_five_by_chance() -> None:
    rng, links = np.random.default_rng(0), np.arange(12)
    read = 0.05 * rng.choice(np.arange(60, 260), 12, replace=False)
    plain = read + rng.normal(0, 0.05, 12)
    assert _of_device(read, plain, links, 0.01) is None
    assert _of_device(read, plain, links, 0.0001) is not None


def test_what_is_printed_to_centimetres_has_no_grids_of_devices() -> None:
    table = rows(SAME, ORIGINS, 0.02).round({"range_m": 2})
    left = table["range_m"].to_numpy() - table["true_range_m"].to_numpy()
    made = RangeRounding.fit_values(table, left)
    assert isinstance(made, RangeRounding)
    assert (made.of, made.step_m) == ("", pytest.approx(0.01))
