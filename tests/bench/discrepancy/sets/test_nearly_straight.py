"""What is nearly a line over the distance is a scale, whatever steps it goes up in."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choose import chosen
from tests.bench.discrepancy.numpy_tables import Hidden
from tests.bench.discrepancy.sets.test_sets import search_of

TAPE_M = 3.0


def tapes(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return what tapes laid end to end are too short by: the last one by a cube of its part."""
    whole, rest = np.divmod(frame["true_range_m"].to_numpy(), TAPE_M)
    return np.asarray(0.02 * TAPE_M * (whole + (rest / TAPE_M) ** 3))


def bend(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return a law that levels off: no scale."""
    far = frame["true_range_m"].to_numpy()
    return np.asarray(0.5 * far / (far + 3.0))


@pytest.mark.parametrize(("hidden", "named"), [(tapes, True), (bend, False)])
def test_steps_of_tapes_are_a_scale_and_a_bend_is_none(hidden: Hidden, named: bool) -> None:
    found = chosen(search_of(hidden, 3), ())
    assert ("range-scale" in found.names) is named
    assert bool(found.names or found.others)
