"""Effects on levels beside others: they must be there, too, where the others do nothing.

A wall of the library takes another share of a level than a real one does. What that leaves looks
like any effect on levels, but only where the walls are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.stats import chisquare

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.skill import gain_interval, tally
from bench.discrepancy.compare.view import Added, View, without
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.covariates import DEVICES
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.settings import (
    MIXED_P,
    MIXED_TIMES,
    OWN_GRID_PLACES,
    ROUNDING_VARIANCE,
    USED_POINTS,
)
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.within_links import within
from bench.discrepancy.settings import (
    CONTROL_ROWS,
    FORMS_OF_MARK,
    LEAST_SCATTER_M,
    SCORE_FIRST,
    SCORE_MEMBERS,
)
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.units import Floats


def elsewhere_too(search: Search, added: Added, explanation: Explanation) -> Explanation:
    """Return the explanation without effects on levels that only act where `added` do.

    Of ranges without waveforms; where enough rows are left in which one of `added` does nothing.
    """
    if search.work is None or not added:
        return explanation
    able = tuple(c for c in explanation.contenders if _stands(search, added, c))
    able = tuple(c for c in able if beyond_marks(search, added, c.effect))
    return replace(explanation, contenders=able)


def _stands(search: Search, added: Added, contender: Contender) -> bool:
    """Return whether a contender gains where others do nothing; one that moves ranges is kept."""
    for view in without_others(search.searched, added):
        before, after = (
            search.comparison.ensemble(view, some, SCORE_MEMBERS, SCORE_FIRST)
            for some in (added, (*added, contender.effect))
        )
        if moves_ranges(after, before):
            return True
        if not gain_interval(tally(before), tally(after), search.seed).likely_above_zero:
            return False
    return True


def beyond_marks(search: Search, added: Added, scatter: Effect) -> bool:
    """Return whether scatter beside what bears a mark does more than another form of that would.

    Ranges that are rounded by chance, or twice, are off by twice the variance of those to the
    nearest step. Rows must scatter by more than that, too, beyond what simulated ones scatter by:
    wide scatter is fitted where little is.
    """
    marks = [effect for effect in added if type(effect).marked]
    if not marks or not type(scatter).independent:
        return True
    rows, others = search.searched, [(e, without(added, e)) for e in marks]
    forms = [
        max(
            _change(search, rest, e),
            own_grids_m(rows, e),
            mixed_m(rows, e),
            _used_m(search, rest, e),
        )
        for e, rest in others
    ]
    most = FORMS_OF_MARK * max(forms)
    bare = tuple(effect for effect in added if effect not in marks)
    there = _missing_m2(search, added, bare) > (FORMS_OF_MARK + 1) * max(forms) ** 2
    return there and _change(search, added, scatter) > most


def _change(search: Search, rest: Added, effect: Effect) -> float:
    """Return how far an effect moves ranges beside others, as a standard deviation in metres."""
    with_it, bare = (
        search.comparison.ensemble(search.searched, some, SCORE_MEMBERS, SCORE_FIRST)
        for some in ((*rest, effect), rest)
    )
    return float(np.nanstd(with_it.simulated_of(RANGE) - bare.simulated_of(RANGE)))


def _missing_m2(search: Search, added: Added, bare: Added) -> float:
    """Return the variance of rows about their link beside effects, less what is simulated, in m2.

    The latter of `bare` effects; infinite where no link has several rows. What simulated versions
    of a row have in common is no scatter.
    """
    made, plain = (
        search.comparison.ensemble(search.searched, some, SCORE_MEMBERS, SCORE_FIRST)
        for some in (added, bare)
    )
    versions = plain.simulated_of(RANGE)
    m = len(versions)
    own = (versions - versions.mean(axis=0)) * np.sqrt(m / max(m - 1, 1))
    values = np.concatenate([made.residual_of(RANGE)[None], own])
    recorded, simulated = within(Ensemble((RANGE,), ("m",), values[..., None], made.links))
    if not np.isfinite(recorded).any():
        return np.inf
    noise_m2 = float(np.nanmean(simulated**2)) if np.isfinite(simulated).any() else 0.0
    return float(np.nanmean(recorded**2)) - noise_m2


def _rounded(rows: View, effect: Effect) -> tuple[RangeRounding, Floats] | None:
    """Return a rounding of all and the recorded ranges [n], in metres, that it acts on, else None.

    Of devices with steps of their own all ranges lie on these: nothing is coarser.
    """
    if not isinstance(effect, RangeRounding) or not effect.step_m or effect.steps_m:
        return None
    return (effect, numeric(rows.frame, "range_m")) if "range_m" in rows.frame else None


def own_grids_m(rows: View, effect: Effect) -> float:
    """Return how far rounding moves ranges where devices have coarser steps of their own, in m.

    One grid holds all their ranges, that of the largest step that divides all of theirs. A step is
    a device's own where all its ranges lie on it, which chance hardly does; 0 for other effects.
    """
    if (found := _rounded(rows, effect)) is None:
        return 0.0
    grid, range_m = found
    place = grid.place(range_m)
    times = np.ones(len(place))
    for name, mine in rows.covariates.groups.items():
        some = place[mine][np.isfinite(place[mine])].astype(int)
        if name.startswith(DEVICES) and len(np.unique(some)) >= OWN_GRID_PLACES:
            times[mine] = np.maximum(times[mine], np.gcd.reduce(some - some[0]))
    steps_m = np.nan_to_num(times * grid.step_at(range_m), nan=grid.step_m)
    return float(np.sqrt(np.mean(steps_m**2) * ROUNDING_VARIANCE))


def mixed_m(rows: View, effect: Effect) -> float:
    """Return how far rounding moves ranges where most are rounded to a multiple of its step, in m.

    Most to the whole and some to its thirds, say: all lie on the finer grid, of which every third
    point is used more often. Places of a link count once; 0 where points are used alike.
    """
    if (found := _rounded(rows, effect)) is None:
        return 0.0
    grid, range_m = found
    place = grid.place(range_m)
    known = np.isfinite(place)
    once = np.unique(np.stack([rows.links[known], place[known].astype(int)]), axis=1)[1]
    times = next((k for k in MIXED_TIMES if _unevenly(once, k)), 0)
    return float(times * grid.step_m * np.sqrt(ROUNDING_VARIANCE))


def _unevenly(places: NDArray[np.intp], times: int) -> bool:
    """Return whether every so manieth place is used more often or less than the others."""
    counts = np.bincount(places % times, minlength=times)
    return bool(chisquare(counts).pvalue < MIXED_P) if len(places) >= times else False


def _used_m(search: Search, rest: Added, effect: Effect) -> float:
    """Return how far rounding moves ranges where few points of its grid are used (`used_m`)."""
    rows = search.searched
    if (found := _rounded(rows, effect)) is None:
        return 0.0
    made = search.comparison.ensemble(rows, (*rest, effect), SCORE_MEMBERS, SCORE_FIRST)
    simulated_m = rows.scene.true_range_m + made.simulated_of(RANGE)
    return used_m(*found, simulated_m)


def used_m(effect: RangeRounding, range_m: Floats, simulated_m: Floats) -> float:
    """Return how far rounding moves ranges where few points of its grid are used, in metres.

    Marks of a ruler that are short and long in turn, or words of a code, lie on a grid of which
    most points are none of them: recorded ranges [n] then have far fewer values than simulated ones
    [m, n], and are off by as much as from mark to mark. 0 where all points are used.
    """
    place = effect.place(range_m)
    known = np.isfinite(place) & np.isfinite(simulated_m).all(axis=0)
    used = np.unique(place[known])
    usual = [len(np.unique(effect.place(one[known]))) for one in simulated_m]
    if len(used) < 3 or len(used) >= USED_POINTS * min(usual):
        return 0.0
    gaps = np.diff(used)
    reach = (np.r_[gaps[:1], gaps] + np.r_[gaps, gaps[-1:]]) / 2
    steps_m = reach[np.searchsorted(used, place[known])] * effect.step_at(range_m[known])
    return float(np.median(steps_m) * np.sqrt(ROUNDING_VARIANCE))


def without_others(rows: View, added: Added) -> list[View]:
    """Return the links in which each effect must do nothing, where these are enough."""
    out = []
    for effect in added:
        inert = effect.inert(Base().paths(rows.scene))
        rest = rows.leaving(np.unique(rows.links[~inert]))
        if len(rest.rows) >= CONTROL_ROWS and len(rest.rows) < len(rows.rows):
            out.append(rest)
    return out


def moves_ranges(whole: Ensemble, rest: Ensemble) -> bool:
    """Return whether ranges of `whole` differ from those of `rest`, of the same replicates."""
    if RANGE not in whole.names or RANGE not in rest.names:
        return False
    change = whole.simulated_of(RANGE) - rest.simulated_of(RANGE)
    return bool(np.nanmax(np.abs(change), initial=0.0) > LEAST_SCATTER_M)
