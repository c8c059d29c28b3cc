"""Where recorded and simulated differ: a search with family-wise control over all of it.

Under the null hypothesis - the simulator is right - the recorded version of a link is exchangeable
with its simulated versions. So the reference distribution comes from drawing, for every link,
which of the 1 + m versions plays the recorded one. It is exact for any dependence inside a link.
The maximum over every cell (observable x moment x covariate interval or group) gives p values that
hold for the whole search (Westfall and Young 1993).
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.reuse import Reused, simulated_share
from bench.discrepancy.compare.settings import LEAST_SUM
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.data.observables import RANGE, SCALARS
from bench.discrepancy.locate.chance import chance_beyond, told_apart
from bench.discrepancy.locate.detectable import in_part, of_all_rows
from bench.discrepancy.locate.finding import Finding, Located, finding_of, row_weights
from bench.discrepancy.locate.hypotheses import Cell, Links, Place, link_sums
from bench.discrepancy.locate.rare import struck_links, struck_rows
from bench.discrepancy.locate.readable import as_read, unreadable
from bench.discrepancy.settings import (
    FAMILY_WISE,
    MOST_CLUSTERS,
    MOST_FINDINGS,
    PERMUTATIONS,
    PERMUTED_AT_ONCE,
    RARE_P,
    ROWS_P,
    SPREAD_TOLD,
)

Floats = NDArray[np.float64]


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
    scores = _Scores(tuple(cells), _counted(ensemble, cells, z, copied), null, wider)
    best = _best(scores, alpha, wider_only)[:top]
    found = _findings(ensemble, covariates, scores, best, alpha, seed)
    rare = _rare_beside(found, ensemble, crowding, seed)
    threshold = scores.threshold(alpha)
    return Located(
        tuple([*found[: top - 1], rare] if rare else found),
        min(float(scores.p.min()), rare.p if rare else 1.0),
        scores.most,
        threshold,
        len(cells),
        _detectable(ensemble, covariates, scores, threshold * crowding),
        chance_beyond(null, scores.most),
    )


@dataclass(frozen=True)
class _Scores:
    """The statistic of every cell [K], the permuted maxima, and how much wider cells scatter [K].

    `wider` is beside the crowding, which `z` is divided by.
    """

    cells: tuple[Cell, ...]
    z: Floats
    null: Floats
    wider: Floats

    @cached_property
    def p(self) -> Floats:
        """The family-wise p value of every cell [K], as permutations count."""
        beyond = (self.null[:, None] >= np.abs(self.z)[None, :]).sum(axis=0)
        return np.asarray((1 + beyond) / (len(self.null) + 1))

    @property
    def most(self) -> float:
        """The largest statistic."""
        return float(np.abs(self.z).max())

    def threshold(self, alpha: float) -> float:
        """Return the family-wise limit of the statistic at a level."""
        return float(np.quantile(self.null, 1 - alpha))

    @cached_property
    def chance(self) -> Floats:
        """The p value of every cell [K], beyond what permutations count, too."""
        return told_apart(self.p, self.null, self.z)


def _counted(ensemble: Ensemble, cells: list[Cell], z: Floats, copied: bool) -> Floats:
    """Return statistics [K] without those that say nothing: of what no reading tells, of copies."""
    z = np.where([copied and cell.moment == "link" for cell in cells], np.maximum(z, 0.0), z)
    return np.where(unreadable(ensemble, cells), 0.0, z)


def _best(scores: _Scores, alpha: float, wider_only: bool) -> list[int]:
    """Return the places of the cells that are found, most telling first.

    A mean says more than a spread: where both are found, the mean is told first.
    """
    moments = [cell.moment for cell in scores.cells]
    weight = [1.0 if one in ("mean", "slope") else SPREAD_TOLD for one in moments]
    spreads = np.array([wider_only and one in ("spread", "link", "rows") for one in moments])
    counts = (scores.chance <= alpha) & ~(spreads & (scores.z < 0))
    return [int(i) for i in np.argsort(-np.abs(scores.z) * weight) if counts[i]]


def _findings(
    ensemble: Ensemble,
    covariates: Covariates,
    scores: _Scores,
    best: list[int],
    alpha: float,
    seed: int,
) -> list[Finding]:
    """Return the findings in some cells, each with the same over all rows where that is one."""
    cells, z, p = scores.cells, scores.z, scores.p
    wholes = _found_everywhere(cells, scores.chance, alpha)
    at = {
        i: finding_of(ensemble, covariates, cells[i], float(z[i]), float(p[i]), seed)
        for i in {*best, *(wholes[i] for i in best if i in wholes)}
    }
    return [replace(at[i], whole=at.get(wholes.get(i, -1))) for i in best]


def _detectable(
    ensemble: Ensemble, covariates: Covariates, scores: _Scores, least: float
) -> dict[str, float]:
    """Return the smallest shift of all rows that reaches a statistic, per observable."""
    small = of_all_rows(ensemble, least) | in_part(ensemble, covariates, scores.cells, least)
    return as_read({n: one * float(scores.wider[ensemble.place(n)]) for n, one in small.items()})


def _rare_beside(
    found: list[Finding], ensemble: Ensemble, crowding: float, seed: int
) -> Finding | None:
    """Return what few links or rows show, where nothing is found or levels alone are."""
    if found and not _levels_alone(ensemble, found):
        return None
    return rare_links(ensemble, seed, crowding) or rare_rows(ensemble, crowding, seed)


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
        place: reused.widening(_of_links(code, row_weights(place, ensemble, covariates)))
        for place in dict.fromkeys(cell.place for cell in cells)
    }
    return np.array([found[cell.place].get(cell.observable, 1.0) for cell in cells])


def _of_links(code: Links, weight: Floats) -> Floats:
    return np.asarray(np.bincount(code, weight), np.float64)


def _found_everywhere(cells: Sequence[Cell], p: Floats, alpha: float) -> dict[int, int]:
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
