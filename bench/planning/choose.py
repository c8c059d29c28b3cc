"""Which measurements, and how many links of each, until one explanation is left."""

from __future__ import annotations

from bisect import bisect_left
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import combinations

import numpy as np
from scipy.stats import norm

from bench.planning.outlook import Counts, Outlook
from bench.planning.scatter import Floats
from bench.planning.settings import (
    ASSURED_NATS,
    LINK_NATS,
    MOST_LINKS,
    STEP_LINKS,
    SURE,
    SURE_NATS,
)


@dataclass(frozen=True)
class Worth:
    """What one measurement alone brings, in nats per link.

    `nats` counts all pairs of explanations together, each up to `LINK_NATS`; `least_nats` and
    `most_nats` are those of the pairs it helps least and most, `best` names the latter; `links`
    are how many settle every pair (None: more than are counted).
    """

    place: int
    nats: float
    least_nats: float
    most_nats: float
    best: tuple[str, str]
    links: int | None


def pairs(nats: Floats) -> Floats:
    """Return the nats of every pair, whichever of the two is true, [pairs]."""
    return np.array([min(nats[a, b], nats[b, a]) for a, b in combinations(range(len(nats)), 2)])


@dataclass(frozen=True)
class Scale:
    """How far links bring each pair: their nats together, but so much for one link at most.

    `single` [c, pairs] are the nats of one link of each measurement.
    """

    outlook: Outlook
    single: Floats

    @classmethod
    def of(cls, outlook: Outlook, count: int) -> Scale:
        """Return the scale for `count` measurements."""
        ones = np.eye(count, dtype=int)
        return cls(outlook, np.array([pairs(outlook.nats(one)) for one in ones]))

    def progress(self, links: Counts) -> Floats:
        """Return the nats [pairs] that so many links [c] bring towards an answer."""
        capped = links @ np.minimum(self.single, LINK_NATS)
        return np.asarray(np.minimum(pairs(self.outlook.nats(links)), capped))


def ranked(scale: Scale) -> list[Worth]:
    """Return what each measurement alone brings, the best first."""
    made = [_worth(scale, place) for place in range(len(scale.single))]
    return sorted(made, key=lambda one: -one.nats)


def _worth(scale: Scale, place: int) -> Worth:
    nats, one = scale.single[place], np.eye(len(scale.single), dtype=int)[place]
    names = list(combinations(scale.outlook.names, 2))

    def sure(links: int) -> bool:
        return bool(scale.progress(links * one).min() >= SURE_NATS)

    # Nats only grow with the links: halve the numbers in question.
    every = range(1, MOST_LINKS + 1)
    links = bisect_left(every, True, key=sure) + 1 if sure(MOST_LINKS) else None
    total = float(np.minimum(nats, LINK_NATS).sum())
    most = int(nats.argmax())
    return Worth(place, total, float(nats.min()), float(nats[most]), names[most], links)


def chosen(scale: Scale, links: int | None, places: Sequence[int]) -> Counts:
    """Return how many links [c] of each measurement: `links` in all, or until every pair is sure.

    A few links at a time, of the measurements at `places`, where they bring the pairs that are not
    yet sure furthest.
    """
    most = MOST_LINKS if links is None else links
    steps = np.eye(len(scale.single), dtype=int)[list(places)]
    made = np.zeros(len(scale.single), dtype=int)
    while (left := most - made.sum()) > 0:
        now = scale.progress(made)
        if links is None and now.min() >= SURE_NATS:
            break
        cap = SURE_NATS if now.min() < SURE_NATS else np.inf
        size = min(STEP_LINKS, int(left))
        value = [np.minimum(scale.progress(made + size * step), cap).sum() for step in steps]
        made = made + size * steps[int(np.argmax(value))]
    return made


def probability(nats: float) -> float:
    """Return how likely the right explanation ends ahead beyond doubt at so many nats of progress.

    At `SURE_NATS` it is `SURE`; a log ratio of mean D scatters by sqrt(2 D).
    """
    if nats <= 0:
        return 0.0
    share = nats / SURE_NATS * ASSURED_NATS
    least = np.log(SURE / (1 - SURE))
    return float(norm.cdf((share - least) / np.sqrt(2 * share)))
