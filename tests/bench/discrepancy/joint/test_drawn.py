"""What effects draw for a link moves its statistics together; SIMULATED numbers."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.joint.covariances import Covariances
from bench.discrepancy.joint.drawn import with_drawn
from bench.discrepancy.joint.settings import SAME_SCATTER

LINKS, ROWS, MEMBERS, SIZE = 80, 3, 6, 12
CODE = np.repeat(np.arange(LINKS), ROWS)
SHARE = 0.3  # of a shrunk covariance, its diagonal


def of_scatter(variance: float) -> Covariances:
    """Return the covariances of links whose statistics scatter by themselves."""
    link, none = variance * np.eye(SIZE), np.zeros((SIZE, SIZE))
    return Covariances((ROWS,), link, none, SHARE, 1.0, none, none)


def drawn(ways: np.ndarray) -> np.ndarray:
    """Return what versions change by, by normal numbers of every link along some ways [k, p]."""
    sizes = np.random.default_rng(5).normal(size=(MEMBERS, LINKS, len(ways)))
    return np.asarray((sizes @ ways)[:, CODE])


def added(ways: np.ndarray) -> np.ndarray:
    """Return the covariance beside plain scatter of one, of what moves along ways."""
    plain = of_scatter(1.0)
    change = drawn(ways)
    whole = Covariances(
        (ROWS,), np.eye(SIZE) + ways.T @ ways, plain.rows, SHARE, 1.0, plain.apart, plain.floor
    )
    return np.asarray(with_drawn(plain, whole, change, CODE, 0)[ROWS])


def test_what_links_draw_moves_statistics_together() -> None:
    """A reflection of chance phase is no scatter of every statistic by itself."""
    way = np.r_[0.0, np.full(SIZE - 1, 0.6)][None]
    made = added(way)
    apart = made[1:, 1:][~np.eye(SIZE - 1, dtype=bool)]
    assert np.median(apart) == pytest.approx(0.36, rel=0.15)  # shrunk it were 0.25
    assert np.diag(made)[1:] == pytest.approx(1.36, rel=0.15)


def test_what_goes_with_levels_alone_is_shrunk() -> None:
    """Else scatter of levels would stand for any form of a loss."""
    made = added(np.full((1, SIZE), 0.6))
    apart = made[~np.eye(SIZE, dtype=bool)]
    assert np.median(apart) == pytest.approx(0.36 * (1 - SHARE), rel=0.15)


def test_what_takes_scatter_away_is_no_sum() -> None:
    plain, whole = of_scatter(1.0), of_scatter(np.exp(-1.1 * SAME_SCATTER[1]))
    made = with_drawn(plain, whole, drawn(np.zeros((1, SIZE))), CODE, 0)
    assert made[ROWS] == pytest.approx(whole[ROWS])


def test_one_version_tells_no_scatter() -> None:
    plain, whole = of_scatter(1.0), of_scatter(1.2)
    assert with_drawn(plain, whole, drawn(np.ones((1, SIZE)))[:1], CODE, 0) is whole


def test_what_takes_some_scatter_away_is_partly_a_sum() -> None:
    """Between a sum and none there is no step at which a fit would stick."""
    plain, way = of_scatter(1.0), np.r_[0.0, np.full(SIZE - 1, 0.6)][None]
    apart = []
    for off in (0.0, np.mean(SAME_SCATTER), SAME_SCATTER[1]):
        link = np.exp(-off) * (np.eye(SIZE) + way.T @ way)
        whole = Covariances((ROWS,), link, plain.rows, SHARE, 1.0, plain.apart, plain.floor)
        made = np.asarray(with_drawn(plain, whole, drawn(way), CODE, 0)[ROWS])
        apart.append(np.median(made[1:, 1:][~np.eye(SIZE - 1, dtype=bool)]))
    assert apart[0] > apart[1] > apart[2]
