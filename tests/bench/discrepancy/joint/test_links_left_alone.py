"""Links with nothing in the way scatter as without what stands there; SIMULATED numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from bench.discrepancy.joint.covariances import Covariances
from bench.discrepancy.joint.likelihood import whitener
from bench.discrepancy.joint.spared import (
    among_touched,
    beside,
    of_touched,
    only_touched,
    scattered_as,
)
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.path_loss import PathLoss

LINKS, TOUCHED, SIZE, ROWS = 60, 15, 3, 2
COUNT = np.full(LINKS, ROWS)
WIDER = 4.0  # of the variance of links behind something, beyond that of others


def pooled(variance: float) -> Covariances:
    """Return the covariances of all links, of one variance."""
    link, none = variance * np.eye(SIZE), np.zeros((SIZE, SIZE))
    return Covariances((ROWS,), link, none, 0.0, 1.0, none, none)


def moments(mean: np.ndarray, variance: float) -> Moments:
    """Return statistics with a mean and pooled scatter."""
    zero = np.zeros((LINKS, SIZE))
    return Moments(zero, mean, pooled(variance), zero, zero)


def parted() -> Moments:
    """Return statistics of which the first links are moved, and scatter more."""
    mean = np.zeros((LINKS, SIZE))
    mean[:TOUCHED] = -6.0
    found = moments(mean, 1.0 + WIDER * TOUCHED / LINKS)
    return among_touched(found, moments(np.zeros((LINKS, SIZE)), 1.0), COUNT)


def test_touched_links_alone_scatter_by_what_touches_them() -> None:
    found = parted()
    assert found.spared is not None
    assert found.spared.alone.sum() == LINKS - TOUCHED
    assert np.diag(found.covariances[ROWS]) == pytest.approx(1.0 + WIDER)
    assert np.diag(found.spared.covariances[ROWS]) == pytest.approx(1.0)


def test_the_likelihood_takes_each_link_at_its_own_scatter() -> None:
    given = Statistics.__new__(Statistics)
    given.count = COUNT
    matrices, volume = whitener(given, parted(), ())
    assert matrices[0, 0, 0] == pytest.approx((1.0 + WIDER) ** -0.5)
    assert matrices[-1, 0, 0] == pytest.approx(1.0)
    assert volume == pytest.approx(SIZE * TOUCHED * np.log(1.0 + WIDER))


def test_few_links_do_not_tell_that_they_scatter_less() -> None:
    mean = np.zeros((LINKS, SIZE))
    mean[:TOUCHED] = -6.0
    found = among_touched(moments(mean, 0.8), moments(np.zeros((LINKS, SIZE)), 1.0), COUNT)
    assert np.diag(found.covariances[ROWS]) == pytest.approx(1.0)


def test_what_touches_all_or_none_parts_nothing() -> None:
    rest = moments(np.zeros((LINKS, SIZE)), 1.0)
    for mean in (np.full((LINKS, SIZE), -6.0), np.zeros((LINKS, SIZE))):
        assert among_touched(moments(mean, 2.0), rest, COUNT).spared is None


def test_effects_of_obstacles_are_those_that_leave_links_alone() -> None:
    assert beside((Diffraction(), PathLoss())) == (PathLoss(),)


def test_changes_are_of_touched_rows() -> None:
    found, code = parted(), np.repeat(np.arange(LINKS), ROWS)
    change = np.arange(LINKS * ROWS, dtype=np.float64)[None, :, None]
    some, links = of_touched(change, code, found.spared)
    assert some.shape == (1, TOUCHED * ROWS, 1)
    assert links.max() == TOUCHED - 1
    assert of_touched(change, code, None)[0] is change


def test_the_scatter_of_others_comes_whole() -> None:
    plain = moments(np.zeros((LINKS, SIZE)), 1.0)
    assert scattered_as(parted(), plain).spared is None
    assert scattered_as(plain, parted()).spared is not None
    assert replace(parted(), spared=None).spared is None


def test_what_strikes_only_links_behind_something_is_a_form_of_that() -> None:
    spared, struck = parted().spared, np.arange(LINKS) < 3
    assert only_touched(spared, struck)
    assert not only_touched(spared, np.arange(LINKS) % 20 == 0)  # clear ones, too
    assert not only_touched(spared, np.arange(LINKS) < 1)  # one of four is behind it by chance
    assert not only_touched(None, struck)
