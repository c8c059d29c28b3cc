"""A level of which several names of a set took what is there once speaks against none of them."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.sets import install
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern
from bench.physics.effects.propagation.diffraction import Diffraction


def scored(range_crps: float, level_crps: float) -> Tally:
    """Return the tally of 20 links of one row each."""
    sums = np.tile([range_crps, level_crps], (20, 1))
    return Tally((RANGE, LEVEL), sums, np.ones((20, 2)))


@pytest.mark.parametrize("alone_db", [0.5, 90.0])
def test_a_name_loses_by_levels_only_where_it_does_alone(
    alone_db: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    made = {0: scored(1, 1), 1: scored(0.5, alone_db), 2: scored(0.5, 90.0)}
    monkeypatch.setattr(install, "_beside", lambda _, added: made[len(added)])
    monkeypatch.setattr(install, "tally", lambda one: one)
    search, pattern = cast(Any, SimpleNamespace(seed=0)), AntennaPattern()
    found = install._contender(search, (Diffraction(),), pattern, scored(1, 1))
    assert (found.gain.high < 0) == (alone_db > 1)
