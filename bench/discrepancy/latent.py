"""Values per device from residual ranges, by robust least squares: clocks and antenna delays."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array, hstack, vstack
from scipy.sparse.linalg import lsqr

from bench.discrepancy.terms import LOGGED_DBM, TRUE_DBM, DeviceClock, DeviceDelay, PowerCurve
from bench.discrepancy.world import Added, View, World, measured
from bench.physics.effect import Effect
from bench.physics.units import C_M_PER_NS

Floats = NDArray[np.float64]
MEMBERS = 4
DRIFT_PRIOR_PPM_PER_HOUR = 0.5  # crystals drift by tenths of a ppm per hour indoors
OFFSET_PRIOR_PPM = 20.0
DELAY_PRIOR_NS = 3.0


def latent_effects(world: World, view: View, added: Added) -> list[Effect]:
    """Return the effects with values per device or level that the rows support."""
    curve = power_curve(world, view, added)
    return [*device_terms(world, view, added), *([curve] if curve else [])]


def device_terms(world: World, view: View, added: Added) -> list[Effect]:
    """Return the device effects that the residual range of the rows supports, none without ids."""
    if "tx" not in view.frame or "rx" not in view.frame:
        return []
    ensemble = world.ensemble(view, added, MEMBERS)
    if "error_m" not in ensemble.names:
        return []
    residual = ensemble.residual[:, ensemble.names.index("error_m")]
    out: list[Effect] = []
    if np.nanmax(measured(view.frame, "reply_time_s"), initial=0) > 0:
        out.append(device_clock(view, residual))
    delay = device_delay(view, residual)
    return [*out, delay] if delay else out


UNCOMPRESSED_DBM = -80.5  # logged levels below this follow the true one
KNOTS_DBM = np.arange(-97.0, -50.0, 3.0)


def power_curve(world: World, view: View, added: Added) -> PowerCurve | None:
    """Return the bias curve over receive level that fits the residual range of the rows.

    The budget's level at 1 m and its scatter come from the logged levels that are not compressed.
    The curve is piecewise linear with small second differences. None where no level was logged.
    """
    ensemble = world.ensemble(view, added, MEMBERS)
    logged = measured(view.frame, "rx_power_dbm")
    weak = logged < UNCOMPRESSED_DBM
    if "error_m" not in ensemble.names or np.isfinite(logged).mean() < 0.5 or weak.sum() < 10:
        return None
    at_1m = np.interp(logged[weak], LOGGED_DBM, TRUE_DBM)
    at_1m = at_1m + 20 * np.log10(view.scene.true_range_m[weak])
    spread = float(np.clip(1.4826 * np.median(np.abs(at_1m - np.median(at_1m))), 0.5, 15))
    budget = float(np.clip(np.median(at_1m), -80, -30))
    residual = ensemble.residual[:, ensemble.names.index("error_m")]
    fits = [_curve(view, residual, budget, s) for s in sorted({0.5, min(1.0, spread), spread})]
    return min(fits, key=lambda fit: fit[1])[0]


def _curve(view: View, residual: Floats, budget: float, spread: float) -> tuple[PowerCurve, float]:
    """Return the curve for one trust in the budget, and the mean |residual| it leaves."""
    start = PowerCurve(level_at_1m_dbm=budget, spread_db=spread)
    level = start.level_dbm(view.scene)
    bias = _smooth_curve(level, residual)
    left = float(np.nanmean(np.abs(residual - np.interp(level, KNOTS_DBM, bias))))
    return replace(start, levels_dbm=tuple(KNOTS_DBM.tolist()), bias_m=tuple(bias.tolist())), left


def _smooth_curve(level: Floats, residual: Floats, smooth: float = 0.1) -> Floats:
    """Return the bias at KNOTS_DBM."""
    known = np.isfinite(residual)
    hats = np.stack([np.interp(level[known], KNOTS_DBM, row) for row in np.eye(len(KNOTS_DBM))], 1)
    bend = np.diff(np.eye(len(KNOTS_DBM)), 2, axis=0) * smooth * np.sqrt(known.sum())
    target = np.concatenate([residual[known], np.zeros(len(bend))])
    return np.asarray(np.linalg.lstsq(np.vstack([hats, bend]), target, rcond=None)[0])


def _ends(view: View) -> tuple[tuple[str, ...], NDArray[np.intp], NDArray[np.intp]]:
    """Return device names and each row's tx and rx numbers."""
    tx = view.frame["tx"].astype(str).to_numpy(dtype=object)
    rx = view.frame["rx"].astype(str).to_numpy(dtype=object)
    names, code = np.unique(np.concatenate([tx, rx]), return_inverse=True)
    return tuple(map(str, names)), code[: len(tx)], code[len(tx) :]


