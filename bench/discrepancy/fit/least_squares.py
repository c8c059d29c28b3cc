"""Robust least squares with a prior, for values that every device has of its own."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, vstack
from scipy.sparse.linalg import lsqr

from bench.discrepancy.compare.view import View
from bench.discrepancy.settings import HUBER, MAD_TO_STD, ROBUST_PASSES

Floats = NDArray[np.float64]


def ends(view: View) -> tuple[tuple[str, ...], NDArray[np.intp], NDArray[np.intp]]:
    """Return device names and each row's tx and rx numbers."""
    tx = view.frame["tx"].astype(str).to_numpy(dtype=object)
    rx = view.frame["rx"].astype(str).to_numpy(dtype=object)
    names, code = np.unique(np.concatenate([tx, rx]), return_inverse=True)
    return tuple(map(str, names)), code[: len(tx)], code[len(tx) :]


def incidence(tx: NDArray[np.intp], rx: NDArray[np.intp], sign: float, count: int) -> csr_array:
    """Return [n, count]: 1 at the transmitter, `sign` at the receiver."""
    rows = np.arange(len(tx))
    cells = (np.concatenate([rows, rows]), np.concatenate([tx, rx]))
    values = np.concatenate([np.ones(len(tx)), np.full(len(tx), sign)])
    return csr_array((values, cells), shape=(len(tx), count))


def robust(design: csr_array, target: Floats, prior: Floats) -> Floats:
    """Return the Huber-weighted ridge solution; `prior` are the standard deviations a priori."""
    known = np.isfinite(target)
    rows, y = design[known], target[known]
    weight = np.ones(len(y))
    found = np.zeros(design.shape[1])
    scale = max(float(np.std(y)), 1e-6)
    for _ in range(ROBUST_PASSES):
        root = np.sqrt(weight) / scale
        ridge = csr_array(np.diag(1 / prior))
        matrix = vstack([rows.multiply(root[:, None]), ridge])
        found = lsqr(matrix, np.concatenate([y * root, np.zeros(len(prior))]), atol=1e-12)[0]
        left = np.abs(y - rows @ found)
        scale = max(float(MAD_TO_STD * np.median(left)), 1e-4)
        weight = np.minimum(1.0, HUBER * scale / np.maximum(left, 1e-12))
    return np.asarray(found, np.float64)
