"""How much ranges of one link scatter beyond simulated ones: the size of independent scatter.

A score of few simulated rows hardly tells it: both sides then scatter. The variance within links
does, whatever the shape of what the simulator scatters by.
"""

from __future__ import annotations

import numpy as np
from scipy.optimize import nnls

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.table import TableComparison
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select.own_draws import once, rows_of_their_own
from bench.discrepancy.select.scatter_shape import alike
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import borrows
from bench.discrepancy.select.within_links import within
from bench.discrepancy.settings import (
    CENTRAL_90,
    FIT_MEMBERS,
    GAIN_DRAWS,
    LEAST_SCATTER_M,
    LEAST_VARIATION,
    OFFSET_FIRST,
    SEARCH_FIRST,
    SEARCH_MEMBERS,
)
from bench.physics.effect import Effect
from bench.physics.units import Floats

Sized = tuple[Effect, tuple[ParameterEstimate, ...]]


def with_sizes(search: Search, added: Added) -> Added:
    """Return the effects, independent scatter among them as wide as rows of links say."""
    made = [sized_scatter(search, without(added, one), one) for one in added]
    return tuple(new[0] if new else one for one, new in zip(added, made, strict=True))


def told_by_rows(
    search: Search, others: Added, effect: Effect, fitted: tuple[ParameterEstimate, ...]
) -> tuple[ParameterEstimate, ...]:
    """Return the intervals of an effect: those of its fit, or of its size as rows of links say."""
    made = sized_scatter(search, others, effect)
    return made[1] if made else fitted


def sized_scatter(search: Search, others: Added, effect: Effect) -> Sized | None:
    """Return independent scatter beside other effects as rows of links say, None without.

    Of ranges alone, and only where what is left has the shape of simulated scatter: else a share of
    wide rows may be there, which a fit has to find.
    """
    kind = type(effect)
    if not kind.independent or kind.marked or search.work is None or search.fit.waveform:
        return None
    made, recorded, simulated = beside_simulated(search, others)
    usable = np.isfinite(recorded)
    if not usable.any() or not np.isfinite(simulated).any():
        return None
    if variances(recorded, simulated)[1] <= 0:
        return None
    if not alike(recorded[usable], simulated[np.isfinite(simulated)]):
        return None
    return sized(search, others, kind, extras(made, recorded, simulated))


def beside_simulated(search: Search, added: Added) -> tuple[Ensemble, Floats, Floats]:
    """Return the versions of the working rows, and how far ranges lie from their link.

    Recorded [n] and simulated [m, n], in metres. Where rows have several simulated ones of their
    own, beside the mean of these: what effects do to all versions alike is no scatter. Simulated
    rows as far off as they would be at the recorded levels.
    """
    assert search.work is not None
    comparison, rows = search.comparison, search.work
    whole = comparison.ensemble(rows, added, SEARCH_MEMBERS, SEARCH_FIRST)
    own, each = comparison.distinct(rows), rows_of_their_own(comparison, rows)
    borrowed = not each and borrows(whole, own)
    made = whole.beside(own) if borrowed else whole.first(own)
    if RANGE not in made.names:
        return made, *_nothing()
    begin = 1 + own * borrowed  # of what stands beside the recorded version
    level_db = _levels(search, whole)[[0, *range(begin, begin + len(made.simulated))]]
    if not each:
        recorded, simulated = within(made, once(comparison, rows, len(made.simulated)))
        return made, recorded, as_here(simulated, level_db)
    recorded, simulated = within(_beside_mean(made))
    return made, recorded, as_here(simulated, level_db)


def _beside_mean(made: Ensemble) -> Ensemble:
    """Return ranges alone, all versions beside the mean simulated where there are several."""
    values = made.versions_of(RANGE).copy()
    m = len(values) - 1
    if m > 1:
        values -= values[1:].mean(axis=0)
        values[1:] *= np.sqrt((m + 1) / (m - 1))  # as far as a new one is
    return Ensemble((RANGE,), ("m",), values[..., None], made.links)


def _levels(search: Search, made: Ensemble) -> Floats:
    """Return the levels of all versions [1 + m, n] at which ranges scattered, NaN without, in dBm.

    Matched rows of a table have theirs, wherever they were moved to: their errors scatter as there.
    """
    comparison, rows = search.comparison, search.work
    if LEVEL not in made.names or rows is None:
        return np.full(made.versions.shape[:2], np.nan)
    levels = made.versions_of(LEVEL).copy()
    if isinstance(comparison, TableComparison):
        bare = comparison.ensemble(rows, (), SEARCH_MEMBERS, SEARCH_FIRST).simulated_of(LEVEL)
        picks, own = comparison.versions(rows), numeric(comparison.frame, LEVEL)
        levels[1:] += [own[picks[i % len(picks)]] for i in range(len(bare))] - bare
    return levels


