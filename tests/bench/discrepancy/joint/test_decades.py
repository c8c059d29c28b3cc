"""Logged noise is compared alike in any unit."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.joint.decades import decades


def test_ratios_count_in_any_unit():
    noise = np.array([1.0, 2.0, 4.0, np.nan])
    for unit in (1e-6, 1.0, 1e6):
        np.testing.assert_allclose(np.diff(decades(noise * unit))[:2], np.log10(2))


def test_what_is_nothing_is_far_below_and_no_infinity():
    assert np.isfinite(decades(np.array([0.0, 1.0, 1.0]))).all()
    assert np.isfinite(decades(np.zeros(3))).all()
