"""A plan that is off moves all its devices: one cause, which is no delay of every device."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.law.between import constants_of_devices
from bench.discrepancy.sets.beside import misplaced
from bench.discrepancy.sets.evidence import Evidence
from bench.discrepancy.sets.set_up import of_setup

EVERY, DELAY = "the plan of every rx", "antenna-delay"
LAMPS_M = np.array([[2, 3, 4], [12, 2, 4], [22, 3, 4], [3, 16, 4], [13, 17, 4], [23, 16, 4.0]])


def kept(hidden: str) -> tuple[str, ...]:
    """Return what `misplaced` leaves of a delay, where a plan is stretched or delays are true."""
    rng = np.random.default_rng(5)
    at = np.column_stack([rng.uniform(0, 25, 240), rng.uniform(0, 18, 240), np.full(240, 1.0)])
    lamp = rng.integers(0, 6, 240)
    frame = pd.DataFrame(
        {f"{end}_{axis}_m": values for end, place in (("tx", at), ("rx", LAMPS_M[lamp]))
         for axis, values in zip("xyz", place.T, strict=True)}
    ).assign(tx=[f"cart{i % 3}" for i in range(240)], rx=[f"lamp{i}" for i in lamp])  # fmt: skip
    true_m = np.linalg.norm(at - LAMPS_M[lamp], axis=1)
    wide = np.linalg.norm(at - (LAMPS_M * [0.99, 1.0, 1.0])[lamp], axis=1) - true_m
    left_m = wide if hidden == "plan" else rng.normal(0, 0.1, 6)[lamp]
    view: Any = SimpleNamespace(frame=frame, scene=SimpleNamespace(true_range_m=true_m))
    devices = {end: frame[end].to_numpy(object) for end in ("tx", "rx")}
    own = {DELAY: (0.1 * constants_of_devices(devices),)}
    left_m = left_m + rng.normal(0, 0.02, 240)
    evidence = Evidence(left_m, np.arange(240) // 4, of_setup(view) | own)
    contest: Any = SimpleNamespace(
        evidence=evidence, library={DELAY}, nats=lambda causes: evidence.of(causes).nats
    )
    return misplaced(cast("Any", contest), (DELAY,))


@pytest.mark.parametrize(("hidden", "left"), [("plan", EVERY), ("delays", DELAY)])
def test_a_plan_that_is_stretched_is_no_delay_of_every_device(hidden: str, left: str) -> None:
    assert kept(hidden) == (left,)
