"""Models over several data sets: how sure it is that one is better than the others in general.

A Bayesian bootstrap (Rubin, Ann. Stat. 9, 1981) in two levels: the links of every data set and the
data sets themselves get Dirichlet weights. With two or three data sets it says honestly little:
they are all that is known of data sets in general.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from reports.ranking.paired import Floats, Paired

DRAWS = 4000
FEWEST_SETS, FEWEST_MODELS = 2, 2


@dataclass(frozen=True)
class Overall:
    """One model over all data sets.

    `ratio`: its MAE over the geometric mean of the models compared, averaged over data sets as a
    geometric mean, with its 95 % credible interval; `best`: probability of being the best one;
    `ranks`: 95 % credible interval of its rank.
    """

    name: str
    ratio: float
    low: float
    high: float
    best: float
    ranks: tuple[int, int]


def across(sets: Mapping[str, Paired], seed: int = 0) -> tuple[Overall, ...]:
    """Return the models that every data set has, best first; empty with fewer than two of each."""
    names = _common(sets)
    if len(sets) < FEWEST_SETS or len(names) < FEWEST_MODELS:
        return ()
    rng = np.random.default_rng(seed)
    logs = np.stack([_log_ratios(one.only(names), rng) for one in sets.values()])
    weights = rng.dirichlet(np.ones(len(sets)), DRAWS)
    scores = np.einsum("bd,dbm->bm", weights, logs)
    places = scores.argsort(axis=1).argsort(axis=1) + 1
    found = [_overall(name, scores[:, at], places[:, at]) for at, name in enumerate(names)]
    return tuple(sorted(found, key=lambda one: one.ratio))


def _common(sets: Mapping[str, Paired]) -> list[str]:
    """Return the models that every data set has, in the order of the first."""
    tables = list(sets.values())
    return [name for name in (tables[0].names if tables else ()) if _everywhere(name, tables)]


def _everywhere(name: str, tables: list[Paired]) -> bool:
    return all(name in one.names for one in tables)


def _log_ratios(paired: Paired, rng: np.random.Generator) -> Floats:
    """Return draws [draws, models] of log MAE less its mean over the models."""
    weights = rng.dirichlet(np.ones(paired.links), DRAWS)
    mae = (weights @ paired.sums_m.T) / (weights @ paired.rows)[:, None]
    logs = np.log(np.maximum(mae, 1e-9))
    return np.asarray(logs - logs.mean(axis=1, keepdims=True))


def _overall(name: str, scores: Floats, places: Floats) -> Overall:
    low, high = np.exp(np.quantile(scores, [0.025, 0.975]))
    first, last = np.quantile(places, [0.025, 0.975], method="inverted_cdf")
    ratio = float(np.exp(scores.mean()))
    best = float(np.mean(places == 1))
    return Overall(name, ratio, float(low), float(high), best, (int(first), int(last)))
