"""A set of two names is chosen over one of one where it is likelier by what a name must bring."""

from __future__ import annotations

from types import SimpleNamespace
from typing import cast

import pytest

from bench.discrepancy.joint.polish import Fit, key_of
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.weighing import Weighing
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from tests.bench.discrepancy.joint.test_growth import LOSS, NOISE, _fit

LOUD = NoiseFloor(level_db=3.0)


@pytest.mark.parametrize(("lead", "two"), [(NAME_NATS - 4, False), (NAME_NATS + 40, True)])
def test_two_names_must_lead_one_by_a_name(
    monkeypatch: pytest.MonkeyPatch, lead: float, two: bool
) -> None:
    one, both = _fit(95.0, LOUD), _fit(94.0, NOISE, LOSS)
    nats: dict[frozenset[str], float] = {
        key_of(one.effects): 100.0, key_of(both.effects): 100.0 + lead, frozenset(): 0.0,
    }  # fmt: skip
    sets = Sets.__new__(Sets)
    sets.none = _fit(0.0)

    def evidence(fit: Fit) -> float:
        return nats[key_of(fit.effects)]

    sets.weighing = cast("Weighing", SimpleNamespace(evidence=evidence, weigh=list))
    monkeypatch.setattr(sets, "_told", lambda *_: False)
    assert sets._likeliest([one, both]) is (both if two else one)
