"""What similar links differ by beyond versions of one link, as effects change it."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.joint.similar import covariance_beyond, scaled, variance_beyond

LINKS = 4000


def versions(least: float = -np.inf) -> tuple[np.ndarray, np.ndarray]:
    """Return four versions of links, and two of links that are like them, one statistic each.

    No smaller than an effect makes them that fills where little arrives.
    """
    rng = np.random.default_rng(7)
    own = rng.normal(0, 6, (1, LINKS, 1)) + rng.normal(0, 1, (4, LINKS, 1))
    others = rng.normal(0, 6, (2, LINKS, 1)) + rng.normal(0, 1, (2, LINKS, 1))
    return np.maximum(own, least), np.maximum(others, least)


def test_similar_links_differ_by_what_each_link_keeps() -> None:
    assert abs(variance_beyond(*versions())[0] / 72 - 1) < 0.05
    own, _ = versions()
    assert abs(variance_beyond(own[:3], own[3:])[0]) < 0.1


def test_what_fills_where_little_arrives_makes_similar_links_differ_less() -> None:
    usual = covariance_beyond(versions()[1] - versions()[0].mean(axis=0), np.eye(1))
    before, after = variance_beyond(*versions()), variance_beyond(*versions(least=0.0))
    made = scaled(usual, before, after)
    assert 0.2 < made[0, 0] / usual[0, 0] < 0.5
    assert (scaled(usual, before, before) == usual).all()
    assert (scaled(usual, before, None) == usual).all()


def test_a_statistic_that_similar_links_share_stays_as_it_is() -> None:
    shared, moved = np.array([0.0, 4.0]), np.array([9.0, 1.0])
    assert scaled(np.ones((2, 2)), shared, moved).tolist() == [[1.0, 0.5], [0.5, 0.25]]
