"""Links of which an effect struck some: the likelihood of two sorts, and who is of which.

Every link's statistics have two likelihoods, of a link that is spared and of one that is struck;
with a chance of being struck, the same for all, their mixture is the evidence. What all links have
beside it is fitted to the spared ones, in turns with the question which these are (expectation and
maximisation: Dempster, Laird and Rubin 1977).
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added
from bench.discrepancy.fit.search import valued
from bench.discrepancy.fit.starts import between, free_parameters
from bench.discrepancy.joint.chance import highest
from bench.discrepancy.joint.likelihood import link_nats, white, whitener, without_own
from bench.discrepancy.joint.polish import fitted, polished
from bench.discrepancy.joint.settings import (
    CALM_FEWEST,
    CALM_SHARE,
    DONE_NATS,
    MOST_STRUCK,
    STRIKE_PASSES,
    STRIKE_POINTS,
    STRIKE_TURNS,
    STRUCK_FEWEST,
)
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.discrepancy.settings import PROFILE_90_NATS, STRUCK_SHARES
from bench.physics.base import Base
from bench.physics.effect import Effect

Floats = NDArray[np.float64]
Values = dict[str, float]
SHARES: Floats = np.array([share for share in STRUCK_SHARES if share <= MOST_STRUCK])


@dataclass(frozen=True)
class Mixed:
    """A mixture of spared and struck links: at which parameters, and how likely it is.

    `nats`: the log likelihood of all links with every share of `SHARES`. `odds` [L]: the log odds
    of every link at the likeliest share. `ranged`: what ranges of struck links say of the values.
    """

    values: Values
    nats: Floats
    odds: Floats
    ranged: float = 0.0

    @property
    def best(self) -> float:
        """The log likelihood at the likeliest share, in nats."""
        return float(self.nats.max())

    @property
    def whole(self) -> float:
        """The log likelihood of waveforms and of struck links' ranges, in nats."""
        return self.best + self.ranged

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
        self.bare = in_place(given, beside)
        self.spared = link_nats(given, self.bare, ())
        self.tried: list[Mixed] = []
        self.ranges: Callable[[Values], float] = lambda _: 0.0  # see `Mixed.ranged`
        self.begun = self.at({p.name: p.default for p in self.free})

    def fitted(self, begin: Values | None = None) -> Mixed | None:
        """Return the likeliest mixture of a search along its parameters, over and over.

        From values of these on; None where the effect, by default as it is, strikes no link.
        """
        best = self.at(begin) if begin else self.begun
        if best is None or best.best < self.spared.sum():
            return None
        for _ in range(STRIKE_PASSES):
            before = best.best
            best = self._along(best)
            if best.best < before + DONE_NATS:
                break
        return best

    def _along(self, best: Mixed) -> Mixed:
        """Return the likeliest mixture along one parameter after the other."""
        for item, share in product(self.free, STRIKE_POINTS):
            value = between(item, item.low, item.high, share)
            made = self.at({**best.values, item.name: value})
            best = made if made and made.best > best.best else best
        return best

    def at(self, values: Values) -> Mixed | None:
        """Return the mixture with these parameters of the effect, None where it has none."""
        moments = self.struck(values)
        if moments is None:
            return None
        made = mixed(values, self.spared, self._more(moments, self.bare, self.spared))
        self.tried.append(replace(made, ranged=self.ranges(values)))
        return self.tried[-1]

    def struck(self, values: Values) -> Moments | None:
        """Return the statistics where every link is struck, None where there are none."""
        assert self.kind.strikes is not None
        effect = valued(self.kind, {**values, self.kind.strikes[0]: 1.0})
        made, bare = self.given.moments((*self.beside, effect)), self.bare
        if made is None:
            return None
        left = bare.left + bare.mean - made.mean
        return replace(made, left=left, uneven=bare.uneven)

    def _more(self, moments: Moments, bare: Moments, spared: Floats) -> Floats:
        """Return how much likelier every link [L] is if struck, in nats."""
        found = link_nats(self.given, moments, (moments.mean - bare.mean,))
        return np.where(self.inert, -np.inf, found - spared)

    def by_chance(self, best: Mixed) -> float:
        """Return what the mixture may bring on simulated links that nothing struck, in nats."""
        struck, bare, brought = self.struck(best.values), self.bare, []
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
        return [one for one in self.tried if one.whole > best.whole - PROFILE_90_NATS]


