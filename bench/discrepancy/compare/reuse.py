"""How often the same simulated links stand for several recorded ones, and what corrects them.

Recorded links that crowd where few simulated ones are share these, so their differences from them
go together: a mean over such links scatters more than permutations link by link say. So do those
of links that what a few simulated ones tell is taken off: how levels walk over the distance, and
what stands behind metal.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.corrected import moved, places, told_by
from bench.discrepancy.compare.settings import LEAST_SUM
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Changed, Comparison, View
from bench.physics.units import Floats


@dataclass(frozen=True)
class Reused:
    """What stands for recorded links, of simulated ones that scatter by one.

    `shares` [L, K], links in the order of their numbers; `moved` [L, q] by what, by observable,
    simulated links tell with the weights `told_by` [q, K] (see `corrected`).
    """

    shares: Floats
    moved: Floats
    told_by: Mapping[str, Floats]

    def widening(self, weight: Floats) -> dict[str, float]:
        """Return by observable how much wider a sum over links scatters than permutations say.

        `weight` [L] is what every link has in the sum. Permutations take 1 / m for every link of
        which m simulated ones stand for it, as if these were its own.
        """
        alone = float((weight**2 * (1 + (self.shares**2).sum(axis=1))).sum())
        stands, moved = weight @ self.shares, weight @ self.moved
        own = float((weight**2).sum())
        every = {name: stands + moved @ by for name, by in self.told_by.items()}
        return {name: widened(own + float(one @ one), alone) for name, one in every.items()}


def widened(whole: float, alone: float) -> float:
    """Return by how much a standard deviation grows from one variance to another, at least 1."""
    return float(np.sqrt(max(whole / alone, 1.0))) if alone > 0 else 1.0


def reuse(comparison: Comparison, view: View) -> Reused | None:
    """Return what simulated links share that stand for recorded ones.

    None where every recorded link has simulated rows of its own.
    """
    if not isinstance(comparison, TableComparison) or comparison.paired(view):
        return None
    code = np.unique(view.links, return_inverse=True)[1]
    versions = comparison.versions(view)
    uses = np.zeros((int(code.max()) + 1, int(comparison.links.max()) + 1))
    for pick in versions:
        np.add.at(uses, (code, comparison.links[pick]), 1.0)
    shares = uses / (np.bincount(code)[:, None] * len(versions))
    over = comparison.over(view)
    layers, taken = over.kinds.layers, over.known.taken
    ours = [(one.ours, len(one.kinds[0].step)) for one in layers]
    theirs = [(one.theirs, len(one.kinds[0].step)) for one in layers]
    known = [[one.block.ours for one in taken], [one.block.theirs for one in taken]]
    here = places(np.asarray(view.scene.true_range_m, np.float64), view.links, ours, known[0])
    there = places(comparison.true_range_m, comparison.links, theirs, known[1])
    kinds = zip(*(one.kinds for one in layers), strict=True)
    by = {
        name: told_by(there, over.walks[name], of, [float(t.told[at]) for t in taken])
        for at, (name, of) in enumerate(zip(over.kinds.names, kinds, strict=True))
    }
    return Reused(shares, moved(shares, here, there), by)


def standing(comparison: Comparison, view: View) -> NDArray[np.intp]:
    """Return a code [n] of recorded rows, the same where one simulated link stands for them first.

    What was learnt from it for one recorded link is known of the others.
    """
    while isinstance(comparison, Changed):
        comparison = comparison.comparison
    if not isinstance(comparison, TableComparison) or comparison.paired(view):
        return view.links
    return np.asarray(comparison.links[comparison.versions(view)[0]], np.intp)


def simulated_share(sums: NDArray[np.float32]) -> Floats:
    """Return the share of the variance of `sums` [1 + m, L, K] that simulated versions have [K].

    What these share widens that. The rest is how far the recorded version is off: no chance.
    """
    whole = np.square(sums).mean(axis=0).sum(axis=0)
    alone = sums[1:].var(axis=0).sum(axis=0) if len(sums) > 2 else whole
    return np.asarray(np.minimum(alone / np.maximum(whole, LEAST_SUM**2), 1), np.float64)
