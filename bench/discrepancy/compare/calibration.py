"""Whether an ensemble looks like the recordings: a classifier's AUC, and ranks."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.settings import LEAST_STD
from bench.discrepancy.data.observables import Floats
from bench.discrepancy.settings import AUC_FOLDS, AUC_LEAVES, AUC_TREES, FEWEST_AUC_LINKS
from bench.parallel import one_openmp_thread

COUNTED = ("rise_time_ns",)  # from one whole sample to another


def separability(ensemble: Ensemble, seed: int, groups: NDArray[np.intp] | None = None) -> float:
    """Return the AUC of a classifier telling recorded from simulated rows, held out by link.

    Or by `groups` [n] of links beside which the same simulated rows stand (see `standing`).
    """
    from sklearn.ensemble import HistGradientBoostingClassifier
    from sklearn.metrics import roc_auc_score
    from sklearn.model_selection import GroupKFold, cross_val_predict

    apart = ensemble.links if groups is None else groups
    several = len(np.unique(apart))
    if several < 2:
        return float("nan")
    made = ensemble.recorded, ensemble.simulated[0]
    known = np.isfinite(made[0]) & np.isfinite(made[1])  # that a log has gaps is no physics
    whole = np.concatenate([np.where(known, side, np.nan) for side in made])
    X = in_whole_samples(whole, ensemble.names)
    y = np.repeat([1, 0], len(ensemble.links))
    model = HistGradientBoostingClassifier(
        max_iter=AUC_TREES, max_leaf_nodes=AUC_LEAVES, random_state=seed
    )
    folds = list(GroupKFold(min(AUC_FOLDS, several)).split(X, y, np.tile(apart, 2)))
    X = X[:, [all(np.isfinite(column[taught]).any() for taught, _ in folds) for column in X.T]]
    if not X.shape[1]:  # trees cannot be taught by what no row has
        return float("nan")
    with one_openmp_thread():
        guess = cross_val_predict(model, X, y, cv=folds, method="predict_proba")
    return float(roc_auc_score(y, guess[:, 1]))


def in_whole_samples(values: Floats, names: Sequence[str]) -> Floats:
    """Return observables [n, p] with those that are so many samples in whole ones again.

    What matching takes off a simulated row's counterpart leaves it between two samples, where no
    recorded row is: that would tell all rows apart, and is no physics.
    """
    out = values.copy()
    for at in (place for place, name in enumerate(names) if name in COUNTED):
        half = len(values) // 2  # recorded ones come first
        steps = np.diff(np.unique(values[:half, at][np.isfinite(values[:half, at])]))
        steps = steps[steps > LEAST_STD]
        if len(steps):
            out[:, at] = np.round(values[:, at] / steps.min())
    return out


def auc_doubt(links: int) -> str:
    """Return, to stand after an AUC, that so few links cannot tell; empty where they can."""
    few = f" ({links} links: too few to tell, an AUC far from 0.5 is no finding)"
    return few if links < FEWEST_AUC_LINKS else ""


def rank_distance(ensemble: Ensemble) -> float:
    """Return the Kolmogorov distance of the range's ensemble ranks from uniform."""
    ranks = ensemble.ranks()[:, ensemble.place(ensemble.main)]
    ordered = np.sort(ranks[np.isfinite(ranks)])
    if not len(ordered):
        return float("nan")
    return float(np.abs(ordered - (np.arange(len(ordered)) + 0.5) / len(ordered)).max())