def _incidence(tx: NDArray[np.intp], rx: NDArray[np.intp], sign: float, count: int) -> csr_array:
    """Return [n, D]: 1 at the transmitter, `sign` at the receiver."""
    rows = np.arange(len(tx))
    cells = (np.concatenate([rows, rows]), np.concatenate([tx, rx]))
    values = np.concatenate([np.ones(len(tx)), np.full(len(tx), sign)])
    return csr_array((values, cells), shape=(len(tx), count))


def device_clock(view: View, residual_m: Floats) -> DeviceClock:
    """Return offsets per device that fit residual ranges [n] in metres.

    Linear drifts are added only where they predict whole links that were left out better than
    constant offsets do: a drift extrapolated from a few sessions can be worse than none.
    """
    if _drift_helps(view, residual_m):
        return _clock(view, residual_m, np.arange(len(view.links)), drift=True)
    return _clock(view, residual_m, np.arange(len(view.links)), drift=False)


def _drift_helps(view: View, residual_m: Floats) -> bool:
    """Return whether drifts lower the error on links left out in turn."""
    names = np.unique(view.links)
    if np.unique(measured(view.frame, "time_s")).size < 3 or len(names) < 3:
        return False
    folds = np.array_split(names, min(5, len(names)))
    left = {False: 0.0, True: 0.0}
    for fold in folds:
        kept = np.flatnonzero(~np.isin(view.links, fold))
        held = np.flatnonzero(np.isin(view.links, fold))
        for drift in left:
            clock = _clock(view, residual_m, kept, drift=drift)
            guess = clock.offset_ppm(view.scene)[held] * _metres_per_ppm(view)[held]
            left[drift] += float(np.nansum(np.abs(residual_m[held] - guess)))
    return left[True] < 0.9 * left[False]


def _metres_per_ppm(view: View) -> Floats:
    """Return c/2 x reply time x 1 ppm of each row [n]."""
    return C_M_PER_NS * np.nan_to_num(measured(view.frame, "reply_time_s")) / 2 * 1e3


def _clock(view: View, residual_m: Floats, rows: NDArray[np.intp], drift: bool) -> DeviceClock:
    """Return the device offsets (and drifts) fitted on some rows."""
    names, tx, rx = _ends(view)
    time = measured(view.frame, "time_s")
    reference = float(np.nanmedian(time)) if np.isfinite(time).any() else 0.0
    hours = np.nan_to_num(time - reference) / 3600
    per_ppm = _metres_per_ppm(view)[rows]
    pair = _incidence(tx[rows], rx[rows], -1.0, len(names))
    parts = [pair.multiply(per_ppm[:, None])]
    prior = np.full(len(names), OFFSET_PRIOR_PPM)
    if drift:
        parts.append(pair.multiply((per_ppm * hours[rows])[:, None]))
        prior = np.concatenate([prior, np.full(len(names), DRIFT_PRIOR_PPM_PER_HOUR)])
    found = _robust(csr_array(hstack(parts)), residual_m[rows], prior)
    drifts = found[len(names) :] if drift else np.zeros(len(names))
    offsets = tuple(found[: len(names)].tolist())
    return DeviceClock(names, offsets, tuple(drifts.tolist()), reference)


def device_delay(view: View, residual_m: Floats) -> DeviceDelay | None:
    """Return delays per device that fit residual ranges [n], None where no delay could."""
    names, tx, rx = _ends(view)
    design = _incidence(tx, rx, 1.0, len(names)) * (C_M_PER_NS / 2)
    found = _robust(csr_array(design), residual_m, np.full(len(names), DELAY_PRIOR_NS))
    if np.abs(found).max() > 20:
        return None  # metres are not a delay
    return DeviceDelay(names, tuple(found.tolist()))


def _robust(design: csr_array, target: Floats, prior: Floats) -> Floats:
    """Return the Huber-weighted ridge solution; `prior` are the standard deviations a priori."""
    known = np.isfinite(target)
    rows, y = design[known], target[known]
    weight = np.ones(len(y))
    found = np.zeros(design.shape[1])
    scale = max(float(np.std(y)), 1e-6)
    for _ in range(6):
        root = np.sqrt(weight) / scale
        ridge = csr_array(np.diag(1 / prior))
        matrix = vstack([rows.multiply(root[:, None]), ridge])
        found = lsqr(matrix, np.concatenate([y * root, np.zeros(len(prior))]), atol=1e-12)[0]
        left = np.abs(y - rows @ found)
        scale = max(float(1.4826 * np.median(left)), 1e-4)
        weight = np.minimum(1.0, 1.5 * scale / np.maximum(left, 1e-12))
    return np.asarray(found, np.float64)
