"""An effect that leaves a mark of its own is named for it, and added only where it helps."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.compare.skill import Tally
from bench.discrepancy.locate.finding import Located
from bench.discrepancy.select import marks, stepwise
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.select.candidates import Contender, Explanation
from bench.discrepancy.select.refute import Checked, Doubt
from bench.discrepancy.select.state import Round
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.quantisation import Quantisation

TALLY = Tally(("noise_std",), np.ones((4, 1)), np.ones((4, 1)))
NOTHING = Located((), 0.5, 1.0, 3.0, 1, {})
ROUNDED, NOISE = Quantisation(20.0), NoiseFloor()


def _round(gained: float) -> Round:
    gain = Estimate(gained, gained - 0.1, gained + 0.1)
    told = Explanation((Contender(ROUNDED, TALLY, gain),), TALLY, gain, TALLY, {}, {})
    return Round(NOTHING, told, ROUNDED)


def test_what_bears_its_mark_is_named_though_a_check_refused_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    monkeypatch.setattr(marks, "marked", lambda *_: (ROUNDED,))
    monkeypatch.setattr(marks, "_announced", lambda _, held, *__: (_round(1.0), *held.rounds))
    last = Round(NOTHING, None, None)
    doubts = tuple(Doubt(effect, Adequacy(False)) for effect in (ROUNDED, NOISE))
    held = marks.with_marks(None, Checked((NOISE,), (last,), doubts))  # type: ignore[arg-type]
    assert held.added == (NOISE, ROUNDED)
    assert held.rounds[-1] is last
    assert [doubt.effect for doubt in held.doubts] == [NOISE]


def test_what_helps_no_link_is_named_but_not_added() -> None:
    for gained, useless in ((1.0, set()), (0.0, {ROUNDED.name})):
        held = Checked((NOISE, ROUNDED), (_round(gained), Round(NOTHING, None, None)))
        assert marks.idle(held) == useless


def test_a_score_that_falls_too_little_to_tell_is_no_word_against_what_a_likelihood_found() -> None:
    for gained, useless in ((0.05, set()), (-0.05, {ROUNDED.name})):
        held = Checked((NOISE, ROUNDED), (_round(gained), Round(NOTHING, None, None)))
        assert marks.idle(held) == {ROUNDED.name}
        assert marks.idle(held, {ROUNDED.name}) == useless


def test_what_bears_its_mark_is_not_pruned(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(stepwise, "pruned", lambda *_: (NOISE,))
    monkeypatch.setattr(Quantisation, "by_mark", classmethod(lambda _, frame: frame))
    for frame, kept in (((ROUNDED,), (ROUNDED, NOISE)), ((), (NOISE,))):
        view = SimpleNamespace(frame=frame)
        seen = {"comparison": None, "seed": 0, "work": None, "logged": ()}
        search = SimpleNamespace(discover=view, fit=view, **seen)
        made = stepwise.prune(search, (ROUNDED, NOISE), 0.0, NOISE, NOTHING)  # type: ignore[arg-type]
        assert made == kept
