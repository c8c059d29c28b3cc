"""Levels that differ by less than any receiver reads differ by nothing."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.permutation_test import locate
from bench.discrepancy.locate.readable import as_read, unreadable

LINKS = np.repeat(np.arange(40), 5)


@pytest.mark.parametrize(("scatter_db", "seen"), [(0.015, False), (0.07, False), (0.4, True)])
def test_a_scatter_of_levels_counts_where_it_is_read(scatter_db: float, seen: bool) -> None:
    """Simulated without waveforms they do not scatter at all."""
    rng = np.random.default_rng(1)
    levels = np.tile(rng.uniform(-90, -70, len(LINKS)), (9, 1))
    levels[0] += rng.normal(0, scatter_db, len(LINKS))
    versions = np.stack([rng.normal(0, 0.03, levels.shape), levels], axis=-1)
    made = Ensemble(("error_m", "rx_power_dbm"), ("m", "dB"), versions, LINKS)
    found = locate(made, Covariates({}, {}), 0)
    assert found.significant is seen
    assert (found.p < 0.01) is seen


def test_a_few_rows_with_far_other_levels_count() -> None:
    rng = np.random.default_rng(1)
    levels = np.tile(rng.uniform(-90, -70, len(LINKS)), (9, 1))
    levels[0, rng.choice(len(LINKS), 12, replace=False)] -= 8.0  # behind somebody
    versions = np.stack([rng.normal(0, 0.03, levels.shape), levels], axis=-1)
    made = Ensemble(("error_m", "rx_power_dbm"), ("m", "dB"), versions, LINKS)
    assert not unreadable(made, [SimpleNamespace(observable="rx_power_dbm")])[0]  # type: ignore[list-item]


def test_no_smaller_shift_of_levels_is_promised_than_is_read() -> None:
    assert as_read({"rx_power_dbm": 4e-14, "error_m": 0.002}) == {
        "rx_power_dbm": 0.1, "error_m": 0.002,
    }  # fmt: skip
