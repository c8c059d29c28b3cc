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
from numpy.typing import NDArray

from bench.discrepancy.law.settings import LAW_TAIL
from bench.discrepancy.sets.choice import Set
from bench.discrepancy.sets.settings import LEAST_WEIGHT, NEAR_NATS, NEAR_SETS, RIVAL_NATS
from bench.discrepancy.sets.weigh import weighed
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.range_scale import RangeScale

if TYPE_CHECKING:
    from bench.discrepancy.sets.choose import Contest
    from bench.discrepancy.sets.evidence import Evidence

CONSTANT_AND_SCALE = {AntennaDelay.name, RangeScale.name}


class Beside:
    """A set that others are compared with, each at the weights that rows have beside it."""

    def __init__(self, contest: Contest, causes: Set) -> None:
        self.contest, self.causes = contest, causes

    @cached_property
    def _own(self) -> Evidence:
        return _weighed_by(self.contest.evidence, self.causes)

    def lead(self, other: Set) -> float:
        """Return by how much another set is worth more, of the rows that take part beside both."""
        contest, own, made = self.contest, self._own, _weighed_by(self.contest.evidence, other)
        rows = np.minimum(made.weights, own.weights) > LEAST_WEIGHT
        worth = _worth(contest, own.among(rows), self.causes)
        return _worth(contest, made.among(rows), other) - worth


def likeliest(contest: Contest, best: Set) -> Set:
    """Return the likeliest of the best set and those near it that do other things instead."""
    least, beside = contest.worth(best) - NEAR_NATS, Beside(contest, best)
    near = [o for o in contest.weighed() if contest.worth(o) > least and _instead(o, best)]
    asked = [*near[:NEAR_SETS], *(o for o in near[NEAR_SETS:] if _of_level(contest, o, best))]
    leads = {one: beside.lead(one) for one in asked}
    able = [one for one, nats in leads.items() if nats > must_lead(contest, one, best)]
    return max(able, key=lambda one: leads[one], default=best)


def must_lead(contest: Contest, one: Set, best: Set) -> float:
    """Return the nats by which a set must lead the best one, to stand in its place.

    Names in the place of a law or a fault must exclude it. An error of the level that does the part
    of a constant and a scale, in one, need only not be excluded: levels follow the distance.
    """
    if _of_level(contest, one, best):
        return -RIVAL_NATS
    names, laws = set(one) - set(best), set(best) - set(one)
    return RIVAL_NATS if names & contest.library and not laws <= contest.library else 0.0


def _of_level(contest: Contest, one: Set, best: Set) -> bool:
    """Return whether a set has one error of the level for a constant and a scale of the best."""
    more = [c for c in one if c not in best]
    follows = len(more) == 1 and more[0] in contest.library and contest.kinds[more[0]].follows
    return bool(follows) and {o for o in best if o not in one} == CONSTANT_AND_SCALE


def _instead(one: Set, other: Set) -> bool:
    """Return whether either of two sets has something that the other has not."""
    return not set(one) <= set(other) and not set(other) <= set(one)


def _weighed_by(evidence: Evidence, causes: Set) -> Evidence:
    """Return an evidence with the weights that rows have beside a set."""
    made = evidence.with_blocks(evidence.blocks)
    made.reweigh(causes)
    return made


def own_nats(evidence: Evidence, causes: Set, rows: NDArray[np.bool_]) -> float:
    """Return the log evidence that some rows [n] have of a set, at the weights that it gives."""
    made = _weighed_by(evidence, causes).among(rows)
    return made.of(causes).nats + _paid(made)


def _worth(contest: Contest, evidence: Evidence, causes: Set) -> float:
    """Return what a set is worth at the weights of an evidence, which are paid for."""
    nats = weighed(evidence, contest.single, [causes])[causes] + _paid(evidence)
    return nats / contest.crowding - sum(map(contest.price, causes))


def _paid(evidence: Evidence) -> float:
    """Return what the weights of rows that take part cost in nats, for what they were before."""
    weights = evidence.weights[evidence.weights > LEAST_WEIGHT]
    return LAW_TAIL / 2 * float((np.log(weights) - weights).sum())
