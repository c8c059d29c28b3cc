"""A fit begins where a set says: a drift in the cold has no good slope about 25 degrees."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.fit.search import Fitted
from bench.discrepancy.select.link_mixture import Mixture, strike
from bench.discrepancy.sets import install
from bench.discrepancy.sets.choice import Choice
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.effects.ranging.temperature import TemperatureDrift
from bench.physics.scene import Scene, scene
from bench.physics.simulator import Simulator


def cold(rows: int = 40) -> Scene:
    """Return rows at -12 to 4 degrees."""
    warm = np.linspace(-12, 4, rows)
    return scene(pd.DataFrame({"true_range_m": np.full(rows, 5.0), "temperature_c": warm}))


def test_a_drift_is_like_a_line_over_the_temperature() -> None:
    rows = cold()
    shift = -0.003 * (rows.number("temperature_c", 0.0) + 6)
    like = TemperatureDrift.like(rows, shift)
    assert like["slope_mm_per_c"] == pytest.approx(-3)
    assert like["reference_c"] == pytest.approx(-6)
    assert TemperatureDrift.like(rows, np.ones(len(rows))) == {}
    assert RangeScale.like(rows, shift) == {}


@pytest.mark.parametrize(("warm_m", "cold_m"), [(0.0, 0.12), (0.04, -0.1)])
def test_a_drift_is_like_what_relaxes_where_no_temperature_is_known(
    warm_m: float, cold_m: float
) -> None:
    """What was calibrated warm is off at first: no rise from nothing does that."""
    time_s = np.linspace(0, 700, 90)
    rows = scene(pd.DataFrame({"true_range_m": np.full(90, 5.0), "time_s": time_s}))
    shift = warm_m + cold_m * np.exp(-time_s / 150)
    drift = TemperatureDrift(**TemperatureDrift.like(rows, shift))
    made = Simulator(effects=(drift,)).observe(rows, cir=False)
    plain = Simulator().observe(rows, cir=False)
    np.testing.assert_allclose(made.range_m - plain.range_m, shift, atol=0.003)


@pytest.mark.parametrize("better", [True, False])
def test_a_fit_begins_with_what_the_set_has_it_do_if_that_is_better(
    monkeypatch: pytest.MonkeyPatch, better: bool
) -> None:
    rows = cold()
    shift = -0.003 * (rows.number("temperature_c", 0.0) + 6)
    first = Fitted(TemperatureDrift(), 1.0, 9)
    monkeypatch.setattr(install, "screen", lambda *_, **__: first)

    class Gain:
        kind, view = TemperatureDrift, SimpleNamespace(scene=rows, rows=np.arange(len(rows)))

        def __call__(self, _: dict[str, float]) -> float:
            return 2.0 if better else 0.5

    search = SimpleNamespace(choice=Choice(shifts_m={"temperature-drift": shift}))
    begun = install._begun(search, Gain(), "temperature-drift")  # type: ignore[arg-type]
    assert (begun is first) is not better
    unknown = install._begun(search, Gain(), "range-scale")  # type: ignore[arg-type]
    assert unknown is first


@pytest.mark.parametrize(("lead", "struck"), [(0.0, True), (3.0, False)])
def test_what_strikes_at_random_must_lead_names_that_say_which(
    monkeypatch: pytest.MonkeyPatch, lead: float, struck: bool
) -> None:
    module = "bench.discrepancy.select.link_mixture"
    found = SimpleNamespace(evidence=SimpleNamespace(value=80.0))
    monkeypatch.setattr(f"{module}._one", lambda *_: (found, 122.5))
    monkeypatch.setattr(f"{module}.strikable", lambda *_: True)
    monkeypatch.setattr(f"{module}.offsets", lambda *_: None)
    monkeypatch.setattr(f"{module}.unstruck", lambda _: Mixture(121.3, 0, 0, 0))
    view = SimpleNamespace(recorded=SimpleNamespace(names=("error_m",)))
    names, kinds = (RangeScale(),), {"blocked-path": BlockedPath}
    made = strike(None, view, (), names, kinds, lead)  # type: ignore[arg-type]
    assert (made is not None) is struck
