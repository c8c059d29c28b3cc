"""A name that held-out links need neither in score nor in the simulator is none."""

from __future__ import annotations

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.joint.verdicts import without_idle
from bench.discrepancy.locate.permutation_test import Located
from bench.discrepancy.select.state import Round
from bench.discrepancy.select.verdict import Control, LeftOut, Unknown
from bench.physics.effects.propagation.ground_bounce import GroundBounce

SURE, UNSURE = Estimate(0.5, 0.2, 0.9, "nats"), Estimate(0.04, -1.2, 1.4, "nats")
TURN = Round(Located((), 0.5, 1.0, 3.0, 1, {}), None, None)


def said(gain: Estimate) -> LeftOut:
    return LeftOut(GroundBounce(), (), gain, 1.0, Control("", None))


def test_only_a_name_without_any_use_is_taken_back() -> None:
    (left,) = without_idle((said(UNSURE),), (TURN,), (), ())
    assert isinstance(left, Unknown)
    assert "looks most like ground-bounce" in left.note
    for gain, best, sure in (
        (SURE, (), ()), (UNSURE, (GroundBounce(),), ()), (UNSURE, (), ("ground-bounce",)),
    ):  # fmt: skip
        assert without_idle((said(gain),), (TURN,), best, sure) == (said(gain),)


def test_what_is_unknown_already_is_said_once() -> None:
    unknown = Unknown((), SURE)
    assert without_idle((said(UNSURE), unknown), (TURN,), (), ()) == (unknown,)
