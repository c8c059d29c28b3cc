"""What is not finite takes no part in a law's fit."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.law.likelihood import iterated, linear

X = np.linspace(0, 10, 60)
LEFT = 0.03 * X + np.random.default_rng(1).normal(0, 0.01, 60)


def test_slopes_that_are_not_finite_are_left_out_in_silence(
    capfd: pytest.CaptureFixture[str],
) -> None:
    slopes = np.where(X > 9, np.nan, X)[:, None]
    found = iterated(lambda value: (value[0] * X, slopes), np.zeros(1), LEFT)
    assert found.values[0] == pytest.approx(0.03, abs=0.002)
    assert found.likelihood > 0
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize("bad", [np.nan, np.inf])
def test_a_law_that_says_no_number_of_a_row_has_no_likelihood(
    bad: float, capfd: pytest.CaptureFixture[str]
) -> None:
    with np.errstate(invalid="ignore"):
        found = linear(np.where(X > 9, bad, X)[:, None], LEFT)
    assert found.likelihood == -np.inf
    assert capfd.readouterr() == ("", "")
