"""Links struck at random: what blocks a share of the links is judged by likelihood, link by link.

A mean score of all rows hardly sees an effect that strikes a few links by metres: nobody can
predict which. Its evidence is in the outlying links themselves. So the offset of every link
(median residual of its range) is modelled as a mixture: calm (as replicates scatter), struck (the
effect's own distribution, simulated with every link struck) or anything at all (uniform, so that
the model without the effect can live with outliers too). The difference of maximised log
likelihoods is the evidence. A rival that all links share is put to the same likelihood.
"""

from __future__ import annotations

from collections.abc import Collection, Iterable, Mapping
from dataclasses import dataclass, replace
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from bench.discrepancy.compare.crps import LIKELIHOOD, Estimate, cluster_bootstrap
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.estimate import ParameterEstimate, profiled
from bench.discrepancy.select.alike_behind import alike_behind, in_common
from bench.discrepancy.select.settings import FEWEST_SEVERAL, MOST_STRUCK
from bench.discrepancy.select.shared_variance import shared_variance
from bench.discrepancy.select.struck_shifts import share_and_size, sizes_of, striking, struck_m
from bench.discrepancy.select.within_links import (
    as_loud,
    coarsest_m,
    link_medians,
    rows_off,
    weakened,
)
from bench.discrepancy.settings import (
    BEHIND_M,
    CALM_EXTRA_M,
    FEW_VERSIONS,
    LEAST_SCATTER_M,
    OFFSET_FIRST,
    OFFSET_MEMBERS,
    PROFILE_90_NATS,
    ROWS_STRUCK_SHARE,
    SHORTEST_DETOUR_M,
    STRAY_SHARE,
    STRIKE_NATS,
    STRUCK_SHARES,
    WIDEST_OFFSET_M,
    WILD_SHARES,
)
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.slabs import unlisted

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]
Kinds = Mapping[str, type[Effect]]
EXTRA_M = (CALM_EXTRA_M[0], *np.geomspace(*CALM_EXTRA_M[1:]).tolist())
SHARES: Floats = np.array(STRUCK_SHARES)


@dataclass(frozen=True)
class Strike:
    """An effect that strikes links at random, with the evidence for it.

    `evidence`: log likelihood over that of the simulator with wild links, in nats; `struck` are
    the link codes that are outliers; `judged`: what the evidence is in; `others` would do as well.
    """

    effect: Effect
    evidence: Estimate
    parameters: tuple[ParameterEstimate, ...]
    struck: NDArray[np.intp]
    judged: str = "evidence in the offsets of links"
    others: tuple[Strike, ...] = ()


@dataclass(frozen=True)
class Offsets:
    """Offset of every link [L] in metres beside the simulator: `links` are their codes.

    `scatter_m`: its standard deviation, known with so many `degrees` of freedom, so offsets are
    distributed as Student's t; `inert`: the effect must spare the link.
    """

    links: NDArray[np.intp]
    offset_m: Floats
    scatter_m: Floats
    inert: Mask
    degrees: float

    @property
    def widest_m(self) -> float:
        """Within how many metres of the simulator offsets that nothing explains are uniform."""
        return max(WIDEST_OFFSET_M, float(np.abs(self.offset_m).max()))

    def calm(self, extra_m: float, behind_m: float) -> Floats:
        """Return the density of the offsets if nothing struck, [L] per metre.

        Links that the effect need not spare are `behind_m` longer.
        """
        centre = np.where(self.inert, 0.0, behind_m)
        wide = np.hypot(self.scatter_m, extra_m)
        return np.asarray(student.pdf((self.offset_m - centre) / wide, self.degrees) / wide)


@dataclass(frozen=True)
class Mixture:
    """A mixture: log likelihood in nats, scatter and offset of calm links, shares of the others."""

    nats: float
    extra_m: float
    behind_m: float
    wild: float
    share: float = 0.0
    size: float = 0.0

    def parts(self, seen: Offsets, struck: Floats | None = None) -> Floats:
        """Return the densities of calm, struck and wild, each with its chance, [3, L] per metre."""
        chance = np.where(seen.inert, 0.0, self.share)
        hit = chance * struck if struck is not None else np.zeros(len(chance))
        known = np.stack([(1 - chance) * seen.calm(self.extra_m, self.behind_m), hit]) * (
            1 - self.wild
        )
        return np.vstack([known, np.full(len(chance), self.wild / (2 * seen.widest_m))])

    def density(self, seen: Offsets, struck: Floats | None = None) -> Floats:
        """Return the density of every link's offset, [L] per metre."""
        return np.asarray(self.parts(seen, struck).sum(axis=0))


def strikable(kind: type[Effect], view: View) -> bool:
    """Return whether an effect is judged link by link: it strikes a share, and ranges are all."""
    return kind.strikes is not None and kind.without_cir and not view.waveform


