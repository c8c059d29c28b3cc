"""Small tables for tests: noise in the exchange format, so nothing may be learnt from them."""

from __future__ import annotations

from collections.abc import Sequence
from typing import Any

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.table import Recordings


def cells(matrix: NDArray[Any]) -> NDArray[np.object_]:
    """Return the rows of a matrix as an object array, one float32 array per cell."""
    column = np.empty(len(matrix), dtype=object)
    column[:] = list(np.asarray(matrix, np.float32))
    return column


def make_frame(
    rows: int = 60,
    width: int = 157,
    links: int = 12,
    environments: Sequence[str] = ("big", "medium", "small"),
    first_path: float = 5.25,
    seed: int = 0,
) -> pd.DataFrame:
    """Return `rows` ranges over `links` links, each link in one environment, LoS or NLoS."""
    rng = np.random.default_rng(seed)
    link = np.arange(rows) % links
    los = (link // len(environments)) % 2 == 0
    true = rng.uniform(1.0, 8.0, links)[link]
    cir = np.abs(rng.normal(0.0, 100.0, (rows, width)))
    peak = int(first_path) + 1
    cir[:, peak] += rng.uniform(5000.0, 10000.0, rows)
    return pd.DataFrame(
        {
            "range_m": true + np.where(los, 0.0, 0.2) + rng.normal(0.0, 0.03, rows),
            "true_range_m": true,
            "cir": cells(cir),
            "first_path_index": np.full(rows, first_path),
            "los": los,
            "environment": np.asarray(environments)[link % len(environments)],
            "obstacles": [[] if seen else ["wall", "glass plate"] for seen in los],
            "link": np.char.add("link-", link.astype(str)),
        }
    )


def make_recordings(source: str = "noise", **options: Any) -> Recordings:
    """Return `make_frame(**options)` as recordings marked SIMULATED."""
    return Recordings(
        make_frame(**options), source=source, licence="CC0-1.0", simulator="# noise", seed=0
    )
