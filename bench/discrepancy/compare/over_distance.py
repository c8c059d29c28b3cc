"""What a simulated table's observables do over the distance: a matched row is rarely just as far.

Matching on covariates leaves a difference where the mixes differ; a regression on the simulated
side takes it out (bias-corrected matching: Abadie and Imbens 2011). Free space is the first guess
of levels, none of all else; so accumulators that are scaled to one peak are seen to be.
"""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from bench.discrepancy.compare.settings import FREE_SPACE_DB, SLOPE_LINKS
from bench.discrepancy.data.observables import RANGE, Observables
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats

LEVELS = (
    "rx_power_dbm", "first_path_power_dbm", "energy_db", "max_amplitude_db", "peak_counts_db",
)  # fmt: skip  # observables that follow the distance in free space


def slopes(
    observed: Observables, range_m: Floats, links: Rows, kinds: Rows | None = None
) -> dict[str, float]:
    """Return the change of every observable but the range per decade of distance.

    Over means of `links` [n], by least squares; as far as it is told from the first guess. Links of
    one of `kinds` [n] are compared: matched rows are of one kind, and far ones stand behind walls.
    """
    decades = _decades(range_m)
    kinds = np.zeros(len(links), np.intp) if kinds is None else kinds
    first = {name: FREE_SPACE_DB * (name in LEVELS) for name in observed.names if name != RANGE}
    return {
        name: _slope(observed.column(name), decades, links, kinds, of) for name, of in first.items()
    }


def nearer(
    names: tuple[str, ...], over: Mapping[str, float], ours: Floats, theirs: Floats
) -> Floats:
    """Return by how much observables [n, p] change from one distance [n] in metres to our own."""
    change = _decades(ours) - _decades(theirs)
    slope = np.array([over.get(name, 0.0) for name in names])
    return np.asarray(np.nan_to_num(change)[:, None] * slope)


def _slope(values: Floats, decades: Floats, links: Rows, kinds: Rows, first: float) -> float:
    """Return a slope, nearer to the first guess the less it is told from that."""
    known = np.isfinite(values) & np.isfinite(decades)
    _, some, code = np.unique(links[known], return_index=True, return_inverse=True)
    count = np.bincount(code)
    kind = np.unique(kinds[known][some], return_inverse=True)[1]
    free = len(count) - len(np.unique(kind)) - 1
    if len(count) < SLOPE_LINKS or free < 1:
        return first
    means = (np.bincount(code, one[known]) / count for one in (decades, values))
    far, high = (_within(one, kind) for one in means)
    high = high - first * far
    square = float(far @ far)
    if square <= 0:
        return first
    more = float(far @ high) / square
    error = float(((high - more * far) ** 2).sum()) / free / square
    return first + more**3 / max(more**2 + error, 1e-30)


def _within(values: Floats, kind: Rows) -> Floats:
    """Return values [L] less the mean of their kind."""
    return np.asarray(values - (np.bincount(kind, values) / np.bincount(kind))[kind], np.float64)


def _decades(range_m: Floats) -> Floats:
    """Return the logarithm of distances, unknown where they are none."""
    return np.asarray(np.log10(np.where(range_m > 0, range_m, np.nan)), np.float64)
