"""Sets whose effects may do what they do in one of two ways: a tone's log, a pulse's height."""

from types import SimpleNamespace

import pytest

from bench.discrepancy.joint import polish
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.pulse_ringing import PulseRinging

TONE = NarrowbandInterference(level_db=3.0)


def _fit(effects):
    nats = -10.0 if effects[0].power_logged else -50.0
    names = tuple(one.name for one in effects)
    return SimpleNamespace(effects=effects, names=names, nats=nats)


@pytest.mark.parametrize(("again", "logged"), [(False, 1.0), (True, 0.0)])
def test_the_log_of_a_table_is_read_as_is_likelier(again, logged, monkeypatch) -> None:
    monkeypatch.setattr(polish, "fitted", lambda _, effects: _fit(effects))
    monkeypatch.setattr(polish, "in_rounds", lambda _, fit, *__: fit)
    made = polish._other_way(SimpleNamespace(by_rows=again), _fit((TONE,)), 5)
    assert made.effects[0].power_logged == logged


@pytest.mark.parametrize(
    ("widening", "again", "high"), [(1.35, False, 1.0), (1.35, True, 1.0), (1.04, False, 0.0)]
)
def test_a_wider_pulse_is_as_high_as_before_where_that_is_likelier(
    widening, again, high, monkeypatch
) -> None:
    def fit(effects):
        return SimpleNamespace(effects=effects, nats=-10.0 if effects[0].as_high else -50.0)

    monkeypatch.setattr(polish, "fitted", lambda _, effects: fit(effects))
    monkeypatch.setattr(polish, "in_rounds", lambda _, made, *__: made)
    begun = fit((PulseRinging(widening=widening),))
    made = polish._other_way(SimpleNamespace(by_rows=again), begun, 5)
    assert made.effects[0].as_high == high
