"""What a search finds: a place where recorded and simulated differ, and by how much."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.locate.row_scatter import about_links, of_links
from bench.discrepancy.settings import LARGER_HERE

Floats = NDArray[np.float64]
_MOMENT_WORDS = {
    "mean": "",
    "spread": " (spread)",
    "link": " (offsets that links keep)",
    "rows": " (scatter of rows within links)",
    "slope": "",
}


@dataclass(frozen=True)
class Finding:
    """A cell in which recorded and simulated differ.

    `effect` is recorded minus simulated in the observable's unit: the mean over the cell; for a
    trend, per standard deviation of the covariate; for a spread or link offsets, of the mean
    |deviation from the ensemble mean|; for rows within links, of that from their
    own link's mean. `z` is the search statistic, `p` its family-wise p value.
    `whole` is the same over all rows, where it is found there too: what is far off everywhere has
    its largest `z` where it is most even, which says nothing of where it is.
    """

    cell: Cell
    effect: Estimate
    z: float
    p: float
    rows: int
    links: int
    whole: Finding | None = None

    @property
    def told(self) -> Finding:
        """The finding as it is told: over all rows, unless it is clearly larger in its place."""
        large = self.whole and abs(self.effect.value) > LARGER_HERE * abs(self.whole.effect.value)
        return self if self.whole is None or large else self.whole

    @property
    def what(self) -> str:
        """What differs, in words."""
        return self.cell.observable + _MOMENT_WORDS[self.cell.moment]

    def __str__(self) -> str:
        where = f"{self.what} {self.cell.place.where()}"
        return f"{where}: recorded - simulated = {self.effect}, p = {self.p:.3g}"


@dataclass(frozen=True)
class Located:
    """The outcome of one search: significant findings, most telling first.

    `p` is the smallest family-wise p value, `threshold` the family-wise limit of |z|;
    `detectable` gives per observable, in its unit, the smallest shift of all rows that would have
    been seen with probability about one half. `tail_p` is `p` as the tail of the permuted maxima
    goes on beyond the farthest of them.
    """

    findings: tuple[Finding, ...]
    p: float
    z: float
    threshold: float
    cells: int
    detectable: dict[str, float]
    tail_p: float = 1.0

    @property
    def significant(self) -> bool:
        """True where the search found anything at its family-wise level."""
        return bool(self.findings)


def finding_of(
    ensemble: Ensemble, covariates: Covariates, cell: Cell, z: float, p: float, seed: int
) -> Finding:
    """Return a finding with its effect in physical units."""
    which = ensemble.names.index(cell.observable)
    weight = row_weights(cell.place, ensemble, covariates)
    value = _effect_rows(ensemble, which, cell, weight)
    inside = (weight != 0) & np.isfinite(value)
    effect = cluster_bootstrap(value[inside], ensemble.links[inside], seed, ensemble.units[which])
    links = len(np.unique(ensemble.links[inside]))
    return Finding(cell, effect, z, p, int(inside.sum()), links)


def _effect_rows(ensemble: Ensemble, which: int, cell: Cell, weight: Floats) -> Floats:
    """Return per-row values [n] whose mean over the cell is the effect."""
    residual = ensemble.residual[:, which]
    if cell.moment == "slope":
        return np.asarray((residual - np.nanmean(residual)) * weight)
    if cell.moment == "mean":
        return residual
    members = ensemble.simulated[..., which]
    if cell.moment == "rows":
        recorded, *others = about_links(ensemble.versions[..., which], ensemble.links)
        return np.asarray(recorded - np.mean(others, axis=0))
    if cell.moment == "link":  # what rows of a link have in common
        residual, members = (of_links(one, ensemble.links) for one in (residual, members))
    typical = np.abs(members - members.mean(axis=0)).mean(axis=0)
    return np.asarray(np.abs(residual) - typical)


def row_weights(place: Place, ensemble: Ensemble, covariates: Covariates) -> Floats:
    """Return the weight of each recorded row [n] in a place: 0/1, or the standardised trend."""
    name = place.covariate
    if name is None:
        return np.ones(len(ensemble.links))
    if name in covariates.groups:
        return place.weight(covariates.groups[name])
    if name in covariates.numbers:
        return place.weight(covariates.numbers[name])
    return place.weight(ensemble.recorded_of(name))
