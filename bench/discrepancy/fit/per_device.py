"""Values per device from residual ranges, by robust least squares: clocks and antenna delays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import lsq_linear
from scipy.sparse import csr_array

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added, Comparison, View, common
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.grouped import in_several
from bench.discrepancy.fit.clocks import device_clock
from bench.discrepancy.fit.ground import ground_ray
from bench.discrepancy.fit.headings import pattern_curve
from bench.discrepancy.fit.least_squares import ends, incidence, robust
from bench.discrepancy.fit.settings import BEYOND_CURVE_DB, BEYOND_CURVE_SHARE
from bench.discrepancy.fit.walls import wall_delay
from bench.discrepancy.settings import (
    BUDGET_AT_1M_DBM,
    BUDGET_SPREADS_DB,
    DELAY_PRIOR_NS,
    LEVEL_BEND,
    LEVEL_KNOTS_DBM,
    LEVEL_KNOWN_SHARE,
    LEVEL_WEAK_ROWS,
    LONGEST_DELAY_NS,
    MAD_TO_STD,
    MOST_LEVEL_BIAS_M,
    RESIDUAL_MEMBERS,
    STEEPEST_M_PER_KNOT,
    UNCOMPRESSED_DBM,
)
from bench.errors import BenchError
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.effects.fitted.ground_ray import GroundRay
from bench.physics.effects.fitted.pattern_curve import PatternCurve
from bench.physics.effects.fitted.power_curve import LOGGED_DBM, TRUE_DBM, PowerCurve
from bench.physics.effects.fitted.wall_delay import WallDelay
from bench.physics.units import C_M_PER_NS

Floats = NDArray[np.float64]


OWN = (  # by code here
    "device-clock",
    "device-delay",
    "power-curve",
    "pattern-curve",
    "ground-ray",
    "wall-delay",
)


def latent_effects(
    comparison: Comparison, view: View, added: Added, physics: str = ""
) -> list[Effect]:
    """Return the effects of ours with values per device or level that the rows support.

    With `physics` only those that stand for it.
    """
    fits = {
        PowerCurve.explains: power_curve,
        PatternCurve.explains: pattern_curve,
        GroundRay.explains: ground_ray,
        WallDelay.explains: wall_delay,
    }
    wanted = [one for name, one in fits.items() if physics in ("", name)]
    curves = [one for fitted in wanted if (one := fitted(comparison, view, added))]
    terms = [] if physics in fits else device_terms(comparison, view, added)
    return [*(one for one in terms if physics in ("", one.physics)), *curves]


def fits_itself(kind: type[Effect]) -> bool:
    """Return whether an effect holds values that it fits itself (see `Effect.fit_values`)."""
    return bool(kind.values_unit) and kind.name not in OWN


def with_values(
    comparison: Comparison, view: View, added: Added, kind: type[Effect]
) -> Effect | None:
    """Return an effect with its values fitted to the rows, None where they support none.

    Raises BenchError where it fails.
    """
    if not fits_itself(kind):
        own = latent_effects(comparison, view, added, kind.explains)
        return next((effect for effect in own if effect.name == kind.name), None)
    made = residual_range(comparison, view, common(added, view), RESIDUAL_MEMBERS)
    if made is None:
        return None
    try:
        return kind.fit_values(view.frame, made[1])
    except Exception as problem:
        raise BenchError(f"effect {kind.name!r} failed to fit its values: {problem}") from problem


def device_terms(comparison: Comparison, view: View, added: Added) -> list[Effect]:
    """Return the device effects that the residual range of the rows supports, none without ids."""
    if "tx" not in view.frame or "rx" not in view.frame:
        return []
    made = residual_range(comparison, view, common(added, view), RESIDUAL_MEMBERS)
    if made is None:
        return []
    residual = made[1]
    out: list[Effect] = []
    if np.nanmax(numeric(view.frame, "reply_time_s"), initial=0) > 0:
        out.append(device_clock(view, residual))
    delay = device_delay(view, residual)
    return [*out, delay] if delay else out


KNOTS_DBM = np.arange(*LEVEL_KNOTS_DBM)


def power_curve(comparison: Comparison, view: View, added: Added) -> PowerCurve | None:
    """Return the bias curve over receive level that fits the residual range of the rows.

    The budget's level at 1 m and its scatter come from the logged levels that are not compressed.
    The curve is piecewise linear with small second differences. None where no level was logged.
    """
    made = residual_range(comparison, view, common(added, view), RESIDUAL_MEMBERS)
    logged = numeric(view.frame, "rx_power_dbm")
    weak = logged < UNCOMPRESSED_DBM
    if (
        made is None
        or np.isfinite(logged).mean() < LEVEL_KNOWN_SHARE
        or weak.sum() < LEVEL_WEAK_ROWS
    ):
        return None
    loss_db = 20 * np.log10(view.scene.true_range_m)
    compression = _compression(logged)
    at_1m = np.interp(logged[weak], LOGGED_DBM, TRUE_DBM) if compression else logged[weak]
    at_1m = at_1m + loss_db[weak]
    spread = float(
        np.clip(
            MAD_TO_STD * np.median(np.abs(at_1m - np.median(at_1m))),
            BUDGET_SPREADS_DB[0],
            BUDGET_SPREADS_DB[2],
        )
    )
    budget = float(np.clip(np.median(at_1m), *BUDGET_AT_1M_DBM))
    residual = made[1]
    fits = [
        _curve(view, residual, PowerCurve((), (), budget, s, compression))
        for s in sorted({BUDGET_SPREADS_DB[0], min(BUDGET_SPREADS_DB[1], spread), spread})
    ]
    return min(fits, key=lambda fit: fit[1])[0]


def _compression(logged: Floats) -> float:
    """Return 0 where levels [n] are logged as they arrive, 1 where the stronger ones are too low.

    Of what a DW1000 logs hardly anything is above the end of its curve, however near devices are.
    """
    known = logged[np.isfinite(logged)]
    return float((known > LOGGED_DBM[-1] + BEYOND_CURVE_DB).mean() <= BEYOND_CURVE_SHARE)


def _curve(view: View, residual: Floats, start: PowerCurve) -> tuple[PowerCurve, float]:
    """Return the curve for one trust in the budget, and the mean |residual| it leaves."""
    level = start.level_dbm(view.scene)
    bias = _bounded(curve_at_knots(level, residual), level)
    left = float(np.nanmean(np.abs(residual - np.interp(level, KNOTS_DBM, bias))))
    return replace(start, levels_dbm=tuple(KNOTS_DBM.tolist()), bias_m=tuple(bias.tolist())), left


def _bounded(bias: Floats, level: Floats) -> Floats:
    """Return the bias within physical bounds of its constant, that at the median level."""
    middle = float(np.interp(np.nanmedian(level), KNOTS_DBM, bias))
    return np.clip(bias, middle - MOST_LEVEL_BIAS_M, middle + MOST_LEVEL_BIAS_M)


def curve_at_knots(
    level: Floats, residual: Floats, smooth: float = LEVEL_BEND, falling: bool = True
) -> Floats:
    """Return the bias at KNOTS_DBM: it only falls as the level rises, and not too steeply.

    Where not `falling`, it may do anything: for its scatter, which a bound would hide.

    A late threshold crossing of a weaker pulse is why there is a bias at all (APS011), so a curve
    that rises and falls again is something else.
    """
    known = np.isfinite(residual)
    hats = np.stack([np.interp(level[known], KNOTS_DBM, row) for row in np.eye(len(KNOTS_DBM))], 1)
    bend = np.diff(np.eye(len(KNOTS_DBM)), 2, axis=0) * smooth * np.sqrt(known.sum())
    target = np.concatenate([residual[known], np.zeros(len(bend))])
    falls = np.triu(np.ones((len(KNOTS_DBM),) * 2))  # bias at a knot = sum of the falls above it
    bounds = np.full(len(KNOTS_DBM), STEEPEST_M_PER_KNOT)
    bounds[-1] = np.inf
    lowest = np.where(np.isinf(bounds), -np.inf, 0.0)
    if not falling:
        lowest, bounds = np.full(len(bounds), -np.inf), np.full(len(bounds), np.inf)
    made = lsq_linear(np.vstack([hats, bend]) @ falls, target, (lowest, bounds))
    return np.asarray(falls @ made.x)


def device_delay(view: View, residual_m: Floats) -> DeviceDelay | None:
    """Return delays per device that fit residual ranges [n], None where no delay could.

    Nor where all rows are of one pair of devices: that is the constant of `antenna-delay`.
    """
    _, tx, rx = ends(view)
    if len({tuple(sorted(pair)) for pair in zip(tx.tolist(), rx.tolist(), strict=True)}) < 2:
        return None
    found = delays_of(view, residual_m, np.arange(len(residual_m)))
    if np.abs(found).max() > LONGEST_DELAY_NS:
        return None  # metres are not a delay
    return DeviceDelay(ends(view)[0], tuple(found.tolist()))


def delays_of(view: View, residual_m: Floats, rows: NDArray[np.intp]) -> Floats:
    """Return the delay of every device in ns from the residual ranges of some rows.

    0 of a device of one link, whose delay is not told.
    """
    names, tx, rx = ends(view)
    told = delay_told(view).astype(np.float64)
    design = incidence(tx[rows], rx[rows], 1.0, len(names)) * (C_M_PER_NS / 2) * told
    found = robust(csr_array(design), residual_m[rows], np.full(len(names), DELAY_PRIOR_NS))
    return fewest_off(found, tx[rows], rx[rows]) * told


def delay_told(view: View) -> NDArray[np.bool_]:
    """Return of which devices of a view delays can be told [D]: those of several links.

    All that one link has by itself would be the delay of a device that has no other.
    """
    names, tx, rx = ends(view)
    both = np.concatenate([tx, rx]), np.concatenate([view.links, view.links])
    return np.asarray(in_several(*both, len(names)), np.bool_)


def fewest_off(delays_ns: Floats, tx: NDArray[np.intp], rx: NDArray[np.intp]) -> Floats:
    """Return the delays of the same sums of which most are near zero.

    Where tags range with anchors alone, a constant may stand in all tags or, with the other sign,
    in all anchors: no recording tells.
    """
    out, side = delays_ns.copy(), sides(tx, rx, len(delays_ns))
    for part in np.unique(np.abs(side[side != 0])):
        mine = np.abs(side) == part
        sign = np.sign(side[mine])
        out[mine] -= sign * np.median(sign * out[mine])
    return out


def sides(tx: NDArray[np.intp], rx: NDArray[np.intp], count: int) -> NDArray[np.intp]:
    """Return which devices [count] range with one another: +k on one side of part k, -k opposite.

    0 where a part has no sides: three devices that all range with each other.
    """
    pairs = np.unique(np.sort(np.stack([tx, rx], axis=1), axis=1), axis=0)
    near: list[list[int]] = [[] for _ in range(count)]
    for one, two in pairs.tolist():
        near[one].append(two)
        near[two].append(one)
    side = np.zeros(count, np.intp)
    for first in range(count):
        if side[first] == 0 and near[first]:
            _spread_sides(first, near, side)
    return side


def _spread_sides(first: int, near: list[list[int]], side: NDArray[np.intp]) -> None:
    """Write the sides of the devices that hang together with one; 0 where these are none."""
    part, reached = int(np.abs(side).max()) + 1, [first]
    side[first] = part
    for one in reached:
        fresh = [two for two in near[one] if side[two] == 0]
        side[fresh] = -side[one]
        reached += fresh
    if any(side[two] == side[one] for one in reached for two in near[one]):
        side[reached] = 0
