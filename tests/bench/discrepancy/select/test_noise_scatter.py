"""Scatter that goes with a logged noise over the signal is no jitter; even scatter is."""

from __future__ import annotations

from types import SimpleNamespace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.select import noise_scatter
from bench.discrepancy.select.noise_scatter import beyond_noise
from bench.physics.effect import Effect
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.noise_floor import NoiseFloor

ROWS = 360
NOISY = (NoiseFloor(level_db=3.0),)


@pytest.mark.parametrize(
    ("of_noise", "logged", "named"),
    [(False, NOISY, True), (True, NOISY, False), (True, (), True)],
)
def test_scatter_of_a_logged_noise_is_no_jitter(
    monkeypatch: pytest.MonkeyPatch, of_noise: bool, logged: tuple[Effect, ...], named: bool
) -> None:
    rng, links = np.random.default_rng(5), np.repeat(np.arange(ROWS // 3), 3)
    level = rng.uniform(-95, -75, ROWS // 3)[links]
    wide = 0.05 * 10 ** (-(level + 88) / 20) if of_noise else 0.05
    versions = rng.normal(0, 0.02, (9, ROWS, 1))
    versions[0, :, 0] += wide * rng.normal(size=ROWS)
    made = Ensemble(("error_m",), ("m",), versions, links)
    monkeypatch.setattr(noise_scatter, "versions", lambda *_: made)
    noise = SimpleNamespace(noise_db=np.full(ROWS, 3.0))
    monkeypatch.setattr(noise_scatter, "logs", lambda *_: noise)
    frame = pd.DataFrame({"rx_power_dbm": level})
    search = SimpleNamespace(logged=logged, work=SimpleNamespace(frame=frame), comparison=None)
    jitter = TimestampJitter()
    assert beyond_noise(search, (jitter,), jitter).adequate is named  # type: ignore[arg-type]
