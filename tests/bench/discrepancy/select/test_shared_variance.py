"""Links that scatter alike tell how much any of them scatters."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.select.shared_variance import shared_variance

RNG = np.random.default_rng(5)


def drawn(true_variance: np.ndarray, degrees: int) -> np.ndarray:
    """Return variances [L] as they are found with so many degrees of freedom."""
    return np.asarray(true_variance * RNG.chisquare(degrees, len(true_variance)) / degrees)


def test_what_two_degrees_leave_open_the_other_links_tell() -> None:
    """Of one common variance all is learnt; no link seems to scatter hardly at all."""
    found, degrees = shared_variance(drawn(np.full(2000, 4.0), 2), 2)
    assert degrees > 8
    assert found.min() > 2.5
    assert found.max() < 8


def test_links_that_scatter_each_by_itself_keep_what_they_have() -> None:
    """Of scatters over decades nothing is common."""
    own = drawn(np.geomspace(1e-4, 1e4, 80), 20)
    found, degrees = shared_variance(own, 20)
    assert degrees < 21
    assert np.median(np.abs(np.log(found / own))) < 0.1


def test_degrees_of_freedom_are_found() -> None:
    """Variances that scatter as of ten more degrees of freedom have about ten more."""
    _, degrees = shared_variance(drawn(10 / RNG.chisquare(10, 4000), 8), 8)
    assert 15 < degrees < 21


def test_one_link_or_none_that_scatters_stays_as_it_is() -> None:
    """Nothing is shared."""
    for one in (np.array([0.5]), np.array([0.0, np.nan, 2.0])):
        found, degrees = shared_variance(one, 3)
        np.testing.assert_array_equal(found, one)
        assert degrees == 3
