"""A name gives way to a law that predicts as well; a name that is the truth does not."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.sets.choose import chosen
from tests.bench.discrepancy.numpy_tables import Hidden, warmth
from tests.bench.discrepancy.sets.test_sets import search_of


def stepped(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return 8 cm from 24 degrees on: warming radios follow no step."""
    return 0.08 * (frame["temperature_c"].to_numpy() > 24)


def settling(frame: pd.DataFrame, _: np.random.Generator) -> np.ndarray:
    """Return what levels off with the distance: an error of the level would too."""
    return 0.15 * (1 - np.exp(-frame["true_range_m"].to_numpy() / 4))


@pytest.mark.parametrize(
    ("hidden", "names", "form"),
    [(stepped, (), "step"), (settling, (), ""), (warmth, ("temperature-drift",), "")],
)
def test_a_name_holds_only_where_no_law_predicts_as_well(
    hidden: Hidden, names: tuple[str, ...], form: str
) -> None:
    found = chosen(search_of(hidden, 11), ())
    assert found.names == names
    assert any(one.startswith(form) for one in (*found.others, ""))
