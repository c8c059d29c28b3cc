"""The negative control of a name: what is left where its effect must do nothing.

A wall delay is zero where there is no wall. What is left there in the observable that the effect
acts on, with its unit, must be nothing, or little beside what is left elsewhere.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import norm
from scipy.stats import t as student

from bench.discrepancy.compare.crps import Estimate, cluster_bootstrap
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.settings import TIE
from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.locate.finding import Finding
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.verdict import Control
from bench.discrepancy.settings import (
    ADEQUACY_TOUCHED,
    CONTROL_QUIET,
    CONTROL_REACH,
    CONTROL_ROWS,
    RESOLUTION,
    SEARCH_FIRST,
    SEARCH_MEMBERS,
    TWO_SIDED_95,
)
from bench.physics.base import Base
from bench.physics.effect import Effect

Floats = NDArray[np.float64]


def negative_control(search: Search, others: Added, effect: Effect, top: Finding) -> Control:
    """Return what is left where the effect must vanish (a wall delay where there is no wall).

    Of a set of causes it may be nothing beyond what is left everywhere: that is another cause. This
    only excuses: what its form leaves where it acts (walls of another kind) is nothing elsewhere.
    What laws and faults of the set do has no name, but is known: a device that stands elsewhere is
    off where there is no wall, too.
    """
    words = type(effect).control
    inert = effect.inert(Base().paths(search.discover.scene))
    if inert.sum() < CONTROL_ROWS or inert.all():
        return Control(words, None)
    ensemble = search.comparison.ensemble(search.discover, others, SEARCH_MEMBERS, SEARCH_FIRST)
    of_range = effect.stage == "ranging" or effect.physics in search.choice.names
    name = RANGE if of_range else acted_on(search, ensemble, (*others, effect), top)
    if name not in ensemble.names:
        return Control(words, None)
    known = nameless_m(search) if name == RANGE else 0.0
    residual, unit = ensemble.residual_of(name) - known, ensemble.units[ensemble.place(name)]
    beyond = everywhere_left(search, others, effect, name, ~inert, known)
    for less in (0.0, beyond):
        left = residual - less
        quiet = _spread(search, left[inert], ensemble.links[inert], unit)
        passed = control_passed(quiet, float(np.nanmean(np.abs(left[~inert]))))
        if passed:
            break
    return Control(words, passed, int(inert.sum()), quiet)


def _spread(search: Search, left: Floats, links: NDArray[np.intp], unit: str) -> Estimate:
    """Return the mean of what is left [n] with the 95 % interval of `links` [n], in its unit.

    As much wider as means of links that share simulated rows scatter, and as few links say less of
    how they scatter than many (Student 1908): links drawn again scatter too little.
    """
    mean = cluster_bootstrap(left, links, search.seed, unit)
    wider = search.comparison.crowding(search.discover) * of_few(len(np.unique(links)))
    low, high = (mean.value + wider * (end - mean.value) for end in (mean.low, mean.high))
    return replace(mean, low=low, high=high)


def of_few(links: int) -> float:
    """Return how much wider a 95 % interval of the mean of so few links is than drawn again."""
    freedom = max(links - 1, 1)
    wide = float(student.isf(norm.sf(TWO_SIDED_95), freedom)) / TWO_SIDED_95
    return wide * float(np.sqrt(links / freedom))


def acted_on(search: Search, ensemble: Ensemble, added: Added, top: Finding) -> str:
    """Return the observable that `added` move beside an `ensemble` of all of them but one.

    Where most differs, unless that one moves it by little beside what it moves most: a louder cause
    leaves something there everywhere. No range but that: it hangs on a detector.
    """
    first = top.cell.observable
    made = search.comparison.ensemble(search.discover, added, SEARCH_MEMBERS, SEARCH_FIRST)
    sizes = {name: _moved(ensemble, made, name) for name in ensemble.names if name in made.names}
    able = {name: size for name, size in sizes.items() if name in {first} or name != RANGE}
    most = max(able, key=lambda name: able[name], default=first)
    return first if able.get(first, 0.0) >= ADEQUACY_TOUCHED * able.get(most, 0.0) else most


def _moved(before: Ensemble, after: Ensemble, name: str) -> float:
    """Return how far the mean of an observable moves, in scatters of simulated rows."""
    means = (one.simulated_of(name).mean(axis=0) for one in (after, before))
    moved = float(np.nanmean(np.abs(np.subtract(*means))))
    least = RESOLUTION.get(before.units[before.place(name)], 0.0) + TIE
    return moved / max(before.scatter_of(name), least) if np.isfinite(moved) else 0.0


def nameless_m(search: Search) -> Floats | float:
    """Return what the nameless causes of a set do to the ranges that are searched [n], in metres.

    0 where there are none, or where other rows than these were weighed.
    """
    shifts = [search.choice.shifts_m[one] for one in search.choice.others]
    work = search.work if shifts else None
    if work is None or len(shifts[0]) != len(work.rows):
        return 0.0
    known = dict(zip(work.rows.tolist(), np.sum(shifts, axis=0), strict=True))
    return np.array([known.get(row, 0.0) for row in search.discover.rows.tolist()])


def control_passed(quiet: Estimate, loud: float) -> bool | None:
    """Return whether nothing is left where an effect must vanish; None where chance decides.

    One in twenty 95 % intervals of true names excludes zero: that alone refuses none.
    """
    if quiet.low <= 0 <= quiet.high or abs(quiet.value) < CONTROL_QUIET * loud:
        return True
    reach = quiet.value - quiet.low if quiet.value > 0 else quiet.high - quiet.value
    return None if abs(quiet.value) < CONTROL_REACH * reach else False


def everywhere_left(
    search: Search,
    others: Added,
    effect: Effect,
    name: str,
    acts: NDArray[np.bool_],
    known: Floats | float = 0.0,
) -> float:
    """Return what an effect of a set leaves where it acts [n]; 0 for other effects.

    Beside what is `known` of rows [n] without a name: it is no part of what is left.
    """
    if effect.physics not in search.choice.names:
        return 0.0
    with_it = (*others, effect)
    made = search.comparison.ensemble(search.discover, with_it, SEARCH_MEMBERS, SEARCH_FIRST)
    return float(np.nanmedian((made.residual_of(name) - known)[acts]))


def struck_control(search: Search, others: Added, effect: Effect) -> Control:
    """Return what is left in ranges where an effect that strikes links at random strikes none.

    Of the links it spared, beyond what is left where it might have struck: that is another cause.
    It must be little beside what the effect does to ranges there, or shorter than there: where most
    links are struck that is what the effect says.
    """
    words, rows = type(effect).control, search.discover
    inert = effect.inert(Base().paths(rows.scene))
    if inert.sum() < CONTROL_ROWS or inert.all():
        return Control(words, None)
    left, struck = (
        search.comparison.ensemble(rows, added, SEARCH_MEMBERS, SEARCH_FIRST)
        for added in (others, (*others, effect))
    )
    residual = left.residual_of(RANGE)
    residual = residual - float(np.nanmedian(residual[~inert]))
    quiet = _spread(search, residual[inert], left.links[inert], "m")
    moved = struck.simulated_of(RANGE).mean(axis=0) - left.simulated_of(RANGE).mean(axis=0)
    loud = float(np.nanmean(np.abs(moved[~inert])))
    passed = quiet.value <= 0 or control_passed(quiet, loud)
    return Control(words, passed, int(inert.sum()), quiet)
