"""Levels that go up and down as two rays meet speak for a reflection of the ground."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View, view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.sets.settings import LEVELS_MOST_NATS
from bench.discrepancy.sets.told_levels import told_by_levels

RNG = np.random.default_rng(11)
LINK = np.repeat(np.arange(60), 4)
FAR = RNG.uniform(3, 30, 60)[LINK]


def rows(size: float, curve_db: float = 0.0) -> tuple[View, Ensemble]:
    """Return rows over a floor that reflects so much, and what is simulated; own formula."""
    longer = np.sqrt(FAR**2 + 4 * 2.4 * 1.2) - FAR
    ray = -size * np.exp(-2j * np.pi * longer / 0.04620)  # channel 5
    lost = curve_db * (FAR / 10) ** 1.5
    level = -60 - 20 * np.log10(FAR)
    seen = level + 20 * np.log10(np.abs(1 + ray)) - lost + RNG.normal(0, 0.5, len(FAR))
    frame = pd.DataFrame({"link": [f"l{i}" for i in LINK], "true_range_m": FAR, "channel": 5})
    frame = frame.assign(tx_z_m=2.4, rx_z_m=1.2, rx_power_dbm=seen, error_m=0.0)
    made = np.tile(np.stack([np.zeros_like(level), level], axis=-1), (5, 1, 1))
    made[0, :, 1] = seen
    shown = view(frame, link_codes(frame), np.arange(len(LINK)), Window(), None, False)
    return shown, Ensemble(("error_m", "rx_power_dbm"), ("m", "dB"), made, LINK)


@pytest.mark.parametrize(("size", "told"), [(0.6, True), (0.0, False)])
@pytest.mark.parametrize("curve_db", [0.0, 3.0])
def test_levels_tell_two_rays_beside_a_curve_over_the_distance(
    size: float, told: bool, curve_db: float
) -> None:
    found = told_by_levels(*rows(size, curve_db))
    assert found == ({"ground-bounce": pytest.approx(LEVELS_MOST_NATS)} if told else {})


def test_nothing_is_told_without_levels_or_heights() -> None:
    shown, made = rows(0.6)
    bare = Ensemble(("error_m",), ("m",), made.versions[..., :1], LINK)
    assert told_by_levels(shown, bare) == {}
