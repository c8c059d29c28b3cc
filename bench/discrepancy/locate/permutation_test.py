"""Where recorded and simulated differ: a search with family-wise control over all of it.

Under the null hypothesis - the simulator is right - the recorded version of a link is exchangeable
with its simulated versions. So the reference distribution comes from drawing, for every link,
which of the 1 + m versions plays the recorded one. It is exact for any dependence inside a link.
The maximum over every cell (observable x moment x covariate interval or group) gives p values that
hold for the whole search (Westfall and Young 1993).
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.reuse import Reused, simulated_share
from bench.discrepancy.compare.settings import LEAST_SUM
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.data.observables import RANGE, SCALARS
from bench.discrepancy.locate.chance import chance_beyond, told_apart
from bench.discrepancy.locate.hypotheses import Cell, Links, Place, link_sums
from bench.discrepancy.locate.rare import struck_links, struck_rows
from bench.discrepancy.locate.readable import as_read, unreadable
from bench.discrepancy.locate.row_scatter import about_links, of_links
from bench.discrepancy.settings import (
    FAMILY_WISE,
    LARGER_HERE,
    MOST_CLUSTERS,
    MOST_FINDINGS,
    PART_SHARE,
    PERMUTATIONS,
    PERMUTED_AT_ONCE,
    RARE_P,
    ROWS_P,
    SPREAD_TOLD,
)

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


def locate(
    ensemble: Ensemble,
    covariates: Covariates,
    seed: int,
    alpha: float = FAMILY_WISE,
    permutations: int = PERMUTATIONS,
    top: int = MOST_FINDINGS,
    wider_only: bool = False,
    crowding: float = 1.0,
    reused: Reused | None = None,
    scatter: Floats | None = None,
    copied: bool = False,
) -> Located:
    """Search every cell. `covariates` describe the ensemble's rows.

    Deterministic from `seed`. `wider_only`: a spread counts only where the recorded is wider (see
    `Ensemble.beside`). `crowding`: how much wider than permutations the null is (see
    `TableComparison.crowding`), or cell by cell from what links share, `reused` (see `reuse`),
    where that is more. `scatter`: see `link_sums`. `copied`: simulated rows stand for several of a
    link, which have more in common by that: then offsets count where recorded links keep more. At
    most `top` findings of p <= `alpha`.
    """
    rng = np.random.default_rng(seed)
    clusters = _clusters(len(np.unique(ensemble.links)), rng)
    cells, sums = link_sums(ensemble, covariates, clusters, scatter)
    z, null = _permuted(sums, rng, permutations)
    wider = np.maximum(_wider(cells, ensemble, covariates, reused) / crowding, 1.0)
    z = z / (crowding * np.sqrt(1 + (wider**2 - 1) * simulated_share(sums)))
    z = np.where([copied and cell.moment == "link" for cell in cells], np.maximum(z, 0.0), z)
    z = np.where(unreadable(ensemble, cells), 0.0, z)
    p = (1 + (null[:, None] >= np.abs(z)[None, :]).sum(axis=0)) / (permutations + 1)
    # A mean says more than a spread: where both are found, the mean is told first.
    told = np.abs(z) * [1.0 if cell.moment in ("mean", "slope") else SPREAD_TOLD for cell in cells]
    narrow = [wider_only and c.moment in ("spread", "link", "rows") for c in cells] & (z < 0)
    chance = told_apart(p, null, z)
    best = [i for i in np.argsort(-told) if chance[i] <= alpha and not narrow[i]][:top]
    wholes = _found_everywhere(cells, chance, alpha)
    at = {
        i: finding_of(ensemble, covariates, cells[i], float(z[i]), float(p[i]), seed)
        for i in {*best, *(wholes[i] for i in best if i in wholes)}
    }
    found = [replace(at[i], whole=at.get(wholes.get(i, -1))) for i in best]
    rare = None
    if not found or _levels_alone(ensemble, found):
        rare = rare_links(ensemble, seed, crowding) or rare_rows(ensemble, crowding, seed)
    found = [*found[: top - 1], rare] if rare else found
    threshold = float(np.quantile(null, 1 - alpha))
    least = threshold * crowding
    small = _detectable(ensemble, least) | _in_part(ensemble, covariates, cells, least)
    small = {n: s * float(wider[ensemble.place(n)]) for n, s in small.items()}  # of all rows
    return Located(
        tuple(found),
        min(float(p.min()), rare.p if rare else 1.0),
        float(np.abs(z).max()),
        threshold,
        len(cells),
        as_read(small),
        chance_beyond(null, float(np.abs(z).max())),
    )


def _levels_alone(ensemble: Ensemble, found: list[Finding]) -> bool:
    """Return whether levels differ, without waveforms, which would hide a few far ranges."""
    ours = all(name in SCALARS for name in ensemble.names)
    return ours and RANGE not in {one.cell.observable for one in found}


def _wider(
    cells: list[Cell], ensemble: Ensemble, covariates: Covariates, reused: Reused | None
) -> Floats:
    """Return how much wider than permutations every cell scatters [K]."""
    if reused is None:
        return np.ones(len(cells))
    code = np.unique(ensemble.links, return_inverse=True)[1]
    found = {
        place: reused.widening(_of_links(code, _weight(place, ensemble, covariates)))
        for place in dict.fromkeys(cell.place for cell in cells)
    }
    return np.array([found[cell.place].get(cell.observable, 1.0) for cell in cells])


def _of_links(code: Links, weight: Floats) -> Floats:
    return np.asarray(np.bincount(code, weight), np.float64)


def _found_everywhere(cells: list[Cell], p: Floats, alpha: float) -> dict[int, int]:
    """Return the place of the cell of all rows by that of one of some rows, where it is found too.

    Not for trends, which are of all rows.
    """
    every = {(c.observable, c.moment): i for i, c in enumerate(cells) if c.place == Place()}
    found = {what: i for what, i in every.items() if p[i] <= alpha}
    what = ((i, (cell.observable, cell.moment)) for i, cell in enumerate(cells))
    return {i: found[one] for i, one in what if one in found and found[one] != i}


def _clusters(links: int, rng: np.random.Generator) -> list[Links] | None:
    """Return random groups of links where there are many, else None."""
    if links <= MOST_CLUSTERS:
        return None
    order = np.asarray(rng.permutation(links), np.intp)
    starts = np.linspace(0, links, MOST_CLUSTERS, endpoint=False).astype(np.int64)
    return np.split(order, starts[1:])


def _permuted(
    sums: NDArray[np.float32], rng: np.random.Generator, permutations: int
) -> tuple[Floats, Floats]:
    """Return z [K] of the recorded version and the permuted maxima of |z| [permutations].

    z = sum over links / its standard deviation under the permutation, so cells compare. Where that
    is rounding, as of a constant, 0.
    """
    versions, clusters, count = sums.shape
    scale = np.sqrt((sums**2).mean(axis=0).sum(axis=0))
    normal = (sums / np.where(scale > LEAST_SUM, scale, np.inf)).reshape(versions * clusters, count)
    null = np.empty(permutations)
    for start in range(0, permutations, PERMUTED_AT_ONCE):
        size = min(PERMUTED_AT_ONCE, permutations - start)
        pick = rng.integers(versions, size=(size, clusters)) * clusters + np.arange(clusters)
        chosen = np.zeros((size, versions * clusters), np.float32)
        np.put_along_axis(chosen, pick, 1.0, axis=1)
        null[start : start + size] = np.abs(chosen @ normal).max(axis=1)
    return normal[:clusters].sum(axis=0, dtype=np.float64), null


def cell_weight(cell: Cell, ensemble: Ensemble, covariates: Covariates) -> Floats:
    """Return the weight of each recorded row [n] in a cell: 0/1, or the standardised trend."""
    return _weight(cell.place, ensemble, covariates)


def _weight(place: Place, ensemble: Ensemble, covariates: Covariates) -> Floats:
    name = place.covariate
    if name is None:
        return np.ones(len(ensemble.links))
    if name in covariates.groups:
        return place.weight(covariates.groups[name])
    if name in covariates.numbers:
        return place.weight(covariates.numbers[name])
    return place.weight(ensemble.recorded_of(name))


def finding_of(
    ensemble: Ensemble, covariates: Covariates, cell: Cell, z: float, p: float, seed: int
) -> Finding:
    """Return a finding with its effect in physical units."""
    which = ensemble.names.index(cell.observable)
    weight = cell_weight(cell, ensemble, covariates)
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


def _detectable(ensemble: Ensemble, threshold: float) -> dict[str, float]:
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
            out[name] = _smallest_shift(versions[:, known], ensemble.links[known], threshold)
    return out


def _in_part(
    ensemble: Ensemble, covariates: Covariates, cells: list[Cell], threshold: float
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
    parts = [
        inside & (cell_weight(Cell(RANGE, "mean", p), ensemble, covariates) > 0) for p in places
    ]
    large = [part for part in (inside, *parts) if part.sum() >= PART_SHARE * inside.sum() > 0]
    shifts = [_smallest_shift(versions[:, p], ensemble.links[p], threshold) for p in large]
    return {RANGE: min(shifts)} if shifts else {}


def _smallest_shift(versions: Floats, links: Links, threshold: float) -> float:
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


def rare_links(ensemble: Ensemble, seed: int, crowding: float = 1.0) -> Finding | None:
    """Return a finding where single links are off by more than any scatter of links explains."""
    beyond, struck = struck_links(ensemble, crowding)
    if not struck:
        return None
    cell = Cell(RANGE, "link", Place())
    return finding_of(ensemble, Covariates({}, {}), cell, beyond, RARE_P, seed)


def rare_rows(ensemble: Ensemble, crowding: float, seed: int) -> Finding | None:
    """Return a finding where rows of some links are beyond all simulated rows."""
    p, times = struck_rows(ensemble, crowding)
    if p > ROWS_P:
        return None
    cell = Cell(RANGE, "spread", Place())
    return finding_of(ensemble, Covariates({}, {}), cell, times, p, seed)
