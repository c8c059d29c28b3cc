"""Small helpers that every experiment's outcome is put together with."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import numpy.typing as npt
import pandas as pd
from numpy.typing import NDArray

from bench.reproduce.context import Context
from bench.reproduce.outcome import Figure, Outcome, Table
from bench.results import Interval

Floats = NDArray[np.float64]
OTHER_DATA = (
    "The paper's figures are of its own recordings (Deep UWB, medium room left out unless said). "
    "A difference is therefore a difference of data as well as of method."
)
RESAMPLES = 1000


def make_outcome(
    context: Context,
    experiment: str,
    title: str,
    protocol: str,
    tables: Sequence[Table] = (),
    figures: Sequence[Figure] = (),
    notes: Sequence[str] = (),
) -> Outcome:
    """Return an outcome about the context's recordings; a quick one says what it left out."""
    rows = len(context.recordings)
    quick = f" QUICK: thinned to {rows} rows by whole links." if context.quick else ""
    return Outcome(
        experiment=experiment,
        title=title,
        data=context.name,
        data_fingerprint=context.recordings.fingerprint,
        simulated=context.recordings.simulated,
        quick=context.quick,
        protocol=protocol + quick,
        tables=tables,
        figures=figures,
        notes=(*notes, OTHER_DATA),
    )


def over_links(
    statistic: Callable[[Floats], float],
    values: npt.ArrayLike,
    links: npt.ArrayLike,
    seed: int = 0,
    resamples: int = RESAMPLES,
) -> Interval:
    """Return statistic(values) with its 95 % percentile interval by bootstrap over links.

    `values` [n]; `links` [n] labels. Whole links are drawn, since rows of one link are no
    independent evidence. No interval where there are fewer than two links.
    """
    whole = np.asarray(values, np.float64)
    codes, _ = pd.factorize(np.asarray(links))
    groups = [whole[rows] for rows in _positions(codes)]
    value = statistic(whole)
    if len(groups) < 2:
        return Interval(value)
    rng = np.random.default_rng(seed)
    draws = [
        statistic(np.concatenate([groups[i] for i in rng.integers(0, len(groups), len(groups))]))
        for _ in range(resamples)
    ]
    low, high = np.quantile(draws, [0.025, 0.975])
    return Interval(value, float(low), float(high))


def _positions(codes: NDArray[np.intp]) -> list[NDArray[np.intp]]:
    order = np.argsort(codes, kind="stable")
    return np.split(order, np.flatnonzero(np.diff(codes[order])) + 1)
