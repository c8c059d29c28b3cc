"""A cause may be far smaller than is typical: of a corrected clock a hundredth of a ppm is left."""

from __future__ import annotations

import numpy as np
import pytest

from bench.discrepancy.sets.evidence import Evidence
from bench.physics.units import C_M_PER_NS

LINKS, ROWS, DEVICES = 60, 5, 15
PER_PPM_M = C_M_PER_NS * 1e3 / 2 * 0.03  # after 30 ms of reply time


@pytest.mark.parametrize("left_ppm", [0.003, 0.03])
def test_what_a_correction_leaves_of_clocks_is_seen(left_ppm: float) -> None:
    rng, links = np.random.default_rng(5), np.repeat(np.arange(LINKS), ROWS)
    own = np.eye(DEVICES)[links % DEVICES]
    reply = PER_PPM_M * rng.uniform(0.2, 1.8, len(links))[:, None]
    left = (left_ppm * reply * own) @ rng.standard_normal(DEVICES)
    left += 0.02 * rng.standard_normal(len(links))
    blocks = {"clock-offset": (reply, reply * own), "antenna-delay": (0.15 * own,)}
    made = Evidence(left, links, blocks)
    none, delay, clock = (made.of(c).nats for c in ((), ("antenna-delay",), ("clock-offset",)))
    assert clock > delay + 6 > none


def test_a_part_that_does_nothing_costs_next_to_nothing() -> None:
    rng, links = np.random.default_rng(6), np.repeat(np.arange(LINKS), ROWS)
    left = 0.02 * rng.standard_normal(len(links))
    own = PER_PPM_M * np.eye(DEVICES)[links % DEVICES]
    made = Evidence(left, links, {"clock-offset": (own,)})
    assert made.of(()).nats - 2.5 < made.of(("clock-offset",)).nats < made.of(()).nats + 2
