"""Sets are compared each with the weights that rows have beside it."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.sets.choose import Contest
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.own_weights import Beside, likeliest
from tests.bench.discrepancy.numpy_tables import constant
from tests.bench.discrepancy.sets.test_sets import search_of


def contest_of(share: float) -> Contest:
    """Return a contest of two columns that do much the same, of heavy-tailed ranges of the first.

    `share` of what the second does is the first's.
    """
    rng, rows = np.random.default_rng(3), search_of(constant, 12).sharpest
    count = len(rows.rows)
    one, other = rng.normal(0, 1, (2, count))
    other = share * one + np.sqrt(1 - share**2) * other
    left = 0.02 * one + rng.laplace(0, 0.01, count)
    every = np.arange(count)
    blocks = {"one": (0.02 * one[:, None],), "other": (0.02 * other[:, None],)}
    evidence = Evidence(left, every, blocks)
    return Contest(evidence, {}, 1.0, rows, every, every >= 0)


def test_weights_of_a_set_speak_for_it_and_own_weights_do_not() -> None:
    contest = contest_of(0.97)
    fair = Beside(contest, ("other",)).lead(("one",))
    leads = []
    for causes in (("one",), ("other",)):
        contest.evidence.reweigh(causes)
        contest._nats = {}
        leads.append(contest.nats(("one",)) - contest.nats(("other",)))
    assert leads[0] > fair > leads[1]
    assert Beside(contest, ("one",)).lead(("other",)) == pytest.approx(-fair, abs=0.5)


def test_the_likelier_of_two_that_are_near_is_taken_whichever_was_first() -> None:
    contest = contest_of(0.97)
    for first in (("one",), ("other",)):
        contest.evidence.reweigh(first)
        contest._nats = {}
        contest.weigh([("one",), ("other",), ()])
        assert likeliest(contest, first) == ("one",)
