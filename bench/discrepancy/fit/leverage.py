"""What links scatter by, free of what a fit of many values takes of it.

With nearly as many devices as links a fit follows these: what it leaves is smaller than what they
scatter by, and links drawn again leave a device one link of two, so values scatter far more than
they do. What a link leaves is (I - H)^(1/2) of its errors, H the part of the hat matrix of its rows
where all scatter alike; taken off again, residuals have the variance of errors (Bell and McCaffrey,
Survey Methodology 28, 2002: "CR2").
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import View
from bench.discrepancy.fit.heard import TIME, WARM, Heard
from bench.discrepancy.fit.least_squares import ends, incidence
from bench.discrepancy.fit.per_device import delay_told
from bench.discrepancy.fit.settings import MOST_LEVERAGE
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.effects.fitted.device_delay import DeviceDelay
from bench.physics.units import C_M_PER_NS

Floats = NDArray[np.float64]
EPS = float(np.finfo(np.float64).eps)


@dataclass(frozen=True)
class Errors:
    """Errors `left_m` [n] of rows, as what a fit leaves tells them.

    `own` [L]: links whose residuals tell of their errors at all; `free`: links more than values.
    """

    left_m: Floats
    own: NDArray[np.bool_]
    free: int


def device_columns(view: View, effect: Effect) -> Floats | None:
    """Return metres per unit of every value that a fit per device has [n, k]; None of others.

    Clocks that wander have none: their curves are no few values.
    """
    wandering = isinstance(effect, DeviceClock) and bool(effect.knots_s)
    if wandering or not isinstance(effect, DeviceClock | DeviceDelay):
        return None
    names, tx, rx = ends(view)
    if isinstance(effect, DeviceDelay):
        return incidence(tx, rx, 1.0, len(names)).toarray() * (C_M_PER_NS / 2) * delay_told(view)
    heard = Heard.of(view, np.zeros(len(view.rows)))
    pair = incidence(tx, rx, -1.0, len(names)).toarray() * heard.per_ppm[:, None]
    slopes = {WARM: effect.slopes_ppm_per_c, TIME: effect.drifts_ppm_per_hour}
    by = [pair * heard.since(over)[:, None] for over, some in slopes.items() if np.any(some)]
    return np.hstack([pair, *by])


def errors_of(left_m: Floats, links: NDArray[np.intp], columns: Floats) -> Errors:
    """Return the errors of rows from what a fit of `columns` [n, k] leaves of them [n]."""
    every, code = np.unique(links, return_inverse=True)
    known = np.isfinite(left_m)
    root, sizes, _ = np.linalg.svd(columns[known], full_matrices=False)
    axes = np.zeros((len(left_m), int((sizes > sizes.max() * len(columns) * EPS).sum())))
    axes[known] = root[:, : axes.shape[1]]
    out, own = left_m.copy(), np.ones(len(every), np.bool_)
    for link in range(len(every)):
        rows = np.flatnonzero((code == link) & known)
        taken, way = np.linalg.eigh(axes[rows] @ axes[rows].T)
        own[link] = bool((taken < MOST_LEVERAGE).all())
        times = 1 / np.sqrt(1 - np.clip(taken, 0, MOST_LEVERAGE))
        out[rows] = way @ (times * (way.T @ left_m[rows]))
    return Errors(out, own, max(len(every) - axes.shape[1], 1))
