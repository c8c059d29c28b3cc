"""Errors of links behind what a fit of many values leaves of them."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.fit.bootstrap import _taken
from bench.discrepancy.fit.leverage import errors_of

ROWS, DEVICES, LINKS = 4, 14, 42


def _crowded() -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return links [n], columns [n, D] of two devices each, and the errors [n] of their rows."""
    rng = np.random.default_rng(5)
    links = np.repeat(np.arange(LINKS), ROWS)
    one = np.arange(LINKS) % DEVICES
    ends = np.stack([one, (one + 1 + np.arange(LINKS) // DEVICES) % DEVICES], axis=1)[links]
    columns = np.eye(DEVICES)[ends[:, 0]] + np.eye(DEVICES)[ends[:, 1]]
    return links, columns, rng.normal(0, 0.02, LINKS)[links] + rng.normal(0, 0.01, len(links))


def test_errors_have_the_scatter_that_a_fit_of_many_values_takes_of_them() -> None:
    links, columns, errors = _crowded()
    left = errors - columns @ np.linalg.lstsq(columns, errors, rcond=None)[0]
    found = errors_of(left, links, columns)

    def of_links(values: np.ndarray) -> float:
        return float(np.std(values.reshape(LINKS, ROWS).mean(axis=1)))

    assert of_links(left) < 0.9 * of_links(errors)
    assert 0.85 < of_links(found.left_m) / of_links(errors) < 1.15
    assert found.free == LINKS - DEVICES
    assert found.own.all()


def test_a_link_that_a_value_follows_alone_tells_nothing_of_its_errors() -> None:
    links, columns, errors = _crowded()
    columns = np.hstack([columns, (links == 3)[:, None]])
    errors[5] = np.nan  # of a range that is not known
    left = errors.copy()
    known = np.isfinite(errors)
    left[known] -= columns[known] @ np.linalg.lstsq(columns[known], errors[known], rcond=None)[0]
    found = errors_of(left, links, columns)
    assert np.flatnonzero(~found.own).tolist() == [3]
    assert np.flatnonzero(np.isnan(found.left_m)).tolist() == [5]


def test_a_link_takes_every_row_of_another_once_before_any_comes_again() -> None:
    codes = np.repeat([0, 1], [4, 9])
    for taken in _taken(codes, ((np.array([0, 1]), np.array([0])),)):
        assert sorted(taken[:4]) == [0, 1, 2, 3]
        assert max(np.bincount(taken[4:])) == 3
