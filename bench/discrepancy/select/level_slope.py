"""What a path loss does, as levels of links say: a line over the logarithm of the distance.

Shadowing is kept by a link, so links count, not rows; a score of a few simulated rows, some of
them of other links, tells neither the slope as sharply nor how sure it is.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from scipy.stats import t as student

from bench.discrepancy.compare.matching import link_means
from bench.discrepancy.compare.settings import SLOPE_LINKS
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.link_line import link_line
from bench.discrepancy.fit.sandwich import estimated
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import FIT_MEMBERS, INTERVAL_LEVEL, SEARCH_FIRST
from bench.physics.effect import Effect
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.units import Floats

Told = tuple[ParameterEstimate, ...]


def with_slope(search: Search, added: Added) -> Added:
    """Return the effects, a path loss among them as levels of links say."""
    return tuple(_as_told(one, told_by_links(search, without(added, one), one)) for one in added)


def told_by_links(search: Search, others: Added, effect: Effect, fitted: Told = ()) -> Told:
    """Return the intervals of an effect: exponent and offset of a path loss as links say.

    `fitted` are those of its fit, which stay for all else.
    """
    line = _line(search, others) if isinstance(effect, PathLoss) else None
    if line is None:
        return fitted
    (offset, slope), halves = line
    kept = tuple(one for one in fitted if one.name not in ("exponent", "offset_db"))
    free = {p.name: p for p in type(effect).parameters()}
    null = float(free["exponent"].null or 0.0)
    values = {"exponent": null - slope, "offset_db": -offset}
    if not all(free[name].low < value < free[name].high for name, value in values.items()):
        return fitted
    sized = zip(values.items(), (halves[1], halves[0]), strict=True)
    return (*(estimated(free[name], value, float(half)) for (name, value), half in sized), *kept)


def _as_told(effect: Effect, told: Told) -> Effect:
    """Return an effect with the values that are told."""
    return replace(effect, **{one.name: one.value for one in told}) if told else effect


def _line(search: Search, others: Added) -> tuple[Floats, Floats] | None:
    """Return the line of recorded less simulated levels over 10 log10 distance, None without.

    In dB at 1 m and per unit of the exponent, [2], and half of their 90 % intervals [2]. Beside a
    curve of a receiver's own levels do not add up.
    """
    rows, comparison = search.sharpest, search.comparison
    if rows.waveform or any(one.own_curve for one in others):
        return None
    made = comparison.ensemble(rows, others, FIT_MEMBERS, SEARCH_FIRST)
    if LEVEL not in made.names or "true_range_m" not in rows.frame:
        return None
    left = made.first(comparison.distinct(rows)).residual_of(LEVEL)
    far = 10 * np.log10(np.maximum(np.asarray(rows.scene.true_range_m, np.float64), 0.05))
    known = np.isfinite(left) & np.isfinite(far)
    links = rows.links[known]
    x, y = (link_means(one[known], links) for one in (far, left))
    if len(x) < SLOPE_LINKS or not np.ptp(x) > 0:
        return None
    found, spread = link_line(x, y)
    # Rows without simulated ones of their own share those of other links.
    more = 1.0 if comparison.paired(rows) else comparison.crowding(rows)
    wide = more * float(student.ppf((1 + INTERVAL_LEVEL) / 2, len(x) - 2))
    return found, np.asarray(wide * np.sqrt(np.diag(spread)), np.float64)
