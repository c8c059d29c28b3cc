"""The shift that is said to be seen is seen about every second time; rare links are seen too."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.permutation_test import locate, rare_links

LINKS, ROWS = 40, 5


def _ensemble(seed: int, versions: int, shift: float = 0.0, struck: int = 0) -> Ensemble:
    """Return an ensemble of one observable whose links have offsets of their own."""
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(LINKS), ROWS)
    offsets = rng.normal(0, 0.03, (1 + versions, LINKS))
    offsets[0, :struck] += 0.8
    values = offsets[:, link] + rng.normal(0, 0.03, (1 + versions, len(link)))
    values[0] += shift
    return Ensemble(("error_m",), ("m",), values[..., None], link)


def _seen(versions: int, times: float) -> float:
    """Return how often a shift of so many times the stated one is seen."""
    seen = []
    for seed in range(24):
        stated = locate(_ensemble(seed, versions), Covariates({}, {}), seed, permutations=199)
        shift = times * stated.detectable["error_m"]
        again = _ensemble(seed + 100, versions, shift)
        seen.append(locate(again, Covariates({}, {}), seed, permutations=199).significant)
    return float(np.mean(seen))


@pytest.mark.parametrize("versions", [1, 3, 8])
def test_the_stated_shift_is_true_within_half(versions):
    assert _seen(versions, 1.5) > 0.6
    assert _seen(versions, 1 / 1.5) < 0.5


def test_two_links_among_forty_are_seen_with_three_simulated_versions():
    found = [rare_links(_ensemble(seed, 3, struck=2), seed) for seed in range(10)]
    assert sum(f is not None for f in found) >= 9
    located = locate(_ensemble(3, 3, struck=2), Covariates({}, {}), 3)
    assert located.significant
    assert located.p <= 0.05


def test_links_that_only_scatter_are_no_rare_cause():
    assert [rare_links(_ensemble(seed, 3), seed) for seed in range(40)].count(None) >= 39
