"""A mismatch that nothing hidden made is none to remove."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd

from bench.challenge.removal import moved
from bench.recordings.table import Recordings


def test_only_observables_that_are_moved_count() -> None:
    clean = pd.DataFrame(
        {
            "true_range_m": [5.0, 6.0, 7.0],
            "error_m": [0.01, 0.02, np.nan],
            "rx_power_dbm": [-80.0, np.nan, -82.0],
        }
    )
    recorded = clean.assign(error_m=clean["error_m"] + 0.1)
    case = SimpleNamespace(recorded=Recordings(recorded, "case"), clean=clean)
    assert moved(case) == {"error_m"}  # type: ignore[arg-type]
    same = SimpleNamespace(recorded=Recordings(clean, "case"), clean=clean)
    assert moved(same) == set()  # type: ignore[arg-type]
