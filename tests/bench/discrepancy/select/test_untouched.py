"""Scatter beside named causes is judged on the links to which these do nothing."""

from __future__ import annotations

import numpy as np
import pandas as pd

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import view
from bench.discrepancy.data.observables import Window
from bench.discrepancy.data.split import link_codes
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.stepwise import calm_for, untouched
from bench.discrepancy.sets.struck_instead import strikes_the_named
from bench.physics.base import Base
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.effects.ranging.antenna_delay import AntennaDelay
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.simulator import Simulator

LINK = np.repeat(np.arange(80), 5)
WALLED = LINK % 2 == 0
WALLS = MaterialDelay()
JITTER = TimestampJitter(jitter_samples=0.08)


def search(jitter_m: float) -> Search:
    """Return a search of links every other of which has a wall, no two alike; SIMULATED."""
    rng = np.random.default_rng(8)
    obstacles = [["brick"] if walled else [] for walled in WALLED]
    frame = pd.DataFrame({"link": [f"l{i}" for i in LINK], "true_range_m": 9.0})
    frame = frame.assign(obstacles=obstacles, los=~WALLED)
    wall_m = (0.1 + 0.05 * rng.normal(size=80))[LINK] * WALLED
    frame["error_m"] = wall_m + rng.normal(0, np.hypot(0.02, jitter_m), len(LINK))
    rows = view(frame, link_codes(frame), np.arange(len(LINK)), Window(), None, False)
    own = Simulator(Base(), (TimestampJitter(jitter_samples=0.067),))
    kinds = {"timestamp-jitter": TimestampJitter}
    return Search(Resimulation(own, Window()), rows, rows, dict(kinds), 0, work=rows)


def test_links_without_walls_are_untouched_by_these() -> None:
    asked = search(0.0)
    assert (untouched(asked.comparison, asked.searched, (WALLS,)) == ~WALLED).all()
    assert untouched(asked.comparison, asked.searched, ()).all()


def test_scatter_alone_is_judged_on_them() -> None:
    asked = search(0.0)
    calm = calm_for(asked, (WALLS, JITTER), JITTER)
    assert calm.searched.frame["los"].all()
    assert len(calm.searched.frame) == (~WALLED).sum()
    assert calm_for(asked, (WALLS, JITTER), WALLS) is asked
    assert calm_for(asked, (AntennaDelay(), JITTER), JITTER) is asked  # it acts on all links
    assert calm_for(asked, (JITTER,), JITTER) is asked


def test_a_strike_of_just_the_walled_links_is_the_walls() -> None:
    asked, rng = search(0.0), np.random.default_rng(2)
    walled = np.unique(asked.searched.links[WALLED])
    every = np.unique(asked.searched.links)
    rows = asked.searched
    assert strikes_the_named(asked, rows, WALLS, walled)
    assert strikes_the_named(asked, rows, WALLS, np.append(walled, every[:3]))
    assert not strikes_the_named(asked, rows, WALLS, walled[:20])  # half of them: at random
    assert not strikes_the_named(asked, rows, WALLS, rng.choice(every, 40, replace=False))
    assert not strikes_the_named(asked, rows, AntennaDelay(), every)  # it acts on all links
