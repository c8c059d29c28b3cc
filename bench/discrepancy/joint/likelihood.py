"""How probable recorded statistics are if only some effects act, and if their forms are not right.

Library forms are never exactly right, so what a set leaves may be another form of it: links differ
from the response by some share each by itself, and all of them together by smooth deformations of
it, every statistic by its own factors (a discrepancy allowance: Kennedy and O'Hagan 2001).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.settings import (
    ACTS,
    ALONE,
    FORMS,
    FREE_SIZES,
    KNOWN_SIZE,
    TAIL,
    WEIGHINGS,
)
from bench.discrepancy.joint.statistics import Moments, Statistics
from bench.discrepancy.joint.whitening import cholesky, inverted, solved

Floats = NDArray[np.float64]
Responses = Sequence[Floats]
Free = tuple[float, Floats]
NONE: Free = 0.0, np.zeros((0, 0))
Root = tuple[Floats, float]
"""Lower roots [L, p, p] of covariances, and their log volume."""


def whitener(given: Statistics, moments: Moments, responses: Responses) -> tuple[Floats, float]:
    """Return the matrices [L, p, p] that whiten every link, and the log volume of its scatter.

    Links may differ from each response by a share of it by themselves: the likeliest of some. A
    larger one than there is would make a smaller response, which asks for less, look likelier.
    """
    _, (root, volume) = _likeliest_root(given, moments, moments.left, responses)
    return inverted(root), volume


def _likeliest_root(
    given: Statistics, moments: Moments, left: Floats, responses: Responses
) -> tuple[float, Root]:
    """Return how likely what is `left` [L, p] is in nats, and the root of the scatter it has."""
    scatter, sizes = _scatter(given, moments), ALONE if responses else (0.0,)
    made = [_root(scatter, size, responses) for size in sizes]
    nats = [_nats(solved(root, left), volume) for root, volume in made]
    best = int(np.argmax(nats))
    return nats[best], made[best]


def _scatter(given: Statistics, moments: Moments) -> Floats:
    """Return the covariance [L, p, p] by which every link scatters, whatever forms effects have."""
    numbers, place = np.unique(given.count, return_inverse=True)

    def of_links(covariances: Mapping[int, Floats]) -> Floats:
        return np.stack([covariances[int(n)] for n in numbers])[place]

    covariance = of_links(moments.covariances)
    if moments.spared is not None:
        others = of_links(moments.spared.covariances)
        covariance = np.where(moments.spared.alone[:, None, None], others, covariance)
    if moments.uneven is not None:
        covariance += np.einsum("lik,ljk->lij", moments.uneven, moments.uneven)
    return covariance


def _root(scatter: Floats, size: float, responses: Responses) -> Root:
    """Return the root of the scatter of links that differ by a share of each response."""
    covariance, places = scatter.copy(), np.arange(scatter.shape[1])
    for response in responses:
        covariance[:, places, places] += (size * response) ** 2
    return cholesky(covariance)


def _nats(flat: Floats, volume: float) -> float:
    """Return the log likelihood of what is left, whitened [L, p], but for a constant."""
    freedom = float(TAIL + flat.shape[1])
    square = np.log1p((flat**2).sum(axis=1) / TAIL)
    return -0.5 * freedom * float(square.sum()) - 0.5 * volume


def white(matrices: Floats, values: Floats) -> Floats:
    """Return values [L, p], whitened."""
    return np.asarray(np.einsum("lij,lj->li", matrices, values))


def paid(given: Statistics, nats: float, parameters: int) -> float:
    """Return nats as links that share simulated ones count, less what parameters cost (BIC)."""
    return nats / given.crowding - parameters / 2 * float(np.log(given.links))


def fitness(
    given: Statistics, moments: Moments, left: Floats, responses: Responses, parameters: int
) -> float:
    """Return the log likelihood of what is `left` [L, p], in nats: what a fit makes largest.

    Links far off count by the logarithm of how far (Student's t).
    """
    nats, _ = _likeliest_root(given, moments, left, responses)
    return paid(given, nats + moments.within, parameters)


def misfits(given: Statistics, moments: Moments, responses: Responses) -> Floats:
    """Return what a set leaves [L, p], in scatters of its links: of size 1 where it is right.

    A posterior predictive check (Gelman, Meng and Stern 1996): among other sets the likeliest may
    be far off all the same. Forms and what devices have of their own are at their likeliest; links
    may differ by the largest share of a response that is allowed: its likeliest makes all fit.
    """
    matrices = inverted(_root(_scatter(given, moments), ALONE[-1], responses)[0])
    flat = white(matrices, moments.left)
    forms = [columns_of(matrices, FORMS[1] * one, given.ways) for one in responses]
    columns = np.concatenate([own_columns(matrices, moments), *forms], axis=2)
    ways = columns.reshape(flat.size, columns.shape[2])
    factors = np.linalg.solve(ways.T @ ways + np.eye(ways.shape[1]), ways.T @ flat.ravel())
    return np.asarray(flat - columns @ factors)


def link_nats(given: Statistics, moments: Moments, responses: Responses) -> Floats:
    """Return the log likelihood of every link [L] but for a constant, in nats (see `fitness`)."""
    matrices, _ = whitener(given, moments, responses)
    square = (white(matrices, moments.left) ** 2).sum(axis=1)
    volume = -np.log(np.einsum("lii->li", matrices)).sum(axis=1)
    freedom = TAIL + moments.left.shape[1]
    return np.asarray(-0.5 * freedom * np.log1p(square / TAIL) - volume)


def evidence(
    given: Statistics, moments: Moments, responses: Responses, parameters: int, free: Free = NONE
) -> float:
    """Return the log evidence of a set, whatever forms its effects have, in nats.

    With `free`, beside something that has no form: sizes, each with the ways [L, w] that it goes.
    """
    seen = whitened(given, moments, responses)
    every = (_evidence(given, seen, moments, responses, form, free) for form in FORMS)
    return max(paid(given, nats, parameters) for nats in every)


def evidence_of(
    given: Statistics, moments: Moments, responses: Responses, parameters: int
) -> float:
    """Return the log evidence of a set, for one allowance of its forms, in nats."""
    seen = whitened(given, moments, responses)
    return paid(given, _evidence(given, seen, moments, responses, FORMS[1], NONE), parameters)


def left_free(
    given: Statistics, moments: Moments, responses: Responses, parameters: int
) -> tuple[float, float]:
    """Return the evidence that something without a form brings beside a set, in nats.

    In all rows and over the distance, of the best size; and over one of all that is known, which
    pays for its choice.
    """
    whole = evidence(given, moments, responses, parameters)
    plain = max(
        evidence(given, moments, responses, parameters, (size, given.ways)) for size in FREE_SIZES
    )
    seen = whitened(given, moments, responses)
    free: list[Free] = [(KNOWN_SIZE, way[:, None]) for way in given.known.T]
    alone = [_evidence(given, seen, moments, responses, FORMS[1], one) for one in free]
    over = [paid(given, nats, parameters) for nats in alone]
    choice = float(np.log(max(len(over), 1)))
    return plain - whole, max(over, default=whole) - choice - whole


@dataclass(frozen=True)
class Whitened:
    """What links leave, whitened: the `matrices` [L, p, p] that do so, and their log `volume`.

    `flat` [L, p]: what is left; `owns`: see the function.
    """

    matrices: Floats
    volume: float
    flat: Floats
    owns: tuple[Floats, ...]

    def nats(self, columns: Sequence[Floats]) -> float:
        """Return the log likelihood beside normal factors of columns, of [L, p, k] each."""
        ways = (np.concatenate([*columns, own], axis=2) for own in self.owns)
        return max(integrated(self.flat, each) for each in ways) - 0.5 * self.volume


def whitened(given: Statistics, moments: Moments, responses: Responses) -> Whitened:
    """Return what links leave beside a set, whitened: the same for all forms of it."""
    matrices, volume = whitener(given, moments, responses)
    return Whitened(matrices, volume, white(matrices, moments.left), owns(matrices, moments))


def _evidence(
    given: Statistics,
    seen: Whitened,
    moments: Moments,
    responses: Responses,
    form: float,
    free: Free,
) -> float:
    """Return the log evidence of a set for one allowance of its forms, not yet `paid`."""
    columns = [columns_of(seen.matrices, form * response, given.ways) for response in responses]
    columns.append(columns_of(seen.matrices, np.full_like(moments.left, free[0]), free[1]))
    return seen.nats(columns) + moments.within


def integrated(flat: Floats, columns: Floats) -> float:
    """Return the log likelihood of whitened values [L, p] plus normal factors of columns [L, p, k].

    By Laplace's approximation at the likeliest factors, links weighed by how far they are off.
    """
    freedom, (factors, inner) = TAIL + flat.shape[1], _likeliest(flat, columns)
    left = flat - columns @ factors
    nats = -0.5 * float(freedom * np.log1p((left**2).sum(axis=1) / TAIL).sum())
    return nats - 0.5 * float(factors @ factors) - 0.5 * float(np.linalg.slogdet(inner)[1])


def _likeliest(flat: Floats, columns: Floats) -> tuple[Floats, Floats]:
    """Return the likeliest normal factors [k] of columns, and the curvature there [k, k]."""
    freedom, count = TAIL + flat.shape[1], columns.shape[2]
    left, factors, inner = flat, np.zeros(count), np.eye(count)
    for _ in range(WEIGHINGS if count else 0):
        weights = freedom / (TAIL + (left**2).sum(axis=1))
        heavy = (columns * weights[:, None, None]).reshape(-1, count)
        inner = heavy.T @ columns.reshape(-1, count) + np.eye(count)
        factors = np.linalg.solve(inner, heavy.T @ flat.ravel())
        left = flat - columns @ factors
    return factors, inner


def without_own(given: Statistics, moments: Moments, responses: Responses) -> Moments:
    """Return statistics less what devices or kinds have of their own, where that is likelier."""
    if moments.own is None or not moments.own.size:
        return moments
    matrices, _ = whitener(given, moments, responses)
    flat, own = white(matrices, moments.left), own_columns(matrices, moments)
    if integrated(flat, own) <= integrated(flat, own[..., :0]):
        return moments
    return replace(moments, left=moments.left - moments.own @ _likeliest(flat, own)[0])


def own_columns(matrices: Floats, moments: Moments) -> Floats:
    """Return what devices may have of their own, whitened [L, p, r]."""
    if moments.own is None:
        return np.zeros((*moments.left.shape, 0))
    return np.asarray(np.einsum("lij,ljr->lir", matrices, moments.own))


def owns(matrices: Floats, moments: Moments) -> tuple[Floats, ...]:
    """Return the columns of devices that do not differ, [L, p, 0], and of those that may."""
    own = own_columns(matrices, moments)
    return (own[..., :0], own) if own.shape[2] else (own,)


def columns_of(matrices: Floats, part: Floats, ways: Floats) -> Floats:
    """Return what every statistic may do by itself, over every way, whitened [L, p, k]."""
    acts = np.flatnonzero(np.abs(part).max(axis=0) > ACTS * FORMS[0])
    out = [
        matrices[:, :, place] * (part[:, place] * way)[:, None] for place in acts for way in ways.T
    ]
    return np.stack(out, axis=2) if out else np.zeros((*matrices.shape[:2], 0))
