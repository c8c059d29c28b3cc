"""What every link has of its own by chance, where a table simulates it several times alike.

Permutations swap the recorded version of a link with a simulated one, as if every version had
drawn anew what a link has by chance: its shadowing, its tail. A table that repeats a link in one
and the same environment draws it once. Every recorded link is then off by its own draw though
nothing is left out, and farther off than its simulated versions are from each other. So what is
found must stand where the simulated versions of a link count as one - in means, which by chance
are off to either side - or among rows of one link, or beside what simulated links differ by.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.grouped import group_sums
from bench.discrepancy.locate.permutation_test import Located, locate
from bench.discrepancy.settings import FAMILY_WISE
from bench.physics.units import Floats


def beyond_own_draws(
    located: Located, ensemble: Ensemble, own: int, view: View, seed: int, crowding: float
) -> Located:
    """Return a significant search, without findings where draws of links may be all there is.

    `ensemble` has `own` simulated versions of each row, then those of similar links.
    """
    tried = []
    for search in _searches(ensemble, own, view, seed, crowding):
        if search.significant:
            return located
        tried.append(search.p)
    return replace(located, findings=(), p=min(1.0, len(tried) * min(tried)))


def _searches(
    ensemble: Ensemble, own: int, view: View, seed: int, crowding: float
) -> Iterator[Located]:
    """Yield searches that draws of links cannot make significant; they share the error of one."""
    covariates, versions, level = view.covariates, ensemble.first(own), FAMILY_WISE / 3
    yield locate(_as_one(versions), covariates, seed, level)
    yield locate(levelled(versions), covariates, seed, level)
    beside = ensemble.beside(own)
    yield locate(beside, covariates, seed, level, wider_only=True, crowding=crowding)


def _as_one(ensemble: Ensemble) -> Ensemble:
    """Return the recorded version and the mean of the simulated ones: only means can differ."""
    both = np.stack([ensemble.recorded, ensemble.simulated.mean(axis=0)])
    return replace(ensemble, versions=both)


def levelled(ensemble: Ensemble) -> Ensemble:
    """Return the ensemble in which rows of all versions of a link have one mean."""
    versions = np.stack([one - _of_links(one, ensemble) for one in ensemble.versions])
    return replace(ensemble, versions=versions)


def _of_links(values: Floats, ensemble: Ensemble) -> Floats:
    """Return the mean [n, p] over the rows of the link of each row, of values [n, p]."""
    code = np.unique(ensemble.links, return_inverse=True)[1]
    parts = np.nan_to_num(values), np.isfinite(values).astype(np.float64)
    sums, count = (group_sums(part, code, int(code.max()) + 1) for part in parts)
    return np.asarray((sums / np.maximum(count, 1))[code])
