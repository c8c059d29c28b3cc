"""Columns that other columns make, but for rounding, tell nothing of links - and hide nothing."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np

from bench.discrepancy.compare.corrected import told_by

RNG = np.random.default_rng(0)


def test_columns_that_others_make_leave_no_weights_without_bound() -> None:
    """A sum of devices' columns is a constant: rounding would be taken for what links tell."""
    far = RNG.uniform(0.3, 1.5, 40)
    one = RNG.normal(size=40)
    block = np.stack([one, one * (1 + 1e-13), RNG.normal(size=40)], axis=1)
    theirs = [np.stack([far, far**2], axis=1), np.ones((40, 1)), block]
    walk = SimpleNamespace(told=np.ones(2))
    kinds = SimpleNamespace(step=np.zeros(1), told=np.ones(1))
    made = told_by(theirs, walk, [kinds], [1.0])  # type: ignore[arg-type, list-item]
    assert made.shape == (2 + 1 + 3, 40)
    assert np.abs(made).max() < 10
