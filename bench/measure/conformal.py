"""How far a corrected range may be off: split-conformal intervals over links, coverage, CRPS."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt
import pandas as pd
from numpy.typing import NDArray
from scipy.special import ndtr

from bench.errors import BenchError

Floats = NDArray[np.float64]
FOLDS = 5
_ROOT_PI = np.sqrt(np.pi)


@dataclass(frozen=True)
class Intervals:
    """Intervals of the true error around the predicted one, calibrated on links not judged.

    `level` was asked for; `coverage` is the share of rows inside, each link counting alike, and
    `half_width_m` half the mean width (metres). Where the model gives a standard deviation,
    intervals are multiples of it, `own_coverage` is that of its own normal intervals and `crps_m`
    the mean continuous ranked probability score of its normal distribution (metres); else None.
    """

    level: float
    links: int
    half_width_m: float
    coverage: float
    own_coverage: float | None = None
    crps_m: float | None = None


def intervals(
    errors_m: npt.ArrayLike,
    predicted_m: npt.ArrayLike,
    links: npt.ArrayLike,
    level: float = 0.9,
    std_m: npt.ArrayLike | None = None,
    seed: int = 0,
) -> Intervals:
    """Return the intervals of predictions that their model was not fitted on.

    `errors_m`, `predicted_m`, `std_m` [n] in metres, `links` [n] labels. Links are dealt into five
    parts; each part's half width is the conformal quantile of |error - predicted| (over std, where
    given) on the links of the other parts, each link weighing 1 and one unseen link infinitely far
    (Vovk, Gammerman and Shafer 2005; weights as in Tibshirani et al. 2019). Rows of a link go
    together, so it is a new link the interval promises to hold for, on average over links.

    Raises BenchError for a level outside (0, 1), fewer than two links, or so few links that no
    finite interval holds at that level.
    """
    if not 0 < level < 1:
        raise BenchError(f"--intervals {level}: expected a level between 0 and 1, such as 0.9")
    left = np.abs(np.asarray(errors_m, float) - np.asarray(predicted_m, float))
    scale = np.ones_like(left) if std_m is None else np.asarray(std_m, float)
    link, names = pd.factorize(np.asarray(links))
    half = scale * _half_widths(left / scale, link, len(names), level, seed)
    own, crps = (None, None) if std_m is None else _own(errors_m, predicted_m, scale, link, level)
    inside = _over_links(left <= half, link)
    return Intervals(level, len(names), float(_over_links(half, link)), float(inside), own, crps)


def _half_widths(
    scores: Floats, link: NDArray[np.intp], links: int, level: float, seed: int
) -> Floats:
    """Return each row's quantile [n], from the links of other parts."""
    parts = min(FOLDS, links)
    if links < 2 or (calibrating := links - -(-links // parts)) / (calibrating + 1) < level:
        least = int(np.ceil(level / (1 - level) * FOLDS / (FOLDS - 1))) + 1
        raise BenchError(f"{links} links are too few for intervals at {level:g}: about {least}")
    part = np.random.default_rng(seed).permutation(links)[link] % parts
    found = np.empty(len(scores))
    for number in range(parts):
        others = part != number
        found[~others] = _quantile(scores[others], link[others], level)
    return found


def _quantile(scores: Floats, link: NDArray[np.intp], level: float) -> float:
    """Return the quantile of scores in which every link weighs 1, with one more at infinity."""
    _, where, count = np.unique(link, return_inverse=True, return_counts=True)
    order = np.argsort(scores, kind="stable")
    weight = np.cumsum((1 / count[where])[order]) / (len(count) + 1)
    return float(scores[order][np.searchsorted(weight, level - 1e-12)])


def _own(
    errors_m: npt.ArrayLike,
    predicted_m: npt.ArrayLike,
    std: Floats,
    link: NDArray[np.intp],
    level: float,
) -> tuple[float, float]:
    """Return coverage and CRPS of normal distributions (Gneiting and Raftery, JASA 2007)."""
    z = (np.asarray(errors_m, float) - np.asarray(predicted_m, float)) / std
    inside = 2 * ndtr(np.abs(z)) - 1 <= level
    density = np.exp(-0.5 * z**2) / np.sqrt(2 * np.pi)
    crps = std * (z * (2 * ndtr(z) - 1) + 2 * density - 1 / _ROOT_PI)
    return float(_over_links(inside, link)), float(_over_links(crps, link))


def _over_links(values: npt.ArrayLike, link: NDArray[np.intp]) -> float:
    """Return the mean over links of each link's mean."""
    sums = np.bincount(link, np.asarray(values, float))
    return float((sums / np.bincount(link)).mean())
