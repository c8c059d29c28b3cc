"""The rows behind a board: what every model predicted for them, read from the result folder.

Files come from elsewhere: only regular Parquet files of sane size are read, column by column, and
one that does not hold what it should leaves its model out of the ranking, by name.
"""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from reports.believe import believed
from reports.boards import Board, Entry
from reports.ranking.paired import Floats, Paired, by_link

if TYPE_CHECKING:
    import pandas as pd

COLUMNS = ["row", "link", "error_m", "predicted_m", "scored_as_los"]
MOST_BYTES = 1_000_000_000


@dataclass(frozen=True)
class Compared:
    """Models on the rows all of them were tested on, and those left out with the reason."""

    paired: Paired | None
    left_out: dict[str, str]


def compared(board: Board, folder: Path, los: bool = False) -> Compared:
    """Return a board's models on its NLoS (or LoS) rows, paired row by row.

    Over several seeds a row's |residual| is the mean of the seeds'. `paired` is None where fewer
    than two models have predictions of common rows.
    """
    tables, left_out = {}, {}
    for entry in board.entries:
        try:
            tables[entry.name] = magnitudes(entry, folder, los)
        except (OSError, ValueError, KeyError) as problem:
            left_out[entry.name] = f"no predictions to compare: {_first_line(problem)}"
    return Compared(paired(tables) if len(tables) > 1 else None, left_out)


def paired(tables: dict[str, pd.Series[float]]) -> Paired | None:
    """Return models on their common rows; each a series of |residual| in metres by (row, link)."""
    series = list(tables.values())
    common = series[0].index
    for other in series[1:]:
        common = common.intersection(other.index)
    if not len(common):
        return None
    links = common.get_level_values("link").to_numpy().astype(str)
    rows = [np.asarray(one.loc[common], np.float64) for one in series]
    return by_link(list(tables), rows, links)


def magnitudes(entry: Entry, folder: Path, los: bool) -> pd.Series[float]:
    """Return |residual| by row and link, the mean over seeds; rows every seed has."""
    import pandas as pd

    seeds = [read(folder / "predictions" / f"{name}.parquet", los) for name in entry.files]
    if not seeds or any(one.empty for one in seeds):
        raise ValueError("no such rows")
    return pd.concat(seeds, axis=1, join="inner").mean(axis=1)


def read(path: Path, los: bool) -> pd.Series[float]:
    """Return |error - prediction| in metres by (row, link) of the NLoS or LoS rows.

    Raises OSError for a missing file and ValueError for one that is no predictions table.
    """
    import pyarrow.parquet as parquet
    from pyarrow import ArrowException

    if not path.is_file() or path.stat().st_size > MOST_BYTES:
        raise ValueError(f"{path.name} is not here, or is no regular file of a sane size")
    if not unchanged(path):
        raise ValueError(f"{path.name} was edited or damaged since its run was written")
    try:
        frame = parquet.read_table(path, columns=COLUMNS).to_pandas()
    except (ArrowException, KeyError) as problem:
        raise ValueError(f"{path.name} is no predictions table") from problem
    if list(frame.columns) != COLUMNS or frame.duplicated("row").any():
        raise ValueError(f"{path.name} is no predictions table: expected columns {COLUMNS}")
    chosen = frame[frame["scored_as_los"] == los].set_index(["row", "link"])
    residual: Floats = np.abs(chosen["error_m"] - chosen["predicted_m"])
    if not np.isfinite(residual).all():
        raise ValueError(f"{path.name} holds values that are not finite")
    return residual  # type: ignore[return-value]


def unchanged(path: Path) -> bool:
    """Return False where the run beside a predictions file holds another hash of it."""
    record = believed(path.parents[1] / "runs" / f"{path.stem}.json")
    expected = record.get("predictions_sha256")
    with path.open("rb") as stream:
        return expected in (None, hashlib.file_digest(stream, "sha256").hexdigest())


def _first_line(problem: Exception) -> str:
    return (str(problem).splitlines() or [type(problem).__name__])[0]
