"""A ringing beside a dense tail is sought from what late samples have in common; SIMULATED rows."""

from __future__ import annotations

from typing import Any

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint.beneath import beneath
from bench.discrepancy.joint.grain import Grain
from bench.discrepancy.joint.sets import Sets
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 60
TAIL = DiffuseTail(level_db=-10.0, ray_decay_ns=12.0, static=0.2)
RINGING = PulseRinging(ring_db=-9.0, ring_delay_ns=8.0, ring_decay_ns=6.0, on_top=1.0)


def recorded(*hidden: Effect) -> tuple[Any, ...]:
    """Return a comparison of links with `hidden` effects beside a simulator without, and rows."""
    rng = np.random.default_rng(4)
    frame = pd.DataFrame({"link": [f"l{i // 4}" for i in range(4 * LINKS)]})
    frame["true_range_m"] = np.repeat(rng.uniform(2, 15, LINKS), 4)
    frame = Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77).table(frame)
    window = window_of(frame)
    rows = view(frame, link_codes(frame), np.arange(len(frame)), window)
    return Resimulation(Simulator(Base(), (), 11, "test"), window), rows


def test_a_fit_of_both_begins_where_the_tail_leaves_room() -> None:
    comparison, rows = recorded(TAIL, RINGING)
    grain = Grain(Statistics(comparison, rows))
    begun = beneath(grain, (DiffuseTail(level_db=-7.0, ray_decay_ns=12.0),))
    assert begun is not None
    tail, ringing = begun
    assert tail.level_db < -7.0  # type: ignore[attr-defined]
    assert -16 < ringing.ring_db < -6  # type: ignore[attr-defined]
    assert beneath(grain, (PathLoss(),)) is None


def test_both_are_chosen_where_both_are_there_and_a_tail_alone_where_it_is() -> None:
    kinds = (DiffuseTail, PulseRinging)
    for hidden in ((TAIL, RINGING), (TAIL,)):
        comparison, rows = recorded(*hidden)
        found = Sets(comparison, rows, rows, kinds).chosen()
        assert {one.name for one in found.added} == {one.name for one in hidden}
