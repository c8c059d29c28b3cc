"""Intervals of finished runs, from the predictions that lie beside their records."""

from __future__ import annotations

import pandas as pd

from bench.measure.conformal import Intervals, intervals
from bench.results import RunRecord
from bench.runner.folder import ResultFolder


def intervals_of(folder: ResultFolder, run: RunRecord, level: float) -> Intervals:
    """Return the intervals of one finished run at `level`; BenchError where there are none."""
    table = pd.read_parquet(folder.predictions_path(run.key.digest()))
    return intervals(
        table["error_m"], table["predicted_m"], table["link"], level, table.get("std_m")
    )
