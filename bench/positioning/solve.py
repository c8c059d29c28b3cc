"""Position fixes from ranges, many epochs at once."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.optimize import least_squares

from bench.errors import BenchError
from bench.positioning.geometry import (
    check_anchors,
    dilution_of_precision,
    directions,
    spanned_dimensions,
)

Floats = NDArray[np.float64]
ITERATIONS = 50
STEP_M = 1e-9  # converged: the last step was shorter
HUBER_SCALE_M = 0.1  # residuals well beyond a good UWB range error (about 5 cm) count less


@dataclass(frozen=True)
class Fixes:
    """Positions of n epochs.

    `positions_m` [n, d]; `residual_rms_m` [n] of the ranges at the fix; `dop` [n] dilution of
    precision there; `converged` [n]. Epochs that did not converge keep their last iterate.
    """

    positions_m: Floats
    residual_rms_m: Floats
    dop: Floats
    converged: NDArray[np.bool_]


def gauss_newton(
    anchors_m: ArrayLike, ranges_m: ArrayLike, start_m: ArrayLike | None = None
) -> Fixes:
    """Return the least-squares positions for ranges [n, a] to anchors [a, d], by Gauss-Newton.

    The iteration of the paper's positioning test: p <- p - (J^T J)^-1 J^T (|p - a| - r). The start
    is the linear solution from differences of squared ranges; where the anchors lie on a line or
    in a plane `start_m` [d] must choose the side. Steps that would raise the sum of squares are
    halved. Raises DegenerateGeometryError or BenchError (ranges of the wrong shape, not finite).
    """
    anchors, ranges = _checked(anchors_m, ranges_m, start_m)
    positions = _start(anchors, ranges, start_m)
    converged = np.zeros(len(ranges), bool)
    for _ in range(ITERATIONS):
        step = _step(anchors, ranges, positions)
        step *= _damping(anchors, ranges, positions, step)[:, None]
        positions = positions - step
        converged = np.linalg.norm(step, axis=1) < STEP_M
        if converged.all():
            break
    return _fixes(anchors, ranges, positions, converged)


def robust_least_squares(
    anchors_m: ArrayLike,
    ranges_m: ArrayLike,
    start_m: ArrayLike | None = None,
    scale_m: float = HUBER_SCALE_M,
) -> Fixes:
    """Return positions that a few long ranges pull less: scipy's soft-L1 loss of scale `scale_m`.

    Arguments and errors as `gauss_newton`; each epoch starts at its Gauss-Newton fix.
    """
    first = gauss_newton(anchors_m, ranges_m, start_m)
    anchors, ranges = np.asarray(anchors_m, np.float64), np.asarray(ranges_m, np.float64)
    solved = [
        _solve_robustly(anchors, row, begin, scale_m)
        for row, begin in zip(ranges, first.positions_m, strict=True)
    ]
    positions = np.array([one.x for one in solved]).reshape(first.positions_m.shape)
    return _fixes(anchors, ranges, positions, np.array([bool(one.success) for one in solved]))


def _solve_robustly(anchors: Floats, ranges: Floats, begin: Floats, scale_m: float) -> Any:
    def residuals(position: Floats) -> Floats:
        return directions(anchors, position)[1] - ranges

    def jacobian(position: Floats) -> Floats:
        return directions(anchors, position)[0]

    return least_squares(residuals, begin, jac=jacobian, loss="soft_l1", f_scale=scale_m)


def _checked(
    anchors_m: ArrayLike, ranges_m: ArrayLike, start_m: ArrayLike | None
) -> tuple[Floats, Floats]:
    anchors, ranges = np.asarray(anchors_m, np.float64), np.asarray(ranges_m, np.float64)
    dimensions = anchors.shape[-1] if anchors.ndim == 2 else 0
    if start_m is None or spanned_dimensions(anchors) < dimensions - 1:
        check_anchors(anchors, dimensions)
    if ranges.ndim != 2 or ranges.shape[1] != len(anchors):
        raise BenchError(f"ranges of shape {ranges.shape}: expected [epochs, {len(anchors)}]")
    if not np.isfinite(ranges).all():
        raise BenchError(f"{int((~np.isfinite(ranges)).sum())} ranges are not finite")
    return anchors, ranges


def _start(anchors: Floats, ranges: Floats, start_m: ArrayLike | None) -> Floats:
    """Return [n, d]: the given start, else the linear solution of r_i^2 - r_0^2."""
    if start_m is not None:
        return np.tile(np.asarray(start_m, np.float64), (len(ranges), 1))
    matrix = 2 * (anchors[1:] - anchors[0])
    squares = (anchors**2).sum(axis=1)
    right = (squares[1:] - squares[0]) - (ranges[:, 1:] ** 2 - ranges[:, :1] ** 2)
    return np.asarray(np.linalg.lstsq(matrix, right.T, rcond=None)[0].T)


def _step(anchors: Floats, ranges: Floats, positions: Floats) -> Floats:
    jacobian, distance = directions(anchors, positions)
    return np.asarray((np.linalg.pinv(jacobian) @ (distance - ranges)[..., None])[..., 0])


def _damping(anchors: Floats, ranges: Floats, positions: Floats, step: Floats) -> Floats:
    """Return the largest of 1, 1/2, 1/4, ... [n] whose step does not raise the sum of squares."""
    now = _sum_of_squares(anchors, ranges, positions)
    factor = np.ones(len(ranges))
    for _ in range(20):
        worse = _sum_of_squares(anchors, ranges, positions - factor[:, None] * step) > now + 1e-18
        if not worse.any():
            break
        factor = np.where(worse, factor / 2, factor)
    return factor


def _sum_of_squares(anchors: Floats, ranges: Floats, positions: Floats) -> Floats:
    _, distance = directions(anchors, positions)
    return np.asarray(((distance - ranges) ** 2).sum(axis=1))


def _fixes(
    anchors: Floats, ranges: Floats, positions: Floats, converged: NDArray[np.bool_]
) -> Fixes:
    rms = np.sqrt(_sum_of_squares(anchors, ranges, positions) / ranges.shape[1])
    return Fixes(positions, rms, dilution_of_precision(anchors, positions), converged)
