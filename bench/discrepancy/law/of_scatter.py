"""Whether a law predicts what rows of a link scatter by: then that was not drawn at random.

A covariate that changes between two rows of a link - how far somebody has walked, how an arm
swings - moves ranges from row to row as jitter does. But jitter is what nobody can predict.
"""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.law.settings import LAW_OF_SCATTER
from bench.discrepancy.select.scatter_size import variances
from bench.discrepancy.select.stepwise import versions
from bench.discrepancy.select.within_links import within
from bench.physics.effects.ranging.law import Law


def independent(added: Added) -> Added:
    """Return the effects that scatter every row by itself, and leave no mark."""
    return tuple(e for e in added if type(e).independent and not type(e).marked)


def predicts(comparison: Comparison, rows: View, kept: Added, law: Law) -> bool:
    """Return whether a law predicts most of what rows scatter by beyond simulated ones.

    `kept` are the effects beside it. False where no link has several rows.
    """
    before, after = (_extra_m2(comparison, rows, one) for one in (kept, (*kept, law)))
    return before > 0 and after < LAW_OF_SCATTER * before


def _extra_m2(comparison: Comparison, rows: View, added: Added) -> float:
    """Return how much more ranges scatter within links than simulated ones, in square metres."""
    made = versions(comparison, rows, added)
    recorded, simulated = within(made) if RANGE in made.names else (np.empty(0), np.empty(0))
    if not (np.isfinite(recorded).any() and np.isfinite(simulated).any()):
        return 0.0
    return variances(recorded, simulated)[1]
