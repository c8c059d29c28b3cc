"""Whether what is left scatters as independent scatter does: one hump, as wide on both sides."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.settings import LEAST_SCATTER_M, SCATTER_SHAPE_P, SCORE_FIRST, SCORE_MEMBERS
from bench.physics.effect import Effect
from bench.physics.units import Floats


def scatters_alike(comparison: Comparison, view: View, added: Added, effect: Effect) -> Adequacy:
    """Return whether ranges beside the simulator's mean are distributed as simulated ones are.

    Asked of independent scatter alone: it is named for a distribution, and a score hardly tells
    one wide hump from two narrow ones (two-sample test of Kolmogorov and Smirnov).
    """
    if not type(effect).independent or RANGE not in view.recorded.names:
        return Adequacy(True)
    return shape(comparison.ensemble(view, added, SCORE_MEMBERS, SCORE_FIRST))


def alike(recorded_m: Floats, simulated_m: Floats) -> bool:
    """Return whether two scatters are of one shape, whatever their widths."""
    from scipy.stats import ks_2samp

    own, other = (
        one / max(float(np.std(one)), LEAST_SCATTER_M) for one in (recorded_m, simulated_m)
    )
    return bool(ks_2samp(own, other).pvalue > SCATTER_SHAPE_P)


def shape(ensemble: Ensemble) -> Adequacy:
    """Return whether recorded and simulated ranges scatter alike around the ensemble's mean."""
    from scipy.stats import ks_2samp

    versions = ensemble.versions_of(RANGE)
    m = len(versions) - 1
    if m < 2:
        return Adequacy(True)
    middle = versions[1:].mean(axis=0)
    recorded = versions[0] - middle
    simulated = (versions[1:] - middle) * np.sqrt((m + 1) / (m - 1))  # as far as a new one is
    own = recorded[np.isfinite(recorded)]
    found = ks_2samp(own, simulated[np.isfinite(simulated)].ravel())
    apart, z = float(found.statistic), float(found.statistic * np.sqrt(max(len(own), 1)))
    return Adequacy(bool(found.pvalue > SCATTER_SHAPE_P), apart, z, "the distribution of error_m")
