"""Factors of many ways at once, of size one before, where rows far off weigh less."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np

from bench.physics.units import Floats

FITS, TAIL = 6, 4.0  # of rows weighed anew; degrees of freedom of their scatter, Student's t
MEDIAN_OF_NORMAL = 0.6745  # of |z|
OTHER_NATS = 6.0  # that another cause must be likelier by than many ways that need none
LEAST_FACTOR = 0.2  # of a cause: published exponents differ by as much from 2 (IEEE 802.15.4a)


@dataclass(frozen=True)
class Ridge:
    """The factors of `ways` [n, k] that leave least of `left` [n], beside a constant.

    The constant, typically of a size `constant`, is another cause.
    """

    ways: Floats
    left: Floats
    constant: float

    @property
    def factors(self) -> Floats:
        """The factor of every way [k]."""
        return self._solved[0][:-1]

    def scatters(self, others: Floats) -> Floats:
        """Return the standard deviation of what is left of each of `others` [n, m], [m].

        Of rows that are not far off, at the weights of the fit.
        """
        return np.sqrt([_variance(one) for one in self._left_of(others, self._solved[1]).T])

    def evidences(self, others: Floats, scatter: float, counts: float) -> Floats:
        """Return the log evidence of each of `others` [n, m] in the place of `left`, [m].

        Factors are Gaussian of size one, rows normal of such a scatter and the weights of the fit
        (Bishop 2006, equation 3.86); each row counts as `counts` of one.
        """
        variance = scatter**2 / counts
        rest = self._left_of(others, variance)
        folded = np.linalg.slogdet(self._square(self._weight, variance) / variance)[1]
        known = (self._weight[:, None] * others * rest).sum(axis=0) / variance
        return np.asarray(-0.5 * (known + folded))

    @cached_property
    def _design(self) -> Floats:
        return np.column_stack([self.ways, np.full(len(self.left), self.constant)])

    @cached_property
    def _solved(self) -> tuple[Floats, float]:
        """Return the factors [k + 1] and the variance of what they leave."""
        design, rest = self._design, self.left - np.median(self.left)
        factors: Floats = np.zeros(design.shape[1])
        for _ in range(FITS):
            variance = _variance(rest)
            weight = _weight(rest, variance)
            square = self._square(weight, variance)
            factors = np.asarray(np.linalg.solve(square, design.T @ (weight * self.left)))
            rest = self.left - design @ factors
        return factors, _variance(rest)

    @cached_property
    def _weight(self) -> Floats:
        factors, variance = self._solved
        return _weight(self.left - self._design @ factors, variance)

    def _square(self, weight: Floats, variance: float) -> Floats:
        design = self._design
        return (design * weight[:, None]).T @ design + variance * np.eye(design.shape[1])

    def _left_of(self, others: Floats, variance: float) -> Floats:
        """Return what the ways leave of values [n, m]."""
        design = self._design
        told = design.T @ (self._weight[:, None] * others)
        square = self._square(self._weight, variance)
        return np.asarray(others - design @ np.linalg.solve(square, told))


def taken(
    ways: Floats, left: Floats, does: Floats, counts: float = 1.0, constant: float = 1.0
) -> Floats | None:
    """Return what another cause does to `left` [n] beside `ways` [n, k], None where it need not.

    It does `does` [n] times a factor of about one; each row counts as `counts` of one. A factor
    below `LEAST_FACTOR` only mends what ways do not do quite.
    """
    alone = Ridge(ways, left, constant)
    beside = Ridge(np.column_stack([ways, does]), left, constant)
    own = left[:, None]
    scatter = max(min(float(one.scatters(own)[0]) for one in (alone, beside)), 1e-6)
    bare, whole = (float(one.evidences(own, scatter, counts)[0]) for one in (alone, beside))
    small = abs(float(beside.factors[-1])) < LEAST_FACTOR
    return None if small or whole - bare < OTHER_NATS else beside.factors[-1] * does


def without_fall(
    ways: Floats,
    left_db: Floats,
    true_range_m: Floats,
    counts: float = 1.0,
    constant: float = 1.0,
) -> Floats:
    """Return levels [n] without a fall over the distance [n] where `ways` [n, k] do not do for it.

    A path loss, which a receiver's freedom or the mean of a gain would take a part of.
    """
    fall_db = -10 * np.log10(np.maximum(true_range_m, 1.0))
    fallen = taken(ways, left_db, fall_db, counts, constant)
    return left_db if fallen is None else left_db - fallen


def _variance(rest: Floats) -> float:
    """Return the variance of most of what is left [n]."""
    return max(float(np.median(np.abs(rest))) / MEDIAN_OF_NORMAL, 1e-6) ** 2


def _weight(rest: Floats, variance: float) -> Floats:
    """Return the weights of rows [n] that scatter as Student's t."""
    return np.asarray((TAIL + 1) / (TAIL + rest**2 / variance))
