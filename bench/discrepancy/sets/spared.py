"""Constants that only a few rows show: most are as simulated, the others far off.

A constant moves every row. A receiver that locks on to something else in a third of the rows moves
the mean, too, and no heavy tail of one hump weighs a third of all rows down (a Student t of four
degrees of freedom breaks down at a fifth: Lange, Little and Taylor 1989). So both are compared.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.sets.choice import Set
from bench.discrepancy.sets.settings import (
    HUMP_STEPS,
    LEAST_VARIANCE_M2,
    NAME_NATS,
    SECOND_HUMP,
)

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

Floats = NDArray[np.float64]


def moves_every_row(contest: Contest, causes: Set) -> Set:
    """Return the set without names that do a mere constant, which most rows do not show."""
    made = contest.evidence.of(causes)
    for name in [one for one in causes if one in contest.library]:
        mine = contest.evidence.response(made, name)
        rest = [contest.evidence.response(made, one) for one in causes if one != name]
        left = contest.evidence.left_m - np.sum([np.zeros(len(mine)), *rest], axis=0)
        if np.std(mine) < abs(mine.mean()) / 2 and most_are_spared(left, abs(float(mine.mean()))):
            causes = tuple(one for one in causes if one != name)
    return causes


def most_are_spared(left_m: Floats, constant_m: float) -> bool:
    """Return whether most of some ranges [n] are where they were, and the rest far off.

    Two normal humps, one about zero, against one hump anywhere (BIC); the hump about zero must
    have most rows, and be so narrow that rows off by the constant are no part of it.
    """
    near = np.abs(left_m) < constant_m / 2
    if not near.any() or near.all():
        return False
    share, width, two = _two_humps(left_m, near.astype(np.float64))
    middle = left_m - left_m.mean()
    one = _log(_density(middle, float((middle**2).mean())))
    lead = two - one - SECOND_HUMP / 2 * np.log(len(left_m))
    return bool(lead > NAME_NATS and share > 0.5 and width < constant_m / 2)


def _two_humps(left_m: Floats, part: Floats) -> tuple[float, float, float]:
    """Return share and width of the hump about zero, and the log-likelihood of both.

    By expectation and maximisation, from `part` [n]: how much each range is of the hump at zero.
    """
    share, width2, every = 0.0, 0.0, np.zeros(len(left_m))
    for _ in range(HUMP_STEPS):
        share, width2 = float(part.mean()), _variance(left_m, part)
        off = left_m - np.average(left_m, weights=1 - part + 1e-9)
        spared = share * _density(left_m, width2)
        every = spared + (1 - share) * _density(off, _variance(off, 1 - part))
        part = spared / np.maximum(every, 1e-300)
    return share, width2**0.5, _log(every)


def _log(density: Floats) -> float:
    return float(np.log(np.maximum(density, 1e-300)).sum())


def _variance(left_m: Floats, weights: Floats) -> float:
    total = max(float(weights.sum()), 1e-9)
    return max(float(weights @ left_m**2) / total, LEAST_VARIANCE_M2)


def _density(left_m: Floats, variance: float) -> Floats:
    return np.asarray(np.exp(-(left_m**2) / (2 * variance)) / np.sqrt(2 * np.pi * variance))
