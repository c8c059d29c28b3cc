"""How the samples that hold nothing but noise scatter within a record: a tone makes them alike.

Before the first path there are some ten samples; behind the last one there may be a hundred. The
mean of the squared power of noise is twice the square of its mean power; a tone of K times its
power beside it takes K^2 / (1 + K)^2 off (Rice 1945), half as much where two tones of one size
beat, and a louder noise nothing. So a set with a tone is likelier, or less likely, than one with a
noise floor of the same power by how much the recorded samples have of that. The square of the mean
is of pairs of samples that are too far apart for the colour of noise to make them alike. Both are
summed over rows, so that the few samples before the path are enough.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bench.discrepancy.compare.records import recorded_samples, simulated_samples
from bench.discrepancy.compare.view import Added
from bench.discrepancy.joint.settings import (
    COLOUR_SAMPLES,
    KEPT,
    QUIET_EARLY,
    QUIET_ERROR,
    QUIET_FEWEST,
    QUIET_LOUDER,
    QUIET_MEMBERS,
    QUIET_MOST_NATS,
    QUIET_SMOOTH,
    STEADY_PARTS,
)
from bench.discrepancy.joint.statistics import Floats, Statistics
from bench.discrepancy.joint.tone_or_noise import with_floor
from bench.discrepancy.settings import NOISE_BEFORE_NS
from bench.physics.memory import Memory


@dataclass(frozen=True)
class Heard:
    """Recorded rows: which samples are `quiet` [K], their ratio and its standard error."""

    quiet: NDArray[np.bool_]
    ratio: float
    error: float


class Quiet:
    """What quiet samples say of sets with a tone in them."""

    def __init__(self, given: Statistics) -> None:
        self.given = given
        self._ratios: Memory[float] = Memory(KEPT)
        self._heard = self._listened()

    def nats(self, effects: Added) -> float:
        """Return by how much likelier a set is than one with noise in place of its tone, in nats.

        0 where it has none, or where too few samples are quiet.
        """
        floor = with_floor(effects)
        if self._heard is None or floor == effects:
            return 0.0
        before, after = self._ratio(floor, self._heard), self._ratio(effects, self._heard)
        return speaks(self._heard.ratio - before, after - before, self._heard.error)

    def _listened(self) -> Heard | None:
        """Return the recorded rows as heard, None where too few samples are quiet."""
        given = self.given
        recorded = recorded_samples(given.comparison, given.rows)
        bare = simulated_samples(given.comparison, given.rows, given.beside, 0)
        if recorded is None or bare is None:
            return None
        quiet = quiet_samples(*recorded) & quiet_samples(*bare)
        if quiet.sum() < QUIET_FEWEST:
            quiet = early_samples(recorded[1]) & early_samples(bare[1])
        if quiet.sum() < QUIET_EARLY:
            return None
        ours, theirs = (loud_moments(samples[0][:, quiet]) for samples in (recorded, bare))
        own = error_of(np.unique(theirs, axis=0)) ** 2 / QUIET_MEMBERS
        links = given.of_links(ours) * given.count[:, None]  # sums: the ratio is of all rows
        square = error_of(links) ** 2 + own + QUIET_ERROR**2
        return Heard(quiet, ratio_of(ours), float(np.sqrt(square)))

    def _ratio(self, added: Added, heard: Heard) -> float:
        """Return the mean ratio of quiet samples of simulated rows with effects."""
        return self._ratios.get(added, lambda: self._simulated(added, heard))

    def _simulated(self, added: Added, heard: Heard) -> float:
        given, every = self.given, []
        for number in range(QUIET_MEMBERS):
            effects = (*given.beside, *added)
            made = simulated_samples(given.comparison, given.rows, effects, number)
            assert made is not None  # the bare rows have samples
            every.append(loud_moments(made[0][:, heard.quiet]))
        return ratio_of(np.concatenate(every))


def speaks(left: float, tone: float, error: float) -> float:
    """Return the nats by which a ratio that is `left` is a `tone`'s rather than noise's.

    Both as differences from the ratio of noise, `tone` that of a steady tone: of one whose size
    changes within a record a part is seen, any as likely. What is farther on the other side than
    the error says that the error is larger.
    """
    error, parts = max(error, left), np.linspace(*STEADY_PARTS, 11)
    each = 0.5 * (left**2 - np.square(left - parts * tone)) / error**2
    nats = float(logsumexp(each)) - np.log(len(parts))
    return float(np.clip(min(nats, 0.0) if left > 0 else nats, -QUIET_MOST_NATS, QUIET_MOST_NATS))


def quiet_samples(magnitude: Floats, delay: Floats) -> NDArray[np.bool_]:
    """Return which samples [K] of rows [n, K] hold noise alone, as those before the path do.

    Those before it, and those from where on the mean power is that of these.
    """
    power, early = mean_known(magnitude**2, 0), early_samples(delay)
    if not early.any():
        return early
    smooth = np.convolve(power, np.full(QUIET_SMOOTH, 1 / QUIET_SMOOTH), "same")
    loud = np.flatnonzero(~early & ~(smooth <= QUIET_LOUDER * power[early].mean()))
    return np.asarray(early | (np.arange(len(power)) > loud.max(initial=early.sum())))


def early_samples(delay: Floats) -> NDArray[np.bool_]:
    """Return which samples [K] of rows with such delays [n, K] lie before the path."""
    return np.asarray(mean_known(delay, 0) < NOISE_BEFORE_NS)


def moments_of(magnitude: Floats) -> Floats:
    """Return the mean squared power and the squared mean power of rows [n, 2] of samples [n, K].

    Over the square of the row's own mean, so that loud rows count like others, and beside the mean
    power of every sample, as some may hold a little of a tail. The squared mean is the mean product
    of samples that are no neighbours: it is of noise of any colour.
    """
    power = magnitude**2
    power = power / mean_known(power, 0)
    power = power / np.maximum(mean_known(power, 1), np.finfo(float).tiny)[:, None]
    count = _products(np.isfinite(power).astype(np.float64))
    power = np.where(count[:, None] > 0, power, np.nan)  # a row that ends early says nothing
    pairs = _products(np.nan_to_num(power)) / np.maximum(count, 1.0)
    squares = np.nan_to_num(power**2).sum(axis=1) / np.maximum(np.isfinite(power).sum(axis=1), 1)
    return np.stack([squares, pairs], axis=1)


def loud_moments(magnitude: Floats) -> Floats:
    """Return the moments of rows [n, 2] as `moments_of` does, times their mean power.

    A tone that fades is in loud rows, which count the more, if not by the square of it.
    """
    power = mean_known(magnitude**2 / mean_known(magnitude**2, 0), 1)
    return np.asarray(moments_of(magnitude) * np.nan_to_num(power)[:, None])


def mean_known(values: Floats, axis: int) -> Floats:
    """Return the mean of what is known along an axis, NaN where nothing is."""
    known = np.isfinite(values)
    count = known.sum(axis=axis)
    return np.asarray(
        np.where(known, values, 0.0).sum(axis=axis) / np.where(count > 0, count, np.nan)
    )


def ratio_of(moments: Floats) -> float:
    """Return the mean squared power over the squared mean power of rows [n, 2]: 2 of noise."""
    return float(moments[:, 0].sum() / moments[:, 1].sum())


def error_of(moments: Floats) -> float:
    """Return the standard error of `ratio_of` of rows or links [n, 2]: that of a ratio of means."""
    left = moments[:, 0] - ratio_of(moments) * moments[:, 1]
    return float(left.std() / np.sqrt(len(left)) / moments[:, 1].mean())


def _products(values: Floats) -> Floats:
    """Return the sum of products of samples that are `COLOUR_SAMPLES` apart or more [n]."""
    near = sum((values[:, lag:] * values[:, :-lag]).sum(axis=1) for lag in range(1, COLOUR_SAMPLES))
    return np.asarray(values.sum(axis=1) ** 2 - (values**2).sum(axis=1) - 2 * near)
