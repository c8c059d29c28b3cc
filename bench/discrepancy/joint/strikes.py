"""Links struck at random, seen in waveforms: each is as it was, or as if the effect struck it.

Where something obstructs a share of the links, a mean over all of them is that of none, and nobody
can predict which are struck. So the effect is simulated with every link struck, and every link's
statistics have two likelihoods: of a link that is spared and of one that is struck. With a chance
of being struck, the same for all, their mixture is the evidence (compare
`bench.discrepancy.select.link_mixture` for ranges alone). It must say more than what all links
share, alone or beside it. What an obstruction does to ranges depends on the receiver's detector,
so these are no part of the likelihood but an independent witness: struck links must read longer,
or their first paths be weak (see `witness`).
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import replace
from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm

from bench.discrepancy.compare.crps import LIKELIHOOD, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import Added, Comparison, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.search import valued
from bench.discrepancy.fit.starts import between
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.climb import climbed
from bench.discrepancy.joint.likelihood import link_nats
from bench.discrepancy.joint.mixture import Found, Mixture, in_place, in_turns, of_each, worth
from bench.discrepancy.joint.ranged import by_ranges
from bench.discrepancy.joint.rows import compared_rows
from bench.discrepancy.joint.settings import (
    CLASS_NATS,
    NAME_NATS,
    NAME_SHARE,
    PREDICTED_P,
    PREDICTED_SHARE,
    SAME_DEVICE,
    STRIKE_ALIKE,
    STRIKE_HARD,
    STRIKE_POINTS,
    STRUCK_FEWEST,
)
from bench.discrepancy.joint.spared import only_touched
from bench.discrepancy.joint.statistics import Statistics
from bench.discrepancy.joint.straight import straight_nats
from bench.discrepancy.joint.strike_intervals import sizes_of
from bench.discrepancy.joint.witness import (
    as_often_short,
    is_longer,
    read_long,
    rows_jump,
    weak_first,
)
from bench.discrepancy.select.link_mixture import Strike
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.within_links import link_medians
from bench.discrepancy.settings import SCORE_FIRST, SCORE_MEMBERS
from bench.errors import BenchError
from bench.physics.effect import Effect

Floats = NDArray[np.float64]


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
    bases = list(dict.fromkeys(((), added)))
    given = _known(Statistics(comparison, rows), able, bases)
    shared = [_common(given, base) for base in bases]
    common = max(shared)
    found = [one for kind in able if (one := _found(given, bases, kind))]
    found.sort(key=_nats, reverse=True)
    if found and found[0].nats - common > NAME_NATS and found[0].mixture.beside:
        found = sorted(_refitted(found, able), key=_nats, reverse=True)
    if not found or found[0].nats - common < NAME_NATS:
        return None
    found = sorted(map(climbed, found), key=_nats, reverse=True)
    rows, beside = found[0].mixture.given.rows, found[0].mixture.beside
    made = comparison.ensemble(rows, beside, SCORE_MEMBERS, SCORE_FIRST)
    if RANGE not in made.names:
        return None
    seen = straight_nats(rows, found[0].struck, made.residual_of(RANGE))
    offset_m = link_medians(made.residual_of(RANGE)[None], given.code)[0]
    if not _witnessed(made, found[0], offset_m, seen):
        return None
    longer = is_longer(offset_m, found[0].struck)  # else straight paths are ranged, if weak
    alike = told(_alike(found, common), seen) if longer else _leaving(found)
    if not (alike and enough(alike[0], common, common - shared[0], seen)):
        return None
    if by_one(alike[0], common, seen) or _behind_others(alike[0]):
        return None
    first, *others = (_strike(by_ranges(one, made), common) for one in alike)
    return replace(first, others=tuple(others))


def enough(found: Found, common: float, explained: float, seen: float) -> bool:
    """Return whether a strike brings what it must, straight paths that are seen (nats) with it.

    They speak for what leaves them there: where it leaves none, they are nothing in its favour.
    """
    seen = 0.0 if found.mixture.kind.silent_before else seen
    return found.nats - common + seen >= least_nats(explained, found, seen)


def by_one(found: Found, common: float, seen: float) -> bool:
    """Return whether one link alone makes a strike: without it no name's nats are left.

    What strikes at random strikes several; one odd link (influential: Cook 1977) is itself alone.
    """
    seen = 0.0 if found.mixture.kind.silent_before else seen
    rest = found.nats - common - float(of_each(found.best).max()) / found.mixture.given.crowding
    return rest + seen < NAME_NATS + found.mixture.by_chance(found.best)


def _behind_others(found: Found) -> bool:
    """Return whether all that is struck stands behind what an effect beside is of.

    But where that is walls: among those listed may be some that are thicker than others.
    """
    if any(type(one).by_kind for one in found.mixture.beside):
        return False
    moments = found.mixture.given.moments(found.mixture.beside)
    return moments is not None and only_touched(moments.spared, found.struck)


def least_nats(explained: float, found: Found, seen: float) -> float:
    """Return what a strike must bring beside effects that explain so much, in nats.

    Less than a share of that may only mend a form of theirs, but where straight paths are seen.
    """
    share = 0.0 if seen > NAME_NATS else NAME_SHARE * explained
    return max(NAME_NATS, share) + found.mixture.by_chance(found.best)


def _known(given: Statistics, kinds: Sequence[type[Effect]], bases: Sequence[Added]) -> Statistics:
    """Return the statistics that every kind of strike leaves known, however hard.

    Beside every base, too: what is rounded to coarse steps loses the weak paths of struck links.
    """
    for kind, base in product(kinds, bases):
        assert kind.strikes is not None
        share, size = kind.strikes
        item = next(p for p in kind.parameters() if p.name == size)
        for point in (STRIKE_POINTS[0], STRIKE_HARD):
            value = between(item, item.low, item.high, point)
            struck = valued(kind, {share: 1.0, size: value})
            given = _knowing(given, (*base, struck)) if base else given.knowing((struck,))
    return given


def _knowing(given: Statistics, added: Added) -> Statistics:
    """Return the statistics that effects leave known; all where they leave nothing to compare."""
    try:
        return given.knowing(added)
    except BenchError:  # then nothing is struck beside them
        return given


def _common(given: Statistics, added: Added) -> float:
    """Return how likely all links are beside effects that strike none, in nats paid for."""
    return given.worth(link_nats(given, in_place(given, added), ()).sum(), added)


def _found(given: Statistics, bases: Sequence[Added], kind: type[Effect]) -> Found | None:
    """Return the likeliest mixture of a kind of effect, None without one."""
    every = [Mixture(given, base, kind) for base in bases]
    begun = [(one, one.begun) for one in every if one.begun]
    if not begun:
        return None
    mixture = max(begun, key=lambda one: given.worth(one[1].best, one[0].beside))[0]
    return worth(mixture, mixture.fitted())


def _refitted(found: Sequence[Found], able: Sequence[type[Effect]]) -> list[Found]:
    """Return the mixtures of every kind beside effects that are fitted to spared links alone.

    What fits all links in the mean, struck or not, fits neither, and hides that there are two
    sorts. So both are fitted in turns, from the links that are likelier struck and from the half
    that has most of the effect.
    """
    begun = [replace(one, begin=struck) for one in found for struck in (one.struck, one.half)]
    turned = [end for one in begun if (end := in_turns(one))]
    best = max((one for one in (*turned, *found) if one.divides), key=_nats, default=found[0])
    given, beside = best.mixture.given, best.mixture.beside
    others = [_found(given, [beside], kind) for kind in able if kind is not best.mixture.kind]
    return [best, *(one for one in others if one)]


def _nats(found: Found) -> float:
    return found.nats


def _alike(found: Sequence[Found], common: float) -> list[Found]:
    """Return the likeliest kind of strike and those that do about as well: forms are never right.

    What blocks a path and what weakens it do the same to many a link.
    """
    least = STRIKE_ALIKE * (found[0].nats - common)
    gap = min(least, found[0].nats - common - CLASS_NATS)
    return [one for one in found if one is found[0] or one.nats - common > gap]


def told(alike: Sequence[Found], seen: float) -> Sequence[Found]:
    """Return of the kinds that do as well those that leave straight paths, where these are seen.

    Nothing arrives before the detour where a path is blocked; where it is weakened it does.
    """
    left = _leaving(alike)
    return left if left and seen > CLASS_NATS else alike


def _leaving(found: Sequence[Found]) -> list[Found]:
    """Return the mixtures of the kinds that leave straight paths."""
    return [one for one in found if not one.mixture.kind.silent_before]


def _witnessed(made: Ensemble, found: Found, offset_m: Floats, seen: float) -> bool:
    """Return whether struck links are as an obstruction leaves them.

    Some are struck and more are not, nothing known tells which nor which read long, their ranges
    are longer than in `made`, which nothing struck, by `offset_m` [L], and those of all their rows,
    or their first paths are weak. What stands in the
    way stands near some device, so devices may tell a little; all that is known may where straight
    paths are seen (`seen` nats), for something stands there.
    """
    struck, able = found.struck, ~found.mixture.inert
    if not found.divides:
        return False
    long = read_long(offset_m, struck)
    if rows_jump(made, struck | long):
        return False
    witness = is_longer(offset_m, struck) or weak_first(found)
    if not witness or as_often_short(offset_m, struck):
        return False
    return not told_of_both(found.mixture.given, struck, long, able, seen > CLASS_NATS)


def told_of_both(
    given: Statistics,
    struck: NDArray[np.bool_],
    long: NDArray[np.bool_],
    able: NDArray[np.bool_],
    seen: bool,
) -> bool:
    """Return whether what is known tells which links are struck, and which read long [L] too.

    Where too few read long to tell which, those that waveforms find are all there is.
    """
    asked = (struck, long) if long.sum() >= STRUCK_FEWEST else (struck,)
    return all(told_which(given, which, able, seen) for which in asked)


def told_which(
    given: Statistics, struck: NDArray[np.bool_], able: NDArray[np.bool_], seen: bool
) -> bool:
    """Return whether what is known tells which of the `able` links [L] are struck.

    Devices must tell a share of it, all else only where something is `seen` to stand in the way.
    """
    least = PREDICTED_SHARE if seen else 0.0
    known, devices = but_devices(given)[able], given.devices[able]
    which = struck[able]
    return predicted(known, which, least) or predicted(devices, which, PREDICTED_SHARE)


def but_devices(given: Statistics) -> Floats:
    """Return what is known of links [L, q] but whether a device is at an end of them."""
    known, devices = given.known, given.devices
    alike = np.abs(_correlations(known, devices)).max(axis=1, initial=0.0)
    return known[:, alike < SAME_DEVICE]


def _correlations(one: Floats, other: Floats) -> Floats:
    """Return the correlations of columns [L, q] and [L, r], [q, r]; 0 of what does not vary."""
    about, beside = (each - each.mean(axis=0) for each in (one, other))
    wide = np.sqrt((about**2).sum(axis=0)[:, None] * (beside**2).sum(axis=0))
    return np.asarray(about.T @ beside / np.maximum(wide, np.finfo(float).tiny))


def predicted(known: Floats, struck: NDArray[np.bool_], least: float = 0.0) -> bool:
    """Return whether something known [L, q] tells which links [L] are struck: then it is no chance.

    By its correlation, with a correction for how many there are (Bonferroni); and whether that is
    `least` of the variance.
    """
    if not known.shape[1]:
        return False
    beside = known - known.mean(axis=0)
    mine = struck - struck.mean()
    wide = np.sqrt((beside**2).sum(axis=0) * (mine**2).sum())
    most = float((np.abs(mine @ beside) / np.maximum(wide, np.finfo(float).tiny)).max())
    z = np.sqrt(len(mine)) * most
    return bool(z > norm.isf(PREDICTED_P / (2 * known.shape[1])) and most**2 > least)


def _strike(found: Found, common: float) -> Strike:
    """Return the strike with its evidence and intervals."""
    given = found.mixture.given
    links = np.unique(given.rows.links)
    each = of_each(found.best) / given.crowding
    excess = each.sum() - (found.nats - common)
    evidence = cluster_bootstrap(each * len(each) - excess, links, 0, LIKELIHOOD)
    parameters = sizes_of(found)
    return Strike(found.effect, evidence, parameters, links[found.struck], "evidence in waveforms")
