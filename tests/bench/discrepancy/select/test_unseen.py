"""What no search saw and whose name does not stand is nothing."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.locate.hypotheses import Cell, Place
from bench.discrepancy.select.state import Round, Selection
from bench.discrepancy.select.unseen import without_unseen
from bench.discrepancy.select.verdict import NoMismatch, Unknown
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

ONE = Estimate(1.0, 0.5, 1.5, "nats")
DELAY = AntennaDelay()
SEEN = Finding(Cell("error_m", "mean", Place()), ONE, 9.0, 0.002, 40, 9)


def refused(found: tuple[Finding, ...] = (), **said: str) -> Selection:
    """Return the selection of a set whose one name was refused; `found`: what a search saw."""
    first = Round(Located(found, 0.4, 2.0, 4.0, 1, {"error_m": 0.012}), None, DELAY)
    last = replace(first, added=None)
    unknown = Unknown(found, ONE, {}, "looks most like antenna-delay", **said)
    return Selection((unknown,), (), (first, last), withheld={"antenna-delay": "not added"})


def test_a_refused_name_of_what_no_search_saw_is_nothing() -> None:
    """Two of 104 empty tables were "something is there" for a name that sealed links refuse."""
    made = without_unseen(refused())
    assert made.verdicts == (NoMismatch({"error_m": 0.012}, 0.4),)
    assert not made.withheld


def test_what_a_search_found_beside_a_refused_name_is_what_that_made() -> None:
    """A ray of the ground that nothing showed was added, and taken out; SIMULATED by a stranger."""
    made = refused()
    loud = replace(made.rounds[1].located, findings=(SEEN,))
    made = replace(made, rounds=(made.rounds[0], replace(made.rounds[1], located=loud)))
    assert made.rounds[1].located.significant
    assert without_unseen(made).verdicts == (NoMismatch({"error_m": 0.012}, 0.4),)


def struck(by: Effect) -> Selection:
    """Return the selection of what struck rows and was refused, where no search saw anything."""
    made = refused()
    strike: Any = SimpleNamespace(effect=by)
    turn = replace(made.rounds[1], strike=strike)
    return replace(made, rounds=(turn, made.rounds[1]))


def test_refused_scatter_of_every_row_that_no_search_saw_is_nothing() -> None:
    """One of 104 empty tables looked "most like timestamp-jitter", and was worse with it."""
    made = without_unseen(struck(TimestampJitter()))
    assert made.verdicts == (NoMismatch({"error_m": 0.012}, 0.4),)


@pytest.mark.parametrize(
    "found",
    [
        struck(BlockedPath()),
        refused((SEEN,)),
        refused(cause="samples are clipped"),
        replace(refused(), added=(DELAY,)),
        replace(refused(), rounds=refused().rounds[1:]),
    ],
    ids=[
        "links are struck",
        "a search saw it",
        "a mark shows it",
        "it was added",
        "nothing was named",
    ],
)
def test_what_anything_else_speaks_for_stays(found: Selection) -> None:
    assert without_unseen(found) == found
