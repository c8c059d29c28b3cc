"""Roots of many small matrices at once are those that numpy finds one by one."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.typing import NDArray

from bench.discrepancy.data.triangular import diagonals, inverses, roots
from bench.discrepancy.joint.whitening import cholesky, inverted, solved

COUNTS = np.array([3, 0, 1, 12], np.intp)


def _matrices() -> list[NDArray[np.float64]]:
    rng = np.random.default_rng(7)
    drawn = [rng.normal(size=(count, 30)) for count in COUNTS]
    return [one @ one.T for one in drawn]


def test_roots_and_inverses_are_those_of_every_matrix() -> None:
    every = _matrices()
    flat = np.concatenate([one.ravel() for one in every])
    root = roots(flat, COUNTS)
    expected = [np.linalg.cholesky(one) for one in every]
    np.testing.assert_allclose(root, np.concatenate([one.ravel() for one in expected]), atol=1e-12)
    back = [np.linalg.inv(one).ravel() for one in expected]
    np.testing.assert_allclose(inverses(root, COUNTS), np.concatenate(back), atol=1e-12)
    on = [np.diag(one) for one in every]
    np.testing.assert_array_equal(flat[diagonals(COUNTS)], np.concatenate(on))


def test_what_has_no_root_is_said() -> None:
    with pytest.raises(np.linalg.LinAlgError, match="not positive"):
        roots(-np.concatenate([one.ravel() for one in _matrices()]), COUNTS)


def test_links_are_whitened_by_the_inverse_of_their_root() -> None:
    rng = np.random.default_rng(8)
    drawn = rng.normal(size=(5, 6, 40))
    covariance, values = drawn @ drawn.transpose(0, 2, 1), rng.normal(size=(5, 6))
    root, volume = cholesky(covariance)
    assert volume == pytest.approx(np.linalg.slogdet(covariance)[1].sum())
    expected = np.einsum("lij,lj->li", np.linalg.inv(np.linalg.cholesky(covariance)), values)
    np.testing.assert_allclose(solved(root, values), expected, atol=1e-12)
    flat = np.einsum("lij,lj->li", inverted(root), values)
    np.testing.assert_allclose(flat, expected, atol=1e-12)