def strike(
    comparison: Comparison,
    view: View,
    added: Added,
    rival: Added,
    kinds: Kinds,
    lead: float = 0.0,
) -> Strike | None:
    """Return the effect of `kinds` that strikes links of `view`, None without evidence for one.

    `added` are the effects so far; `rival` those with the best that all links share, which must
    explain the offsets worse by `lead` nats.
    """
    able = [kind for kind in kinds.values() if strikable(kind, view)]
    if not able or RANGE not in view.recorded.names:
        return None
    found = [one for one in (_one(comparison, view, added, kind, kinds) for kind in able) if one]
    if not found:
        return None
    best, nats = max(found, key=lambda one: one[0].evidence.value)
    behind = (
        rival != added and unstruck(offsets(comparison, view, rival, able[0])).nats > nats - lead
    )
    return None if behind else best


def _one(
    comparison: Comparison, view: View, added: Added, kind: type[Effect], kinds: Kinds
) -> tuple[Strike, float] | None:
    """Return a kind of effect with its evidence and penalised log likelihood.

    Where nearly all links seem struck, a delay or a scale moves them all: what strikes is asked
    beside what most of them have in common.
    """
    seen = offsets(comparison, view, added, kind)
    found = _beside(comparison, view, added, kind, seen)
    if found is None:
        return None
    if len(found[0].struck) <= MOST_STRUCK * len(seen.links):
        ways = alike_behind(kinds, view, seen.links, seen.inert)
        return _apart_from_alike(comparison, view, added, found, seen, ways)
    common = replace(seen, offset_m=seen.offset_m - in_common(seen.offset_m))
    beside = _beside(comparison, view, added, kind, common)
    return beside and (beside[0], beside[1] - float(np.log(len(seen.links)) / 2))  # of a constant


def _apart_from_alike(
    comparison: Comparison,
    view: View,
    added: Added,
    found: tuple[Strike, float],
    seen: Offsets,
    ways: Iterable[Floats],
) -> tuple[Strike, float]:
    """Return what strikes, beside what obstacles of one kind do to all links behind them, if more.

    Else links are held to be struck that are late by as much as all others behind the same.
    """
    kind, constant = type(found[0].effect), float(np.log(len(seen.links)) / 2)
    for way in ways:
        acting = way != 0
        size = in_common(seen.offset_m[acting] / way[acting])
        other = replace(seen, offset_m=seen.offset_m - size * way)
        made = _beside(comparison, view, added, kind, other)
        if made and made[1] - constant > found[1] + STRIKE_NATS:
            found, seen = (made[0], made[1] - constant), other
    return found


