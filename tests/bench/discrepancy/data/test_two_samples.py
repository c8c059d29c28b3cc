"""Two samples are compared without a warning of scipy's that nobody can act on."""

from __future__ import annotations

import warnings
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import scipy.stats

from bench.discrepancy.data.two_samples import two_samples


def test_samples_of_one_distribution_are_told_from_others() -> None:
    rng = np.random.default_rng(1)
    one, alike, wider = rng.normal(size=80), rng.normal(size=90), rng.normal(0, 3, 90)
    assert two_samples(one, alike)[1] > 0.01
    apart, chance = two_samples(one, wider)
    assert apart > 0.2
    assert chance < 1e-3


@pytest.mark.filterwarnings("error")
def test_what_scipy_cannot_do_exactly_is_no_warning(monkeypatch: pytest.MonkeyPatch) -> None:
    def unsure(*_: Any) -> SimpleNamespace:
        warnings.warn("ks_2samp: Exact calculation unsuccessful.", RuntimeWarning, stacklevel=2)
        return SimpleNamespace(statistic=0.5, pvalue=0.25)

    monkeypatch.setattr(scipy.stats, "ks_2samp", unsure)
    assert two_samples(np.zeros(3), np.ones(3)) == (0.5, 0.25)
