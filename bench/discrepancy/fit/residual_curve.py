"""A mismatch without a name is modelled too: a smooth discrepancy, labelled unnamed."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.data.piecewise import hats, knots_of
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.settings import (
    CURVE_MEMBERS,
    UNNAMED_KNOTS,
    UNNAMED_LINKS,
    UNNAMED_RIDGE,
    UNNAMED_ROWS,
    UNNAMED_WIDEST_M,
)
from bench.physics.effects.fitted.unnamed import Unnamed


def unnamed_effects(
    comparison: Comparison, fit: View, added: Added, findings: tuple[Finding, ...]
) -> tuple[Unnamed, ...]:
    """Return piecewise-linear discrepancies of the range, the richest first, a constant last.

    Over a number that findings on the range name, or over the distance: whichever leaves least.
    None where there is no such finding (a mismatch in powers or shape is reported, not modelled).
    """
    ours = [f.cell.place.covariate for f in findings if f.cell.observable == RANGE]
    if not ours:
        return ()
    ensemble = comparison.ensemble(fit, added, CURVE_MEMBERS)
    if RANGE not in ensemble.names:
        return ()
    numbers = fit.covariates.numbers
    columns = dict.fromkeys((*(name for name in ours if name in numbers and name), "true_range_m"))
    made = [_over(column, fit, ensemble, UNNAMED_KNOTS) for column in columns]
    able = [one for one in made if one is not None]
    flat = _over("true_range_m", fit, ensemble, 1)
    best = [min(able, key=lambda one: one.spread_m)] if able else []
    return (*best, *([flat] if flat else []))


def _over(column: str, fit: View, ensemble: Ensemble, most: int) -> Unnamed | None:
    """Return the discrepancy of the range over a column, None where too few rows know it.

    With `most` knots, fewer where there are few links: rows of one are near-copies.
    """
    residual, value = ensemble.residual_of(RANGE), numeric(fit.frame, column)
    known = np.isfinite(residual) & np.isfinite(value)
    if known.sum() < UNNAMED_ROWS:
        return None
    links = len(np.unique(ensemble.links[known]))
    knots = knots_of(value[known], int(np.clip(links // UNNAMED_LINKS, 1, most)))
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
