"""Intervals hold what an effect may do beside causes of which less is known."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.doubt import QUANTILE, with_doubt
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.sets.believed import Believed, Unsure
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.fitted.power_curve import PowerCurve, at_level
from bench.physics.effects.ranging.range_scale import RangeScale
from bench.physics.simulator import Simulator

WORLD = Resimulation(Simulator(Base(), (), 3), Window())
ONE = ParameterEstimate("scale", 0.01, 0.009, 0.011, "m/m")
LEVEL = ParameterEstimate(at_level(-85.0), 0.02, 0.01, 0.03, "m")


@pytest.fixture(scope="module")
def seen() -> View:
    rng = np.random.default_rng(0)
    range_m = rng.uniform(2, 20, 200)
    frame = pd.DataFrame(
        {"link": [f"l{i // 4}" for i in range(200)], "true_range_m": range_m, "error_m": 0.0}
    )
    frame["range_m"], frame["rx_power_dbm"] = range_m, rng.uniform(-95, -70, 200)
    return view(frame, link_codes(frame), np.arange(200), Window(), ("error_m",), False)


def _known(columns: np.ndarray, *sets: tuple[float, float, float], before: float = 0.0) -> Unsure:
    """Return what sets of a share, a factor and a variance say; 1 is the variance alone.

    `before`: how surely a factor is known before, of the inverse variance.
    """

    def said(share: float, factor: float, variance: float, known: float = before) -> Believed:
        told = np.array([[1 / variance - known]])
        return Believed(share, np.array([factor]), told, np.array([known]), np.array([True]))

    return Unsure(columns, tuple(said(*one) for one in sets), said(1.0, 0.0, 1.0, 0.0))


def _interval(
    seen: View, known: Unsure, one: ParameterEstimate = ONE, effect: Effect | None = None
) -> ParameterEstimate:
    (made,) = with_doubt(WORLD, seen, (), effect or RangeScale(scale=0.01), (one,), known)
    return made


def _of_range(seen: View) -> np.ndarray:
    return 0.01 * seen.scene.true_range_m[:, None]


def test_what_a_score_leaves_open_is_as_wide_as_the_joint_fit_knows(seen: View) -> None:
    """Of one simulated row a score is too rough to be bent as much as it is."""
    loose = ParameterEstimate("scale", 0.01, -0.05, 0.05, "m/m", determined=False)
    known = _known(0.1 * _of_range(seen), (1.0, 1.0, 1.0))
    made = _interval(seen, known, loose)
    assert made.determined
    assert (made.low, made.high) == pytest.approx((0.01 - 0.001645, 0.01 + 0.001645), abs=1e-5)
    nothing = _interval(seen, known, loose, RangeScale(scale=0.0))  # what it does not do
    assert not nothing.determined


def test_what_the_joint_fit_leaves_open_counts(seen: View) -> None:
    known = _known(0.1 * _of_range(seen) / QUANTILE, (1.0, 1.0, 4.0))  # as rows say alone: 0.001
    made = _interval(seen, known)
    assert made.low == pytest.approx(0.008, abs=1e-5)
    assert made.high == pytest.approx(0.012, abs=1e-5)


def test_rows_that_tell_less_than_a_set_has_tell_less_of_others_too(seen: View) -> None:
    few = 0.02 * _of_range(seen) / QUANTILE  # rows scatter five times more than the set has it
    made = _interval(seen, _known(few, (1.0, 1.0, 4.0)))
    assert made.high - made.value == pytest.approx(0.002, rel=0.01)


def test_what_no_row_tells_is_as_open_as_before_however_much_rows_scatter(seen: View) -> None:
    """A constant of two causes: bias over the level beside delays of devices."""
    few = 0.02 * _of_range(seen) / QUANTILE
    made = _interval(seen, _known(few, (1.0, 1.0, 100.0), before=0.01))
    open_before = 0.02 * 0.01 * 10  # ten standard errors alone, known to that before
    assert made.high - made.value == pytest.approx(
        np.hypot(0.001, np.sqrt(open_before**2 - 0.001**2)), rel=0.02
    )


def test_a_constant_may_be_of_the_devices_of_either_side() -> None:
    """Which device is taken as right changes with the constant, so each may have some of it."""
    pairs = [(x, y) for x in "abcd" for y in "efg"]
    tx, rx = (np.repeat(side, 8) for side in zip(*pairs, strict=True))
    frame = pd.DataFrame({"link": tx + rx, "tx": tx, "rx": rx, "true_range_m": 5.0})
    frame["range_m"], frame["error_m"] = 5.0, 0.0
    rows = np.arange(len(frame))
    pair = view(frame, link_codes(frame), rows, Window(), ("error_m",), False)
    own = (0.3, 0.0, -0.1, 0.2, 0.1, -0.2, 0.4)
    each = [ParameterEstimate(f"delay_ns[{n}]", v, v - 0.01, v + 0.01, "ns")
            for n, v in zip("abcdefg", own, strict=True)]  # fmt: skip
    known = _known(np.full((len(frame), 1), 0.03), (1.0, 0.0, 4.0))
    made = with_doubt(WORLD, pair, (), DeviceDelay(tuple("abcdefg"), own), tuple(each), known)
    assert min(one.high - one.low for one in made) > 0.2


def test_a_cause_that_may_be_there_moves_the_end_on_its_side(seen: View) -> None:
    made = _interval(seen, _known(_of_range(seen), (0.7, 1.0, 1.0), (0.3, 2.0, 1.0)))
    assert made.high > 0.0195
    assert made.low == pytest.approx(ONE.low, abs=2e-4)
    rare = _interval(seen, _known(_of_range(seen), (0.98, 1.0, 1.0), (0.02, 2.0, 1.0)))
    assert rare.high < 0.0125


def test_intervals_stay_within_the_bounds_of_physics(seen: View) -> None:
    made = _interval(seen, _known(_of_range(seen), (1.0, 1.0, 1e4)))
    (scale,) = (p for p in RangeScale.parameters() if p.name == "scale")
    assert (made.low, made.high) == (scale.low, scale.high)


def test_a_curve_moves_where_the_other_cause_does(seen: View) -> None:
    weak = 0.1 * (seen.frame["rx_power_dbm"].to_numpy()[:, None] < -80)
    curve = PowerCurve((-97.0, -50.0), (0.02, 0.02))
    known = _known(weak, (0.5, 0.0, 1.0), (0.5, 1.0, 1.0))
    assert _interval(seen, known, LEVEL, curve).high > 0.1
    strong = ParameterEstimate(at_level(-70.0), 0.02, 0.01, 0.03, "m")
    assert _interval(seen, known, strong, curve).high < 0.06
