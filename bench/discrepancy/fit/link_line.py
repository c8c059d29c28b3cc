"""A straight line, or more columns, through one value per link, with what it is uncertain by."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.settings import HUBER, MAD_TO_STD, ROBUST_PASSES
from bench.physics.units import Floats


def link_line(x: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return value at 0 and slope [2] of y [L] over x [L], and their covariance [2, 2]."""
    return link_plane(np.stack([np.ones(len(x)), x], axis=1), y)


def link_plane(design: Floats, y: Floats) -> tuple[Floats, Floats]:
    """Return what each column of a design [L, K] does to y [L], and the covariance [K, K].

    Huber's M-estimator, as a few links stand behind obstacles; its sandwich (HC2: MacKinnon and
    White 1985) holds where links far away scatter more.
    """
    weight = np.ones(len(y))
    for _ in range(ROBUST_PASSES):
        pull = design * weight[:, None]
        found = np.linalg.solve(pull.T @ design, pull.T @ y)
        left = y - design @ found
        edge = HUBER * max(MAD_TO_STD * float(np.median(np.abs(left))), 1e-6)
        weight = np.minimum(1.0, edge / np.maximum(np.abs(left), 1e-12))
    inside = design * (np.abs(left) <= edge)[:, None]
    inverse = np.linalg.inv(inside.T @ design)
    apart = np.maximum(1 - np.einsum("ij,jk,ik->i", inside, inverse, design), 0.5)
    bent = design * (weight * left / np.sqrt(apart))[:, None]
    return np.asarray(found, np.float64), np.asarray(
        inverse @ (bent.T @ bent) @ inverse, np.float64
    )
