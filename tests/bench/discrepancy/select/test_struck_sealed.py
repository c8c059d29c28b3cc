"""Offsets of held-out links say whether as many are struck, and as far, as others told."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pytest

from bench.discrepancy.compare.crps import Estimate
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.select import struck_sealed
from bench.discrepancy.select.link_mixture import Offsets, Strike
from bench.discrepancy.select.struck_sealed import struck_nats
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.plugins import plugins

BLOCKED = next(p for p in plugins("effects") if p.name == "blocked-path").load()
DETOUR = ParameterEstimate("detour_m", 1.5, 1.0, 2.0, "m")


def offset_of(struck: int) -> Offsets:
    """Return 24 links, some of which are 1 m longer."""
    long_m = np.where(np.arange(24) < struck, 1.0, 0.01 * np.cos(np.arange(24)))
    return Offsets(np.arange(24), long_m, np.full(24, 0.01), np.zeros(24, bool), 16)


@pytest.mark.parametrize(
    ("struck", "low", "least", "most"), [(8, 0.1, 3, 99), (0, 0.3, -99, -3), (1, 0.1, -3, 3)]
)
def test_links_that_are_off_as_others_told_speak_for_a_strike(
    struck: int, low: float, least: float, most: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Of so few struck ones, as chance has them here, neither for nor against it."""
    monkeypatch.setattr(struck_sealed, "offsets", lambda *_: offset_of(struck))
    monkeypatch.setattr(struck_sealed, "struck_m", lambda *_: np.full(24, 0.5))
    rows = SimpleNamespace(waveform=False)
    other = SimpleNamespace(ensemble=lambda *_: None)
    told = (ParameterEstimate("share", 0.3, low, 0.4, "ratio"), DETOUR)
    found = Strike(BLOCKED(), Estimate(9, 7, 11), told, np.empty(0, np.intp))
    nats = struck_nats(other, rows, (), found)  # type: ignore[arg-type]
    assert nats is not None
    assert least < nats < most
    scatter = Strike(TimestampJitter(), Estimate(9, 7, 11), (), np.empty(0, np.intp))
    assert struck_nats(other, rows, (), scatter) is None  # type: ignore[arg-type]
