"""A name that held-out links need neither in score nor in the simulator is none."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import cast

import pytest

from bench.checkpoint.journal import Journal
from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.joint.choice import WaveChoice
from bench.discrepancy.joint.turn import with_scatter
from bench.discrepancy.joint.verdicts import without_idle
from bench.discrepancy.locate.finding import Finding, Located
from bench.discrepancy.select.state import Round, State
from bench.discrepancy.select.verdict import Ambiguous, Control, LeftOut, Unknown
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.fading import SmallScaleFading
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter

SURE, UNSURE = Estimate(0.5, 0.2, 0.9, "nats"), Estimate(0.04, -1.2, 1.4, "nats")
TURN = Round(Located((), 0.5, 1.0, 3.0, 1, {}), None, None)


def nothing() -> Located:
    """Return a search that finds nothing left."""
    return TURN.located


def said(gain: Estimate) -> LeftOut:
    return LeftOut(GroundBounce(), (), gain, 1.0, Control("", None))


def test_only_a_name_without_any_use_is_taken_back() -> None:
    (left,) = without_idle((said(UNSURE),), (TURN,), (), (), (), nothing)
    assert isinstance(left, Unknown)
    assert "looks most like ground-bounce" in left.note
    for gain, best, sure in (
        (SURE, (), ()), (UNSURE, (GroundBounce(),), ()), (UNSURE, (), ("ground-bounce",)),
    ):  # fmt: skip
        assert without_idle((said(gain),), (TURN,), best, sure, (), nothing) == (said(gain),)


def test_a_class_of_which_none_is_of_use_is_taken_back() -> None:
    tail = replace(said(UNSURE), effect=DiffuseTail())
    (left,) = without_idle((Ambiguous((said(UNSURE), tail), ""),), (TURN,), (), (), (), nothing)
    assert isinstance(left, Unknown)
    one_of_use = Ambiguous((said(UNSURE), replace(tail, gain=SURE)), "")
    assert without_idle((one_of_use,), (TURN,), (), (), (), nothing) == (one_of_use,)


def test_scatter_that_was_seen_beside_a_name_goes_with_it() -> None:
    alone = LeftOut(TimestampJitter(), (), SURE, 1.0, Control("", None))
    names = GroundBounce.name, TimestampJitter.name
    for scatter in (alone, Ambiguous((alone, replace(alone, effect=SmallScaleFading())), "")):
        (left,) = without_idle((said(UNSURE), scatter), (TURN,), (), (), names[:1], nothing)
        assert isinstance(left, Unknown)
        for sure, waves in (((), names), (names[1:], names[:1])):
            both = said(UNSURE), scatter
            assert without_idle(both, (TURN,), (), sure, waves, nothing)[0] == scatter
        sound = said(SURE), scatter
        assert without_idle(sound, (TURN,), (), (), names[:1], nothing) == sound


def test_something_without_a_name_is_beside_names_only_where_the_search_finds_it() -> None:
    sure = LeftOut(AntennaDelay(), (), SURE, 1.0, Control("", None))
    seen = replace(TURN.located, findings=(cast(Finding, SimpleNamespace()),))
    for found, more in ((TURN.located, 0), (seen, 1)):
        stay = without_idle((said(UNSURE), sure), (TURN,), (), (), (), lambda found=found: found)
        assert stay[0] == sure
        assert len(stay) == 1 + more
    (alone,) = without_idle((said(UNSURE),), (TURN,), (), (), (), nothing)
    assert isinstance(alone, Unknown)  # something differed, and nothing else has its name


def test_what_is_unknown_already_is_said_once() -> None:
    unknown = Unknown((), SURE)
    assert without_idle((said(UNSURE), unknown), (TURN,), (), (), (), nothing) == (unknown,)


def test_beside_what_no_effect_explains_scatter_of_ranges_is_not_asked() -> None:
    bounce, state = GroundBounce(), cast(State, SimpleNamespace(search=None, added=()))
    refused = WaveChoice((bounce,), doubted=(bounce.name,))
    for choice in (refused, WaveChoice(unexplained=True)):
        assert with_scatter(state, cast(Journal, None), choice) is state
    with pytest.raises(AttributeError):  # what is explained is asked further: of a search
        with_scatter(state, cast(Journal, None), WaveChoice((bounce,)))
