"""A set whose tone another tool's table may log by its power or by its scatter."""

from types import SimpleNamespace

import pytest

from bench.discrepancy.joint import polish
from bench.physics.effects.receiver.interference import NarrowbandInterference

TONE = NarrowbandInterference(level_db=3.0)


def _fit(effects):
    nats = -10.0 if effects[0].power_logged else -50.0
    names = tuple(one.name for one in effects)
    return SimpleNamespace(effects=effects, names=names, nats=nats)


@pytest.mark.parametrize(("again", "logged"), [(False, 1.0), (True, 0.0)])
def test_the_log_of_a_table_is_read_as_is_likelier(again, logged, monkeypatch) -> None:
    monkeypatch.setattr(polish, "fitted", lambda _, effects: _fit(effects))
    monkeypatch.setattr(polish, "in_rounds", lambda _, fit, *__: fit)
    made = polish._as_logged(SimpleNamespace(by_rows=again), _fit((TONE,)), 5)
    assert made.effects[0].power_logged == logged
