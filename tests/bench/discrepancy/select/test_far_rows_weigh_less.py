"""Rows far off their own links hide no cause beside waveforms: each counts as if it were near."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.select.flattened import whitening
from bench.discrepancy.select.row_weights import row_weights

LINKS = np.repeat(np.arange(42), 10)


def _left(far_m: float) -> np.ndarray:
    """Return ranges that grow with a reply time, three of them answers of another exchange."""
    rng = np.random.default_rng(4)
    left = 0.03 * rng.normal(size=len(LINKS))
    left[[11, 97, 203]] += far_m
    return left


def test_a_row_far_off_its_link_counts_as_if_it_were_near() -> None:
    weights = row_weights(_left(16.0), np.full(len(LINKS), np.nan), LINKS)
    far = [11, 97, 203]
    assert np.abs(weights[far] * 16.0).max() < 0.3
    assert np.delete(weights, far).min() > 0.8
    assert row_weights(_left(0.0), np.full(len(LINKS), np.nan), LINKS).min() > 0.8


def test_links_that_are_off_in_all_their_rows_count_as_before() -> None:
    left = _left(0.0)
    left[LINKS == 7] += 5.0
    assert row_weights(left, np.full(len(LINKS), -80.0), LINKS).min() > 0.8


def test_three_rows_off_by_16_m_are_not_spread_over_all_by_forms() -> None:
    """A clock of 0.15 m was not seen: forms of a noise floor carried these rows into all others."""
    left = _left(16.0)
    forms = 0.05 * np.random.default_rng(5).normal(size=(len(left), 20))
    forms[[11, 97, 203], 0] = 0.95
    for weights, most in ((row_weights(left, np.full(len(left), np.nan), LINKS), 0.05), (1.0, 99)):
        weight = np.broadcast_to(np.asarray(weights, np.float64), left.shape)
        flat = whitening(weight[:, None] * forms, weight * left) * weight
        spread = np.delete(flat @ left, [11, 97, 203])
        assert spread.std() < most
        assert most < 1 or spread.std() > 0.1
