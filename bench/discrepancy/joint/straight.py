"""Whether the straight path of struck links still arrives, before the one that is ranged.

What weakens a straight path leaves it where it was: faint, ahead of the detour that is ranged. What
blocks it leaves nothing there. A single row hardly shows a path below the threshold of detection;
rows of many struck links together do. They are compared with links that nothing struck, in whose
rows nothing arrives so long before the detected path: what leads there is noise.
"""

from __future__ import annotations

from itertools import pairwise

import numpy as np
from numpy.typing import NDArray
from scipy.stats import mannwhitneyu

from bench.discrepancy.compare.view import View
from bench.discrepancy.data.grouped import group_sums
from bench.discrepancy.data.observables import NOISE, Window, aligned
from bench.discrepancy.joint.settings import (
    AHEAD_NS,
    EARLIEST_SAMPLES,
    EDGE_NS,
    RISEN,
    SHOULDER_NS,
    STRAIGHT_NS,
    STRUCK_FEWEST,
)
from bench.physics.units import C_M_PER_NS

Floats = NDArray[np.float64]
Mask = NDArray[np.bool_]


def straight_nats(rows: View, struck: Mask, longer_m: Floats) -> float:
    """Return how sure struck links [L] have power where their straight path would arrive, in nats.

    `longer_m` [n]: by how much rows read longer than simulated. At least 0, which it is where too
    few links tell. The largest odds that a chance p of a rank test leaves (Sellke et al. 2001).
    """
    hit = struck[np.unique(rows.links, return_inverse=True)[1]]
    known = np.isfinite(longer_m)
    if not (known & hit).any() or not (known & ~hit).any():
        return 0.0
    loud = straight_power(rows, hit, longer_m)
    told = np.isfinite(loud)
    mine, others = loud[struck & told], loud[~struck & told]
    if min(len(mine), len(others)) < STRUCK_FEWEST:
        return 0.0
    p = float(mannwhitneyu(mine, others, alternative="greater").pvalue)
    chance = min(max(p, np.finfo(float).tiny), np.exp(-1))
    return -1.0 - float(np.log(-chance * np.log(chance)))


def straight_power(rows: View, hit: Mask, longer_m: Floats) -> Floats:
    """Return the power over the noise, of links [L], where the straight path would arrive.

    `hit` [n]: rows of struck links. Those of others are asked at the delays of struck ones, from
    which they differ by nothing but a path. NaN where nothing is known of it.
    """
    magnitude, delay = aligned(rows.frame, Window(EARLIEST_SAMPLES, 1))
    after = delay + _leads(hit, longer_m)[:, None]
    power = np.asarray(magnitude, np.float64) ** 2
    power = power / _noise(rows, power, after < -AHEAD_NS)[:, None]
    edge = _edge_ns(power[~hit], delay[~hit])
    near = (after > STRAIGHT_NS[0]) & (after < STRAIGHT_NS[1]) & (delay < edge)
    return _mean(power, near, rows.links)


def _leads(hit: Mask, longer_m: Floats) -> Floats:
    """Return how long before the detected path the straight one would arrive [n], in ns."""
    lead = (longer_m - float(np.nanmedian(longer_m[~hit]))) / C_M_PER_NS
    mine = lead[hit & np.isfinite(lead)]
    return np.where(hit, lead, np.resize(mine, len(lead)))


def _noise(rows: View, power: Floats, before: Mask) -> Floats:
    """Return the power of the noise [n] but for a factor: as logged, else of what is `before`."""
    logged = rows.recorded.column(NOISE) if NOISE in rows.recorded.names else np.full(1, np.nan)
    if np.isfinite(logged).all() and (logged > 0).all():
        return np.asarray(logged**2)
    code = np.unique(rows.links, return_inverse=True)[1]
    return _mean(power, before, rows.links)[code]


def _mean(power: Floats, where: Mask, links: NDArray[np.intp]) -> Floats:
    """Return the mean of powers [n, K] over the samples of each link [L] that are meant."""
    code = np.unique(links, return_inverse=True)[1]
    able = where & np.isfinite(power)
    sums = np.stack([np.where(able, power, 0.0).sum(axis=1), able.sum(axis=1)], axis=1)
    total, count = group_sums(sums, code, int(code.max()) + 1).T
    return np.asarray(np.divide(total, count, out=np.full(len(count), np.nan), where=count > 0))


def _edge_ns(power: Floats, delay: Floats) -> float:
    """Return the delay at which the rise of a detected path's own edge begins, in ns.

    Of powers over the noise [n, K]; -infinity where nothing precedes it.
    """
    steps = [
        (low, float(np.median(power[at])))
        for low, high in pairwise(EDGE_NS)
        if (at := (delay >= low) & (delay < high) & np.isfinite(power)).any()
    ]
    quiet = min((size for _, size in steps), default=0.0)
    return next((low - SHOULDER_NS for low, size in steps if size > RISEN * quiet), -np.inf)
