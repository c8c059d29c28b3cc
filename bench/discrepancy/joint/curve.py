"""What a member of a set brings beside an effect whose curve is every receiver's own.

How a level control attenuates and when it ends accumulation was measured of one chip. Above the
level where it starts any curve is another form of it, so what is named beside it must do something
that none of these does: where signals are weaker than that, or to what no level moves.
"""

from __future__ import annotations

from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.likelihood import columns_of, paid, whitened
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import ACTS, CURVE_PARTS, FORMS
from bench.discrepancy.joint.statistics import Moments, Statistics

Floats = NDArray[np.float64]


def beside_own_curve(given: Statistics, fit: Fit, rest: Fit, name: str) -> float:
    """Return the evidence of a member over the `rest` where curves of others are free, in nats.

    Infinite where no other has a curve of its own.
    """
    curved = [one.name for one in fit.effects if type(one).own_curve and one.name != name]
    if not curved or not set(curved) <= set(rest.names):
        return float("inf")
    return _evidence(given, fit, curved) - _evidence(given, rest, curved)


def with_own_curve(fit: Fit) -> Moments:
    """Return the statistics of a set, where an effect with a curve of its own may have any.

    As what devices have of their own: what is left beside it is then none of its forms.
    """
    curves = [
        response
        for one, response in zip(fit.effects, fit.responses, strict=True)
        if type(one).own_curve
    ]
    own = [] if fit.moments.own is None else [fit.moments.own]
    whole = [*own, *(_parts_of(one) for one in curves)]
    return replace(fit.moments, own=np.concatenate(whole, axis=2)) if curves else fit.moments


def _parts_of(response: Floats) -> Floats:
    """Return what any curve may do [L, p, k], to one statistic in one part of the links each."""
    far, parts = any_curve(response)
    acts = np.flatnonzero(far.any(axis=0))
    out = np.zeros((*response.shape, len(acts) * parts.shape[1]))
    for column, (place, part) in enumerate(product(acts, parts.T)):
        out[:, place, column] = far[:, place] * part
    return out


def _evidence(given: Statistics, fit: Fit, curved: list[str]) -> float:
    """Return the evidence of a set where what some of its members do may have any curve."""
    seen = whitened(given, fit.moments, fit.responses)
    columns = [columns_of(seen.matrices, FORMS[1] * one, given.ways) for one in fit.responses]
    for name in curved:
        response = fit.responses[fit.names.index(name)]
        columns.append(columns_of(seen.matrices, *any_curve(response)))
    return paid(given, seen.nats(columns) + fit.moments.within, fit.parameters)


def any_curve(response: Floats) -> tuple[Floats, Floats]:
    """Return how far a curve goes in every statistic [L, p], and the parts of it [L, k].

    As far as the response [L, p] does over all links, where it does something at all.
    """
    usual = np.sqrt((response**2).mean(axis=0))
    acts = usual > ACTS
    if not acts.any():
        return np.zeros_like(response), np.ones((len(response), 1))
    shown = np.abs(response[:, acts]) / usual[acts]
    order = np.argsort(np.argsort(response[:, int(np.argmax(usual))]))
    part = order * CURVE_PARTS // len(order)
    far = np.minimum(shown.max(axis=1), 1)[:, None] * np.where(acts, usual, 0)
    return far, np.asarray(part[:, None] == np.arange(CURVE_PARTS), np.float64)
