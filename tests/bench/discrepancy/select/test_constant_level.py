"""Levels that are off by so many dB everywhere are no name's."""

from __future__ import annotations

import numpy as np

from bench.discrepancy.select.constant_level import lead_over_constant
from bench.discrepancy.sets.settings import RIVAL_NATS

FAR = np.linspace(1, 20, 40)


def test_a_transmit_power_does_as_well_as_any_curve() -> None:
    scatter = np.random.default_rng(0).normal(0, 0.5, len(FAR))
    nats, constant_db = lead_over_constant(scatter + 0.1, -5.8 + scatter)
    assert nats < RIVAL_NATS
    assert abs(constant_db + 5.8) < 0.3


def test_a_slope_leads_a_constant() -> None:
    scatter = np.random.default_rng(1).normal(0, 0.5, len(FAR))
    sloped = scatter - 4 * np.log10(FAR)
    assert lead_over_constant(scatter, sloped)[0] > RIVAL_NATS
    few = np.where(np.arange(len(FAR)) == 3, 60.0, 0.0)  # one link behind metal decides nothing
    assert lead_over_constant(scatter + few, sloped + few)[0] > RIVAL_NATS


def test_without_levels_nothing_leads() -> None:
    assert lead_over_constant(FAR[:0], FAR[:0]) == (0.0, 0.0)
