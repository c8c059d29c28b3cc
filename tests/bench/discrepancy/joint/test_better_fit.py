"""Rivals are held against the best fit of a set, also where that was found while they were."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest

from bench.discrepancy.joint.nested import Nested
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import CLASS_NATS
from bench.discrepancy.joint.weighing import Weighing
from bench.physics.effect import Effect
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from tests.bench.discrepancy.joint.test_growth import _fit

TONE = NarrowbandInterference()


@pytest.mark.parametrize(("gained", "left"), [(1.0, (TONE,)), (CLASS_NATS + 1, ())])
def test_a_rival_of_a_worse_fit_is_none_of_a_better_one(
    monkeypatch: pytest.MonkeyPatch, gained: float, left: tuple[Effect, ...]
) -> None:
    worse, better = _fit(90.0, NoiseFloor(level_db=1.0)), _fit(95.0, NoiseFloor(level_db=1.5))
    worth = {worse.effects: 100.0, better.effects: 100.0 + gained}
    sets = Sets.__new__(Sets)
    sets.start, sets.idle, sets.fits = _fit(0.0), set(), {}

    def evidence(fit: Fit) -> float:
        return worth[fit.effects]

    def rivals(fit: Fit, _: str) -> tuple[Effect, ...]:
        return (TONE,) if fit is worse else ()

    sets.weighing = cast("Weighing", SimpleNamespace(evidence=evidence))
    sets.nested = cast("Nested", SimpleNamespace(likeliest=lambda _: worse, wider=lambda _: []))
    monkeypatch.setattr(sets, "_needed", lambda fit: fit)
    monkeypatch.setattr(sets, "_rivals", rivals)
    monkeypatch.setattr(sets, "_likeliest", lambda _: better)
    assert sets._settled()[1] == {"noise-floor": left}
