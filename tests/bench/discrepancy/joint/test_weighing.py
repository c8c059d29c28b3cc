"""Sets that are weighed beside one another are worth what they are worth one by one."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import pytest

from bench.discrepancy.joint import weighing
from bench.discrepancy.joint.polish import Fit
from bench.discrepancy.joint.weighing import Weighing
from bench.forked import forking
from bench.physics.effects.receiver.noise_floor import NoiseFloor


def _fit(level_db: float) -> Fit:
    effects = (NoiseFloor(level_db=level_db),)
    key = effects, 0
    made = SimpleNamespace(effects=effects, key=key, moments=level_db, responses=(), parameters=1)
    return cast("Fit", made)


@pytest.fixture
def asked(monkeypatch: pytest.MonkeyPatch) -> list[float]:
    """Have evidence be twice the level and what is needed a level of 1 dB less; say of what."""
    seen: list[float] = []

    def evidence(given: Any, level_db: float, *_: Any) -> float:
        seen.append(level_db)
        return 2 * level_db

    monkeypatch.setattr(weighing, "evidence", evidence)
    monkeypatch.setattr(weighing, "plainer", lambda _, fit, __: _fit(fit.moments - 1))
    return seen


def _weighing() -> Weighing:
    return Weighing(cast("Any", None), cast("Any", SimpleNamespace(nats=lambda effects: 0.5)))


@pytest.mark.parametrize("forks", [False, True])
def test_what_is_weighed_together_is_known_then(
    asked: list[float], monkeypatch: pytest.MonkeyPatch, forks: bool
) -> None:
    monkeypatch.setenv("BENCH_THREADS", "2")
    sets, known = [_fit(float(n)) for n in range(8)], _weighing()
    with forking(forks):
        known.weigh(sets)
        known.weigh_plain([*sets, sets[0]])
    done = len(asked)
    assert [known.evidence(fit) for fit in sets] == [2 * n + 0.5 for n in range(8)]
    assert [known.worth(fit) for fit in sets] == [2 * (n - 1) + 0.5 for n in range(8)]
    assert len(asked) == done
