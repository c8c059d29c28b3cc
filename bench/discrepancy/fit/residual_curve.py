"""A mismatch without a name is modelled too: a smooth discrepancy, labelled unnamed."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.data.piecewise import hats, knots_of
from bench.discrepancy.locate.permutation_test import Finding
from bench.discrepancy.settings import (
    CURVE_MEMBERS,
    UNNAMED_RIDGE,
    UNNAMED_ROWS,
    UNNAMED_WIDEST_M,
)
from bench.physics.effects.fitted.unnamed import Unnamed


def unnamed_effect(
    comparison: Comparison, fit: View, added: Added, findings: tuple[Finding, ...]
) -> Unnamed | None:
    """Return a piecewise-linear discrepancy of the range over the located covariate.

    Takes the first finding on the range whose covariate is a known number; None where there is
    none (a mismatch in powers or shape is reported but not modelled).
    """
    ours = [f for f in findings if f.cell.observable == RANGE]
    numbers = fit.covariates.numbers
    names = [f.cell.place.covariate for f in ours if f.cell.place.covariate in numbers]
    if not ours:
        return None
    column = names[0] if names and names[0] else "true_range_m"
    ensemble = comparison.ensemble(fit, added, CURVE_MEMBERS)
    if RANGE not in ensemble.names:
        return None
    residual = ensemble.residual_of(RANGE)
    value = numeric(fit.frame, column)
    known = np.isfinite(residual) & np.isfinite(value)
    if known.sum() < UNNAMED_ROWS:
        return None
    knots = knots_of(value[known])
    parts = hats(value[known], knots)
    ridge = UNNAMED_RIDGE * np.sqrt(known.sum()) * np.eye(len(knots))
    target = np.concatenate([residual[known], np.zeros(len(knots))])
    shifts = np.linalg.lstsq(np.vstack([parts, ridge]), target, rcond=None)[0]
    left = residual[known] - parts @ shifts
    members = ensemble.simulated_of(RANGE)[:, known]
    own = float(members.var(axis=0, ddof=1).mean()) * (1 + 1 / CURVE_MEMBERS)
    spread = float(np.sqrt(max(left.var() - own, 0.0)))
    return Unnamed(
        column, tuple(knots.tolist()), tuple(shifts.tolist()), min(spread, UNNAMED_WIDEST_M)
    )
