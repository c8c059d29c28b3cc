"""How well ranges are corrected, with intervals that respect links.

Rows of one link share their geometry and their error, so they are no independent evidence: every
interval resamples whole links (the cluster bootstrap of Davison and Hinkley, "Bootstrap Methods
and their Application", 1997, section 3.8).
"""

from __future__ import annotations

import math
from collections.abc import Sequence

import numpy as np
import numpy.typing as npt
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.results import Interval, Score

Floats = NDArray[np.float64]
RESAMPLES = 2000
CONFIDENCE = 0.95
_BLOCK_CELLS = 2_000_000  # link counts held at once while resampling: 16 MB


def score(
    errors_m: npt.ArrayLike,
    predicted_m: npt.ArrayLike,
    links: npt.ArrayLike,
    seed: int = 0,
    resamples: int = RESAMPLES,
) -> Score:
    """Return the accuracy of ranges corrected by a model.

    `errors_m` [n] = measured - true range and `predicted_m` [n] its prediction, both in metres;
    `links` [n] any hashable labels. With residual = error - prediction:

    - MAE = mean |residual|;
    - sigma = sqrt(mean (residual - mean residual)^2), the population standard deviation;
    - bias = mean residual;
    - R2 = 1 - sum residual^2 / sum (error - mean error)^2; where every error is the same it is 1
      for a perfect prediction and 0 for any other (scikit-learn's convention).

    The 95 % intervals are bias-corrected and accelerated bootstrap intervals over links (Efron,
    JASA 82, 1987) from `resamples` draws; None where there are fewer than two links. With ten
    links or fewer such an interval is too short (nothing in the data tells otherwise): read it as
    a lower bound of the uncertainty. Only per-link sums are resampled. Same `seed`, same result.

    Raises BenchError for no rows, unequal lengths and values that are not finite.
    """
    errors, predicted = _checked(errors_m, predicted_m)
    residuals = errors - predicted
    sums = _link_sums(errors - errors.mean(), residuals, links)
    mae, r2, sigma = _intervals(sums, seed, resamples)
    return Score(
        rows=len(errors),
        links=len(sums),
        mae_m=mae,
        r2=r2,
        sigma_m=sigma,
        bias_m=float(residuals.mean()),
        raw_mae_m=float(np.abs(errors).mean()),
        raw_sigma_m=float(errors.std()),
    )


def over_seeds(seeds: Sequence[Interval] | Sequence[float]) -> Interval:
    """Return the mean of one figure over training seeds, with a 95 % interval.

    The seeds' part is Student's t interval of their mean (None for one seed). Where every seed
    brings an interval over links, that uncertainty is the same for all - they are tested on the
    same links - and does not shrink with more seeds: the mean distance to either end is added to
    the seeds' part in quadrature. One `Interval` alone is returned as it is.

    Raises BenchError for an empty sequence.
    """
    if not seeds:
        raise BenchError("no seeds to average over")
    figures = [seed if isinstance(seed, Interval) else Interval(float(seed)) for seed in seeds]
    if len(figures) == 1:
        return figures[0]
    mean, spread = _t_interval(np.array([figure.value for figure in figures]))
    below, above = _mean_distances(figures)
    return Interval(mean, mean - math.hypot(spread, below), mean + math.hypot(spread, above))


def _checked(errors_m: npt.ArrayLike, predicted_m: npt.ArrayLike) -> tuple[Floats, Floats]:
    """Return both as float64 [n], or raise BenchError."""
    errors, predicted = np.asarray(errors_m, np.float64), np.asarray(predicted_m, np.float64)
    if errors.ndim != 1 or errors.shape != predicted.shape:
        raise BenchError(
            f"cannot score predictions of shape {predicted.shape} against errors of shape "
            f"{errors.shape}: one prediction per error was expected"
        )
    if not len(errors):
        raise BenchError("cannot score: no rows")
    for name, values in (("errors", errors), ("predictions", predicted)):
        if bad := int(np.count_nonzero(~np.isfinite(values))):
            raise BenchError(f"cannot score: {bad} of {len(values)} {name} are not finite")
    return errors, predicted


