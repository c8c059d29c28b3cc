"""What an effect does beside a loud one is not what it does alone: decibels do not add up."""

from __future__ import annotations

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import window_of
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.joint import screen as module
from bench.discrepancy.joint.screen import Screen, Tried
from bench.discrepancy.joint.settings import NAME_NATS
from bench.discrepancy.joint.statistics import Statistics
from bench.physics.base import Base
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

LINKS = 48
TAIL = DiffuseTail(
    level_db=-4.1,
    distance_exponent=2.0,
    ray_decay_ns=17.0,
    cluster_decay_ns=6.3,
    cluster_rate=0.002,
    cluster_sigma_db=0.3,
    static=0.8,
)


def statistics() -> Statistics:
    """Return statistics of links, a third behind metal, of a tail and diffraction; SIMULATED."""
    rng = np.random.default_rng(3)
    frame = pd.DataFrame(
        {
            "link": [f"l{i}" for i in range(LINKS)],
            "true_range_m": rng.uniform(3, 12, LINKS),
            "obstacles": [["metal"] if i % 3 == 0 else [] for i in range(LINKS)],
        }
    )
    hidden = (TAIL, Diffraction())
    made = Simulator(Base(), hidden, 5, "test").observe(scene(frame), 5, 77).table(frame)
    window = window_of(made)
    rows = view(made, link_codes(made), np.arange(len(made)), window)
    return Statistics(Resimulation(Simulator(Base(), (), 11, "test"), window), rows)


def beside_the_tail() -> Tried:
    """Return what the screen says of diffraction beside the tail."""
    (found,) = Screen(statistics(), [Diffraction]).beside((TAIL,))
    return found


def test_diffraction_beside_a_loud_tail_is_simulated_beside_it(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    assert beside_the_tail().gained > NAME_NATS
    monkeypatch.setattr(module, "FAR_OFF", np.inf)  # as the sum of what each does alone
    assert beside_the_tail().gained < NAME_NATS
