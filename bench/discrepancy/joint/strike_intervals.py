"""How far values of a strike are known: as likely ones go, and as links differ from each other.

The likelihood of a link's statistics is a normal one of forms that are never right, so what it
calls likely is too narrow. How links pull at a value says more: the variance of the likelihood's
slope over links, beside its curvature (the sandwich of Huber 1967).
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from bench.discrepancy.fit.estimate import ParameterEstimate, profiled
from bench.discrepancy.fit.starts import between
from bench.discrepancy.joint.climb import shares_of
from bench.discrepancy.joint.mixture import SHARES, Found, Mixed, of_each
from bench.discrepancy.joint.settings import OTHERS_HELD, SANDWICH_STEP
from bench.discrepancy.settings import ONE_SIDED_95, PROFILE_90_NATS
from bench.physics.effect import Parameter


def sizes_of(found: Found) -> tuple[ParameterEstimate, ...]:
    """Return the parameters of a strike with their intervals, in the order of its kind."""
    near = found.mixture.near(found.best)
    made = (_share(found), *(_size(p, found, near) for p in found.mixture.free))
    order = {p.name: i for i, p in enumerate(found.mixture.kind.parameters())}
    return tuple(sorted(made, key=lambda one: order[one.name]))


def _share(found: Found) -> ParameterEstimate:
    assert found.mixture.kind.strikes is not None
    name = found.mixture.kind.strikes[0]
    item = next(p for p in found.mixture.kind.parameters() if p.name == name)
    near = SHARES[found.best.nats > found.best.best - PROFILE_90_NATS].tolist()
    return profiled(item, found.best.share, near, SHARES.tolist())


def _size(item: Parameter, found: Found, near: Sequence[Mixed]) -> ParameterEstimate:
    """Return a parameter with what was tried of it and is about as likely, or as links allow."""
    grid = {one.values[item.name] for one in found.mixture.tried}
    wide = _as_links_differ(item, found)
    some = [*(one.values[item.name] for one in near), *wide]
    return profiled(item, found.best.values[item.name], some, sorted({*grid, *wide}))


def _as_links_differ(item: Parameter, found: Found) -> tuple[float, ...]:
    """Return the ends of the interval that links, drawn again, would leave; () where none shows.

    Of one parameter beside the others, by three points about the best.
    """
    mixture, values = found.mixture, found.best.values
    middle = shares_of(mixture, found.best)[item.name]
    middle = float(np.clip(middle, SANDWICH_STEP, 1 - SANDWICH_STEP))
    places = middle - SANDWICH_STEP, middle, middle + SANDWICH_STEP
    points = [{**values, item.name: between(item, item.low, item.high, one)} for one in places]
    made = [mixture.at(point) for point in points]
    if any(one is None for one in made):
        return ()
    low, mid, high = (of_each(one) for one in made if one)
    slope = (high - low) / (2 * SANDWICH_STEP)
    curve = -float((high - 2 * mid + low).sum()) / SANDWICH_STEP**2
    if curve <= 0:
        return ()
    half = OTHERS_HELD * ONE_SIDED_95 * float(np.sqrt(len(slope) * np.var(slope))) / curve
    ends = np.clip([middle - half, middle + half], 0, 1)
    return tuple(between(item, item.low, item.high, float(one)) for one in ends)
