"""Crystal offsets per device from residual ranges: constant, drifting, or wandering.

Which of the three is decided by cross-validation: drifts must predict whole links that were left
out, a wandering crystal these and stretches of rows. It wanders about its mean (a process of
Ornstein and Uhlenbeck; at long time constants a random walk): knots where the device was heard,
spread and time constant by their marginal likelihood.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse import csr_array, hstack
from scipy.sparse.csgraph import connected_components

from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.fit.least_squares import ends, incidence, robust
from bench.discrepancy.settings import (
    CLOCK_FOLDS,
    CLOCK_KNOTS,
    CLOCK_LINK_FOLDS,
    CLOCK_RIDGES,
    CLOCK_SHORTEST_S,
    CLOCK_STRETCHES,
    DRIFT_PRIOR_PPM_PER_HOUR,
    HUBER,
    MAD_TO_STD,
    OFFSET_PRIOR_PPM,
    RICHER_CLOCK,
    SCALE_SETTLED,
    WANDER_PASSES,
    WANDER_SETTLES_S,
    WANDER_SPREADS_PPM,
)
from bench.errors import BenchError
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.units import C_M_PER_NS

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]


@dataclass(frozen=True)
class Wander:
    """How crystals wander: standard deviation about their mean, and how fast they return to it."""

    spread_ppm: float
    settle_s: float


@dataclass(frozen=True)
class Heard:
    """What clocks are fitted to: rows with their devices, times and residual ranges.

    `residual_m` [n]; `per_ppm` [n] metres per ppm; `links` [n] codes; `tx`, `rx` [n] numbers of
    `names`.
    """

    names: tuple[str, ...]
    tx: Rows
    rx: Rows
    time_s: Floats
    per_ppm: Floats
    residual_m: Floats
    links: Rows
    view: View

    @classmethod
    def of(cls, view: View, residual_m: Floats) -> Heard:
        """Return the rows of a view with their residual ranges [n]."""
        names, tx, rx = ends(view)
        time = numeric(view.frame, "time_s")
        reply_s = np.nan_to_num(numeric(view.frame, "reply_time_s"))
        per_ppm = C_M_PER_NS * reply_s / 2 * 1e3
        return cls(names, tx, rx, time, per_ppm, residual_m, view.links, view)

    @cached_property
    def reference_s(self) -> float:
        """The middle of the recording, 0 without times."""
        known = np.isfinite(self.time_s)
        return float(np.median(self.time_s[known])) if known.any() else 0.0

    def error(self, clock: DeviceClock, rows: Rows) -> float:
        """Return the mean abs. residual that a clock leaves on some rows, in metres."""
        guess = clock.offset_ppm(self.view.scene)[rows] * self.per_ppm[rows]
        left = np.abs(self.residual_m[rows] - guess)
        return float(np.nanmean(left)) if np.isfinite(left).any() else 0.0

    @cached_property
    def stretches(self) -> Rows:
        """Fold of each row [n]: alternate stretches of every pair of devices and link."""
        fold = np.zeros(len(self.links), np.intp)
        keys = np.stack([self.links, self.tx, self.rx], axis=1)
        code = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
        for pair in np.unique(code):
            rows = np.flatnonzero(code == pair)
            rows = rows[np.argsort(self.time_s[rows], kind="stable")]
            fold[rows] = (np.arange(len(rows)) * CLOCK_STRETCHES // len(rows) + pair) % CLOCK_FOLDS
        return fold

    @cached_property
    def parts(self) -> Rows:
        """Fold of each row [n]: whole links."""
        names = np.unique(self.links)
        return np.asarray(
            np.searchsorted(names, self.links) % max(min(CLOCK_LINK_FOLDS, len(names)), 1)
        )


def device_clock(view: View, residual_m: Floats) -> DeviceClock:
    """Return clocks per device that fit residual ranges [n] in metres.

    Constant offsets, unless left-out rows are predicted better by drifts or by wandering crystals.
    """
    heard = Heard.of(view, residual_m)
    every = np.arange(len(view.links))
    linear = _drift_helps(heard)
    curved = walking(heard, every) if _times(heard) >= 2 * CLOCK_STRETCHES else None
    if curved and _wander_helps(heard, Wander(curved.spread_ppm, curved.settle_s), linear):
        return curved
    return polynomial(heard, every, linear)


def _times(heard: Heard) -> int:
    """Return how many different times are known."""
    return len(np.unique(heard.time_s[np.isfinite(heard.time_s)]))


def _drift_helps(heard: Heard) -> bool:
    """Return whether drifts lower the error on links left out in turn."""
    if _times(heard) < 3 or len(np.unique(heard.links)) < 3:
        return False
    left = [0.0, 0.0]
    for kept, held in _folds(heard, heard.parts):
        for drift in (False, True):
            left[drift] += heard.error(polynomial(heard, kept, drift), held) * len(held)
    return left[True] < RICHER_CLOCK * left[False]


def _wander_helps(heard: Heard, wander: Wander, linear: bool) -> bool:
    """Return whether wandering lowers the error on rows left out, stretches and links alike.

    Both count: a curve that only interpolates loses on links what it gains on stretches.
    """
    ways = [heard.stretches] + [heard.parts] * (len(np.unique(heard.links)) >= 3)
    left = np.sum([_compared(heard, wander, linear, fold) for fold in ways], axis=0)
    return bool(left[1] < RICHER_CLOCK * left[0])


def _compared(heard: Heard, wander: Wander, linear: bool, fold: Rows) -> tuple[float, float]:
    """Return the summed error on rows left out: of the simple clock and of a wandering one."""
    simple = curved = 0.0
    for kept, held in _folds(heard, fold):
        simple += heard.error(polynomial(heard, kept, linear), held) * len(held)
        found = walking(heard, kept, (wander,))
        curved += heard.error(found, held) * len(held) if found else np.inf
    return simple, curved


def _folds(heard: Heard, fold: Rows) -> Iterator[tuple[Rows, Rows]]:
    """Yield (kept rows, held-out rows) of every fold that leaves something to predict.

    Held-out rows count where their two devices are joined by rows that are kept: the offset of a
    device from others it was never heard with cannot be known.
    """
    for number in np.unique(fold):
        kept, held = np.flatnonzero(fold != number), np.flatnonzero(fold == number)
        count = len(heard.names)
        graph = csr_array(
            (np.ones(len(kept)), (heard.tx[kept], heard.rx[kept])), shape=(count, count)
        )
        part = connected_components(graph, directed=False)[1]
        held = held[part[heard.tx[held]] == part[heard.rx[held]]]
        if len(kept) and len(held):
            yield kept, held


def polynomial(heard: Heard, rows: Rows, drift: bool) -> DeviceClock:
    """Return constant offsets, or offsets and linear drifts, fitted on some rows."""
    count = len(heard.names)
    hours = np.nan_to_num(heard.time_s[rows] - heard.reference_s) / 3600
    per_ppm = heard.per_ppm[rows]
    pair = incidence(heard.tx[rows], heard.rx[rows], -1.0, count)
    parts = [pair.multiply(per_ppm[:, None])]
    prior = np.full(count, OFFSET_PRIOR_PPM)
    if drift:
        parts.append(pair.multiply((per_ppm * hours)[:, None]))
        prior = np.concatenate([prior, np.full(count, DRIFT_PRIOR_PPM_PER_HOUR)])
    found = robust(csr_array(hstack(parts)), heard.residual_m[rows], prior)
    drifts = found[count:] if drift else np.zeros(count)
    offsets = tuple(found[:count].tolist())
    return DeviceClock(heard.names, offsets, tuple(drifts.tolist()), heard.reference_s)


def walking(
    heard: Heard, rows: Rows, wanders: tuple[Wander, ...] | None = None
) -> DeviceClock | None:
    """Return wandering clocks fitted on some rows, spread and time constant of most evidence.

    None where no row has a time.
    """
    rows = rows[np.isfinite(heard.time_s[rows]) & np.isfinite(heard.residual_m[rows])]
    knots = [_knots(heard, rows, device) for device in range(len(heard.names))]
    if not len(rows) or max(map(len, knots)) < 2:
        return None
    problem = _Walk(heard, rows, knots)
    tried = wanders or tuple(Wander(s, t) for s in WANDER_SPREADS_PPM for t in WANDER_SETTLES_S)
    weight = problem.weights(tried[-1])
    fits = [problem.solve(wander, weight) for wander in tried]
    best = int(np.argmax([evidence for _, evidence in fits]))
    return problem.clock(fits[best][0], tried[best])


def _knots(heard: Heard, rows: Rows, device: int) -> Floats:
    """Return when a device was heard [k], at most CLOCK_KNOTS mean times of equal intervals."""
    here = (heard.tx[rows] == device) | (heard.rx[rows] == device)
    time = np.sort(heard.time_s[rows][here])
    if not len(time):
        return time
    width = CLOCK_SHORTEST_S
    while len(np.unique(time // width)) > CLOCK_KNOTS:
        width *= 1.5
    code = np.unique(time // width, return_inverse=True)[1]
    return np.asarray(np.bincount(code, time) / np.bincount(code))


class _Walk:
    """The linear problem: the offset of every device, and its wander at its knots."""

    def __init__(self, heard: Heard, rows: Rows, knots: list[Floats]) -> None:
        self.heard, self.rows, self.knots = heard, rows, knots
        self.starts = np.concatenate([[0], np.cumsum([len(k) for k in knots])])
        self.design = self._design()
        self.target = heard.residual_m[rows]

    def _design(self) -> Floats:
        """Return metres per ppm of every unknown [n, U]: wander at all knots, then offsets.

        Rows lie within a knot's interval, so straight lines between knots are near enough.
        """
        heard, rows = self.heard, self.rows
        count, devices = int(self.starts[-1]), len(heard.names)
        out = np.zeros((len(rows), count + devices))
        for end, sign in ((heard.tx, 1.0), (heard.rx, -1.0)):
            for device, knots in enumerate(self.knots):
                mine = np.flatnonzero(end[rows] == device)
                per_ppm = sign * heard.per_ppm[rows][mine]
                place = slice(int(self.starts[device]), int(self.starts[device + 1]))
                out[mine, place] += per_ppm[:, None] * _hats(heard.time_s[rows][mine], knots)
                out[mine, count + device] += per_ppm
        return out

    def _precision(self, wander: Wander) -> tuple[Floats, float]:
        """Return the prior precision [U, U] and its log determinant up to a constant.

        Ornstein and Uhlenbeck: w[0] ~ N(0, s^2), w[k+1] ~ N(rho w[k], s^2 (1 - rho^2)).
        """
        count, devices = int(self.starts[-1]), len(self.knots)
        out = np.zeros((count + devices, count + devices))
        total = 0.0
        for start, knots in zip(self.starts[:-1].tolist(), self.knots, strict=True):
            if len(knots):
                out[start, start] += wander.spread_ppm**-2
                total -= 2 * float(np.log(wander.spread_ppm))
            for k, gap in enumerate(np.diff(knots)):
                rho = float(np.exp(-gap / wander.settle_s))
                variance = wander.spread_ppm**2 * (1 - rho**2)
                step = np.ix_([start + k, start + k + 1], [start + k, start + k + 1])
                out[step] += np.array([[rho**2, -rho], [-rho, 1.0]]) / variance
                total -= float(np.log(variance))
        ridge = np.arange(count, count + devices)
        out[ridge, ridge] = OFFSET_PRIOR_PPM**-2
        return out, total

    def weights(self, wander: Wander) -> Floats:
        """Return weight / variance of each row [n], Huber-weighted around its own solution."""
        scale = max(float(np.std(self.target)), 1e-6)
        weight = np.full(len(self.target), scale**-2)
        for _ in range(WANDER_PASSES):
            left = np.abs(self.target - self.design @ self.solve(wander, weight)[0])
            last, scale = scale, max(float(MAD_TO_STD * np.median(left)), 1e-3)
            weight = np.minimum(1.0, HUBER * scale / np.maximum(left, 1e-12)) / scale**2
            if abs(scale - last) < SCALE_SETTLED * scale:
                break
        return weight

    def solve(self, wander: Wander, weight: Floats) -> tuple[Floats, float]:
        """Return the unknowns [U] and the log marginal likelihood up to a constant."""
        prior, logdet_prior = self._precision(wander)
        factor = _factor(self.design.T @ (weight[:, None] * self.design) + prior)
        right = self.design.T @ (weight * self.target)
        found = cho_solve(factor, right)
        logdet = 2 * float(np.log(np.diag(factor[0])).sum())
        quadratic = float((weight * self.target**2).sum() - right @ found)
        return found, 0.5 * (logdet_prior - logdet - quadratic)

    def clock(self, found: Floats, wander: Wander) -> DeviceClock:
        """Return the unknowns as an effect: offsets, and what is added to them at the knots."""
        curves = [found[a:b] for a, b in zip(self.starts, self.starts[1:], strict=False)]
        count = len(curves)
        heard, start = self.heard, int(self.starts[-1])
        return DeviceClock(
            devices=heard.names,
            offsets_ppm=tuple(found[start : start + count].tolist()),
            drifts_ppm_per_hour=(0.0,) * count,
            reference_s=heard.reference_s,
            knots_s=tuple(tuple(k.tolist()) for k in self.knots),
            wander_ppm=tuple(tuple(c.tolist()) for c in curves),
            spread_ppm=wander.spread_ppm,
            settle_s=wander.settle_s,
        )


def _factor(precision: Floats) -> tuple[Floats, bool]:
    """Return the Cholesky factor of a precision [U, U]; what rounding spoils gets a ridge."""
    for ridge in (0.0, *CLOCK_RIDGES):
        try:
            more = ridge * float(np.diag(precision).max()) * np.eye(len(precision))
            return cho_factor(precision + more if ridge else precision, lower=True)
        except LinAlgError:
            continue
    raise BenchError("clocks cannot be fitted: expected 'reply_time_s' and 'time_s' in seconds")


def _hats(time: Floats, knots: Floats) -> Floats:
    """Return linear interpolation weights [n, k], constant beyond the ends."""
    after = np.clip(np.searchsorted(knots, time), 1, max(len(knots) - 1, 1))
    out = np.zeros((len(time), len(knots)))
    rows = np.arange(len(time))
    if len(knots) < 2:
        out[:] = 1.0
        return out
    share = np.clip((time - knots[after - 1]) / (knots[after] - knots[after - 1]), 0.0, 1.0)
    out[rows, after - 1] += 1 - share
    out[rows, after] += share
    return out
