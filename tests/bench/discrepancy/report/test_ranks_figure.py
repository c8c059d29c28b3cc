"""The picture of ranks says how uneven chance makes them."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.report.figures import chance_of_ranks
from bench.discrepancy.select.settings import RANK_BINS


def test_nine_in_ten_densities_of_even_ranks_lie_within_the_band() -> None:
    rng, links = np.random.default_rng(2), 1200
    draws = rng.random((400, links))
    density = np.stack([np.histogram(one, RANK_BINS, (0, 1), density=True)[0] for one in draws])
    inside = (np.abs(density - 1) <= chance_of_ranks(links)).mean()
    assert 0.86 < inside < 0.95
