"""Intervals beside waveform effects are as wide as a receiver's own shift leaves them."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.select.range_part import chosen_beside
from bench.discrepancy.select.settings import DETECTION_M
from bench.physics.effects.propagation.path_loss import PathLoss
from tests.bench.discrepancy.select.test_range_part import search_of


def test_a_constant_is_no_surer_than_what_a_receiver_adds_to_all_rows() -> None:
    """What flattened rows show of a delay hardly has its mean, of which least is known."""
    search = search_of(0.15)[1]
    made = chosen_beside(search, (PathLoss(),)).unsure["antenna-delay"]
    mean = made.columns.mean(axis=0)
    wide = [float(np.sqrt(mean @ one.covariance() @ mean)) for one in made.sets]
    alone = float(np.sqrt(mean @ made.alone.covariance() @ mean))
    assert max(wide) > 0.7 * DETECTION_M
    assert alone < 0.5 * max(wide)
    first = made.columns @ made.sets[0].factors
    assert abs(np.median(first) - 0.15) < 0.03


def test_how_large_shifts_of_receivers_are_is_told_by_rows() -> None:
    """Where nothing follows what is known, shifts ten times smaller are likelier."""
    search = search_of(0.15)[1]
    made = chosen_beside(search, (PathLoss(),)).unsure["antenna-delay"]
    mean = made.columns.mean(axis=0)
    narrow = [one.share for one in made.sets if mean @ one.covariance() @ mean < 0.005**2]
    assert sum(one.share for one in made.sets) == pytest.approx(1)
    assert 0.4 < sum(narrow) < 1
