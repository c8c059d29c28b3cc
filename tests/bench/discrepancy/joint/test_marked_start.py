"""Where sets of waveform effects begin: with the likeliest form of what bears a mark."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import pytest

from bench.discrepancy.joint import polish
from bench.discrepancy.joint.polish import key_of
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import STARTED
from bench.physics.effects.propagation.specular import SpecularReflections
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.effects.receiver.quantisation import Quantisation
from tests.bench.discrepancy.joint.test_growth import LOSS, NOISE, _fit

GIVEN: Any = None


def test_of_many_forms_those_that_are_likely_as_they_are_are_fitted(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    tried: list[Any] = []

    def fitted(_: Any, effects: Any) -> Any:
        return SimpleNamespace(effects=effects, nats=float(effects[0]))

    def polished(_: Any, effects: Any) -> Any:
        tried.append(effects[0])
        return SimpleNamespace(effects=effects, nats=-float(effects[0]))

    monkeypatch.setattr(polish, "fitted", fitted)
    monkeypatch.setattr(polish, "polished", polished)
    many: Any = [(number,) for number in range(STARTED + 4)]
    best = polish.likeliest(GIVEN, many)
    assert sorted(tried) == list(range(4, STARTED + 4))
    assert best is not None
    assert best.effects == (4,)
    tried.clear()
    few: Any = [(0,), (1,)]
    polish.likeliest(GIVEN, few)
    assert tried == [0, 1]
    assert polish.likeliest(GIVEN, []) is None


@pytest.mark.parametrize(
    ("kind", "told"), [(Quantisation, True), (LevelControl, False), (SpecularReflections, False)]
)
def test_only_a_mark_that_tells_the_form_leaves_nothing_to_be_another_form_of_it(
    kind: Any, told: bool
) -> None:
    """What a set explains beyond the exact part of it, a name beside it must bring a share of."""
    some: Any = SimpleNamespace(
        start=SimpleNamespace(effects=(kind(),)), none=SimpleNamespace(effects=())
    )
    exact = Sets._exact.fget  # type: ignore[attr-defined]
    assert exact is not None
    assert bool(exact(some).effects) is told


def test_a_set_without_what_was_marked_is_none_to_choose() -> None:
    """What a member brings is asked of sets without the marked one, which are then known, too."""
    marked = Quantisation(step_counts=90.0)
    every = [_fit(1.0, marked), _fit(3.0, NOISE), _fit(2.0, marked, LOSS), _fit(2.5, marked, NOISE)]
    sets = Sets.__new__(Sets)
    sets.start, sets.idle = every[0], {LOSS.name}
    sets.fits = {key_of(one.effects): one for one in every}
    assert sets._able() == [every[0], every[3]]
