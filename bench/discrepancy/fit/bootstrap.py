"""Intervals of values per device and per level: they are estimated again on resampled links.

Basic bootstrap over links (Efron and Tibshirani 1993) around the estimate, Student's t for the
few links there are. Where values are many, of every device, links stay and their errors are drawn.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence

import numpy as np
from numpy.typing import NDArray
from scipy.stats import t as student

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added, Comparison, View, common
from bench.discrepancy.fit.clocks import STEADY, polynomial
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.headings import HEADINGS_DEG, curve_over
from bench.discrepancy.fit.heard import WARM, Heard
from bench.discrepancy.fit.least_squares import ends
from bench.discrepancy.fit.leverage import Errors, device_columns, errors_of
from bench.discrepancy.fit.per_device import KNOTS_DBM, curve_at_knots, delay_told, delays_of
from bench.discrepancy.fit.walls import delays_of_kinds
from bench.discrepancy.settings import (
    HALF_TURN_DEG,
    HEADING_BENDS,
    HEADING_STEP_DEG,
    INTERVAL_LEVEL,
    KNOT_ROWS,
    LEAST_HALF,
    LEVEL_KNOTS_DBM,
    MOVED_M,
    RESIDUAL_MEMBERS,
    VALUE_DRAWS,
)
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.fitted.device_values import beside_middle
from bench.physics.effects.fitted.pattern_curve import PatternCurve
from bench.physics.effects.fitted.power_curve import PowerCurve, at_level
from bench.physics.effects.fitted.wall_delay import WallDelay
from bench.physics.effects.propagation.antenna_pattern import heading_rad
from bench.physics.effects.ranging.range_rounding import RangeRounding
from bench.physics.slabs import crossed

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]
Values = Callable[[Rows, Floats, bool], Floats]


def latent_values(view: View, effect: Effect) -> tuple[tuple[str, ...], str, Values] | None:
    """Return names, unit and estimator of the values an effect holds, None where it holds none.

    The estimator maps rows of the view, the residual range of all rows [n] and whether physical
    bounds hold to the values. Clocks that wander have curves besides their values.
    """
    if not effect.values():
        return None
    names, estimate = ESTIMATORS.get(type(effect), _refitted)(view, effect)
    return names, type(effect).values_unit, estimate


def _refitted(view: View, effect: Effect) -> tuple[tuple[str, ...], Values]:
    """Return the values of an effect that fits them itself, fitted again on some rows."""
    names = tuple(effect.values())

    def estimate(rows: Rows, residual_m: Floats, _: bool) -> Floats:
        frame = view.frame.iloc[rows].reset_index(drop=True)
        made = type(effect).fit_values(frame, residual_m[rows])
        found = made.values() if made is not None else {}
        return np.array([found.get(name, np.nan) for name in names])

    return names, estimate


def _of_clocks(view: View, effect: Effect) -> tuple[tuple[str, ...], Values]:
    assert isinstance(effect, DeviceClock)
    own, over = _places(view, effect.devices), WARM if effect.slopes_ppm_per_c else STEADY
    heard = _heard(view)
    return tuple(effect.values()), lambda rows, left, _: (
        _offsets(view, left, rows, over) * heard(rows)
    )[own]


def _of_delays(view: View, effect: Effect) -> tuple[tuple[str, ...], Values]:
    assert isinstance(effect, DeviceDelay)
    own = _places(view, effect.devices)
    told = np.where(delay_told(view), 1.0, np.nan)  # one that is not told has no interval
    heard = _heard(view)
    return tuple(effect.values()), lambda rows, left, _: (
        delays_of(view, left, rows) * told * heard(rows)
    )[own]


def _heard(view: View) -> Callable[[Rows], Floats]:
    """Return what says 1 of the devices [D] that some rows hold, NaN of others: not told by them.

    Links drawn again leave a device of two out once in eight times, and a prior is no estimate.
    """
    names, tx, rx = ends(view)
    every = np.arange(len(names))
    return lambda rows: np.where(np.isin(every, [tx[rows], rx[rows]]), 1.0, np.nan)


def _places(view: View, devices: Sequence[str]) -> NDArray[np.intp]:
    """Return where devices stand among those of a view, which may have more than were fitted."""
    names = ends(view)[0]
    return np.array([names.index(device) for device in devices], np.intp)


def _of_levels(view: View, effect: Effect) -> tuple[tuple[str, ...], Values]:
    assert isinstance(effect, PowerCurve)
    level = effect.level_dbm(view.scene)
    names = tuple(at_level(float(knot), effect.compression) for knot in KNOTS_DBM)
    return names, lambda rows, left, bounded: _bias(level, left, rows, bounded)


def _of_headings(view: View, _: Effect) -> tuple[tuple[str, ...], Values]:
    heading = heading_rad(view.scene)
    names = tuple(f"bias_m[{heading_deg:g} deg]" for heading_deg in HEADINGS_DEG)
    return names, lambda rows, left, __: _lobes(heading, left, rows)


def _of_walls(view: View, effect: Effect) -> tuple[tuple[str, ...], Values]:
    assert isinstance(effect, WallDelay)
    walls = crossed(view.scene, effect.kinds)
    return tuple(effect.values()), lambda rows, left, _: delays_of_kinds(walls[rows], left[rows])


def _of_grids(view: View, effect: Effect) -> tuple[tuple[str, ...], Values]:
    """Return the grid of all, found again; steps of devices as they are: their ranges are on it."""
    assert isinstance(effect, RangeRounding)
    if not effect.steps_m:
        return _refitted(view, effect)
    steps_m = np.array([*effect.values().values()])
    return tuple(effect.values()), lambda _, __, ___: steps_m


# How values are estimated that are fitted by code of ours; other effects are fitted again.
ESTIMATORS: Mapping[type[Effect], Callable[[View, Effect], tuple[tuple[str, ...], Values]]] = {
    DeviceClock: _of_clocks,
    DeviceDelay: _of_delays,
    PowerCurve: _of_levels,
    PatternCurve: _of_headings,
    RangeRounding: _of_grids,
    WallDelay: _of_walls,
}


def _lobes(heading: Floats, residual_m: Floats, rows: Rows) -> Floats:
    """Return the bias at every heading in metres, NaN where hardly a row is near it.

    Its mean over the circle is zero: which constant a curve has beside it is no part of it.
    """
    turn = np.degrees(heading[rows])[:, None] - np.array(HEADINGS_DEG)
    near = (
        np.abs((turn + HALF_TURN_DEG) % (2 * HALF_TURN_DEG) - HALF_TURN_DEG) < HEADING_STEP_DEG
    ).sum(axis=0)
    curve = curve_over(heading[rows], residual_m[rows], HEADING_BENDS[0])
    return np.where(near >= KNOT_ROWS, curve - curve.mean(), np.nan)


def _offsets(view: View, residual_m: Floats, rows: Rows, over: str) -> Floats:
    """Return clock offsets in ppm beside middling ones; they go by `over` besides."""
    heard = Heard.of(view, residual_m)
    return beside_middle(polynomial(heard, rows, over, heard.with_mean).offsets_ppm)


def _bias(level: Floats, residual_m: Floats, rows: Rows, bounded: bool) -> Floats:
    """Return the bias at every knot in metres, NaN where hardly a row is near it."""
    near = (np.abs(level[rows][:, None] - KNOTS_DBM) < LEVEL_KNOTS_DBM[2]).sum(axis=0)
    curve = curve_at_knots(level[rows], residual_m[rows], falling=bounded)
    return np.where(near >= KNOT_ROWS, curve, np.nan)


def latent_intervals(
    comparison: Comparison, view: View, added: Added, effect: Effect
) -> tuple[ParameterEstimate, ...]:
    """Return the values an effect holds with 90 % intervals, none where it holds none.

    Half of the variance is that of links as they are, half that of what all links scatter by: the
    few links that tell of one level or heading may lie close by chance. Of all that it acts on:
    behind a wall links differ as walls do, in the open they do not.
    """
    found = latent_values(view, effect)
    made = residual_range(comparison, view, common(added, view), RESIDUAL_MEMBERS)
    whole = residual_range(comparison, view, common((*added, effect), view), RESIDUAL_MEMBERS)
    if found is None or made is None or whole is None:
        return ()
    names, unit, values = found
    columns = device_columns(view, effect)
    if columns is None:
        spread = _drawn_again(view, values, made[1], whole[1])
    else:
        errors = errors_of(whole[1], view.links, columns)
        spread = _of_devices(view, values, made[1] - whole[1], errors)
    centre = values(np.arange(len(made[1])), made[1], True)
    return tuple(
        ParameterEstimate(name, float(v), float(v - h), float(v + h), unit)
        for name, v, h in zip(names, centre, LEAST_HALF + spread, strict=True)
        if np.isfinite(v) and np.isfinite(h)
    )


def _drawn_again(view: View, values: Values, before: Floats, left: Floats) -> Floats:
    """Return half the width of every interval, of links drawn again.

    `before` and `left`: residual ranges [n] without and with the effect.
    """
    links, every = np.unique(view.links), np.arange(len(before))
    own = np.stack([values(rows, before, False) for rows in _resampled(view.links, links)])
    acts = np.isin(links, view.links[np.abs(before - left) > MOVED_M])
    drawn = [left[rows] for rows in _exchanged(view.links, links, acts)]
    alike = np.stack([values(every, one, False) for one in drawn])
    wide = _student(len(links) - 1) * np.sqrt(1 + 1 / (RESIDUAL_MEMBERS * view.rich))
    return np.asarray(
        _mean_spread(own, alike) * wide * np.sqrt(len(links) / max(len(links) - 1, 1))
    )


def _of_devices(view: View, values: Values, fitted_m: Floats, errors: Errors) -> Floats:
    """Return the same of many values: rows stay, and the errors of links are drawn (Wu 1986).

    Links drawn again leave devices few of their links or none, and values scatter more than they
    do; each keeps its own errors instead, with either sign, or those of another link. What
    simulated rows scatter by is in these. `fitted_m` [n] is what the values do.
    """
    links, every = np.unique(view.links), np.arange(len(fitted_m))
    code = np.searchsorted(links, view.links)
    telling = links[errors.own] if errors.own.any() else links
    others = [errors.left_m[rows] for rows in _taken(view.links, ((links, telling),))]
    signs = np.random.default_rng(2).choice([-1.0, 1.0], (VALUE_DRAWS, len(links)))
    own = np.where(errors.own[code], signs[:, code] * errors.left_m, others)
    drawn = [[values(every, fitted_m + e, False) for e in some] for some in (own, others)]
    return _mean_spread(*map(np.stack, drawn)) * _student(errors.free)


def _student(freedom: int) -> float:
    """Return how many standard deviations half an interval is."""
    return float(student.ppf((1 + INTERVAL_LEVEL) / 2, max(freedom, 1)))


def _mean_spread(one: Floats, other: Floats) -> Floats:
    """Return the root mean of two variances of every value, over draws [draws, k] each."""
    return np.asarray(np.sqrt((_spread(one) ** 2 + _spread(other) ** 2) / 2))


def _spread(draws: Floats) -> Floats:
    """Return the standard deviation of every value over draws, NaN where hardly one is known."""
    known = np.isfinite(draws).sum(axis=0) > 1
    out = np.full(draws.shape[1], np.nan)
    out[known] = np.nanstd(draws[:, known], axis=0, ddof=1)
    return out


def _resampled(codes: Rows, links: Rows) -> list[Rows]:
    """Return the rows of links drawn with replacement, `VALUE_DRAWS` times."""
    rng = np.random.default_rng(0)
    rows = {link: np.flatnonzero(codes == link) for link in links}
    return [
        np.concatenate([rows[link] for link in rng.choice(links, len(links))])
        for _ in range(VALUE_DRAWS)
    ]


def _exchanged(codes: Rows, links: Rows, acts: NDArray[np.bool_]) -> list[Rows]:
    """Return for every row one of another link's [n], one link for all rows of one.

    `VALUE_DRAWS` times: what a link keeps stays with it, whichever link it falls to. Links that an
    effect `acts` on, [L], are taken for one another, and so are those that it leaves as they are.
    """
    alike = [pool for pool in (links[acts], links[~acts]) if len(pool)]
    return _taken(codes, [(pool, pool) for pool in alike])


def _taken(codes: Rows, pools: Sequence[tuple[Rows, Rows]]) -> list[Rows]:
    """Return the same for links that take those of others: pairs of both.

    Each row once, before one comes again: the mean of a link is no surer, and no less sure, then.
    """
    rng = np.random.default_rng(1)
    rows = {link: np.flatnonzero(codes == link) for link in np.unique(codes)}
    out = []
    for _ in range(VALUE_DRAWS):
        taken = np.empty(len(codes), np.intp)
        for pool, some in pools:
            for link, other in zip(pool, rng.choice(some, len(pool)), strict=True):
                taken[rows[link]] = np.resize(rng.permutation(rows[other]), len(rows[link]))
        out.append(taken)
    return out
