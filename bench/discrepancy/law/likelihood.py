"""How well a law fits: Student t residuals, links that keep offsets counted as fewer rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.law.settings import LAW_CLIP, LAW_PASSES, LAW_TAIL
from bench.discrepancy.settings import LEAST_SCATTER_M, MAD_TO_STD

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Fit:
    """Coefficients [q], their shift [n] in metres, the scale of what is left, log-likelihood."""

    values: Floats
    shift_m: Floats
    scale_m: float
    likelihood: float


def log_density(left_m: Floats, scale_m: Floats | float) -> Floats:
    """Return the log density [n] of residuals, up to a constant that all laws share.

    Scales of their own, [..., n], give as many densities.
    """
    z = (left_m / scale_m) ** 2 / LAW_TAIL
    return np.asarray(-(LAW_TAIL + 1) / 2 * np.log1p(z) - np.log(scale_m))


def weights(left_m: Floats, scale_m: float) -> Floats:
    """Return the weights [n] of reweighted least squares."""
    return np.asarray((LAW_TAIL + 1) / (LAW_TAIL + (left_m / scale_m) ** 2))


def first_scale(left_m: Floats) -> float:
    """Return a robust scale to begin with."""
    return max(float(np.median(np.abs(left_m))) * MAD_TO_STD, LEAST_SCATTER_M)


def unmoved(residual_m: Floats) -> Fit:
    """Return the fit of no law at all."""
    return linear(np.empty((len(residual_m), 0)), residual_m)


def linear(design: Floats, residual_m: Floats) -> Fit:
    """Return the fit of a law that is linear in its coefficients; `design` [n, q]."""
    return iterated(lambda values: (design @ values, design), np.zeros(design.shape[1]), residual_m)


def iterated(
    model: Callable[[Floats], tuple[Floats, Floats]], start: Floats, residual_m: Floats
) -> Fit:
    """Return the fit of a law by reweighted Gauss-Newton steps.

    `model` maps values [q] to (shift [n], slopes [n, q]). Rows where either is not finite take no
    part in a step; a law whose shift is not finite somewhere has no likelihood: minus infinity.
    """
    values, scale = start, 0.0
    for _ in range(LAW_PASSES):
        shift, slopes = model(values)
        left = residual_m - shift
        weight = weights(left, scale) if scale else np.ones(len(left))
        if len(start):
            values = values + _step(slopes, left, weight)
            left = residual_m - model(values)[0]
        scale = _scale(left, scale or first_scale(left))
    shift = model(values)[0]
    likelihood = float(log_density(residual_m - shift, scale).sum())
    return Fit(values, shift, scale, likelihood if np.isfinite(likelihood) else -np.inf)


def _step(slopes: Floats, left_m: Floats, weight: Floats) -> Floats:
    """Return the weighted least-squares step [q] of finite rows; LAPACK prints about others."""
    root = np.sqrt(weight)
    design, target = slopes * root[:, None], left_m * root
    finite = np.isfinite(target) & np.isfinite(design).all(axis=1)
    return np.asarray(np.linalg.lstsq(design[finite], target[finite], rcond=None)[0])


def _scale(left_m: Floats, scale: float) -> float:
    """Return the next scale of the Student t."""
    mean = float(np.mean(weights(left_m, scale) * left_m**2))
    return max(float(np.sqrt(mean)), LEAST_SCATTER_M)


def fixed(shift_m: Floats, residual_m: Floats) -> Fit:
    """Return the fit of a law without anything to fit."""
    left = unmoved(residual_m - shift_m)
    return Fit(np.empty(0), shift_m, left.scale_m, left.likelihood)


def effective_share(left_m: Floats, links: NDArray[np.intp]) -> float:
    """Return how much a row counts where rows of a link keep an offset (Kish's design effect)."""
    z = np.clip(left_m / first_scale(left_m), -LAW_CLIP, LAW_CLIP)
    code = np.unique(links, return_inverse=True)[1]
    count = np.bincount(code).astype(np.float64)
    if len(count) < 2 or count.max() < 2:
        return 1.0
    mean = np.bincount(code, z) / count
    inside = float(((z - mean[code]) ** 2).sum() / max(len(z) - len(count), 1))
    typical = (len(z) - float((count**2).sum()) / len(z)) / (len(count) - 1)
    among = float((count * (mean - z.mean()) ** 2).sum() / (len(count) - 1))
    kept = max(among - inside, 0.0) / typical
    share = kept / max(kept + inside, 1e-12)
    size = float((count**2).sum() / len(z))
    return 1 / (1 + (size - 1) * share)
