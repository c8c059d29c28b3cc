"""Sets are compared each with the weights that rows have beside it."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.sets.choose import Contest
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.own_weights import Beside, likeliest, must_lead, own_nats
from bench.discrepancy.sets.settings import RIVAL_NATS
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


def test_own_weights_are_paid_for_so_that_what_they_speak_for_is_not_counted() -> None:
    contest = contest_of(0.97)
    every = np.ones(len(contest.known), bool)
    contest.evidence.reweigh(("other",))
    made = {one: own_nats(contest.evidence, (one,), every) for one in ("one", "other")}
    fair = Beside(contest, ("other",)).lead(("one",))
    assert made["one"] - made["other"] == pytest.approx(fair, abs=0.5)
    some = every & (np.arange(len(every)) % 2 == 0)
    assert own_nats(contest.evidence, ("one",), some) < made["one"]


def test_names_in_the_place_of_a_law_must_exclude_it() -> None:
    level = SimpleNamespace(follows="rx_power_dbm")
    other = SimpleNamespace(follows="")
    kinds = {"power-bias": level, "antenna-delay": other, "range-scale": other}
    contest = SimpleNamespace(library=frozenset(kinds), kinds=kinds)

    def needs(one: tuple[str, ...], best: tuple[str, ...]) -> float:
        return must_lead(contest, one, best)  # type: ignore[arg-type]

    assert needs(("antenna-delay", "power-bias"), ("a law of tx", "power-bias")) == RIVAL_NATS
    assert needs(("a law of tx", "power-bias"), ("antenna-delay", "power-bias")) == 0
    assert needs(("antenna-delay",), ("power-bias",)) == 0
    # A constant and a scale are what one error of the level may do: it need not be the likelier.
    assert needs(("power-bias",), ("antenna-delay", "range-scale")) == -RIVAL_NATS
    assert needs(("antenna-delay", "range-scale"), ("power-bias",)) == 0
