"""Effects on levels alone beside geometry: what a level does for another reason is no second cause.

A pattern that delays a direction weakens it too, a reflection of the ground fades with the
distance, and an effect's own curve is never quite right. Each leaves a level that follows the
distance a little, and so looks like a path loss. So an effect on levels has to predict links left
out better than these can without it: any gain over headings where a pattern is named, two-ray
fading where heights are known, any level where a named effect acts, and smooth deformations of what
it does to levels. Beside a receiver's control of levels, of which every make has its own curve, it
must lead any curve that turns strong signals down.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import nnls

from bench.discrepancy.compare.view import Added, View, without
from bench.discrepancy.data.grouped import group_means
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.control_curve import fallen, own_curve_of
from bench.discrepancy.select.elsewhere import moves_ranges
from bench.discrepancy.select.receiver_logs import logs
from bench.discrepancy.select.settings import (
    CURVE_NEIGHBOURS,
    CURVE_ROWS,
    GOES_WITH_ERRORS,
    LEVEL_FOLDS,
    LEVEL_HARMONICS,
    LEVEL_LEFT,
    LEVEL_PRINTED_DB,
    LEVEL_RIDGE,
    LEVEL_SHARE,
    LOGGED_LEVELS,
)
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import locate_left
from bench.discrepancy.sets.shifted import Shifted
from bench.discrepancy.settings import FIT_MEMBERS, ONE_SIDED_95
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.propagation.antenna_pattern import AntennaPattern, heading_rad
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.two_rays import fading_ways
from bench.physics.effects.receiver.level_control import LevelControl

Floats = NDArray[np.float64]
Regression = Callable[[Floats, Floats, Floats], Floats]  # of a design, values, rows to be told
OBSTACLES, OBSTACLE = "obstacles", "obstacle="  # the column, and how its groups begin


def beyond_geometry(search: Search, added: Added, explanation: Explanation) -> Explanation:
    """Return the explanation without effects on levels that other reasons do as well as.

    Of ranges without waveforms, where levels are known.
    """
    if search.work is None or search.fit.waveform or LEVEL not in search.work.recorded.names:
        return explanation
    able = tuple(c for c in explanation.contenders if _second(search, search.work, added, c))
    return replace(explanation, contenders=able)


def calmed(search: Search, added: Added, located: Located, turn: int) -> Located:
    """Return what is located where levels may do what other forms of the named effects do.

    As it was, where ranges differ too or levels still do: only what all of these leave counts.
    """
    rows, seen = search.work, {finding.cell.observable for finding in located.findings}
    if rows is None or search.fit.waveform or not added or seen != {LEVEL}:
        return located
    left = search.comparison.ensemble(rows, added, FIT_MEMBERS).residual_of(LEVEL)
    known = np.isfinite(left)
    design = np.hstack(_reasons(search, rows, added))
    if not design.any():  # named effects do nothing to levels
        return located
    shift = np.zeros(len(left))
    shift[known] = _ridge(design[known], left[known], design[known])
    bent = replace(search, comparison=Shifted(search.comparison, shift, LEVEL))
    again = locate_left(bent, added, turn)
    if not again.significant:
        return again
    small = _missed(left[known], design[known], rows.links[known]) < LEVEL_LEFT
    small = small or float(np.sqrt(np.mean((left - shift)[known] ** 2))) < LEVEL_PRINTED_DB
    small = small or _of_a_curve(search, rows, added, left)
    return replace(again, findings=()) if small else located


def _of_a_curve(search: Search, rows: View, added: Added, left_db: Floats) -> bool:
    """Return whether a receiver's curve over the level explains what is left of levels [n].

    Of any form, steps among them: rows of other links at which as much arrives are off by as much,
    but for those beside a step.
    """
    known = next((one for one in added if one.own_curve), None)
    if known is None or not np.isfinite(left_db).all():
        return False
    arriving, read = (
        search.comparison.ensemble(rows, some, FIT_MEMBERS).simulated_of(LEVEL).mean(axis=0)
        for some in (without(added, known), added)
    )
    guess = _of_neighbours(left_db, arriving, np.unique(rows.links, return_inverse=True)[1])
    missed = left_db - np.where(read != arriving, guess, 0.0)
    after, before = (np.sort(one**2)[: int(CURVE_ROWS * len(one))] for one in (missed, left_db))
    return bool(after.sum() < LEVEL_LEFT * before.sum())


def _of_neighbours(values: Floats, over: Floats, codes: NDArray[np.intp]) -> Floats:
    """Return the mean of values [n] of the rows of left-out links next to each in `over` [n]."""
    out = np.empty_like(values)
    for fold in range(LEVEL_FOLDS):
        held = codes % LEVEL_FOLDS == fold
        apart = np.abs(over[held][:, None] - over[~held])
        near = np.argpartition(apart, CURVE_NEIGHBOURS, axis=1)[:, :CURVE_NEIGHBOURS]
        out[held] = values[~held][near].mean(axis=1)
    return out


def _missed(left_db: Floats, design: Floats, links: NDArray[np.intp]) -> float:
    """Return the share of the squares of levels [n] that a design leaves on links left out."""
    missed = _left_out(left_db, design, np.unique(links, return_inverse=True)[1])
    return float((missed**2).sum() / max(float((left_db**2).sum()), 1e-12))


def _second(search: Search, rows: View, added: Added, contender: Contender) -> bool:
    """Return whether a contender is more than levels do anyhow; True where it moves ranges."""
    effect = contender.effect
    bare, whole = (
        search.comparison.ensemble(rows, some, FIT_MEMBERS) for some in (added, (*added, effect))
    )
    if LEVEL not in bare.names or LEVEL not in whole.names or moves_ranges(whole, bare):
        return True
    change = (whole.simulated_of(LEVEL) - bare.simulated_of(LEVEL)).mean(axis=0)
    left = bare.residual_of(LEVEL)
    known = np.isfinite(change) & np.isfinite(left)
    if type(effect).independent or not known.any() or not np.ptp(change[known]) > 0:
        return True
    others = np.hstack([np.ones((len(left), 1)), *_reasons(search, rows, added, effect)])
    return predicts(left[known], change[known], others[known], rows.links[known]) and (
        _beyond_control(search, rows, added, effect)
    )


def _beyond_control(search: Search, rows: View, added: Added, effect: Effect) -> bool:
    """Return whether an effect predicts levels beside any curve of a control among `added`.

    A control turns signals down, the stronger the more: what is read falls behind what arrives. No
    curve of it makes levels fall faster than they do, and whatever they fall slower by may be its.
    """
    control = next((one for one in added if one.physics == LevelControl.name), None)
    if control is None:
        return True
    if _lone_curve(search, rows, added, control):
        return _beyond_own_curve(search, without(added, control), effect)
    rest, acts = without(added, control), np.any(_deformed(search, rows, added, control), axis=1)
    bare, whole = (
        search.comparison.ensemble(rows, some, FIT_MEMBERS) for some in (rest, (*rest, effect))
    )
    arriving, moved = (one.simulated_of(LEVEL).mean(axis=0) for one in (bare, whole))
    left, change = bare.residual_of(LEVEL), (moved - arriving)[:, None]
    known = np.isfinite(left) & np.isfinite(change[:, 0])
    curve = np.hstack([_either_sign(np.ones_like(change)), -_over_levels(arriving, acts)])[known]
    both = np.hstack([curve, _either_sign(change)[known]])
    codes = np.unique(rows.links[known], return_inverse=True)[1]
    after, before = (_squares(left[known], one, codes, _turned_down) for one in (both, curve))
    return _better(after, before)


def _lone_curve(search: Search, rows: View, added: Added, known: Effect) -> bool:
    """Return whether an effect is a control's own curve and nothing else that is named acts there.

    What other names leave of levels, as their forms are not quite right, is in its curve too.
    """
    if not own_curve_of(known):
        return False
    others = (one for one in added if one is not known)
    return not any(_deformed(search, rows, added, one).any() for one in others)


def _beyond_own_curve(search: Search, others: Added, effect: Effect) -> bool:
    """Return whether levels are nearer to a receiver's curve and an effect than to its curve alone.

    Of any form, that takes nothing where all symbols are accumulated; of links left out.
    """
    seen = logs(search, search.sharpest)
    before, after = (fallen(search, seen, some) for some in (others, (*others, effect)))
    if before is None or after is None:
        return True
    return _better(*(_by_links(one.missed_db, one.codes) for one in (after, before)))


def _by_links(missed_db: Floats, codes: NDArray[np.intp]) -> Floats:
    """Return the sum of the squares of what is missed of levels [n], by link [L]."""
    return np.asarray(np.bincount(codes, missed_db**2), np.float64)


def _either_sign(columns: Floats) -> Floats:
    """Return columns [n, k] with their negatives, [n, 2 k], for factors that are not negative."""
    return np.hstack([columns, -columns])


def _turned_down(design: Floats, values: Floats, wanted: Floats) -> Floats:
    """Return what a ridge regression with no factor below zero says of `wanted` rows [m, k]."""
    size = np.sqrt((design**2).mean(axis=0))
    design, wanted = (one[:, size > 0] / size[size > 0] for one in (design, wanted))
    small = np.sqrt(LEVEL_RIDGE * len(design)) * np.eye(design.shape[1])
    nothing = np.zeros(design.shape[1])
    return np.asarray(wanted @ nnls(np.vstack([design, small]), np.r_[values, nothing])[0])


def _reasons(
    search: Search, rows: View, added: Added, effect: Effect | None = None
) -> list[Floats]:
    """Return what else levels may do beside an effect, columns [n, k] each."""
    ground = any(one.physics == GroundBounce.name for one in added)
    fades = ground if effect is None else effect.physics != GroundBounce.name
    out = [fading_ways(rows.scene, ground)] if fades else []
    paths = Base().paths(rows.scene)
    for known in added:
        if known.physics == AntennaPattern.name:
            out.append(harmonics(heading_rad(rows.scene)))
        if effect is not None and _lone_curve(search, rows, added, known):
            continue  # it has any form already: see `_beyond_control`
        acts, bent = ~known.inert(paths), _deformed(search, rows, added, known)
        if effect is None and known.physics == LevelControl.name:
            arriving = search.comparison.ensemble(rows, without(added, known), FIT_MEMBERS)
            level = arriving.simulated_of(LEVEL).mean(axis=0)  # recorded ones hold what is asked
            out.append(_over_levels(level, np.any(bent != 0, axis=1)))
        if bent.any() and not acts.all():
            out.append(acts[:, None].astype(np.float64))
        if any(OBSTACLES in way for way in known.needs):
            kinds = rows.covariates.groups.items()
            out += [mask[:, None].astype(np.float64) for n, mask in kinds if n.startswith(OBSTACLE)]
        out.append(bent)
    return out


def harmonics(turn: Floats) -> Floats:
    """Return the waves of a gain over headings [n], 0 where these are not known."""
    orders = np.arange(1, LEVEL_HARMONICS + 1) * turn[:, None]
    return np.asarray(np.nan_to_num(np.hstack([np.sin(orders), np.cos(orders)])))


def _over_levels(level_dbm: Floats, acts: NDArray[np.bool_]) -> Floats:
    """Return what a receiver may make of levels [n]: slopes and steps of a curve, where it acts.

    A control of levels is a curve over the level, whatever its form, and nothing below its start.
    """
    known = acts & np.isfinite(level_dbm)
    if not known.any():
        return np.zeros((len(level_dbm), 0))
    over = np.nan_to_num(level_dbm)[:, None] - np.quantile(level_dbm[known], LOGGED_LEVELS)
    return np.asarray(np.hstack([np.maximum(over, 0), over > 0]) * known[:, None])


def _deformed(search: Search, rows: View, added: Added, known: Effect) -> Floats:
    """Return what an effect does to levels, as it is and bent over itself and the distance."""
    whole, rest = (
        search.comparison.ensemble(rows, some, FIT_MEMBERS)
        for some in (added, without(added, known))
    )
    if LEVEL not in whole.names or LEVEL not in rest.names:
        return np.zeros((len(rows.rows), 0))
    change = np.nan_to_num((whole.simulated_of(LEVEL) - rest.simulated_of(LEVEL)).mean(axis=0))
    far = np.log(np.maximum(rows.scene.true_range_m, 0.1))
    far = (far - far.mean()) / max(float(far.std()), 1e-9)
    return np.stack([change, change**2, change * far, change * far**2], axis=1)


def predicts(left_db: Floats, change_db: Floats, others: Floats, links: NDArray[np.intp]) -> bool:
    """Return whether a change [n] predicts levels [n] of links left out as `others` [n, k] do not.

    Beside them, or alone as well as all of these do, which are many. More than so many decibel in
    all rows in any case: as links left out say, or how surely levels of links go with it.
    """
    codes = np.unique(links, return_inverse=True)[1]
    flat = np.ones((len(left_db), 1))
    designs = flat, np.column_stack([flat, change_db]), others, np.column_stack([others, change_db])
    nothing, single, many, both = (_squares(left_db, design, codes) for design in designs)
    fewer = float(single.sum()) < (1 - LEVEL_SHARE) * float(nothing.sum())
    alone = _better(single, nothing) or (fewer and _goes_with(left_db, change_db, codes))
    if not _better(many, nothing):  # what explains nothing is no rival
        return alone
    return (alone and float(single.sum()) <= float(many.sum())) or _better(both, many)


def _goes_with(left_db: Floats, change_db: Floats, codes: NDArray[np.intp]) -> bool:
    """Return whether mean levels of links surely go with a change [n], beside a constant."""
    both = group_means(np.column_stack([left_db, change_db]), codes)
    left, change = both[np.unique(codes, return_index=True)[1]].T
    freedom = len(left) - 2
    if freedom < 1 or not np.ptp(change) > 0:
        return False
    alike = abs(float(np.corrcoef(left, change)[0, 1]))
    return alike > GOES_WITH_ERRORS / float(np.sqrt(freedom + GOES_WITH_ERRORS**2))


def _better(after: Floats, before: Floats) -> bool:
    """Return whether squares per link [L] fall by a share that matters, beyond doubt."""
    gained = before - after
    error = float(gained.std()) * np.sqrt(len(gained))
    worth = float(gained.sum()) > LEVEL_SHARE * float(before.sum())
    return bool(worth and float(gained.sum()) > ONE_SIDED_95 * error)


def _ridge(design: Floats, values: Floats, wanted: Floats) -> Floats:
    """Return what a ridge regression on `design` [n, k] says of `wanted` rows [m, k]."""
    size = np.sqrt((design**2).mean(axis=0))
    design, wanted = (one[:, size > 0] / size[size > 0] for one in (design, wanted))
    square = design.T @ design + LEVEL_RIDGE * len(design) * np.eye(design.shape[1])
    return np.asarray(wanted @ np.linalg.solve(square, design.T @ values))


def _left_out(
    values: Floats, design: Floats, codes: NDArray[np.intp], fit: Regression = _ridge
) -> Floats:
    """Return what regressions [n, k] on other links leave of values [n]."""
    out = np.empty_like(values)
    for fold in range(LEVEL_FOLDS):
        held = codes % LEVEL_FOLDS == fold
        out[held] = values[held] - fit(design[~held], values[~held], design[held])
    return out


def _squares(
    values: Floats, design: Floats, codes: NDArray[np.intp], fit: Regression = _ridge
) -> Floats:
    """Return the squares that regressions on other links leave of values [n], by link [L]."""
    return _by_links(_left_out(values, design, codes, fit), codes)
