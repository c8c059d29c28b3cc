"""Crystal offsets per device from residual ranges: constant, drifting, or wandering.

They drift with time or with temperature, each crystal by a slope of its own, as it was cut. Which
of these is decided by cross-validation: drifts must predict whole links that were left out, a
wandering crystal these and stretches of rows. It wanders about its mean (a process of
Ornstein and Uhlenbeck; at long time constants a random walk): knots where the device was heard,
spread and time constant by their marginal likelihood.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.linalg import LinAlgError, cho_factor, cho_solve
from scipy.sparse import csr_array, hstack
from scipy.sparse.csgraph import connected_components

from bench.discrepancy.compare.view import View
from bench.discrepancy.fit.heard import TIME, WARM, Heard
from bench.discrepancy.fit.least_squares import robust
from bench.discrepancy.fit.settings import (
    DRIFT_PRIOR_PPM_PER_HOUR,
    MEAN_PRIOR_M,
    SCALE_SETTLED,
    SLOPE_VALUES,
    WANDER_PASSES,
    WANDER_SPREADS_PPM,
    WARM_PRIOR_PPM_PER_C,
)
from bench.discrepancy.settings import (
    CLOCK_KNOTS,
    CLOCK_RIDGES,
    CLOCK_SHORTEST_S,
    CLOCK_STRETCHES,
    HUBER,
    MAD_TO_STD,
    OFFSET_PRIOR_PPM,
    RICHER_CLOCK,
    WANDER_SETTLES_S,
)
from bench.errors import BenchError
from bench.physics.effects.fitted.device_clock import DeviceClock

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]
STEADY = ""  # what offsets go by: nothing
PRIORS = {TIME: DRIFT_PRIOR_PPM_PER_HOUR, WARM: WARM_PRIOR_PPM_PER_C}


@dataclass(frozen=True)
class Wander:
    """How crystals wander: standard deviation about their mean, and how fast they return to it."""

    spread_ppm: float
    settle_s: float


def device_clock(view: View, residual_m: Floats) -> DeviceClock:
    """Return clocks per device that fit residual ranges [n] in metres.

    Constant offsets, unless left-out rows are predicted better by drifts or by wandering crystals.
    """
    heard = Heard.of(view, residual_m)
    every = np.arange(len(view.links))
    linear = _goes_by(heard)
    curved = walking(heard, every) if _values(heard.time_s) >= 2 * CLOCK_STRETCHES else None
    if curved and _wander_helps(heard, Wander(curved.spread_ppm, curved.settle_s), linear):
        return curved
    return polynomial(heard, every, linear, heard.with_mean)


def _values(values: Floats) -> int:
    """Return how many different values are known."""
    return len(np.unique(values[np.isfinite(values)]))


def _goes_by(heard: Heard) -> str:
    """Return what offsets go by: whose slopes lower the error on links left out in turn most."""
    columns = {TIME: heard.time_s, WARM: heard.warm_c}
    able = [over for over, values in columns.items() if _values(values) >= SLOPE_VALUES]
    if not able or len(np.unique(heard.links)) < 3:
        return STEADY
    left = dict.fromkeys((STEADY, *able), 0.0)
    for kept, held in _folds(heard, heard.parts):
        for over in left:
            left[over] += heard.error(polynomial(heard, kept, over), held) * len(held)
    best = min(able, key=lambda over: left[over])
    return best if left[best] < RICHER_CLOCK * left[STEADY] else STEADY


def _wander_helps(heard: Heard, wander: Wander, linear: str) -> bool:
    """Return whether wandering lowers the error on rows left out, stretches and links alike.

    Both count: a curve that only interpolates loses on links what it gains on stretches.
    """
    ways = [heard.stretches] + [heard.parts] * (len(np.unique(heard.links)) >= 3)
    left = np.sum([_compared(heard, wander, linear, fold) for fold in ways], axis=0)
    return bool(left[1] < RICHER_CLOCK * left[0])


def _compared(heard: Heard, wander: Wander, linear: str, fold: Rows) -> tuple[float, float]:
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


def polynomial(heard: Heard, rows: Rows, over: str, beside_mean: bool = False) -> DeviceClock:
    """Return constant offsets, with slopes over time or temperature if asked, of some rows.

    `beside_mean`: beside a constant of all ranges, where that is told from clocks. Not where forms
    are compared on rows left out: of crystals that wander it takes what they have in common.
    """
    count = len(heard.names)
    offset = heard.design(rows)
    parts: list[Any] = [offset]
    prior = np.full(count, OFFSET_PRIOR_PPM)
    if over:
        parts.append(offset.multiply(heard.since(over)[rows][:, None]))
        prior = np.concatenate([prior, np.full(count, PRIORS[over])])
    if beside_mean:
        parts.append(csr_array(np.ones((len(rows), 1))))
        prior = np.append(prior, MEAN_PRIOR_M)
    found = robust(csr_array(hstack(parts)), heard.residual_m[rows], prior)
    found = found[: len(found) - beside_mean].tolist()
    offsets, slopes, none = tuple(found[:count]), tuple(found[count:]), (0.0,) * count
    if over == WARM:
        made = DeviceClock(heard.names, offsets, none, heard.reference_s)
        return replace(made, slopes_ppm_per_c=slopes, reference_c=heard.reference_c)
    return DeviceClock(heard.names, offsets, slopes or none, heard.reference_s)


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
