"""Sets of causes weighed together get what each gets alone, to the last bit."""

from __future__ import annotations

from itertools import combinations

import numpy as np
import pytest

from bench.discrepancy.sets.evidence import Evidence, Weighed
from bench.discrepancy.sets.likeliest import inverse_root
from bench.discrepancy.sets.settings import OFFSET_RATIOS

WIDTHS = [(1,), (2,), (1, 8), (3,), (17,), (1, 1), (2, 1), (4,)]


def _evidence() -> Evidence:
    rng = np.random.default_rng(3)
    links = np.repeat(np.arange(40), 10)
    blocks = {
        f"cause {i}": tuple(rng.normal(size=(400, width)) for width in widths)
        for i, widths in enumerate(WIDTHS)
    }
    left = 0.1 * rng.normal(size=400) + 0.05 * rng.normal(size=40)[links]
    left += 0.2 * blocks["cause 2"][1][:, 0] + 0.1 * blocks["cause 0"][0][:, 0]
    return Evidence(left, links, blocks, {"cause 3": 0.5})


def _assert_same(one: Weighed, other: Weighed) -> None:
    assert (one.causes, one.nats) == (other.causes, other.nats)
    assert (one.variance_m2, one.ratio) == (other.variance_m2, other.ratio)
    for name in ("places", "factors", "covariance"):
        np.testing.assert_array_equal(getattr(one, name), getattr(other, name))


def test_sets_get_together_what_each_gets_alone() -> None:
    made = _evidence()
    for nearby in (0, made.nearby, len(OFFSET_RATIOS) - 1):
        made.nearby = nearby
        sets = [(), *((name,) for name in made.blocks), *combinations(made.blocks, 2)]
        together = made.of_all(sets)
        for one, causes in zip(together, sets, strict=True):
            _assert_same(one, made.of(causes))
    assert made.of_all([]) == []


def test_a_ratio_is_left_only_for_a_better_one() -> None:
    made = _evidence()
    best = made.of(("cause 0", "cause 2"))
    every = [made.at([best.causes], ratio)[0].nats for ratio in OFFSET_RATIOS]
    place = OFFSET_RATIOS.index(best.ratio)
    assert best.nats == every[place] == max(every[max(place - 1, 0) : place + 2])


def test_a_root_is_that_of_the_inverse() -> None:
    rng = np.random.default_rng(4)
    columns, more = rng.normal(size=(30, 6)), rng.uniform(0.1, 1, 6)
    matrix = np.asfortranarray(columns.T @ columns)
    root = inverse_root(matrix.copy(order="F"), more)
    np.testing.assert_allclose(root.T @ root, np.linalg.inv(matrix + np.diag(more)), rtol=1e-9)
    assert np.array_equal(root, np.tril(root))
    with pytest.raises(np.linalg.LinAlgError, match="not positive"):
        inverse_root(np.asfortranarray(-matrix), more)
