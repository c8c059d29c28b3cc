"""The likeliest values of what strikes links, sought from many starts.

A struck link's samples say the same of a small loss that differs between links as of a larger one,
and of a late straight path as of a detour: the likelihood has several tops. A search along one
parameter after the other ends on the top it began below. So points all over the bounds are tried
(Sobol 1967: evenly), and from the best of these steps are taken along each parameter, halved where
none gains (compass search: Kolda, Lewis and Torczon 2003).
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import replace

import numpy as np
from scipy.stats import qmc

from bench.discrepancy.fit.starts import between, share_between
from bench.discrepancy.joint.mixture import Found, Mixed, Mixture, worth
from bench.discrepancy.joint.settings import (
    CLIMB_GAIN,
    CLIMB_LEAST,
    CLIMB_POINTS,
    CLIMB_STARTS,
    CLIMB_STEP,
    CLIMB_TRIES,
)

Shares = dict[str, float]  # by parameter, of the way from its lowest value to its highest


def climbed(found: Found) -> Found:
    """Return a mixture at its likeliest values, as it was where none are likelier."""
    mixture = found.mixture
    tried = [(one, made) for one in _spread(mixture) if (made := _at(mixture, one))]
    tried.sort(key=lambda pair: -pair[1].best)
    begun = [(shares_of(mixture, found.best), found.best), *tried[:CLIMB_STARTS]]
    ends = [_climb(mixture, *one) for one in begun]
    return _ending(found, max(ends, key=lambda one: one.whole))


def ascended(found: Found) -> Found:
    """Return a mixture at the likeliest values by steps from where it is."""
    mixture = found.mixture
    now = mixture.at(found.best.values)
    return _ending(found, _climb(mixture, shares_of(mixture, found.best), now or found.best))


def _ending(found: Found, best: Mixed) -> Found:
    """Return a mixture at values that a search ended on."""
    end = worth(found.mixture, best)
    return replace(end, begin=found.begin) if end else found


def _spread(mixture: Mixture) -> Iterator[Shares]:
    """Yield points all over the bounds; half of them nearer to where effects are small."""
    names = [p.name for p in mixture.free]
    points = qmc.Sobol(max(len(names), 1), scramble=True, seed=0).random(CLIMB_POINTS)
    toward = np.array([p.null == p.low or p.low == 0 for p in mixture.free])
    for number, point in enumerate(points):
        small = toward & (number % 2 == 1)
        yield dict(zip(names, np.where(small, point**2, point).tolist(), strict=True))


def _at(mixture: Mixture, shares: Shares) -> Mixed | None:
    values = {p.name: between(p, p.low, p.high, shares[p.name]) for p in mixture.free}
    return mixture.at(values)


def shares_of(mixture: Mixture, found: Mixed) -> Shares:
    """Return where values lie within their bounds."""
    return {p.name: share_between(p, p.low, p.high, found.values[p.name]) for p in mixture.free}


def _climb(mixture: Mixture, at: Shares, best: Mixed) -> Mixed:
    """Return the end of a compass search from a point."""
    steps = dict.fromkeys(at, CLIMB_STEP)
    for name in _rounds(steps):
        for way in (1, -1):
            other = {**at, name: float(np.clip(at[name] + way * steps[name], 0, 1))}
            made = _at(mixture, other) if other != at else None
            if made and made.whole > best.whole + CLIMB_GAIN:
                at, best = other, made
                break
        else:
            steps[name] /= 2
    return best


def _rounds(steps: Shares) -> Iterator[str]:
    """Yield parameters in turn while their steps are not too small, as often as is worth it."""
    for _ in range(CLIMB_TRIES):
        able = [name for name in steps if steps[name] >= CLIMB_LEAST]
        if not able:
            return
        yield from able
