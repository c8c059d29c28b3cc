"""Moments of rows that tell a tone from noise: of samples, and of what is logged beside them.

Magnitudes of noise scatter by the root of 1 - pi/4, 0.46, of their root of mean squares, however
loud it is. A tone of K times the noise's power takes 0.46 K^2 / (1 + K)^2 off the square of that
(Rice 1945). A log of noise is of many samples, so it tells more than how the few before the path
scatter by themselves: these say the power, the log the scatter.
"""

from __future__ import annotations

from typing import Final

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bench.discrepancy.joint.settings import COLOUR_SAMPLES
from bench.discrepancy.joint.statistics import Floats
from bench.discrepancy.settings import NOISE_BEFORE_NS
from bench.physics.base import RAYLEIGH_STD

SQUARE: Final = RAYLEIGH_STD**2 / 2  # of the scatter of magnitudes of noise, over their mean square


def early_samples(delay: Floats) -> NDArray[np.bool_]:
    """Return which samples [K] of rows with such delays [n, K] lie before the path."""
    return np.asarray(mean_known(delay, 0) < NOISE_BEFORE_NS)


def moments_of(magnitude: Floats) -> Floats:
    """Return the mean squared power and the squared mean power of rows [n, 2] of samples [n, K].

    Over the square of the row's own mean, so that loud rows count like others, and beside the mean
    power of every sample, as some may hold a little of a tail. The squared mean is the mean product
    of samples that are no neighbours: it is of noise of any colour.
    """
    power = relative_power(magnitude)
    count = _products(np.isfinite(power).astype(np.float64))
    power = np.where(count[:, None] > 0, power, np.nan)  # a row that ends early says nothing
    pairs = _products(np.nan_to_num(power)) / np.maximum(count, 1.0)
    squares = np.nan_to_num(power**2).sum(axis=1) / np.maximum(np.isfinite(power).sum(axis=1), 1)
    return np.stack([squares, pairs], axis=1)


def relative_power(magnitude: Floats) -> Floats:
    """Return powers over the mean of their sample in all rows, then of their row [n, K]."""
    power = magnitude**2
    power = power / np.maximum(mean_known(power, 0), np.finfo(float).tiny)
    return np.asarray(power / np.maximum(mean_known(power, 1), np.finfo(float).tiny)[:, None])


def loud_moments(magnitude: Floats) -> Floats:
    """Return the moments of rows [n, 2] as `moments_of` does, times their mean power.

    A tone that fades is in loud rows, which count the more, if not by the square of it.
    """
    usual = np.maximum(mean_known(magnitude**2, 0), np.finfo(float).tiny)
    power = mean_known(magnitude**2 / usual, 1)
    return np.asarray(moments_of(magnitude) * np.nan_to_num(power)[:, None])


def log_moments(magnitude: Floats, logged: Floats) -> Floats:
    """Return squares of logs, over `SQUARE`, and mean powers of rows [n, 2] of samples [n, K].

    The ratio of their sums is 1 of noise whose scatter is logged. Rows that lack one say nothing.
    """
    known = np.isfinite(magnitude)
    power = np.where(known, magnitude**2, 0.0).sum(axis=1) / np.maximum(known.sum(axis=1), 1)
    both = np.stack([logged**2 / SQUARE, power], axis=1)
    told = known.any(axis=1) & np.isfinite(logged)
    return np.asarray(np.where(told[:, None], both, 0.0))


def in_part(
    left: Floats, whole: Floats, errors: Floats, parts: tuple[float, float] = (0.0, 1.0)
) -> float:
    """Return the nats by which figures [m] that are `left` are a part of the `whole`, not nothing.

    Any of `parts` from the first to the second is as likely. All are differences from the
    figures without it, with standard `errors`.
    """
    some = np.linspace(*parts, 11)[:, None] * whole
    each = 0.5 * ((left**2 - np.square(left - some)) / errors**2).sum(axis=1)
    return float(logsumexp(each)) - float(np.log(len(some)))


def mean_known(values: Floats, axis: int) -> Floats:
    """Return the mean of what is known along an axis, NaN where nothing is."""
    known = np.isfinite(values)
    count = known.sum(axis=axis)
    return np.asarray(
        np.where(known, values, 0.0).sum(axis=axis) / np.where(count > 0, count, np.nan)
    )


def ratio_of(moments: Floats) -> float:
    """Return the mean squared power over the squared mean power of rows [n, 2]: 2 of noise."""
    return float(moments[:, 0].sum() / moments[:, 1].sum())


def error_of(moments: Floats) -> float:
    """Return the standard error of `ratio_of` of rows or links [n, 2]: that of a ratio of means."""
    left = moments[:, 0] - ratio_of(moments) * moments[:, 1]
    return float(left.std() / np.sqrt(len(left)) / moments[:, 1].mean())


def _products(values: Floats) -> Floats:
    """Return the sum of products of samples that are `COLOUR_SAMPLES` apart or more [n]."""
    near = sum((values[:, lag:] * values[:, :-lag]).sum(axis=1) for lag in range(1, COLOUR_SAMPLES))
    return np.asarray(values.sum(axis=1) ** 2 - (values**2).sum(axis=1) - 2 * near)
