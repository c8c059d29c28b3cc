"""Whether anchors can fix a position at all, and how much they magnify range errors."""

from __future__ import annotations

import numpy as np
from numpy.typing import ArrayLike, NDArray

from bench.errors import BenchError

Floats = NDArray[np.float64]
SPREAD_TOLERANCE = 1e-6
"""Anchors span a dimension where their scatter along it exceeds this fraction of the largest."""


class DegenerateGeometryError(BenchError):
    """The anchors cannot tell one position from another."""


def check_anchors(anchors_m: ArrayLike, dimensions: int) -> Floats:
    """Return the anchors float64 [a, d] if they fix one position, for d = 2 or 3.

    d + 1 anchors that span all d dimensions leave one solution; with fewer, or with all anchors
    on a line (d = 2) or in a plane (d = 3), a position and its mirror image have the same ranges.
    Raises DegenerateGeometryError saying which of these it is.
    """
    anchors = np.asarray(anchors_m, np.float64)
    if anchors.ndim != 2 or anchors.shape[1] != dimensions or not np.isfinite(anchors).all():
        raise DegenerateGeometryError(
            f"anchors of shape {anchors.shape}: expected finite coordinates [anchors, {dimensions}]"
        )
    distinct = len(np.unique(anchors, axis=0))
    if distinct < len(anchors):
        raise DegenerateGeometryError(
            f"{len(anchors) - distinct} of {len(anchors)} anchors coincide with another: "
            "expected distinct positions"
        )
    if len(anchors) < dimensions + 1:
        raise DegenerateGeometryError(
            f"{len(anchors)} anchors: a {dimensions}-D position needs at least {dimensions + 1}"
        )
    if spanned_dimensions(anchors) < dimensions:
        where = "on one line" if dimensions == 2 else "in one plane"
        raise DegenerateGeometryError(
            f"all {len(anchors)} anchors lie {where}: a position and its mirror image have the "
            "same ranges; give a start position on the right side"
        )
    return anchors


def spanned_dimensions(anchors_m: Floats) -> int:
    """Return how many dimensions the anchors [a, d] really span."""
    scatter = np.linalg.svd(anchors_m - anchors_m.mean(axis=0), compute_uv=False)
    return int((scatter > SPREAD_TOLERANCE * max(scatter[0], 1e-12)).sum())


def dilution_of_precision(anchors_m: ArrayLike, positions_m: ArrayLike) -> Floats:
    """Return the dilution of precision [n] at positions [n, d] for anchors [a, d] or [n, a, d].

    sqrt(trace((J^T J)^-1)) with J the unit vectors from anchors to position: the standard
    deviation of the position per standard deviation of one range, both in metres (Langley,
    "Dilution of precision", GPS World 10(5), 1999, without the clock column since two-way ranging
    has no common clock). Infinite where the geometry does not fix the position.
    """
    jacobian, _ = directions(np.asarray(anchors_m, np.float64), np.asarray(positions_m, np.float64))
    normal = np.swapaxes(jacobian, -1, -2) @ jacobian
    eigenvalues = np.linalg.eigvalsh(normal)
    singular = eigenvalues[..., 0] <= 1e-12 * eigenvalues[..., -1]
    with np.errstate(divide="ignore"):
        inverse = 1.0 / np.where(singular[..., None], np.inf, eigenvalues)
    dop = np.sqrt(inverse.sum(axis=-1))
    return np.where(singular, np.inf, dop)


def directions(anchors_m: Floats, positions_m: Floats) -> tuple[Floats, Floats]:
    """Return unit vectors anchor -> position [n, a, d] and the distances [n, a] in metres."""
    apart = positions_m[..., None, :] - anchors_m
    distance = np.linalg.norm(apart, axis=-1)
    return apart / np.maximum(distance, 1e-9)[..., None], distance
