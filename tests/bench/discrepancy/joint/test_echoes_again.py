"""What echoes again and again is fitted with it and without it; SIMULATED rows."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint import polish
from bench.discrepancy.joint.polish import Fit, fitted, polished
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.base import Base
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 24
BEGUN = PulseRinging(ring_db=-15.0, ring_delay_ns=7.0)


def beside(hidden: PulseRinging) -> Statistics:
    """Return the statistics of links that ring beside a simulator that lacks this."""
    rng = np.random.default_rng(4)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(2, 15, LINKS),
        }
    )
    frame = Simulator(Base(), (hidden,), 5, "test").observe(scene(frame), 5, 77).table(frame)
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    return Statistics(Resimulation(Simulator(Base(), (), 11, "test"), window), rows)


def test_a_fit_goes_on_with_what_echoes_again() -> None:
    hidden = PulseRinging(ring_db=-12.0, ring_delay_ns=9.0, again=0.8, on_top=1.0)
    given = beside(hidden)
    without = fitted(given, (replace(hidden, again=0.0),))
    fit = polished(given, (replace(hidden, again=0.3),))
    assert fit
    assert without
    assert fit.nats > without.nats + NAME_NATS
    assert fit.effects[0].again > 0.3  # type: ignore[attr-defined]


def test_a_fit_without_it_is_kept_where_it_is_likelier(monkeypatch: pytest.MonkeyPatch) -> None:
    given = beside(PulseRinging(ring_db=-12.0, ring_delay_ns=7.0))
    astray = fitted(given, (PulseRinging(ring_db=-12.0, ring_delay_ns=7.0, again=0.9),))
    assert astray
    rounds = polish.in_rounds

    def led_astray(given: Statistics, best: Fit, steps: int, held: list[int]) -> Fit:
        return rounds(given, best, steps, held) if held else astray

    monkeypatch.setattr(polish, "in_rounds", led_astray)
    fit = polished(given, (BEGUN,))
    assert fit
    assert fit.nats > astray.nats
    assert fit.effects[0].again == 0  # type: ignore[attr-defined]
