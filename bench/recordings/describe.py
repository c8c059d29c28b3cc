"""What a recordings table holds, in numbers."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.recordings.clean import cir_lengths
from bench.recordings.table import SAMPLE_PERIOD_NS, Recordings

PERCENTILES = (5, 25, 50, 75, 95)
ALL = "all"
KINDS = ("LoS", "NLoS", "unlabelled")


@dataclass(frozen=True)
class ErrorStatistics:
    """Error = measured - true range, in metres, of the rows of one environment and kind.

    `sigma_m` is the standard deviation; `percentiles_m` goes by percent (5, 25, 50, 75, 95).
    """

    environment: str
    kind: str
    rows: int
    links: int | None
    mean_m: float
    mae_m: float
    sigma_m: float
    percentiles_m: Mapping[int, float]


@dataclass(frozen=True)
class Description:
    """The size of a table, what was dropped, and its error statistics.

    `links` is None without a link column; `cir_samples` is None without CIRs.
    """

    source: str
    simulated: bool
    licence: str
    fingerprint: str
    rows: int
    links: int | None
    cir_samples: int | None
    sample_period_ns: float
    columns: list[str]
    dropped: Mapping[str, int]
    errors: list[ErrorStatistics]


def describe_recordings(recordings: Recordings) -> Description:
    """Return what a table holds. Raises BenchError where no range error can be computed."""
    frame = recordings.frame
    periods = frame.get("sample_period_ns", pd.Series([SAMPLE_PERIOD_NS])).dropna()
    return Description(
        source=recordings.source,
        simulated=recordings.simulated,
        licence=recordings.licence,
        fingerprint=recordings.fingerprint,
        rows=len(frame),
        links=int(frame["link"].nunique()) if "link" in frame else None,
        cir_samples=int(cir_lengths(frame["cir"]).max()) if "cir" in frame else None,
        sample_period_ns=float(periods.median()) if len(periods) else SAMPLE_PERIOD_NS,
        columns=[str(column) for column in frame.columns],
        dropped=dict(recordings.dropped),
        errors=list(_statistics(recordings)),
    )


def row_kinds(recordings: Recordings) -> NDArray[np.str_]:
    """Return LoS, NLoS or unlabelled for each row [n]."""
    if "los" not in recordings.frame:
        return np.full(len(recordings), KINDS[2])
    labels = recordings.frame["los"].astype("boolean")
    los = labels.fillna(False).to_numpy(np.bool_)
    return np.select([labels.isna().to_numpy(), los], [KINDS[2], KINDS[0]], KINDS[1])


def _statistics(recordings: Recordings) -> Iterator[ErrorStatistics]:
    """Yield the statistics of all rows, then by kind, then by environment and kind."""
    frame = recordings.frame
    kinds = row_kinds(recordings)
    yield _of(recordings, ALL, ALL, np.ones(len(frame), np.bool_))
    for kind in _present(kinds):
        yield _of(recordings, ALL, kind, kinds == kind)
    if "environment" not in frame or frame["environment"].nunique() < 2:
        return
    environment = frame["environment"].astype("str").fillna("unknown").to_numpy()
    for name in sorted(set(environment)):
        for kind in _present(kinds[environment == name]):
            yield _of(recordings, name, kind, (environment == name) & (kinds == kind))


def _present(kinds: NDArray[np.str_]) -> list[str]:
    """Return the kinds that occur, in the fixed order."""
    return [kind for kind in KINDS if (kinds == kind).any()]


def _of(
    recordings: Recordings, environment: str, kind: str, rows: NDArray[np.bool_]
) -> ErrorStatistics:
    """Return the statistics of some rows."""
    errors = recordings.errors_m()[rows]
    frame = recordings.frame
    return ErrorStatistics(
        environment=environment,
        kind=kind,
        rows=int(rows.sum()),
        links=int(frame.loc[rows, "link"].nunique()) if "link" in frame else None,
        mean_m=float(errors.mean()),
        mae_m=float(np.abs(errors).mean()),
        sigma_m=float(errors.std()),
        percentiles_m={p: float(np.percentile(errors, p)) for p in PERCENTILES},
    )
