"""Links are the same by name only where they are in the same place."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.matching import same_places


def table(offset_m: float, moved: int = 0) -> pd.DataFrame:
    links = np.repeat([f"A{i}" for i in range(9)], 4)
    true = np.repeat(np.linspace(2, 10, 9), 4) + offset_m
    true[: 4 * moved] += 30
    return pd.DataFrame({"link": links, "true_range_m": true})


@pytest.mark.parametrize(
    ("simulated", "same"),
    [
        (table(0.0), True),
        (table(0.3), True),
        (table(0.0, moved=2), True),
        (table(5.0), False),
        (table(0.0).drop(columns="true_range_m"), True),
    ],
)
def test_names_that_are_used_again_elsewhere_are_other_links(
    simulated: pd.DataFrame, same: bool
) -> None:
    assert same_places(table(0.0), simulated) is same
