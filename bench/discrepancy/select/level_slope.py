"""What a path loss does, as levels of links say: a line over the logarithm of the distance.

Shadowing is kept by a link, so links count, not rows; a score of a few simulated rows, some of
them of other links, tells neither the slope as sharply nor how sure it is. What is absorbed all
along the way bends that line: so many dB are lost in every metre.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import t as student

from bench.discrepancy.compare.matching import link_means
from bench.discrepancy.compare.settings import SLOPE_LINKS
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.link_line import link_line, link_plane
from bench.discrepancy.fit.sandwich import estimated
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.settings import NAME_NATS
from bench.discrepancy.settings import (
    FIT_MEMBERS,
    INTERVAL_LEVEL,
    MAD_TO_STD,
    RESOLUTION,
    SEARCH_FIRST,
)
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.units import Floats

Told = tuple[ParameterEstimate, ...]
LINE = ("exponent", "offset_db")


def with_slope(search: Search, added: Added) -> Added:
    """Return the effects, a path loss among them as levels of links say."""
    added = with_absorption(search, added)
    return tuple(_as_told(one, told_by_links(search, without(added, one), one)) for one in added)


def told_by_links(search: Search, others: Added, effect: Effect, fitted: Told = ()) -> Told:
    """Return the intervals of an effect: exponent and offset of a path loss as links say.

    `fitted` are those of its fit, which stay for all else.
    """
    if not isinstance(effect, PathLoss) or (seen := _seen(search, others)) is None:
        return fitted
    (offset, slope), halves = _line(search, seen, effect.per_metre_db)
    free = {p.name: p for p in type(effect).parameters()}
    null = float(free["exponent"].null or 0.0)
    values = {"exponent": null - slope, "offset_db": -offset, "per_metre_db": effect.per_metre_db}
    if not all(free[name].low < values[name] < free[name].high for name in LINE):
        return fitted
    named = LINE + (("per_metre_db",) if effect.per_metre_db else ())
    told = (estimated(free[name], values[name], halves[name]) for name in named)
    return (*told, *(one for one in fitted if one.name not in named))


def _as_told(effect: Effect, told: Told) -> Effect:
    """Return an effect with the values that are told."""
    return replace(effect, **{one.name: one.value for one in told}) if told else effect


def with_absorption(search: Search, added: Added) -> Added:
    """Return the effects, of a path loss among them what it loses in every metre besides.

    Where levels of links speak for it beside the line, within the bounds of an exponent. What was
    taken for shadowing because no line bends is none.
    """
    return tuple(_absorbing(search, without(added, one), one) for one in added)


def _absorbing(search: Search, others: Added, effect: Effect) -> Effect:
    if not isinstance(effect, PathLoss) or (seen := _seen(search, others)) is None:
        return effect
    per_metre_db, left_db = absorbed(*seen)
    if not per_metre_db:
        return effect
    shadowing = min(effect.shadowing_db, MAD_TO_STD * float(np.median(np.abs(left_db))))
    bent = replace(effect, per_metre_db=per_metre_db, shadowing_db=shadowing)
    told = told_by_links(search, others, bent)
    return _as_told(bent, told) if told else effect


def absorbed(far_m: Floats, left_db: Floats) -> tuple[float, Floats]:
    """Return the dB that levels [L] lose in every metre beside a line, and what that leaves [L].

    0 where that does not lead the best line by what a name must bring; Laplace's law, as a few
    links stand behind obstacles. Beside it levels fall as in free space, or faster: a curve tells
    little more than one of both.
    """
    x = _over_logarithm(far_m)

    def beside(per_metre_db: float) -> Floats:
        y = left_db + per_metre_db * far_m
        fall = min(float(link_line(x, y)[0][1]), 0.0)
        return np.asarray(y - fall * x - np.median(y - fall * x))

    def spread(left: Floats) -> float:
        return max(float(np.mean(np.abs(left))), RESOLUTION["dB"])

    most = next(p.high for p in PathLoss.parameters() if p.name == "per_metre_db")
    found = minimize_scalar(lambda one: spread(beside(one)), bounds=(0.0, most), method="bounded")
    offset, slope = link_line(x, left_db)[0]
    line = np.asarray(left_db - offset - slope * x)
    sure = len(x) * float(np.log(spread(line) / spread(beside(found.x)))) >= NAME_NATS
    return (float(found.x), beside(found.x)) if sure else (0.0, line)


def _over_logarithm(far_m: Floats) -> Floats:
    return np.asarray(10 * np.log10(far_m))


def _line(
    search: Search, seen: tuple[Floats, Floats], per_metre_db: float
) -> tuple[Floats, dict[str, float]]:
    """Return the line of levels of links `seen` over 10 log10 distance, beside a loss per metre.

    In dB at 1 m and per unit of the exponent, [2], and half of the 90 % interval by parameter: a
    loss per metre bends much as an exponent does, so that each is as unsure as both leave it.
    """
    (far_m, left_db), rows, comparison = seen, search.sharpest, search.comparison
    x, free = _over_logarithm(far_m), left_db + per_metre_db * far_m
    found, spread = link_line(x, free)
    if per_metre_db:
        _, spread = link_plane(np.stack([np.ones(len(x)), x, far_m], axis=1), left_db)
    # Rows without simulated ones of their own share those of other links.
    more = 1.0 if comparison.paired(rows) else comparison.crowding(rows)
    wide = more * float(student.ppf((1 + INTERVAL_LEVEL) / 2, len(far_m) - len(spread)))
    halves = wide * np.sqrt(np.diag(spread))
    names = ("offset_db", "exponent", "per_metre_db")
    return found, dict(zip(names, map(float, halves), strict=False))


def _seen(search: Search, others: Added) -> tuple[Floats, Floats] | None:
    """Return distances in m and recorded less simulated levels in dB, by link [L]; None without.

    Beside a curve of a receiver's own levels do not add up.
    """
    rows, comparison = search.sharpest, search.comparison
    if rows.waveform or any(one.own_curve for one in others):
        return None
    made = comparison.ensemble(rows, others, FIT_MEMBERS, SEARCH_FIRST)
    if LEVEL not in made.names or "true_range_m" not in rows.frame:
        return None
    left = made.first(comparison.distinct(rows)).residual_of(LEVEL)
    far = np.maximum(np.asarray(rows.scene.true_range_m, np.float64), 0.05)
    known = np.isfinite(left) & np.isfinite(far)
    far_m, left_db = (link_means(one[known], rows.links[known]) for one in (far, left))
    enough = len(far_m) >= SLOPE_LINKS and np.ptp(far_m) > 0
    return (far_m, left_db) if enough else None
