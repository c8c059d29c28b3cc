"""Devices that round in ways of their own to one grid: down, up or to the nearest point."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.physics.base import Base
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.units import Floats

COUNT = 10  # of anchors, at the end that rounds
LINKS = np.repeat(np.arange(80), 4)
OF = (np.arange(80) % COUNT)[LINKS]
STEP_M = 0.12
LEANS: Floats = np.where(np.arange(COUNT) < 4, -0.5, 0.0)


def rows(leans: Floats, delays_m: Floats) -> pd.DataFrame:
    """Return rows whose ranges, delayed by anchors, are put on one grid as these lean."""
    rng = np.random.default_rng(5)
    true = rng.uniform(3, 28, 80)[LINKS] + rng.uniform(-0.3, 0.3, len(LINKS))
    read = true + rng.normal(0, 0.03, len(LINKS)) + delays_m[OF]
    read = STEP_M * np.rint(read / STEP_M + leans[OF])
    names = {"link": LINKS, "tx": [f"tag{i % 7}" for i in LINKS], "rx": [f"a{i}" for i in OF]}
    return pd.DataFrame({**names, "true_range_m": true, "range_m": read})


def found(table: pd.DataFrame) -> RangeRounding:
    left = (table["range_m"] - table["true_range_m"]).to_numpy()
    made = RangeRounding.fit_values(table, left)
    assert isinstance(made, RangeRounding)
    return made


def test_leans_of_devices_are_found_and_what_they_do() -> None:
    table = rows(LEANS, np.zeros(COUNT))
    made = found(table)
    assert made.of == "rx"
    assert dict(zip(made.devices, made.leans, strict=True)) == {
        f"a{i}": lean for i, lean in enumerate(LEANS)
    }
    assert sorted(made.values()) == ["origin_m", "step_m"]
    given = scene(table.drop(columns=["range_m"]))
    whole = np.asarray(Simulator(Base(), (made,), 0).observe(given, 0, cir=False).range_m)
    assert np.abs(whole / STEP_M - np.rint(whole / STEP_M)).max() < 0.01
    left = table["range_m"].to_numpy() - whole
    assert max(abs(left[i == OF].mean()) for i in range(COUNT)) < 0.02


def test_forms_of_leans_are_those_that_all_have_and_those_of_devices() -> None:
    made = found(rows(LEANS, np.zeros(COUNT)))
    *alike, own = made.forms()
    assert own == made
    assert [one.lean for one in alike if isinstance(one, RangeRounding)] == [0.0, -0.5, 0.5]
    assert not any(one.leans for one in alike if isinstance(one, RangeRounding))


def test_one_lean_of_all_is_none_of_devices() -> None:
    made = found(rows(np.full(COUNT, -0.5), np.zeros(COUNT)))
    assert (made.lean, made.leans) == (-0.5, ())


def test_what_leans_do_in_the_mean_is_half_a_step_of_their_devices() -> None:
    table = rows(LEANS, np.zeros(COUNT))
    given = scene(table.drop(columns=["range_m"]))
    assert found(table).leant_m(given) == pytest.approx(STEP_M * LEANS[OF])
    assert RangeRounding(STEP_M, lean=0.5).leant_m(given) == pytest.approx(STEP_M / 2)


def test_leans_of_devices_pay_for_their_choice() -> None:
    made = found(rows(LEANS, np.zeros(COUNT)))
    assert made.chosen_nats == pytest.approx(COUNT * np.log(2) + np.log(3))
    assert RangeRounding(STEP_M).chosen_nats == 0
