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
from bench.discrepancy.law.likelihood import weights
from bench.discrepancy.law.material import material
from bench.discrepancy.select.state import Search
from bench.discrepancy.sets.beside import nats_with, reweighed
from bench.discrepancy.sets.choice import Set
from bench.discrepancy.sets.evidence import Columns, Weighed
from bench.discrepancy.sets.formed import Formed, groups_of, laws_of, left_by
from bench.discrepancy.sets.rivals import CONSTANT
from bench.discrepancy.sets.settings import (
    AS_SIMULATED,
    FORM_NATS,
    LAW_M,
    LEAST_VARIANCE_M2,
    LEAST_WEIGHT,
    MISTAKEN_NATS,
    REWEIGHINGS,
    RIVAL_NATS,
)
from bench.discrepancy.settings import ONE_SIDED_95, RESIDUAL_MEMBERS

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
    asked = _Asked(contest, best, doubtful, *_scatters(contest, ensemble))
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
    """Whether laws over columns that were set aside hold; simulated rows scatter by `noise_m2`.

    And by `rows_m2`, whichever links they are of.
    """

    contest: Contest
    best: Set
    doubtful: pd.DataFrame
    noise_m2: float
    rows_m2: float

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
        return self._leaves_simulated(rest, made, self._needless(law, gone))

    def _leaves_simulated(self, rest: Set, made: Columns, needless: bool) -> bool:
        """Return whether a law beside some of the set leaves what is simulated (see `_leads`).

        Of rows of links; or of rows alone, of which more is known, within what chance makes.
        """
        contest, known = self.contest, self.contest.evidence.weights > LEAST_WEIGHT
        left, rows_m = reweighed(contest, rest, made)
        before = [
            contest.evidence.of(self.best).variance_m2 / self.noise_m2,
            of_rows(left_by(contest, self.best, ())[known]) / self.rows_m2,
        ]
        of_links, of_all = (np.inf if needless else one for one in before)
        share, chance = of_rows(rows_m) / self.rows_m2, _chance(contest, len(rows_m))
        return _alike(share, of_all, chance) or any(
            _alike(one / self.noise_m2, of_links) for one in (left.variance_m2, _whole(left))
        )

    def _needless(self, law: Formed, gone: Set) -> bool:
        """Return whether names do nothing any more where a law is in place."""
        rest, made = tuple(one for one in self.best if one not in gone), {law.name: law.parts}
        brings = nats_with(self.contest, self.best, made) - nats_with(self.contest, rest, made)
        return bool(gone) and brings < RIVAL_NATS


def _alike(after: float, before: float, chance: float = 1.0) -> bool:
    """Return whether a law leaves what is simulated, nearer to that than before it, as shares.

    Or less than it may by a factor of chance.
    """
    usual = AS_SIMULATED[0] < after * chance and after < AS_SIMULATED[1]
    return usual and abs(log(after)) < abs(log(before))


def _chance(contest: Contest, count: int) -> float:
    """Return by what factor the variance of rows is too small by chance, against simulated ones.

    One-sided, 95 %; of normal rows, of which the simulated ones may stand for several.
    """
    return float(np.exp(ONE_SIDED_95 * np.sqrt(2 * (1 + contest.crowding) / count)))


def _scatters(contest: Contest, ensemble: Ensemble) -> tuple[float, float]:
    """Return the variances of simulated rows in the recorded ones' place, weighed as these are.

    Each beside the mean of the others, of which there is one less; infinite where there is one.
    With what links keep, as rows of one link may have a simulated row in common; and of rows alone
    (see `of_rows`).
    """
    versions = ensemble.simulated_of(RANGE)[:, contest.known]
    count, found = len(versions), []
    for one in range(count if count > 1 else 0):
        others = np.delete(versions, one, axis=0).mean(axis=0)
        made = contest.evidence.with_blocks({}).toward(contest.seen(versions[one] - others))
        made.weights = np.ones(len(others))
        made.reweigh(())
        found.append((_whole(made.of(())), of_rows(made.left_m[made.weights > LEAST_WEIGHT])))
    links_m2, rows_m2 = np.mean(found, axis=0) * (1 - 1 / count**2) if found else (np.inf, np.inf)
    return float(links_m2), float(rows_m2)


def of_rows(left_m: Floats) -> float:
    """Return the variance of rows [n] about their mean, far ones weighed by Student's t.

    Whichever links they are of: where rows of a link share simulated ones, what is far off is
    theirs in common, which no weight lessens, and of the recorded ones it is a row's alone.
    """
    left_m = left_m - np.median(left_m)
    weight = np.ones(len(left_m))
    for _ in range(REWEIGHINGS):
        size = float(np.mean(weight * left_m**2))
        weight = weights(left_m, float(np.sqrt(max(size, LEAST_VARIANCE_M2))))
    return size


def _whole(left: Weighed) -> float:
    """Return the variance that is left, of rows and of their links, in square metres."""
    return left.variance_m2 * (1 + left.ratio)
