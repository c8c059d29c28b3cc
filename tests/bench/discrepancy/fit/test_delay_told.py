"""Delays of devices that recordings do not tell have no interval."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.fit.bootstrap import latent_intervals
from bench.discrepancy.fit.per_device import device_delay
from bench.physics.base import Base
from bench.physics.simulator import Simulator

WORLD = Resimulation(Simulator(Base()), Window())


def test_a_device_of_one_link_has_no_interval() -> None:
    """All that its link has by itself would be its delay: a zero without width held nothing."""
    rng = np.random.default_rng(0)
    pairs = [(x, y) for x in "abcd" for y in "abcd" if x < y] + [("a", "alone")]
    tx, rx = (np.repeat(side, 20) for side in zip(*pairs, strict=True))
    frame = pd.DataFrame(
        {"link": [f"{x} {y}" for x, y in zip(tx, rx, strict=True)], "tx": tx, "rx": rx}
    )
    frame["true_range_m"] = rng.uniform(3, 30, len(frame))
    frame["error_m"] = 0.2 * (tx == "a") + rng.normal(0, 0.02, len(frame))
    seen = view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("error_m",), False)
    found = device_delay(seen, seen.recorded.column("error_m"))
    assert found is not None
    intervals = latent_intervals(WORLD, seen, (), found)
    assert {one.name for one in intervals} == {f"delay_ns[{name}]" for name in "abcd"}
    assert all(one.high - one.low > 0.01 for one in intervals)


def test_links_drawn_again_tell_nothing_of_a_device_that_they_leave_out() -> None:
    """Its delay would be the prior's then, and a device of two links as unsure as it is off."""
    rng = np.random.default_rng(1)
    pairs = [(x, y) for x in "abcde" for y in "abcde" if x < y] + [("a", "two"), ("b", "two")]
    tx, rx = (np.repeat(side, 20) for side in zip(*pairs, strict=True))
    frame = pd.DataFrame(
        {"link": [f"{x} {y}" for x, y in zip(tx, rx, strict=True)], "tx": tx, "rx": rx}
    )
    frame["true_range_m"] = rng.uniform(3, 30, len(frame))
    frame["error_m"] = 0.6 * (rx == "two") + rng.normal(0, 0.02, len(frame))
    seen = view(frame, link_codes(frame), np.arange(len(frame)), Window(), ("error_m",), False)
    found = device_delay(seen, seen.recorded.column("error_m"))
    assert found is not None
    intervals = {one.name: one for one in latent_intervals(WORLD, seen, (), found)}
    assert intervals["delay_ns[two]"].high - intervals["delay_ns[two]"].low < 0.5
