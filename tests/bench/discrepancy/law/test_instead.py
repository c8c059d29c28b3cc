"""Laws in the place of names that they undo, and over whatever column is known."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.law import instead
from bench.discrepancy.law.material import Material, material
from bench.discrepancy.law.search import propose
from bench.discrepancy.select.candidates import Explanation
from bench.discrepancy.select.state import Round, Search, Selection
from bench.discrepancy.select.verdict import Control, LeftOut
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.temperature import TemperatureDrift

LINKS = np.repeat(np.arange(60), 5)
SURE = Estimate(1.0, 0.9, 1.1)


def rows(seed: int, own: int) -> tuple[pd.DataFrame, np.random.Generator]:
    """Return rows of links with temperatures, hours, and as many columns that tell nothing."""
    rng = np.random.default_rng(seed)
    count = len(LINKS)
    frame = pd.DataFrame({"true_range_m": rng.uniform(3, 30, count), "error_m": 0.0})
    frame["temperature_c"], frame["hours"] = rng.uniform(15, 40, count), rng.uniform(0, 6, count)
    for number in range(own):
        frame[f"own_{number}"] = rng.uniform(0, 1, count)
    return frame, rng


def test_a_law_is_found_over_the_last_of_many_columns() -> None:
    frame, rng = rows(1, 24)
    frame["walked_m"] = rng.uniform(0, 60, len(frame))
    error = 0.1 * np.cos(2 * np.pi * frame["walked_m"] / 1.4) + rng.normal(0, 0.02, len(frame))
    found = propose(material(frame, error.to_numpy(), LINKS), 0)
    assert found is not None
    assert (found.best.structure.form, found.best.structure.columns) == ("periodic", ("walked_m",))


@pytest.mark.parametrize(
    ("drift_is_there", "own_form", "gone"),
    [(False, False, True), (True, False, False), (False, True, False)],
)
def test_a_name_that_a_law_undoes_goes(
    monkeypatch: pytest.MonkeyPatch, drift_is_there: bool, own_form: bool, gone: bool
) -> None:
    """Of what goes with temperature times hours a drift takes a part, and a law gives it back."""
    frame, rng = rows(2, 0)
    warm = frame["temperature_c"].to_numpy() - 25
    law = 0.002 * frame["hours"].to_numpy() * frame["temperature_c"].to_numpy()
    known = 0.02 * frame["true_range_m"].to_numpy() if drift_is_there else 0.0 * law
    error = law + known + rng.normal(0, 0.02, len(frame))
    drift = TemperatureDrift(slope_mm_per_c=5.0)
    does = known if drift_is_there else 0.005 * warm

    def left(_: object, __: object, added: tuple[object, ...]) -> Material:
        return material(frame, error - does * (drift in added), LINKS)

    monkeypatch.setattr(instead, "gathered", left)
    monkeypatch.setattr(instead, "has_form", lambda *_: own_form)
    option = LeftOut(drift, (), SURE, 1.0, Control("", None))
    explained = cast(Explanation, SimpleNamespace(contenders=(), removable=SURE))
    turn = Round(SimpleNamespace(findings=()), explained, drift)  # type: ignore[arg-type]
    found = Selection((option,), (drift,), (turn,), together=(drift.physics,))
    search = cast(Search, SimpleNamespace(comparison=None, seed=0, kinds={}, discover=None))
    rest = left(None, None, (drift,))
    after = propose(rest, 0)
    assert after is not None
    made = instead.undone(search, found, (), rest, after)
    assert (made is not None) is gone
    if made is not None:
        assert made[0].added == ()
        assert not made[0].names
        assert set(made[1].best.structure.columns) <= {"hours", "temperature_c"}


@pytest.mark.parametrize("own", [True, False])
def test_a_scale_of_every_devices_own_gives_way_to_no_cycle_of_when_they_were_used(
    own: bool,
) -> None:
    """Six hooks count by beats of their own, one after the other: a cycle over the time, nearly."""
    frame, rng = rows(3, 0)
    device = LINKS % 6
    frame["tx"] = np.char.add("hook", device.astype(str)).astype(object)
    frame["time_s"] = 300.0 * device + rng.uniform(0, 300, len(frame))
    far_m, phase = frame["true_range_m"].to_numpy(), frame["time_s"].to_numpy() / 1800
    sizes = np.array([0.009, 0.013, 0.012, 0.008, 0.005, 0.006])[device]
    scale = sizes if own else 0.009 + 0.004 * np.sin(2 * np.pi * phase)
    error = scale * far_m + rng.normal(0, 0.005, len(frame))
    alone = propose(material(frame, error, LINKS), 0)
    assert alone is not None
    rest = material(frame, error - 0.009 * far_m, LINKS)
    named = (RangeScale(0.009),)
    assert instead.leads(alone, rest, None, named) is not own
    assert instead.leads(alone, rest, None, (TemperatureDrift(slope_mm_per_c=5.0),))
