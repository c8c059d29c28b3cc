"""Intervals over links: promised coverage on new links, widths, and scores of distributions."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad
from scipy.stats import norm

from bench.errors import BenchError
from bench.measure.conformal import intervals


def made_up(links: int, seed: int, rows: int = 20) -> tuple[np.ndarray, np.ndarray]:
    """Residuals whose size differs from link to link."""
    rng = np.random.default_rng(seed)
    link = np.repeat(np.arange(links), rows)
    return rng.gamma(2, 0.1, links)[link] * rng.normal(0, 1, links * rows), link


@pytest.mark.parametrize("level", [0.8, 0.9])
def test_new_links_are_covered_as_promised(level: float) -> None:
    found = [
        intervals(e, np.zeros_like(e), k, level) for e, k in (made_up(40, s) for s in range(40))
    ]
    coverage = np.mean([one.coverage for one in found])
    assert level - 0.005 < coverage < level + 0.04  # the quantile is rounded up, never down


def test_rows_of_one_link_do_not_count_as_many() -> None:
    """A link of a thousand calm rows must not narrow what thirty wild links need."""
    errors, links = made_up(30, 1)
    calm = np.concatenate([errors, np.zeros(5000)]), np.concatenate([links, np.full(5000, 99)])
    alone = intervals(errors, np.zeros_like(errors), links)
    both = intervals(calm[0], np.zeros_like(calm[0]), calm[1])
    assert both.half_width_m > 0.8 * alone.half_width_m


def test_a_deviation_gives_wide_intervals_where_it_is_large() -> None:
    rng = np.random.default_rng(0)
    links = np.repeat(np.arange(100), 10)
    std = np.where(links % 2, 0.5, 0.05)
    errors = std * rng.normal(size=1000)
    scaled = intervals(errors, np.zeros(1000), links, std_m=std)
    flat = intervals(errors, np.zeros(1000), links)
    assert scaled.half_width_m < flat.half_width_m
    assert scaled.own_coverage == pytest.approx(0.9, abs=0.03)
    assert flat.own_coverage is None


def test_crps_is_the_integral_that_defines_it() -> None:
    errors, mean, std = np.array([0.3, -0.1]), np.array([0.1, 0.0]), np.array([0.2, 0.4])
    found = intervals(np.tile(errors, 9), np.tile(mean, 9), np.arange(18) // 2, 0.5,
                      np.tile(std, 9)).crps_m  # fmt: skip

    def integral(x: float, m: float, s: float) -> float:
        return quad(lambda t: (norm.cdf(t, m, s) - (t >= x)) ** 2, -4, 4, points=[x])[0]

    expected = np.mean([integral(*row) for row in zip(errors, mean, std, strict=True)])
    assert found == pytest.approx(expected, rel=1e-4)


REFUSED = [(1.2, 20, "between 0 and 1"), (0.99, 20, "too few"), (0.9, 1, "too few")]


@pytest.mark.parametrize(("level", "links", "said"), REFUSED)
def test_what_cannot_be_promised_is_refused(level: float, links: int, said: str) -> None:
    errors, link = made_up(links, 0)
    with pytest.raises(BenchError, match=said):
        intervals(errors, np.zeros_like(errors), link, level)
