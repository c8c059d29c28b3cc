"""What could be removed at all: a flexible regression of the residual on the known covariates.

An effect is named only if physics does about as well on held-out links with its few parameters.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.hypotheses import OWN
from bench.discrepancy.settings import (
    LEAST_SCALE,
    REGRESSION_BETTER,
    REGRESSION_FOLDS,
    REGRESSION_KNOTS,
    REGRESSION_LEAVES,
    REGRESSION_RATE,
    REGRESSION_ROWS,
    REGRESSION_TREES,
)
from bench.parallel import one_openmp_thread

Floats = NDArray[np.float64]


def corrected(
    fit: Ensemble,
    fit_covariates: Covariates,
    held: Ensemble,
    held_covariates: Covariates,
    focus: tuple[str, ...],
) -> Ensemble:
    """Return the held-out ensemble shifted and rescaled by what the fit rows teach.

    For every observable of `focus`: gradient-boosted trees, a smooth spline model of the residual
    on all covariates, and a fine spline on each number alone are compared by cross-validation over
    links on the fit rows; the best one (or a constant) shifts the ensemble, and its spread is
    scaled to what is left.
    """
    names = tuple(n for n in held_covariates.numbers if n in fit_covariates.numbers)
    names += tuple(n for n in held_covariates.groups if n in fit_covariates.groups)
    versions = held.versions.copy()
    for which, name in enumerate(fit.names):
        if name in focus and name in held.names:
            place = held.names.index(name)
            own = [one for one in OWN if one != name and one in fit.names and one in held.names]
            left, right = (
                _inputs(part, cov, names, own)
                for part, cov in ((fit, fit_covariates), (held, held_covariates))
            )
            with one_openmp_thread():
                shift, scale = _fitted(left, fit, which, right)
            members = versions[1:, :, place]
            centre = members.mean(axis=0)
            versions[1:, :, place] = centre + shift + (members - centre) * scale
    return replace(held, versions=versions)


def _inputs(
    part: Ensemble, covariates: Covariates, names: tuple[str, ...], powers: Sequence[str]
) -> Floats:
    """Return the regressors [n, q]: known covariates and some recorded powers."""
    columns = [covariates.matrix(names)] if names else []
    for own in powers:
        value = part.recorded_of(own)
        columns.append(np.nan_to_num(value, nan=float(np.nanmedian(value)))[:, None])
    return np.hstack(columns) if columns else np.zeros((len(part.links), 1))


def _fitted(X: Floats, fit: Ensemble, which: int, X_held: Floats) -> tuple[Floats, float]:
    """Return the shift [n held] and the factor of the spread."""
    from sklearn.model_selection import GroupKFold, cross_val_predict

    y = fit.residual[:, which]
    known = np.flatnonzero(np.isfinite(y))[:REGRESSION_ROWS]
    links = fit.links[known]
    count = min(REGRESSION_FOLDS, len(np.unique(links)))
    folds = list(GroupKFold(count).split(X[known], groups=links)) if count > 1 else []
    members = fit.simulated[:, known, which]
    spread = np.sqrt(members.var(axis=0, ddof=1).mean() * (1 + 1 / len(members)))
    best, left = None, y[known] - y[known].mean()
    shift = np.full(len(X_held), y[known].mean())
    if folds and min(len(taught) for taught, _ in folds) > 1:  # one row teaches no curve
        every = list(range(X.shape[1]))
        for model, columns in [*((one, every) for one in _models()), *_fine(X[known])]:
            guess = cross_val_predict(model, X[known][:, columns], y[known], cv=folds)
            if np.mean(np.abs(y[known] - guess)) < REGRESSION_BETTER * np.mean(np.abs(left)):
                best, left = (model, columns), y[known] - guess
    if best is not None:
        model, columns = best
        shift = model.fit(X[known][:, columns], y[known]).predict(X_held[:, columns])
    return np.asarray(shift, np.float64), float(max(left.std() / max(spread, 1e-12), LEAST_SCALE))


def _models() -> list[Any]:
    """Return the regressions that compete."""
    from sklearn.ensemble import HistGradientBoostingRegressor
    from sklearn.linear_model import RidgeCV
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import SplineTransformer, StandardScaler

    spline = SplineTransformer(REGRESSION_KNOTS[0], knots="quantile", extrapolation="constant")
    smooth = make_pipeline(StandardScaler(), spline, RidgeCV(np.logspace(-3, 3, 7)))
    trees = HistGradientBoostingRegressor(
        max_iter=REGRESSION_TREES,
        max_leaf_nodes=REGRESSION_LEAVES[0],
        min_samples_leaf=REGRESSION_LEAVES[1],
        learning_rate=REGRESSION_RATE,
        random_state=0,
    )
    return [smooth, trees]


def _fine(X: Floats) -> list[tuple[Any, list[int]]]:
    """Return a fine spline regression on each number alone (columns with many values)."""
    from sklearn.linear_model import RidgeCV
    from sklearn.pipeline import make_pipeline
    from sklearn.preprocessing import SplineTransformer

    numbers = [j for j in range(X.shape[1]) if len(np.unique(X[:, j])) > REGRESSION_KNOTS[1]]
    spline = SplineTransformer(REGRESSION_KNOTS[1], knots="quantile", extrapolation="constant")
    return [(make_pipeline(spline, RidgeCV(np.logspace(-3, 3, 7))), [j]) for j in numbers]
