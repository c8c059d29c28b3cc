"""Factors of many ways, and another cause beside them."""

from __future__ import annotations

import numpy as np
import pytest

from bench.physics.effects.fitted.ridge import Ridge, taken

RNG = np.random.default_rng(4)
FAR = RNG.uniform(2, 30, 300)
WAVES = np.stack([np.sin(k * FAR) for k in range(1, 9)], axis=1)
FALL = -10 * np.log10(FAR)
NOISE = 0.3 * RNG.normal(size=len(FAR))


def test_factors_are_found_beside_a_constant_and_rows_far_off() -> None:
    left = WAVES @ np.arange(8.0) / 4 + 0.5 + NOISE
    left[:9] += 40
    assert Ridge(WAVES, left, 1.0).factors == pytest.approx(np.arange(8) / 4, abs=0.12)


def test_another_cause_is_taken_where_ways_do_not_do_for_it() -> None:
    found = taken(WAVES, WAVES[:, 0] + 0.5 * FALL + NOISE, FALL)
    assert found is not None
    assert found == pytest.approx(0.5 * FALL, rel=0.1)
    assert taken(WAVES, WAVES[:, 0] + NOISE, FALL) is None
    assert taken(WAVES, WAVES[:, 0] + 0.1 * FALL + NOISE, FALL) is None  # too little


def test_near_copies_of_a_few_rows_are_no_evidence() -> None:
    weak = 0.25 * FALL + 10 * NOISE
    assert taken(WAVES, weak, FALL) is not None
    assert taken(WAVES, weak, FALL, counts=0.05) is None


def test_the_evidence_is_that_of_a_normal_law() -> None:
    """Against the density of rows that ways of size one make normal (all rows near)."""
    from scipy.stats import multivariate_normal

    ridge, scatter = Ridge(WAVES, NOISE, 1.0), 0.3
    weight = ridge._weight
    both = np.column_stack([WAVES, np.ones(len(FAR))])
    law = multivariate_normal(np.zeros(len(FAR)), both @ both.T + np.diag(scatter**2 / weight))
    tried = np.stack([NOISE, NOISE + 0.2 * WAVES[:, 2], 2 * NOISE], axis=1)
    mine = ridge.evidences(tried, scatter, 1.0)
    assert np.diff(mine) == pytest.approx(np.diff(law.logpdf(tried.T)), rel=1e-6)
