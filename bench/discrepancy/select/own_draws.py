"""What every link has of its own by chance, where a table simulates it several times alike.

Permutations swap the recorded version of a link with a simulated one, as if every version had
drawn anew what a link has by chance: its shadowing, its tail. A table that repeats a link in one
and the same environment draws it once. Every recorded link is then off by its own draw though
nothing is left out, and farther off than its simulated versions are from each other. So what is
found must stand where the simulated versions of a link count as one - in means, which by chance
are off to either side - or in how rows of one link differ, or beside what simulated links differ
by.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Comparison, View
from bench.discrepancy.data.covariates import Covariates
from bench.discrepancy.data.grouped import group_means
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.locate.hypotheses import OWN
from bench.discrepancy.locate.permutation_test import locate
from bench.discrepancy.locate.row_scatter import row_scatter
from bench.discrepancy.select.settings import EVERYWHERE_SHARE, IN_PLACES_SHARE
from bench.discrepancy.settings import FAMILY_WISE
from bench.physics.units import Floats


def within_links(comparison: Comparison, view: View, ensemble: Ensemble) -> Floats | None:
    """Return how rows scatter within links (see `row_scatter`), None where that is not comparable.

    Of the versions that are the rows' own.
    """
    own = comparison.distinct(view)
    return row_scatter(ensemble.first(own)) if rows_of_their_own(comparison, view) else None


def rows_of_their_own(comparison: Comparison, view: View) -> bool:
    """Return whether every recorded row has simulated rows that are of its link, and its alone.

    Simulated rows that stand for several of a link scatter less within it.
    """
    if not isinstance(comparison, TableComparison):
        return True
    picks = comparison.versions(view)[: comparison.distinct(view)]
    return comparison.paired(view) and all(len(np.unique(p)) == len(p) for p in picks)


def copied(comparison: Comparison, view: View) -> bool:
    """Return whether simulated rows stand for several rows of a link, as where these are fewer."""
    first = once(comparison, view, 1)
    return first is not None and not bool(first.all())


def once(comparison: Comparison, view: View, members: int) -> NDArray[np.bool_] | None:
    """Return which simulated rows [members, n] are the first to stand for any row of their link.

    A simulated link of few rows stands for a recorded one of more by some of them twice, and what
    is there twice scatters less. None where every row has its own. The members are the first
    versions, or, where these are few, those that come after the rows' own.
    """
    if not isinstance(comparison, TableComparison) or rows_of_their_own(comparison, view):
        return None
    picks, own = comparison.versions(view), comparison.distinct(view)
    start = own if members > own else 0
    out = np.zeros((members, len(view.rows)), bool)
    for number in range(members):
        pair = np.stack([view.links, picks[(start + number) % len(picks)]])
        out[number, np.unique(pair, axis=1, return_index=True)[1]] = True
    return out


def free_share(links: NDArray[np.intp], known: NDArray[np.bool_]) -> Floats:
    """Return as how many independent deviations from their link known rows [n] count, each.

    k rows of a link have k - 1 beside its mean.
    """
    code = np.unique(links, return_inverse=True)[1]
    count = np.maximum(np.bincount(code, known)[code], 1)
    return np.asarray(known * (1 - 1 / count))


def free_of(comparison: Comparison, view: View, simulated: Floats) -> float:
    """Return how many independent deviations from their link known simulated rows [m, n] have.

    A row of a table that stands for several recorded ones is one. At least 1.
    """
    known = np.isfinite(simulated)
    if not isinstance(comparison, TableComparison):
        return max(float(sum(free_share(view.links, one).sum() for one in known)), 1.0)
    picks, own = comparison.versions(view), comparison.distinct(view)
    start = own if len(simulated) > own else 0
    stood = [picks[(start + number) % len(picks)][one] for number, one in enumerate(known)]
    rows = np.unique(np.concatenate(stood))
    return max(float(len(rows) - len(np.unique(comparison.links[rows]))), 1.0)


def beyond_own_draws(
    located: Located,
    ensemble: Ensemble,
    comparison: Comparison,
    view: View,
    seed: int,
    scatter: Floats | None,
    family_wise: float = FAMILY_WISE,
) -> Located:
    """Return a significant search, without findings where draws of links may be all there is.

    `ensemble` has the rows' own simulated versions, then those of similar links; `scatter`: see
    `within_links`; `family_wise`: the error of all that is asked here. What is found of an
    observable must stand, too: a jitter of ranges says nothing of levels that links have drawn.
    """
    tried = list(_searches(ensemble, comparison, view, seed, scatter, family_wise))
    beyond = [found for search in tried for found in search.findings]
    shares = (EVERYWHERE_SHARE, *[IN_PLACES_SHARE] * (len(tried) - 1))
    if beyond:
        sure = {found.cell.observable for found in beyond}
        kept = tuple(one for one in located.findings if one.cell.observable in sure)
        least = min(s.tail_p / share for s, share in zip(tried, shares, strict=True))
        found, p = kept or tuple(beyond), min(located.p, least)  # both searches are sure of it
        return replace(located, findings=found, p=p, detectable=tried[0].detectable)
    p = min(1.0, *(search.p / share for search, share in zip(tried, shares, strict=True)))
    return replace(located, findings=(), p=p, detectable=tried[0].detectable)


def _searches(
    ensemble: Ensemble,
    comparison: Comparison,
    view: View,
    seed: int,
    scatter: Floats | None,
    family_wise: float,
) -> Iterator[Located]:
    """Yield searches that draws of links cannot make significant; they share the error of one.

    How rows scatter within links, and when, a link may have drawn, too: so all simulated versions
    count as one there, as in means.
    """
    level, own = IN_PLACES_SHARE * family_wise, comparison.distinct(view)
    one = _as_one(ensemble.first(own))
    covariates = _with_shared(view.covariates, one)
    both = None if scatter is None else np.stack([scatter[0], scatter[1:].mean(axis=0)])
    yield locate(one, _nowhere(one), seed, EVERYWHERE_SHARE * family_wise, scatter=both)
    yield locate(one, covariates, seed, level)
    yield locate(levelled(one), covariates, seed, level)
    yield beside_similar(ensemble, comparison, view, seed, level)


def beside_similar(
    ensemble: Ensemble, comparison: Comparison, view: View, seed: int, level: float
) -> Located:
    """Return what is found beside what simulated links differ by (see `Ensemble.beside`).

    Places over levels are of the rows' own simulated levels. What versions differ from these by is
    no level: where it is next to nothing stand most recorded rows and few of similar links.
    """
    own, crowding = comparison.distinct(view), comparison.crowding(view)
    means = {
        n: ensemble.first(own).simulated_of(n).mean(axis=0) for n in OWN if n in ensemble.names
    }
    known = replace(view.covariates, numbers={**view.covariates.numbers, **means})
    beside = ensemble.beside(own)
    return locate(beside, known, seed, level, wider_only=True, crowding=crowding)


def _as_one(ensemble: Ensemble) -> Ensemble:
    """Return the recorded version and the mean of the simulated ones: only means can differ."""
    both = np.stack([ensemble.recorded, ensemble.simulated.mean(axis=0)])
    return replace(ensemble, versions=both)


def _with_shared(covariates: Covariates, one: Ensemble) -> Covariates:
    """Return the covariates with the levels that both versions have in common (see `common`).

    A mean of several versions scatters less than a recorded level does: where each version's own
    level is above some value, there are more recorded rows than simulated ones.
    """
    levels = {n: common(one.versions_of(n), one.links) for n in OWN if n in one.names}
    return replace(covariates, numbers={**covariates.numbers, **levels})


def common(both: Floats, links: NDArray[np.intp]) -> Floats:
    """Return what two versions [2, n] have in common [n], in their unit.

    Of links their mean; within links the mix that tells nothing of their difference. The mean leans
    to the version that scatters more there: where it is high, that version is the higher by chance.
    """
    code = np.unique(links, return_inverse=True)[1]
    mean, apart = both.mean(axis=0), both[0] - both[1]
    inside, differs = (one - group_means(one[:, None], code)[:, 0] for one in (mean, apart))
    square = float(np.nansum(differs**2))
    leads = float(np.nansum(inside * differs)) / square if square > 0 else 0.0
    return np.asarray(mean - leads * differs)


def _nowhere(one: Ensemble) -> Covariates:
    """Return covariates without a place: levels that are all one.

    What is off everywhere need not stand out of what chance does in a thousand places.
    """
    return Covariates({n: np.zeros(len(one.links)) for n in OWN if n in one.names}, {})


def levelled(ensemble: Ensemble) -> Ensemble:
    """Return the ensemble in which rows of all versions of a link have one mean."""
    code = np.unique(ensemble.links, return_inverse=True)[1]
    versions = np.stack([one - group_means(one, code) for one in ensemble.versions])
    return replace(ensemble, versions=versions)
