"""A curve without a name goes over what leaves least, not over what was told first."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.fit.residual_curve import unnamed_effects
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.locate.hypotheses import Cell, Place

ROWS = 400
RNG = np.random.default_rng(0)
FRAME = pd.DataFrame(
    {"true_range_m": RNG.uniform(2, 20, ROWS), "tx_z_m": RNG.choice([2.2, 2.6, 2.9], ROWS)}
)


def found(observable: str, covariate: str | None) -> Finding:
    cell = Cell(observable, "mean", Place(covariate))
    return Finding(cell, Estimate(0.1, 0.05, 0.15, "m"), 9.0, 0.002, ROWS, 40)


@pytest.mark.parametrize("follows", ["true_range_m", "tx_z_m"])
def test_the_curve_goes_over_what_the_error_follows(follows: str) -> None:
    value = FRAME[follows].to_numpy()
    versions = RNG.normal(0, 0.02, (9, ROWS, 1))
    versions[0, :, 0] += 0.2 * (value - value.min()) / np.ptp(value)
    made = Ensemble(("error_m",), ("m",), versions, np.arange(ROWS) // 10)
    comparison = SimpleNamespace(ensemble=lambda *_: made)
    covariates = SimpleNamespace(numbers={name: FRAME[name].to_numpy() for name in FRAME})
    fit = SimpleNamespace(frame=FRAME, covariates=covariates)
    told = (found("noise_std", None), found("error_m", "tx_z_m"))
    curve, flat = unnamed_effects(comparison, fit, (), told)  # type: ignore[arg-type]
    assert len(flat.shifts_m) == 1
    assert flat.shifts_m[0] == pytest.approx(0.1, abs=0.05)
    assert curve.column == follows
    assert np.ptp(curve.shifts_m) == pytest.approx(0.2, abs=0.05)
    assert unnamed_effects(comparison, fit, (), told[:1]) == ()  # type: ignore[arg-type]


def test_a_curve_of_few_links_has_few_knots() -> None:
    versions = RNG.normal(0, 0.02, (9, ROWS, 1))
    versions[0] += 0.2
    made = Ensemble(("error_m",), ("m",), versions, np.arange(ROWS) * 10 // ROWS)
    comparison = SimpleNamespace(ensemble=lambda *_: made)
    covariates = SimpleNamespace(numbers={name: FRAME[name].to_numpy() for name in FRAME})
    fit = SimpleNamespace(frame=FRAME, covariates=covariates)
    told = (found("error_m", None),)
    curve, _ = unnamed_effects(comparison, fit, (), told)  # type: ignore[arg-type]
    assert len(curve.knots) == 3
