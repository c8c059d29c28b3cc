"""How often the same simulated links stand for several recorded ones.

Recorded links that crowd where few simulated ones are share these, so their differences from them
go together: a mean over such links scatters more than permutations link by link say.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Changed, Comparison, View
from bench.physics.units import Floats


def reuse(comparison: Comparison, view: View) -> Floats | None:
    """Return the covariance [L, L] of what stands for recorded links, in variances of one link.

    Links in the order of their numbers; its diagonal is 1 / m with m simulated links for each.
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
    return np.asarray(shares @ shares.T)


def standing(comparison: Comparison, view: View) -> NDArray[np.intp]:
    """Return a code [n] of recorded rows, the same where one simulated link stands for them first.

    What was learnt from it for one recorded link is known of the others.
    """
    while isinstance(comparison, Changed):
        comparison = comparison.comparison
    if not isinstance(comparison, TableComparison) or comparison.paired(view):
        return view.links
    return np.asarray(comparison.links[comparison.versions(view)[0]], np.intp)


def widening(weight: Floats, reused: Floats) -> float:
    """Return how much wider a sum over links scatters than permutations say, at least 1.

    `weight` [L] is what every link has in the sum, `reused` as `reuse` gives: permutations take
    its diagonal alone.
    """
    alone = float((weight**2 * (1 + np.diag(reused))).sum())
    if alone <= 0:
        return 1.0
    whole = float((weight**2).sum() + weight @ reused @ weight)
    return float(np.sqrt(max(whole / alone, 1.0)))
