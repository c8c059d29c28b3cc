"""What is remembered of a simulation never changes its numbers."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.prefix_cache import Prefixes
from bench.discrepancy.compare.staged_simulation import KEPT_ROWS, Stages
from bench.discrepancy.data.observables import Window
from bench.parallel import in_threads, threads
from bench.physics.base import Base
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.scene import scene
from bench.physics.simulator import Simulator

WINDOW = Window(8, 60)
BASE = replace(Base(), cir_lead=8, cir_samples=68)
ROWS = scene(pd.DataFrame({"link": ["a"] * 9 + ["b"] * 9, "true_range_m": np.linspace(2, 20, 18)}))


def _simulators() -> list[Simulator]:
    chain = (DiffuseTail(), PulseRinging(), NoiseFloor(), TimestampJitter())
    simulator = Simulator(BASE, chain, 5)
    louder = [simulator.with_effect(PulseRinging(ring_db=level)) for level in (-20.0, -10.0, -6.0)]
    return [simulator, *louder, simulator, Simulator(BASE, chain[1:], 5)]


def test_shared_beginnings_give_the_numbers_of_fresh_ones():
    shared = Stages(WINDOW)
    for simulator in _simulators():
        for replicate in range(2):
            fresh = Stages(WINDOW).observables(simulator, ROWS, replicate, True)
            kept = shared.observables(simulator, ROWS, replicate, True)
            assert kept.names == fresh.names
            assert np.array_equal(kept.values, fresh.values, equal_nan=True)


def test_rows_that_were_forgotten_are_simulated_again_and_no_others_take_their_place():
    stages, simulator = Stages(WINDOW), _simulators()[0]
    fresh = Stages(WINDOW).observables(simulator, ROWS, 0, True)
    stages.observables(simulator, ROWS, 0, True)
    for size in range(1, KEPT_ROWS + 2):
        assert len(stages.observables(simulator, ROWS.slice(0, size), 0, True).values) == size
    kept = stages.observables(simulator, ROWS, 0, True)
    assert np.array_equal(kept.values, fresh.values, equal_nan=True)


def test_ranges_are_those_of_the_simulator_itself():
    simulator = _simulators()[1]
    made = simulator.observe(ROWS, replicate=3)
    seen = Stages(WINDOW).observables(simulator, ROWS, 3, True)
    assert seen.column("error_m") == pytest.approx(made.range_m - ROWS.true_range_m)


def test_only_steps_that_changed_are_run():
    ran: list[str] = []

    def step(name: str):
        return name, lambda batch: ran.append(name) or batch

    chain = Prefixes(10)
    start = Base().paths(ROWS)
    chain.run("rows", lambda: start, [step("a"), step("b"), step("c")])
    chain.run("rows", lambda: start, [step("a"), step("b"), step("d")])
    chain.run("rows", lambda: start, [step("a"), step("b"), step("c")])
    assert ran == ["a", "b", "c", "d"]
    small = Prefixes(1)
    small.run("rows", lambda: start, [step("x"), step("y")])
    small.run("rows", lambda: start, [step("x"), step("z")])
    assert ran[4:] == ["x", "y", "x", "z"]


def test_work_in_threads_keeps_its_order_and_its_errors(monkeypatch):
    for count in ("1", "4"):
        monkeypatch.setenv("BENCH_THREADS", count)
        assert threads() == int(count)
        assert in_threads(lambda item: item**2, range(20)) == [i**2 for i in range(20)]
        with pytest.raises(ZeroDivisionError):
            in_threads(lambda item: 1 / item, [1, 0])
    monkeypatch.delenv("BENCH_THREADS")
    assert threads() >= 1