def mixed(values: Values, spared: Floats, more: Floats) -> Mixed:
    """Return the mixture of links, likely by `spared` [L], and by `more` [L] likelier if struck."""
    each = np.logaddexp(np.log1p(-SHARES)[:, None], np.log(SHARES)[:, None] + more)
    nats = (spared + each).sum(axis=1)
    share = SHARES[nats.argmax()]
    return Mixed(values, nats, np.asarray(more + np.log(share) - np.log1p(-share)))


def of_each(made: Mixed) -> Floats:
    """Return the nats that every link [L] brings to a mixture."""
    return np.asarray(np.logaddexp(0, made.odds) + np.log1p(-made.share))


def in_place(given: Statistics, effects: Added) -> Moments:
    """Return the statistics beside effects, less what kinds of walls have of their own of these.

    Or devices of a noise floor; links may have more or less of it, too, where that is likelier. A
    wall of another make strikes no link at random. Raises BenchError where nothing is simulated.
    """
    varied = any(type(one).by_kind or type(one).by_device for one in effects)
    fit = fitted(given, effects) if varied else None
    if fit is None:
        return given.needed(effects)
    able = (replace(fit.moments, uneven=one) for one in (None, fit.moments.uneven))
    less = (without_own(given, one, ()) for one in able)
    return max(less, key=lambda one: float(link_nats(given, one, ()).sum()))


@dataclass(frozen=True)
class Found:
    """The likeliest mixture of a kind of effect, beside which effects, and what it is worth.

    `begin`: links that are taken for struck to begin with.
    """

    mixture: Mixture
    best: Mixed
    nats: float
    begin: NDArray[np.bool_] | None = None

    @property
    def struck(self) -> NDArray[np.bool_]:
        """Which links [L] are likelier struck than not; at a beginning those it begins with."""
        return np.asarray(self.best.odds > 0) if self.begin is None else self.begin

    @property
    def half(self) -> NDArray[np.bool_]:
        """The links [L] that have more of what the effect does than half of all that may."""
        mixture, bare = self.mixture, self.mixture.bare
        struck = mixture.struck(self.best.values)
        assert struck is not None  # the best was made of it
        matrices, _ = whitener(mixture.given, bare, ())
        way, able = white(matrices, struck.mean - bare.mean), ~mixture.inert
        size = np.where(able, (way**2).sum(axis=1), 1.0)
        much = (white(matrices, bare.left) * way).sum(axis=1) / size
        return np.asarray(able & (much > np.median(much[able])))

    @property
    def divides(self) -> bool:
        """Whether there are struck links, and as many others as show what these lack.

        Where nothing is in the way of some, all others may be struck.
        """
        struck, able = self.struck, ~self.mixture.inert
        calm = (able & ~struck).sum() >= max(CALM_FEWEST, CALM_SHARE * struck.sum())
        told = (~able).sum() >= CALM_FEWEST
        return bool(struck.sum() >= STRUCK_FEWEST and (calm or told))

    @property
    def effect(self) -> Effect:
        """The effect at its likeliest."""
        kind = self.mixture.kind
        assert kind.strikes is not None
        return valued(kind, {**self.best.values, kind.strikes[0]: self.best.share})


def worth(mixture: Mixture, best: Mixed | None) -> Found | None:
    """Return a mixture with what it is worth, None without one."""
    if best is None:
        return None
    paid = (*mixture.beside, mixture.kind())
    return Found(mixture, best, mixture.given.worth(best.best, paid))


def in_turns(begun: Found) -> Found | None:
    """Return the mixture at the end of turns that begin with some links, None without one."""
    best = now = _turned(begun)
    for _ in range(STRIKE_TURNS - 1):
        now = _turned(now) if now else None
        if best is None or now is None or now.nats < best.nats + DONE_NATS:
            break
        best = now
    return best


def _turned(found: Found) -> Found | None:
    """Return the mixture beside effects that are fitted to the links that `found` spares."""
    mixture, given = found.mixture, found.mixture.given
    if min(found.struck.sum(), (~found.struck).sum()) < STRUCK_FEWEST:
        return None
    links = np.unique(given.rows.links)[found.struck]
    calm = Statistics(given.comparison, given.rows.leaving(links), given.beside, given.members)
    fit = polished(calm, mixture.beside)
    if fit is None:
        return None
    again = Mixture(given, fit.effects, mixture.kind)
    return worth(again, again.fitted(found.best.values))
