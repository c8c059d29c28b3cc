"""What effects draw by chance: how it moves the statistics of a link together."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, fields

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.joint.covariances import Covariances, beyond_rows, in_parts, shrunk
from bench.discrepancy.joint.settings import LEAST_VARIANCE, SAME_SCATTER

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class WithDrawn(Covariances):
    """Covariances and what effects change by chance: of links and rows, `change` [p, p] each.

    What is drawn once for a link moves all statistics along one way: shrunk to its diagonal it
    would move each by itself, and a reflection of chance phase would ask for scatter that no link
    has. What goes with the statistic at place `level` is shrunk all the same: scatter of levels
    alone would stand for any form of a loss. How far each scatters `whole` says: an effect may
    drown what is there. Where it takes much of that away, it is no sum, and in between (see
    `SAME_SCATTER`) partly one: fits go by small steps.
    """

    change: tuple[Floats, Floats]
    level: int
    whole: Covariances

    def made(self) -> Floats:
        """Return covariances [c, p, p]: a sum as far as scatter adds up."""
        added = self._sum()
        ratio = _sizes(self.whole.every) / np.maximum(_sizes(added), LEAST_VARIANCE)
        off = float(np.abs(np.log(np.maximum(ratio, LEAST_VARIANCE))).max())
        share, scale = float(np.interp(off, SAME_SCATTER, (1.0, 0.0))), np.sqrt(ratio)
        added *= share * scale[:, :, None] * scale[:, None]
        return np.asarray(added + (1 - share) * self.whole.every)

    def _sum(self) -> Floats:
        """Return the covariances as a sum."""
        level = [_going_with(one, self.level) for one in self.change]
        shared = self.over(self.link + level[0], self.rows + level[1])
        rest = self.over(self.change[0] - level[0], self.change[1] - level[1])
        made = shrunk(shared, self.share) + shrunk(rest, 0.0)
        return np.asarray(made * self.wider + self.besides)


def with_drawn(
    plain: Mapping[int, Floats],
    whole: Mapping[int, Floats],
    change: Floats,
    code: Codes,
    level: int,
) -> Mapping[int, Floats]:
    """Return covariances with what effects draw (see `WithDrawn`), made when they are asked for.

    `plain` are those without the effects, `whole` with them. `change` [m, n, p]: what effects do to
    rows of m versions, each drawn anew; `code` [n] tells their links.
    """
    if not (isinstance(plain, Covariances) and isinstance(whole, Covariances)) or len(change) < 2:
        return whole
    own = {one.name: getattr(plain, one.name) for one in fields(plain)}
    return WithDrawn(**own, change=drawn(change, code), level=level, whole=whole)


def drawn(change: Floats, code: Codes) -> tuple[Floats, Floats]:
    """Return the covariances [p, p] of what versions [m, n, p] draw for links, and for rows."""
    members, count = len(change), np.bincount(code)
    own = (change - change.mean(axis=0)) * np.sqrt(members / (members - 1))
    between, rows, _ = in_parts(own, code, count)
    return beyond_rows(between, rows, count), rows


def _going_with(covariance: Floats, place: int) -> Floats:
    """Return that part of a covariance [p, p] which goes with the statistic at a place."""
    own = max(float(covariance[place, place]), LEAST_VARIANCE)
    return np.asarray(np.outer(covariance[place], covariance[place]) / own)


def _sizes(covariances: Floats) -> Floats:
    """Return the variances [c, p] of covariances [c, p, p]."""
    return np.asarray(np.diagonal(covariances, axis1=-2, axis2=-1))
