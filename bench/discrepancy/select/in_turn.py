"""Whether rows of a link that follow each other scatter apart: what is drawn for every row does.

A deck that heels, somebody who leans over, a clock that wanders: each moves the ranges of a link
from row to row, as jitter does, but row after row by nearly as much. Where such rows differ by
less than any two of their link, nothing was drawn for each (von Neumann 1941).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.settings import (
    IN_TURN_DRAWS,
    IN_TURN_P,
    IN_TURN_ROWS,
    IN_TURN_SHARE,
)
from bench.discrepancy.select.within_links import components
from bench.physics.units import Floats

NOTE = "rows of one link that follow each other scatter alike"


def apart_in_turn(made: Ensemble, time_s: Floats, seed: int = 0) -> Adequacy:
    """Return whether ranges of rows [n] that follow each other differ as any two of a link do.

    Beyond simulated ones, and what cannot be chance where rows of a link change places. In the
    order of their times, of the table where these are not known.
    """
    code = np.unique(made.links, return_inverse=True)[1]
    values = made.versions_of(RANGE) - made.simulated_of(RANGE).mean(axis=0)
    able = (np.bincount(code)[code] >= IN_TURN_ROWS) & np.isfinite(values).all(axis=0)
    if not able.any():
        return Adequacy(True)
    order = np.lexsort((np.nan_to_num(time_s[able]), code[able]))
    values, code = values[:, able][:, order], code[able][order]
    steps, within = ([of(one, code) for one in values] for of in (_steps, _within))
    after, beyond = (one[0] - float(np.mean(one[1:])) for one in (steps, within))
    if beyond <= 0 or after > IN_TURN_SHARE * beyond:
        return Adequacy(True)
    chance = _chance(values[0], code, seed)
    return Adequacy(chance > IN_TURN_P, 1.0, note=NOTE)


def _steps(values: Floats, code: NDArray[np.intp]) -> float:
    """Return the variance that rows of a link, one after the other, differ by."""
    same = code[1:] == code[:-1]
    return float(np.mean(np.diff(values)[same] ** 2) / 2)


def _within(values: Floats, code: NDArray[np.intp]) -> float:
    """Return the variance of rows of a link about its mean."""
    return components(values, code)[1]


def _chance(values: Floats, code: NDArray[np.intp], seed: int) -> float:
    """Return how often rows of links in random turns differ by no more than as they are."""
    rng, own = np.random.default_rng(seed), _steps(values, code)
    mixed = (values[np.lexsort((rng.random(len(code)), code))] for _ in range(IN_TURN_DRAWS))
    below = sum(_steps(one, code) <= own for one in mixed)
    return (1 + below) / (1 + IN_TURN_DRAWS)
