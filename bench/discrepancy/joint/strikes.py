"""Links struck at random, seen in waveforms: each is as it was, or as if the effect struck it.

Where something obstructs a share of the links, a mean over all of them is that of none, and nobody
can predict which are struck. So the effect is simulated with every link struck, and every link's
statistics have two likelihoods: of a link that is spared and of one that is struck. With a chance
of being struck, the same for all, their mixture is the evidence (compare
`bench.discrepancy.select.link_mixture` for ranges alone). It must say more than what all links
share, alone or beside it. What an obstruction does to ranges depends on the receiver's detector,
so these are no part of the likelihood but an independent witness: struck links must read longer.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm, rankdata

from bench.discrepancy.compare.crps import cluster_bootstrap
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.estimate import ParameterEstimate, profiled
from bench.discrepancy.fit.search import valued
from bench.discrepancy.fit.starts import between, free_parameters
from bench.discrepancy.joint.chance import highest
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.likelihood import link_nats
from bench.discrepancy.joint.rows import compared_rows
from bench.discrepancy.joint.settings import (
    CALM_FEWEST,
    CLASS_NATS,
    LONGER_M,
    LONGER_ODDS,
    NAME_NATS,
    NAME_SHARE,
    PREDICTED_P,
    STRIKE_ALIKE,
    STRIKE_POINTS,
    STRUCK_FEWEST,
)
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.within_links import link_medians, rows_off
from bench.discrepancy.settings import (
    PROFILE_90_NATS,
    ROWS_STRUCK_SHARE,
    SCORE_FIRST,
    SCORE_MEMBERS,
    STRUCK_SHARES,
)
from bench.physics.base import Base
from bench.physics.effect import Effect, Parameter

Floats = NDArray[np.float64]
Values = dict[str, float]
SHARES: Floats = np.array(STRUCK_SHARES)


@dataclass(frozen=True)
class Mixed:
    """A mixture of spared and struck links: at which parameters, and how likely it is.

    `nats`: the log likelihood of all links with every share of `SHARES`. `odds` [L]: the log odds
    of every link at the likeliest share.
    """

    values: Values
    nats: Floats
    odds: Floats

    @property
    def best(self) -> float:
        """The log likelihood at the likeliest share, in nats."""
        return float(self.nats.max())

    @property
    def share(self) -> float:
        """The likeliest share."""
        return float(SHARES[self.nats.argmax()])


class Mixture:
    """Links beside effects that are in place, each struck by a kind of effect or not.

    Raises BenchError where nothing can be simulated.
    """

    def __init__(self, given: Statistics, beside: Added, kind: type[Effect]) -> None:
        self.given, self.beside, self.kind = given, beside, kind
        assert kind.strikes is not None
        self.free = [p for p in free_parameters(kind) if p.name != kind.strikes[0]]
        inert = kind().inert(Base().paths(given.rows.scene))
        self.inert = np.bincount(given.code, inert) == given.count
        self.bare = given.needed(beside)
        self.spared = link_nats(given, self.bare, ())
        self.tried: list[Mixed] = []
        self.begun = self._at({p.name: p.default for p in self.free})

    def fitted(self) -> Mixed | None:
        """Return the likeliest mixture of a search along one parameter after the other.

        None where the effect as it is by default strikes no link.
        """
        best = self.begun
        if best is None or best.best < self.spared.sum():
            return None
        for item in self.free:
            for share in STRIKE_POINTS:
                value = between(item, item.low, item.high, share)
                made = self._at({**best.values, item.name: value})
                best = made if made and made.best > best.best else best
        return best

    def _at(self, values: Values) -> Mixed | None:
        """Return the mixture with these parameters of the effect, None where it has none."""
        moments = self._struck(values)
        if moments is None:
            return None
        self.tried.append(mixed(values, self.spared, self._more(moments, self.bare, self.spared)))
        return self.tried[-1]

    def _struck(self, values: Values) -> Moments | None:
        """Return the statistics where every link is struck, None where there are none."""
        assert self.kind.strikes is not None
        effect = valued(self.kind, {**values, self.kind.strikes[0]: 1.0})
        return self.given.moments((*self.beside, effect))

    def _more(self, moments: Moments, bare: Moments, spared: Floats) -> Floats:
        """Return how much likelier every link [L] is if struck, in nats."""
        found = link_nats(self.given, moments, (moments.mean - bare.mean,))
        return np.where(self.inert, -np.inf, found - spared)

    def by_chance(self, best: Mixed) -> float:
        """Return what the mixture may bring on simulated links that nothing struck, in nats."""
        struck, bare, brought = self._struck(best.values), self.bare, []
        assert struck is not None  # the best was made of it
        for left in self.given.others(self.beside):
            alike = replace(bare, left=left)
            hit = replace(struck, left=left + bare.mean - struck.mean)
            spared = link_nats(self.given, alike, ())
            more = self._more(hit, alike, spared)
            brought.append(mixed(best.values, spared, more).best - float(spared.sum()))
        return max(0.0, highest(brought)) / self.given.crowding

    def near(self, best: Mixed) -> list[Mixed]:
        """Return what was tried that is about as likely as the best."""
        return [one for one in self.tried if one.best > best.best - PROFILE_90_NATS]


def mixed(values: Values, spared: Floats, more: Floats) -> Mixed:
    """Return the mixture of links, likely by `spared` [L], and by `more` [L] likelier if struck."""
    each = np.logaddexp(np.log1p(-SHARES)[:, None], np.log(SHARES)[:, None] + more)
    nats = (spared + each).sum(axis=1)
    share = SHARES[nats.argmax()]
    return Mixed(values, nats, np.asarray(more + np.log(share) - np.log1p(-share)))


@dataclass(frozen=True)
class Found:
    """The likeliest mixture of a kind of effect, beside which effects, and what it is worth."""

    mixture: Mixture
    best: Mixed
    nats: float

    @property
    def struck(self) -> NDArray[np.bool_]:
        """Which links [L] are likelier struck than not."""
        return np.asarray(self.best.odds > 0)

    @property
    def effect(self) -> Effect:
        """The effect at its likeliest."""
        kind = self.mixture.kind
        assert kind.strikes is not None
        return valued(kind, {**self.best.values, kind.strikes[0]: self.best.share})


def struck_by(search: Search, choice: WaveChoice) -> Strike | None:
    """Return the effect that strikes links at random, None where waveforms speak for none.

    `choice` is what waveforms say of all links alike: with it, or instead of it.
    """
    return strike_beside(
        search.comparison, compared_rows(search), search.kinds.values(), choice.added
    )


def strike_beside(
    comparison: Comparison, rows: View, kinds: Iterable[type[Effect]], added: Added
) -> Strike | None:
    """Return which of `kinds` strikes links at random, beside the effects `added` or without them.

    None where neither says more than these or nothing, or links are not as one struck.
    """
    able = [kind for kind in kinds if kind.strikes is not None]
    given = _known(Statistics(comparison, rows), able)
    bases = list(dict.fromkeys(((), added)))
    shared = [_common(given, base) for base in bases]
    common = max(shared)
    least = max(NAME_NATS, NAME_SHARE * (common - shared[0]))  # less may only mend a form
    found = [one for kind in able if (one := _found(given, bases, kind))]
    found.sort(key=lambda one: -one.nats)
    if not found or found[0].nats - common < least or not _witnessed(comparison, found[0]):
        return None
    if found[0].nats - common < least + found[0].mixture.by_chance(found[0].best):
        return None
    first, *others = (_strike(one, common) for one in _alike(found, common))
    return replace(first, others=tuple(others))


def _known(given: Statistics, kinds: Sequence[type[Effect]]) -> Statistics:
    """Return the statistics that every kind of strike leaves known, however hard."""
    for kind in kinds:
        assert kind.strikes is not None
        share, size = kind.strikes
        item = next(p for p in kind.parameters() if p.name == size)
        for point in (STRIKE_POINTS[0], STRIKE_POINTS[-1]):
            value = between(item, item.low, item.high, point)
            given = given.knowing((valued(kind, {share: 1.0, size: value}),))
    return given


def _common(given: Statistics, added: Added) -> float:
    """Return how likely all links are beside effects that strike none, in nats paid for."""
    return given.worth(link_nats(given, given.needed(added), ()).sum(), added)


def _found(given: Statistics, bases: Sequence[Added], kind: type[Effect]) -> Found | None:
    """Return the likeliest mixture of a kind of effect, None without one."""
    every = [Mixture(given, base, kind) for base in bases]
    begun = [(one, one.begun) for one in every if one.begun]
    if not begun:
        return None
    mixture = max(begun, key=lambda one: given.worth(one[1].best, one[0].beside))[0]
    best = mixture.fitted()
    if best is None:
        return None
    return Found(mixture, best, given.worth(best.best, (*mixture.beside, kind())))


def _alike(found: Sequence[Found], common: float) -> list[Found]:
    """Return the likeliest kind of strike and those that do about as well: forms are never right.

    What blocks a path and what weakens it do the same to many a link.
    """
    least = STRIKE_ALIKE * (found[0].nats - common)
    gap = min(least, found[0].nats - common - CLASS_NATS)
    return [one for one in found if one is found[0] or one.nats - common > gap]


def _witnessed(comparison: Comparison, found: Found) -> bool:
    """Return whether struck links are as an obstruction leaves them.

    Some are struck and more are not, nothing known tells which, their ranges are longer, and
    those of all their rows.
    """
    struck, able = found.struck, ~found.mixture.inert
    if struck.sum() < STRUCK_FEWEST or (able & ~struck).sum() < max(CALM_FEWEST, struck.sum()):
        return False
    given = found.mixture.given
    made = comparison.ensemble(given.rows, found.mixture.beside, SCORE_MEMBERS, SCORE_FIRST)
    if RANGE not in made.names or rows_off(made) > ROWS_STRUCK_SHARE * struck.mean():
        return False
    offset_m = link_medians(made.residual_of(RANGE)[None], given.code)[0]
    known = np.isfinite(offset_m)
    longer = is_longer(offset_m[known & able], struck[known & able])
    return longer and not predicted(given.known[able], struck[able])


def is_longer(offset_m: Floats, struck: NDArray[np.bool_]) -> bool:
    """Return whether struck links [L] read longer than the others: nearly all of them, and well."""
    hit, calm = offset_m[struck], offset_m[~struck]
    if not len(hit) or not len(calm):
        return False
    ranks = rankdata(offset_m)[struck].sum() - len(hit) * (len(hit) + 1) / 2
    far = float(np.median(hit) - np.median(calm))
    return bool(ranks / (len(hit) * len(calm)) > LONGER_ODDS and far > LONGER_M)


def predicted(known: Floats, struck: NDArray[np.bool_]) -> bool:
    """Return whether something known [L, q] tells which links [L] are struck: then it is no chance.

    By its correlation, with a correction for how many there are (Bonferroni).
    """
    if not known.shape[1]:
        return False
    beside = known - known.mean(axis=0)
    mine = struck - struck.mean()
    wide = np.sqrt((beside**2).sum(axis=0) * (mine**2).sum())
    z = np.sqrt(len(mine)) * np.abs(mine @ beside) / np.maximum(wide, np.finfo(float).tiny)
    return bool(z.max() > norm.isf(PREDICTED_P / (2 * known.shape[1])))


def _strike(found: Found, common: float) -> Strike:
    """Return the strike with its evidence and intervals."""
    given, kind = found.mixture.given, found.mixture.kind
    links = np.unique(given.rows.links)
    each = (np.logaddexp(0, found.best.odds) + np.log1p(-found.best.share)) / given.crowding
    excess = each.sum() - (found.nats - common)
    evidence = cluster_bootstrap(each * len(each) - excess, links, 0, "nats of likelihood")
    near = found.mixture.near(found.best)
    parameters = (_share(found), *(_size(p, found, near) for p in found.mixture.free))
    order = {p.name: i for i, p in enumerate(kind.parameters())}
    parameters = tuple(sorted(parameters, key=lambda one: order[one.name]))
    return Strike(found.effect, evidence, parameters, links[found.struck], "evidence in waveforms")


def _share(found: Found) -> ParameterEstimate:
    assert found.mixture.kind.strikes is not None
    name = found.mixture.kind.strikes[0]
    item = next(p for p in found.mixture.kind.parameters() if p.name == name)
    near = SHARES[found.best.nats > found.best.best - PROFILE_90_NATS].tolist()
    return profiled(item, found.best.share, near, SHARES.tolist())


def _size(item: Parameter, found: Found, near: Sequence[Mixed]) -> ParameterEstimate:
    """Return a parameter with what was tried of it and is about as likely."""
    grid = {one.values[item.name] for one in found.mixture.tried}
    some = [one.values[item.name] for one in near]
    return profiled(item, found.best.values[item.name], some, sorted(grid))
