"""The smallest shift that a search would have seen, about every second time."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.finding import row_weights
from bench.discrepancy.locate.hypotheses import Cell, Links
from bench.discrepancy.settings import PART_SHARE

Floats = NDArray[np.float64]


def of_all_rows(ensemble: Ensemble, threshold: float) -> dict[str, float]:
    """Return the shift of all rows whose statistic is expected at the threshold, per observable.

    With s^2 the variance of a link's sum between versions, n its rows and m simulated versions,
    z = shift x sum(n) x sqrt(m / (m + 1)) / sqrt(sum(s^2) + shift^2 sum(n^2) / (m + 1)): the shift
    itself widens what permutations give. Infinite where no shift reaches the threshold.
    """
    out = {}
    for name, dust in zip(ensemble.names, ensemble.rounding, strict=True):
        versions = ensemble.versions_of(name)
        known = np.isfinite(versions).all(axis=0)
        if known.any() and np.ptp(versions[:, known]) > dust:
            out[name] = smallest_shift(versions[:, known], ensemble.links[known], threshold)
    return out


def in_part(
    ensemble: Ensemble, covariates: Covariates, cells: Sequence[Cell], threshold: float
) -> dict[str, float]:
    """Return the same for the range, where it is best seen in a part of the rows, not in all.

    Rows behind walls scatter most and hide what the others show. Of large parts alone: of many
    small ones some seem to scatter little.
    """
    if RANGE not in ensemble.names or not np.isfinite(ensemble.recorded_of(RANGE)).any():
        return {}
    versions = ensemble.versions_of(RANGE)
    inside = np.isfinite(versions).all(axis=0)
    places = dict.fromkeys(c.place for c in cells if (c.observable, c.moment) == (RANGE, "mean"))
    parts = [inside & (row_weights(place, ensemble, covariates) > 0) for place in places]
    large = [part for part in (inside, *parts) if part.sum() >= PART_SHARE * inside.sum() > 0]
    shifts = [smallest_shift(versions[:, p], ensemble.links[p], threshold) for p in large]
    return {RANGE: min(shifts)} if shifts else {}


def smallest_shift(versions: Floats, links: Links, threshold: float) -> float:
    """Return the smallest shift of values [1 + m, n] that is seen, about every second time."""
    code = np.unique(links, return_inverse=True)[1]
    rows = np.bincount(code).astype(np.float64)
    sums = np.stack([np.bincount(code, row) for row in versions])
    m = len(versions) - 1
    if m > 1:
        spread = sums[1:].var(axis=0, ddof=1).sum()
    else:  # one simulated version: what the two differ by, their mean difference taken out
        mean = (versions[0] - versions[1]).mean()
        spread = ((sums[0] - sums[1] - mean * rows) ** 2).sum() / 2
    room = rows.sum() ** 2 * m / (m + 1) - threshold**2 * (rows**2).sum() / (m + 1)
    return float(threshold * np.sqrt(spread / room)) if room > 0 else float("inf")
