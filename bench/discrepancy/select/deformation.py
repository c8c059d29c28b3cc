"""Whether an effect does no more than another form of a larger one beside it would.

Library forms are never exactly right. What a large effect leaves by its form, a second one always
fits: so a second name must move things by more than such a form may be wrong (a discrepancy
allowance: Kennedy and O'Hagan 2001).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.select.predictive_cells import (
    fresh_ensemble,
    kept,
    predictive_places,
    response_cells,
    typical_size,
)
from bench.discrepancy.settings import ADEQUACY_MOST, ADEQUACY_TOUCHED, FORM_SHARE
from bench.physics.effect import Effect

Floats = NDArray[np.float64]


def needless(
    comparison: Comparison, views: tuple[View, ...], added: Added, sure: tuple[str, ...] = ()
) -> Effect | None:
    """Return the smallest effect that is within another's allowance, None where none is.

    Those named in `sure` were weighed beside such allowances already.
    """
    if len(added) < 2:
        return None
    sizes = _responses(comparison, views, added)
    order = sorted(range(len(added)), key=lambda i: float((sizes[i] ** 2).sum()))
    order = [i for i in order if added[i].physics not in sure]
    return next((added[i] for i in order if within(sizes[i], np.delete(sizes, i, axis=0))), None)


def within(own: Floats, others: Floats, share: float = FORM_SHARE) -> bool:
    """Return whether most of a response [p, 2] is less than a share of others' [m, p, 2] there."""
    acts = own > ADEQUACY_TOUCHED * own.max(initial=0.0)
    small = acts & (own < share * others.max(axis=0))
    return bool((own[small] ** 2).sum() > ADEQUACY_MOST * (own[acts] ** 2).sum())


def _responses(comparison: Comparison, views: tuple[View, ...], added: Added) -> Floats:
    """Return the size of every effect's response, [effects, p, 2], beside all the others."""
    whole = fresh_ensemble(comparison, views, added)
    rests = [fresh_ensemble(comparison, views, without(added, effect)) for effect in added]
    names = tuple(n for n in whole.names if all(n in rest.names for rest in rests))
    weights = np.stack([weight for _, weight in predictive_places(views)], axis=1)
    parts = [(kept(whole, names), kept(rest, names)) for rest in rests]
    return np.stack([typical_size(response_cells(*both, weights)[0]) for both in parts])
