"""What a name brings beside something without a form: whether its own form is needed.

What nobody listed often looks a little like a listed effect, and that then brings much. So every
statistic may also move by factors of its own, over a constant and the distance, each as far as the
recordings ask (automatic relevance determination: Tipping 2001). An effect of the right form makes
most of these needless, and tells links apart as they cannot; one of the wrong form does neither.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.likelihood import columns_of, owns, paid, white, whitener
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.settings import (
    FORMS,
    SIZE_LARGEST,
    SIZE_LEAST,
    SIZE_STEPS,
    SIZE_WEIGHINGS,
    TAIL,
)
from bench.discrepancy.joint.spared import scattered_as
from bench.discrepancy.joint.statistics import Statistics

Floats = NDArray[np.float64]


def beside_unformed(given: Statistics, fit: Fit, whole: Fit | None = None) -> float:
    """Return the evidence of a set beside what has no form, of a size for every statistic, in nats.

    The sizes cost nothing: what must be asked of a name is then that it brings anything at all.
    Links may differ by themselves from what has no form as from what `whole` does in its place:
    else the name alone would pay for that it may not be right. Nor need links scatter more than
    without the set: how much they do is a matter of its form, too.
    """
    plain = scattered_as(fit.moments, given.needed(()))
    scatters = (fit.moments, plain) if fit.effects else (plain,)
    return max(_beside(given, replace(fit, moments=one), whole or fit) for one in scatters)


def _beside(given: Statistics, fit: Fit, whole: Fit) -> float:
    """Return that evidence for one scatter, at the likeliest allowance for forms of the set."""
    matrices, volume = whitener(given, fit.moments, whole.responses)
    flat = white(matrices, fit.moments.left)
    forms = [columns_of(matrices, FORMS[1] * one, given.ways) for one in fit.responses]
    free = columns_of(matrices, np.ones_like(flat), given.ways)
    every = (
        np.concatenate([own, *(size / FORMS[1] * form for form in forms)], axis=2)
        for own in owns(matrices, fit.moments)
        for size in (FORMS if forms else FORMS[:1])
    )
    best = max(_of_sizes(flat, fixed, free) for fixed in every) - 0.5 * volume
    return paid(given, best + fit.moments.within, fit.parameters)


def _of_sizes(flat: Floats, fixed: Floats, free: Floats) -> float:
    """Return the log likelihood at the likeliest sizes of what has no form."""
    square, best = np.ones(flat.shape[1]), -np.inf
    for _ in range(SIZE_STEPS):
        nats, squares = _likeliest(flat, fixed, free, square)
        best = max(best, nats)
        square = np.clip(squares, SIZE_LEAST**2, SIZE_LARGEST**2)
    return best


def _likeliest(flat: Floats, fixed: Floats, free: Floats, square: Floats) -> tuple[float, Floats]:
    """Return the log likelihood at the likeliest factors, and the squared sizes [p] that they ask.

    `free` [L, p, p w] holds all ways of the first statistic, of the second, ...
    """
    sizes = np.sqrt(np.repeat(square, free.shape[2] // len(square)))
    columns = np.concatenate([fixed, free * sizes], axis=2)
    freedom, count = TAIL + flat.shape[1], columns.shape[2]
    left, factors, inner = flat, np.zeros(count), np.eye(count)
    for _ in range(SIZE_WEIGHINGS):
        weights = freedom / (TAIL + (left**2).sum(axis=1))
        heavy = (columns * weights[:, None, None]).reshape(-1, count)
        inner = heavy.T @ columns.reshape(-1, count) + np.eye(count)
        factors = np.linalg.solve(inner, heavy.T @ flat.ravel())
        left = flat - columns @ factors
    nats = -0.5 * freedom * float(np.log1p((left**2).sum(axis=1) / TAIL).sum())
    nats -= 0.5 * float(factors @ factors) + 0.5 * float(np.linalg.slogdet(inner)[1])
    told = (1 - np.diag(np.linalg.inv(inner)))[fixed.shape[2] :].reshape(len(square), -1)
    moved = (factors[fixed.shape[2] :] ** 2).reshape(len(square), -1).sum(axis=1)
    return nats, square * moved / np.maximum(told.sum(axis=1), 1e-9)
