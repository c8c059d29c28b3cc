"""Columns of the user's own that were taken as measured with the range, and are not.

What scatters from row to row is set aside, for a receiver's quality figure that follows the error
would else explain it. But such a figure follows the noise too. Where a law over a column explains
what a set of causes leaves, or stands in for names of it, and what is left then scatters just as
simulated rows do, the column says nothing of the noise: it was known before.
"""

from __future__ import annotations

from collections.abc import Iterator
from copy import copy
from dataclasses import dataclass
from itertools import islice
from math import log
from typing import TYPE_CHECKING

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.law.material import material
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.beside import nats_with, reweighed
from bench.discrepancy.sets.choice import Set
from bench.discrepancy.sets.evidence import Weighed
from bench.discrepancy.sets.formed import Formed, groups_of, laws_of, left_by
from bench.discrepancy.sets.rivals import CONSTANT
from bench.discrepancy.sets.settings import (
    AS_SIMULATED,
    FORM_NATS,
    LAW_M,
    LEAST_WEIGHT,
    MISTAKEN_NATS,
    RIVAL_NATS,
)
from bench.discrepancy.settings import RESIDUAL_MEMBERS

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest

Floats = NDArray[np.float64]


def mistaken(
    contest: Contest, best: Set, doubtful: pd.DataFrame, ensemble: Ensemble
) -> tuple[str, ...]:
    """Return which `doubtful` columns [all rows] are known before, beside or instead of `best`.

    `ensemble` has the simulated versions of the contest's view.
    """
    if not len(doubtful.columns):
        return ()
    asked = _Asked(contest, best, doubtful, _scatter(contest, ensemble))
    return tuple(filter(asked.known_before, map(str, doubtful.columns)))


def beside_alike(search: Search, beside: Added, contest: Contest) -> Contest:
    """Return a contest of ranges beside the simulated rows of similar links, too.

    Few rows of a link leave so much of their own noise that what follows the recorded one seems to
    leave what is simulated.
    """
    rows = search.work
    if rows is None or not len(search.doubtful.columns):
        return contest
    made = residual_range(search.comparison, rows, beside, RESIDUAL_MEMBERS, alike=True)
    if made is None:
        return contest
    other = copy(contest)
    other.evidence = contest.evidence.toward(made[1][contest.known])
    other.crowding, other._nats = search.comparison.crowding(rows) ** 2, {}
    return other


@dataclass(frozen=True)
class _Asked:
    """Whether laws over columns that were set aside hold; simulated rows scatter by `noise_m2`."""

    contest: Contest
    best: Set
    doubtful: pd.DataFrame
    noise_m2: float

    def known_before(self, name: str) -> bool:
        """Return whether a law over a column holds beside the set, or in the place of names.

        There it needs no more than a law over a known column: it makes a cause less, not one more.
        A constant beside it could be a name, so it must do without.
        """
        instead = FORM_NATS + log(len(self.doubtful.columns))
        return any(
            self._leads(law, gone, instead if gone else MISTAKEN_NATS)
            for gone in ((), *groups_of(self.contest, self.best))
            for law in islice((o for o in self._laws(name, gone) if not (gone and o.offset)), 1)
        )

    def _laws(self, name: str, gone: Set) -> Iterator[Formed]:
        """Yield the laws over a column of what the set leaves without the names `gone`."""
        contest = self.contest
        rows, links = contest.rows.rows[contest.known], contest.rows.links[contest.known]
        frame = self.doubtful[[name]].iloc[rows].reset_index(drop=True)
        every = material(frame, left_by(contest, self.best, gone), links)
        if every.columns and len(every.residual_m) == len(rows):
            taken = np.flatnonzero(contest.evidence.weights > LEAST_WEIGHT)
            yield from (law for law in laws_of(every, every.take(taken)) if law.over)

    def _leads(self, law: Formed, gone: Set, price: float) -> bool:
        """Return whether a law beats the set, or a constant, by a price in nats.

        And leaves what is simulated, nearer to that than the set alone: a figure that follows the
        noise leaves less. Or leaves nothing for names to do: the mean of what these did is its own,
        and a figure that follows the noise knows of no delay.
        """
        contest, rest = self.contest, tuple(one for one in self.best if one not in gone)
        made = {law.name: law.parts}
        none = nats_with(contest, rest, {CONSTANT: (np.full((len(contest.known), 1), LAW_M),)})
        lead = nats_with(contest, rest, made) - law.pays - max(contest.nats(self.best), none)
        if lead <= price:
            return False
        before = np.inf if self._needless(law, gone) else contest.evidence.of(self.best).variance_m2
        left = reweighed(contest, rest, made)
        return any(self._alike(one, before) for one in (left.variance_m2, _whole(left)))

    def _needless(self, law: Formed, gone: Set) -> bool:
        """Return whether names do nothing any more where a law is in place."""
        rest, made = tuple(one for one in self.best if one not in gone), {law.name: law.parts}
        brings = nats_with(self.contest, self.best, made) - nats_with(self.contest, rest, made)
        return bool(gone) and brings < RIVAL_NATS

    def _alike(self, after_m2: float, before_m2: float) -> bool:
        """Return whether a law leaves what is simulated, nearer to that than before it."""
        after, before = after_m2 / self.noise_m2, before_m2 / self.noise_m2
        return AS_SIMULATED[0] < after < AS_SIMULATED[1] and abs(log(after)) < abs(log(before))


def _scatter(contest: Contest, ensemble: Ensemble) -> float:
    """Return the variance of simulated rows in the recorded ones' place, weighed as these are.

    Each beside the mean of the others, of which there is one less; infinite where there is one.
    With what links keep: rows of one link may have a simulated row in common.
    """
    versions = ensemble.simulated_of(RANGE)[:, contest.known]
    count, found = len(versions), []
    for one in range(count if count > 1 else 0):
        others = np.delete(versions, one, axis=0).mean(axis=0)
        made = contest.evidence.with_blocks({}).toward(contest.seen(versions[one] - others))
        made.weights = np.ones(len(others))
        made.reweigh(())
        found.append(_whole(made.of(())))
    return float(np.mean(found)) * (1 - 1 / count**2) if found else np.inf


def _whole(left: Weighed) -> float:
    """Return the variance that is left, of rows and of their links, in square metres."""
    return left.variance_m2 * (1 + left.ratio)
