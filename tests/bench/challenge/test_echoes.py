"""Echoes and ringing are of what arrives: a receiver's own noise is made behind its antenna."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd
import pytest

from bench.challenge.families.case import WITH_WAVES, Draw, world_of


def _with_noise(world: Any, seed: int) -> pd.DataFrame:
    """Return rows with a first pulse that all tables share, and after it noise of this seed."""
    rows: pd.DataFrame = world.known(Draw(), 5).head(160).reset_index(drop=True)
    since = np.arange(world.WIDE_SAMPLES) - world.WIDE_LEAD
    shared, own = (np.random.default_rng(one).normal(size=(2, len(rows), len(since)))
                   for one in (3, seed))  # fmt: skip
    noise = np.where(since > 14, own, shared)
    pulse = 60 * np.exp(-(((since - 2) / 1.6) ** 2))
    told = {"error_m": 0.0, "noise_std": 0.655136, "preamble_count": 1000.0}
    return rows.assign(
        **told,
        rx_power_dbm=-80.0,
        first_path_power_dbm=-81.0,
        sample_period_ns=1.0016,
        range_m=rows["true_range_m"],
        first_path_index=float(world.WIDE_LEAD),
        cir_i=[*(noise[0] + pulse)],
        cir_q=[*noise[1]],
    )


ECHOES = ("ground-bounce", "specular-reflections", "obstructed-path", "pulse-ringing")


@pytest.mark.parametrize("family", WITH_WAVES)
@pytest.mark.parametrize("name", ECHOES)
def test_echoes_are_of_what_arrives_and_not_of_noise(family: str, name: str) -> None:
    """Noise is made behind the antenna: it gets no louder, and reports of it stay the same."""
    world: Any = world_of(family, "CIR")
    if name not in world.KNOWN:
        pytest.skip("this family hides no such thing")
    before = [_with_noise(world, seed) for seed in (1, 2)]
    after = [world.conceal(table, Draw((name,), 2.0), 5) for table in before]
    apart = []
    for one, other in (before, after):
        both = [np.array([[*t["cir_i"]], [*t["cir_q"]]]) for t in (one, other)]
        apart.append(np.subtract(*both)[:, :, world.WIDE_LEAD + 45 : -4])
    assert np.mean(apart[1] ** 2) == pytest.approx(np.mean(apart[0] ** 2), rel=0.04)
    assert np.allclose(after[0]["noise_std"], before[0]["noise_std"])
