"""A mismatch without a name is modelled too: a smooth discrepancy, labelled unnamed."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.resimulation import Added, View, World, measured
from bench.discrepancy.locate.permutation_test import Finding
from bench.physics.effects.fitted.unnamed import Unnamed

KNOTS = 9
MEMBERS = 8


def unnamed_effect(
    world: World, fit: View, added: Added, findings: tuple[Finding, ...]
) -> Unnamed | None:
    """Return a piecewise-linear discrepancy of the range over the located covariate.

    Takes the first finding on the range whose covariate is a known number; None where there is
    none (a mismatch in powers or shape is reported but not modelled).
    """
    ours = [f for f in findings if f.cell.observable == "error_m"]
    numbers = fit.covariates.numbers
    names = [f.cell.place.covariate for f in ours if f.cell.place.covariate in numbers]
    if not ours:
        return None
    column = names[0] if names and names[0] else "true_range_m"
    ensemble = world.ensemble(fit, added, MEMBERS)
    if "error_m" not in ensemble.names:
        return None
    residual = ensemble.residual[:, ensemble.names.index("error_m")]
    value = measured(fit.frame, column)
    known = np.isfinite(residual) & np.isfinite(value)
    if known.sum() < 20:
        return None
    knots = np.unique(np.quantile(value[known], np.linspace(0, 1, KNOTS)))
    hats = np.stack([np.interp(value[known], knots, row) for row in np.eye(len(knots))], axis=1)
    ridge = 1e-3 * np.sqrt(known.sum()) * np.eye(len(knots))
    target = np.concatenate([residual[known], np.zeros(len(knots))])
    shifts = np.linalg.lstsq(np.vstack([hats, ridge]), target, rcond=None)[0]
    left = residual[known] - hats @ shifts
    members = ensemble.simulated[:, known, ensemble.names.index("error_m")]
    own = float(members.var(axis=0, ddof=1).mean()) * (1 + 1 / MEMBERS)
    spread = float(np.sqrt(max(left.var() - own, 0.0)))
    return Unnamed(column, tuple(knots.tolist()), tuple(shifts.tolist()), min(spread, 100.0))