def _link_sums(errors: Floats, residuals: Floats, links: npt.ArrayLike) -> Floats:
    """Return per-link sums [links, 7] from which every figure of a resample follows.

    Columns: rows, |residual|, residual^2, centred residual and its square, centred error and its
    square. Centring changes no variance, and float64 loses nothing to a large common offset.
    """
    labels = np.asarray(links)
    if labels.shape != errors.shape:
        raise BenchError(f"cannot score: {labels.size} links for {errors.size} errors")
    group, _ = pd.factorize(labels, use_na_sentinel=False)
    centred = residuals - residuals.mean()
    columns = [np.ones_like(errors), np.abs(residuals), residuals**2, centred, centred**2]
    columns += [errors, errors**2]
    return np.stack([np.bincount(group, column) for column in columns], axis=1)


def _figures(totals: Floats) -> Floats:
    """Return MAE, R2 and sigma [.., 3] from summed columns [.., 7]."""
    rows, absolute, squared, shift, centred, error, error_squared = np.moveaxis(totals, -1, 0)
    sigma = np.sqrt(np.maximum(centred / rows - (shift / rows) ** 2, 0.0))
    scatter = np.maximum(error_squared - error**2 / rows, 0.0)
    flat = scatter <= 1e-12 * np.maximum(error_squared, 1e-12)
    r2 = np.where(flat, (squared <= 1e-12).astype(float), 1 - squared / np.where(flat, 1, scatter))
    return np.stack([absolute / rows, r2, sigma], axis=-1)


def _intervals(sums: Floats, seed: int, resamples: int) -> list[Interval]:
    """Return MAE, R2 and sigma, each with its interval over the rows (links) of `sums`."""
    value = _figures(sums.sum(axis=0))
    if len(sums) < 2:
        return [Interval(float(figure)) for figure in value]
    draws = _resampled(sums, np.random.default_rng(seed), resamples)
    without_one = _figures(sums.sum(axis=0) - sums)
    return [_bca(value[i], draws[:, i], without_one[:, i]) for i in range(len(value))]


def _resampled(sums: Floats, rng: np.random.Generator, resamples: int) -> Floats:
    """Return the figures [resamples, 3] of links drawn with replacement."""
    links = len(sums)
    block = max(1, _BLOCK_CELLS // links)
    parts = []
    for start in range(0, resamples, block):
        rows = min(block, resamples - start)
        drawn = rng.integers(0, links, (rows, links), dtype=np.int32)
        drawn += links * np.arange(rows, dtype=np.int32)[:, None]
        counts = np.bincount(drawn.ravel(), minlength=rows * links).reshape(rows, links)
        parts.append(_figures(counts.astype(np.float64) @ sums))
    return np.concatenate(parts)


def _bca(value: float, draws: Floats, without_one: Floats) -> Interval:
    """Return the bias-corrected and accelerated interval of one figure."""
    from scipy.special import ndtr, ndtri  # a quarter of a second, and exports need no interval

    below = np.clip((np.mean(draws < value) + np.mean(draws <= value)) / 2, 1e-3, 1 - 1e-3)
    gaps = without_one.mean() - without_one
    scale = float(np.sum(gaps**2)) ** 1.5
    acceleration = float(np.sum(gaps**3)) / (6 * scale) if scale > 0 else 0.0
    tail = (1 - CONFIDENCE) / 2
    shifted = ndtri(below) + ndtri(np.array([tail, 1 - tail]))
    level = ndtr(ndtri(below) + shifted / (1 - acceleration * shifted))
    low, high = np.quantile(draws, level)
    return Interval(float(value), float(low), float(high))


def _t_interval(values: Floats) -> tuple[float, float]:
    """Return the mean and the half width of its 95 % t interval."""
    from scipy.special import stdtrit

    quantile = float(stdtrit(len(values) - 1, (1 + CONFIDENCE) / 2))
    return float(values.mean()), quantile * float(values.std(ddof=1)) / len(values) ** 0.5


def _mean_distances(figures: list[Interval]) -> tuple[float, float]:
    """Return how far the ends lie below and above the value on average; 0 where not all known."""
    below = [f.value - f.low for f in figures if f.low is not None]
    above = [f.high - f.value for f in figures if f.high is not None]
    if len(below) < len(figures) or len(above) < len(figures):
        return 0.0, 0.0
    return float(np.mean(below)), float(np.mean(above))
