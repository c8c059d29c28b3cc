"""The recordings of a run as arrays: windows, errors, labels and folds."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.open import Table, open_recordings, read
from bench.recordings.sources.base import Source
from bench.recordings.splits import Split, default_split, make_split
from bench.recordings.table import CIR_COLUMNS, Recordings
from bench.recordings.window import CirWindow, cir_window


@dataclass(frozen=True)
class Material:
    """Everything a run reads, row for row.

    `cirs` float32 [n, 157] counts ([n, 0] where the table has none), `errors_m` float32 [n],
    `links` [n]; `split` holds positions into them. `dropped` counts rows left
    out by reason, windowing included.
    """

    name: str
    recordings: Recordings
    fingerprint: str
    cirs: NDArray[np.float32]
    errors_m: NDArray[np.float32]
    links: NDArray[np.str_]
    split: Split
    dropped: dict[str, int]

    def sent(self) -> Material:
        """Return what another process needs: without the CIRs as recorded, half of the bytes."""
        slim = self.recordings.frame.drop(columns=list(CIR_COLUMNS), errors="ignore")
        return replace(self, recordings=replace(self.recordings, frame=slim))


def load_material(
    data: Table, split: str | Callable[[Recordings], Split] | None, fingerprint: str | None = None
) -> Material:
    """Open a data set, cut its windows and split it by link. Raises BenchError on bad input.

    `split` is a split's name, None for what suits the data, or what splits the rows left.
    `fingerprint` is taken as it is from whoever has no use for the rows' own, half a second's work.
    """
    if isinstance(data, Recordings | pd.DataFrame):
        whole, source = read(data), None
        name = whole.source
    else:
        whole, source = open_recordings(data)
        name = source.full_name if source else str(data)
    window = cir_window(whole) if "cir" in whole.frame else _no_window(len(whole))
    recordings = whole.select(window.rows)
    if not callable(split):
        split = partial(_named_split, name=split, source=source)
    made = split(recordings)
    return Material(
        name,
        recordings,
        whole.fingerprint if fingerprint is None else fingerprint,
        window.cirs,
        recordings.errors_m().astype(np.float32),
        recordings.frame["link"].astype(str).to_numpy(np.str_),
        made,
        {**whole.dropped, **window.dropped},
    )


def _no_window(rows: int) -> CirWindow:
    """Return windows of no samples: every row stays, for the models that read no CIR."""
    return CirWindow(np.empty((rows, 0), np.float32), np.arange(rows), {})


def _named_split(recordings: Recordings, name: str | None, source: Source | None) -> Split:
    return make_split(recordings, name or default_split(recordings, source), source=source)


def predictions_table(material: Material, positions: NDArray[np.intp]) -> pd.DataFrame:
    """Return the identifying columns of the rows scored, for the predictions file."""
    wanted = ("link", "environment", "los", "tx", "rx", "range_m", "true_range_m", "time_s")
    frame = material.recordings.frame
    table = frame.iloc[positions][[c for c in wanted if c in frame]].reset_index(drop=True)
    return table.assign(row=positions, error_m=material.errors_m[positions].astype(np.float64))
