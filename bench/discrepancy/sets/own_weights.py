"""Sets beside each other, each with the weights that rows have beside it.

Rows are weighed as Student's t says beside the set that seems best, so they speak for that set: of
two that are near each other either may win at its own weights. With rows of weights w the evidence
is less than that of Student's t, and as much at the weights that a set itself gives them, once
these have paid for what they were before: nu / 2 (log w - w) each, of a gamma law (a variational
bound: Jaakkola and Jordan 2000).
"""

from __future__ import annotations

from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np

from bench.discrepancy.law.settings import LAW_TAIL
from bench.discrepancy.sets.choice import Set
from bench.discrepancy.sets.settings import LEAST_WEIGHT, NEAR_NATS, NEAR_SETS
from bench.discrepancy.sets.weigh import weighed

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest
    from bench.discrepancy.sets.evidence import Evidence


class Beside:
    """A set that others are compared with, each at the weights that rows have beside it."""

    def __init__(self, contest: Contest, causes: Set) -> None:
        self.contest, self.causes = contest, causes

    @cached_property
    def _own(self) -> Evidence:
        return _weighed_by(self.contest, self.causes)

    def lead(self, other: Set) -> float:
        """Return by how much another set is worth more, of the rows that take part beside both."""
        contest, own, made = self.contest, self._own, _weighed_by(self.contest, other)
        rows = np.minimum(made.weights, own.weights) > LEAST_WEIGHT
        worth = _worth(contest, own.among(rows), self.causes)
        return _worth(contest, made.among(rows), other) - worth


def likeliest(contest: Contest, best: Set) -> Set:
    """Return the likeliest of the best set and those near it that do other things instead."""
    least, beside = contest.worth(best) - NEAR_NATS, Beside(contest, best)
    near = [o for o in contest.weighed() if contest.worth(o) > least and _instead(o, best)]
    leads = {one: beside.lead(one) for one in near[:NEAR_SETS]}
    able = [one for one, nats in leads.items() if nats > 0]
    return max(able, key=lambda one: leads[one], default=best)


def _instead(one: Set, other: Set) -> bool:
    """Return whether either of two sets has something that the other has not."""
    return not set(one) <= set(other) and not set(other) <= set(one)


def _weighed_by(contest: Contest, causes: Set) -> Evidence:
    """Return the evidence with the weights that rows have beside a set."""
    made = contest.evidence.with_blocks(contest.evidence.blocks)
    made.reweigh(causes)
    return made


def _worth(contest: Contest, evidence: Evidence, causes: Set) -> float:
    """Return what a set is worth at the weights of an evidence, which are paid for."""
    weights = evidence.weights[evidence.weights > LEAST_WEIGHT]
    paid = LAW_TAIL / 2 * float((np.log(weights) - weights).sum())
    nats = weighed(evidence, contest.single, [causes])[causes] + paid
    return nats / contest.crowding - sum(map(contest.price, causes))