def _beside(
    comparison: Comparison, view: View, added: Added, kind: type[Effect], seen: Offsets
) -> tuple[Strike, float] | None:
    """Return the same for the offsets of links as they are `seen`."""
    bare = comparison.ensemble(view, added, OFFSET_MEMBERS // 2, OFFSET_FIRST)
    sizes = {
        size: struck_m(comparison, view, added, kind, size, seen, bare) for size in sizes_of(kind)
    }
    plain = unstruck(seen)
    for wilds in (WILD_SHARES, WILD_SHARES[:1]):  # if many are anything: as if hardly any were
        likely = _every(seen, sizes, wilds)
        mixed = max(likely, key=lambda one: one.nats)
        likeliest = mixed.parts(seen, sizes[mixed.size]).argmax(axis=0)  # calm, struck or wild
        outlying = likeliest > 0
        if not (strays := (likeliest == 2).sum() > STRAY_SHARE * outlying.sum()):
            break
    weaker = weakened(bare, outlying)
    short = mixed.size < SHORTEST_DETOUR_M and not _behind_any(view, seen)
    if mixed.nats + weaker - plain.nats < STRIKE_NATS or short or strays:
        return None
    if rows_off(bare, coarsest_m(added)) > ROWS_STRUCK_SHARE * outlying.mean():
        return None  # what strikes rows, not links
    effect = as_loud(striking(kind, mixed.share, mixed.size), bare, likeliest)
    each = np.log(mixed.density(seen, sizes[mixed.size]) / plain.density(seen))
    evidence = cluster_bootstrap(each * len(each), seen.links, 0, LIKELIHOOD)
    parameters = _intervals(likely, mixed, kind, sizes)
    cost = np.log(len(each))  # of two parameters (Schwarz 1978)
    return Strike(effect, evidence, parameters, seen.links[outlying]), mixed.nats - cost


def _behind_any(view: View, seen: Offsets) -> bool:
    """Return whether walls of any make may stand in ways that are not clear: they delay by less.

    Where a table tells which ways these are, of many links, and not what stands in them.
    """
    able = np.isin(seen.links, view.links[unlisted(view.scene)]) & ~seen.inert
    return bool(min(able.sum(), seen.inert.sum()) >= FEWEST_SEVERAL)


def apart(comparison: Comparison, view: View, added: Added) -> float:
    """Return the evidence, in nats, that links have offsets of their own beside the simulator.

    The log likelihood of scatter between links beyond the simulator's over that of none; links
    may be anything at all in both. 0 where ranges are not on both sides.
    """
    if RANGE not in comparison.ensemble(view, added, OFFSET_MEMBERS, OFFSET_FIRST).names:
        return 0.0
    every = _chances(offsets(comparison, view, added, None))
    none = max(one.nats for one in every if one.extra_m == 0)
    return max(one.nats for one in every) - none


def offsets(comparison: Comparison, view: View, added: Added, kind: type[Effect] | None) -> Offsets:
    """Return the offset of every link of the view beside the simulator with `added`.

    Without a `kind` all links count as spared.
    """
    whole, own = (
        comparison.ensemble(view, added, OFFSET_MEMBERS, OFFSET_FIRST),
        comparison.distinct(view),
    )
    borrows = own < FEW_VERSIONS and len(whole.simulated) >= own + FEW_VERSIONS
    made = whole.beside(own) if borrows else whole.first(own)
    members = len(made.simulated)
    links, code = np.unique(made.links, return_inverse=True)
    which = made.names.index("error_m")
    middle = made.simulated[..., which].mean(axis=0)
    per_version = link_medians(made.versions[..., which] - middle, code)
    inert = kind().inert(Base().paths(view.scene)) if kind else np.ones(len(code), bool)
    spared = np.bincount(code, inert) == np.bincount(code)
    variance, degrees = shared_variance(per_version[1:].var(axis=0, ddof=1), members - 1)
    scatter = np.sqrt(variance * (1 + 1 / members))
    return Offsets(links, per_version[0], np.maximum(scatter, LEAST_SCATTER_M), spared, degrees)


def left_far(
    comparison: Comparison, view: View, before: Added, after: Added, struck: NDArray[np.intp]
) -> float:
    """Return which share of struck links lies farther off than half of what it did `before`."""
    was, now = (offsets(comparison, view, some, None) for some in (before, after))
    some = np.isin(was.links, struck)
    return float(np.mean(np.abs(now.offset_m) > np.abs(was.offset_m) / 2, where=some))


def unstruck(seen: Offsets) -> Mixture:
    """Return the likeliest mixture without strikes."""
    return max(_chances(seen), key=lambda one: one.nats)


def _chances(seen: Offsets) -> list[Mixture]:
    """Return every mixture without strikes that is tried."""
    every = []
    behinds = BEHIND_M[:1] if seen.inert.all() else BEHIND_M  # spared links are behind nothing
    for extra, behind, wild in product(EXTRA_M, behinds, WILD_SHARES):
        one = Mixture(0.0, extra, behind, wild)
        every.append(replace(one, nats=float(np.log(one.density(seen)).sum())))
    return every


def _every(seen: Offsets, sizes: Mapping[float, Floats], wilds: Collection[float]) -> list[Mixture]:
    """Return the likely mixtures with strikes of some `sizes` (densities by size), and `wilds`."""
    chance = SHARES[:, None] * np.where(seen.inert, 0.0, 1.0)
    hits = {size: chance * struck for size, struck in sizes.items()}
    out: list[Mixture] = []
    top = -np.inf
    for extra, behind in product(EXTRA_M, BEHIND_M):
        calm = (1 - chance) * seen.calm(extra, behind)
        for (size, hit), wild in product(hits.items(), wilds):
            nats = np.log((1 - wild) * (calm + hit) + wild / (2 * seen.widest_m)).sum(axis=1)
            top = max(top, float(nats.max()))
            near = np.flatnonzero(nats > top - PROFILE_90_NATS)
            out += [
                Mixture(float(nats[i]), extra, behind, wild, float(SHARES[i]), size) for i in near
            ]
    return [one for one in out if one.nats > top - PROFILE_90_NATS]


def _intervals(
    likely: list[Mixture], best: Mixture, kind: type[Effect], sizes: Collection[float]
) -> tuple[ParameterEstimate, ...]:
    """Return share and size with the 90 % intervals of the profile likelihood.

    On the grids that were tried: an interval ends half way to the next value on either side.
    """
    share, size = share_and_size(kind)
    out = []
    for item, now, near, grid in (
        (share, best.share, [one.share for one in likely], SHARES.tolist()),
        (size, best.size, [one.size for one in likely], list(sizes)),
    ):
        out.append(profiled(item, now, near, grid))
    return tuple(out)
