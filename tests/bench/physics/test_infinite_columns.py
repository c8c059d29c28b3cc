"""An infinite number in a table is not known: no range is made of it."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.errors import BenchError
from bench.physics.scene import scene


def table(**columns: list[float]) -> pd.DataFrame:
    return pd.DataFrame({"true_range_m": [3.0, 4.0], **columns})


def test_an_infinite_number_is_as_unknown_as_an_empty_one() -> None:
    rows = scene(table(reply_time_s=[np.inf, 5e-4], temperature_c=[-np.inf, 20.0]))
    assert rows.numbers["reply_time_s"].tolist() == pytest.approx([np.nan, 5e-4], nan_ok=True)
    assert rows.numbers["temperature_c"].tolist() == pytest.approx([np.nan, 20.0], nan_ok=True)


def test_an_infinite_true_range_is_refused() -> None:
    with pytest.raises(BenchError, match="true_range_m must be known"):
        scene(table().assign(true_range_m=[np.inf, 4.0]))