def as_here(simulated_m: Floats, level_dbm: Floats) -> Floats:
    """Return how far simulated ranges [m, n] would lie from their link at the recorded levels.

    Edges of weak signals scatter more (Kay 1993, section 3.11): the variance is a line over one
    over the power, as simulated rows have it. Of `level_dbm` [1 + m, n] the first are recorded
    ones, which count as no weaker or stronger than any that was simulated.
    """
    known = np.isfinite(simulated_m) & np.isfinite(level_dbm).all(axis=0)
    if not known.any() or np.ptp(level_dbm[1:][known]) < LEAST_VARIATION:
        return simulated_m
    theirs = level_dbm[1:]
    ours = np.clip(level_dbm[0], theirs[known].min(), theirs[known].max())
    there, here = (10 ** ((theirs[known].min() - one) / 10) for one in (theirs, ours))
    ways = np.stack([np.ones(known.sum()), there[known]], axis=1)
    even, weak = nnls(ways, simulated_m[known] ** 2)[0]
    wider = (even + weak * here) / np.maximum(even + weak * there, LEAST_SCATTER_M**2)
    return np.asarray(np.where(known, simulated_m * np.sqrt(wider), simulated_m))


def _nothing() -> tuple[Floats, Floats]:
    return np.empty(0), np.empty((0, 0))


def variances(recorded: Floats, simulated: Floats) -> tuple[float, float]:
    """Return the simulated variance within links, and how much more the recorded one is, in m2."""
    spread = float(np.nanmean(simulated**2)) if np.isfinite(simulated).any() else np.inf
    return spread, float(np.nanmean(recorded**2)) - spread


def extras(made: Ensemble, recorded: Floats, simulated: Floats) -> Floats:
    """Return the variance that is missing, in m2: as found, then of links drawn again."""
    code = np.unique(made.links, return_inverse=True)[1]
    rng = np.random.default_rng(0)
    links = int(code.max()) + 1
    often = [np.ones(links), *(np.bincount(rng.integers(0, links, links), minlength=links)
                               for _ in range(GAIN_DRAWS))]  # fmt: skip
    own = np.nan_to_num(recorded**2)
    theirs = np.nan_to_num(simulated**2).mean(axis=0)  # a row is known in all versions, or in none
    known = np.isfinite(recorded) * 1.0
    sums = [np.bincount(code, one, links) for one in (own - theirs, known)]
    weights = np.stack(often)
    return np.maximum((weights @ sums[0]) / np.maximum(weights @ sums[1], 1.0), 0.0)


def sized(search: Search, added: Added, kind: type[Effect], extras_m2: Floats) -> Sized:
    """Return the effect that adds a variance, with the interval of its size.

    `extras_m2`: the variance, then as links drawn again say. Variance goes with a size squared; it
    comes on top of what the simulator scatters by the same effect already.
    """
    assert search.work is not None
    item = next(p for p in kind.parameters() if p.null is not None and p.fitted)
    have = _simulated(search, kind, item.name)
    more = kind.from_values({item.name: have + item.default})
    made, bare = (
        search.comparison.ensemble(search.work, some, FIT_MEMBERS, OFFSET_FIRST)
        for some in ((*added, more), added)
    )
    moved = float(np.nanvar(made.simulated_of(RANGE) - bare.simulated_of(RANGE)))
    sizes = np.sqrt(have**2 + item.default**2 * extras_m2 / max(moved, 1e-12))
    size = float(np.clip(sizes[0], item.low, item.high))
    low, high = np.clip(np.percentile(sizes[1:], CENTRAL_90), item.low, item.high)
    bound = size >= item.high
    told = ParameterEstimate(item.name, size, float(low), float(high), item.unit, bound)
    return kind.from_values({item.name: size}), (told,)


def _simulated(search: Search, kind: type[Effect], name: str) -> float:
    """Return the size at which the simulator has an effect already, 0 where it has not."""
    simulator = getattr(search.comparison, "simulator", None)
    have = [one for one in getattr(simulator, "effects", ()) if one.physics == kind.name]
    return float(getattr(have[0], name)) if have else 0.0
