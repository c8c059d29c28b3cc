"""What is remembered of a simulation never changes its numbers."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.prefix_cache import Prefixes
from bench.discrepancy.compare.staged_simulation import KEPT_ROWS, Stages
from bench.discrepancy.data.observables import Window
from bench.errors import BenchError
from bench.parallel import in_threads, threads
from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.effects.propagation.diffuse_tail import DiffuseTail
from bench.physics.effects.ranging.timestamp_jitter import TimestampJitter
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.effects.receiver.pulse_ringing import PulseRinging
from bench.physics.randomness import Draws
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


@pytest.mark.parametrize("rows", [1, 18, 60, 2048], ids="at most {} stacked".format)
@pytest.mark.parametrize("cir", [True, False], ids=["cir", "paths"])
def test_replicates_simulated_at_once_are_those_simulated_one_by_one(monkeypatch, rows, cir):
    monkeypatch.setattr("bench.discrepancy.compare.staged_simulation.STACKED_ROWS", rows)
    shared = Stages(WINDOW)
    for simulator in _simulators():
        for numbers in (range(5), range(3, 5), range(1)):
            made = shared.ensemble(simulator, ROWS, numbers, cir)
            alone = [Stages(WINDOW).observables(simulator, ROWS, n, cir) for n in numbers]
            for ours, theirs in zip(made, alone, strict=True):
                assert (ours.names, ours.units) == (theirs.names, theirs.units)
                assert np.array_equal(ours.values, theirs.values, equal_nan=True)


def _variants() -> dict[str, list[Simulator]]:
    """Return simulators by the effect that differs among them: at every stage, and two at once."""
    simulator = _simulators()[0]
    tails = [DiffuseTail(level_db=level) for level in (-30.0, -20.0, -60.0)]
    rings = [PulseRinging(ring_db=level) for level in (-20.0, -10.0, -60.0)]
    jitters = [TimestampJitter(jitter_samples=size) for size in (0.0, 0.2)]
    made = {
        name: [simulator.with_effect(effect) for effect in effects]
        for name, effects in (("tail", tails), ("ring", rings), ("jitter", jitters))
    }
    both = [one.with_effect(ring) for one, ring in zip(made["tail"], rings, strict=True)]
    return made | {"both": both, "same": [simulator, simulator], "one": [simulator], "none": []}


@pytest.mark.parametrize("most", [18, 2 * 18, 2048], ids="at most {} rows".format)
@pytest.mark.parametrize("cir", [True, False], ids=["cir", "paths"])
@pytest.mark.parametrize("name", _variants())
def test_variants_of_one_effect_are_those_simulated_one_by_one(monkeypatch, name, cir, most):
    monkeypatch.setattr("bench.discrepancy.compare.staged_simulation.STACKED_ROWS", most)
    simulators, stages = _variants()[name], Stages(WINDOW)
    for _ in range(2):  # the second time from memory
        made = stages.variants(simulators, ROWS, 3, cir)
        alone = [Stages(WINDOW).observables(one, ROWS, 3, cir) for one in simulators]
        for ours, theirs in zip(made, alone, strict=True):
            assert ours is not None
            assert (ours.names, ours.units) == (theirs.names, theirs.units)
            assert np.array_equal(ours.values, theirs.values, equal_nan=True)


def test_only_one_variant_that_fails_is_missing():
    variants = [Simulator(BASE, (Choosy(strict=strict),), 5) for strict in (0.0, 1.0, 0.5)]
    made = Stages(WINDOW).variants(variants, ROWS, 2, True)
    assert [one is None for one in made] == [False, True, True]


@dataclass(frozen=True)
class Choosy(Effect):
    """Fails on one row of one replicate."""

    name = "choosy"
    stage = "receiver"
    source = "a test"
    strict: float = parameter(1.0, "1", 0, 1, "0 never fails")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        if self.strict and draws.replicate == 2 and (batch.rows.true_range_m > 19.9).any():
            raise ValueError("too far")
        return batch


def test_the_first_row_and_replicate_that_fail_are_blamed_among_many():
    stages, simulator = Stages(WINDOW), Simulator(BASE, (Choosy(),), 5)
    assert len(stages.ensemble(simulator, ROWS, range(2), True)) == 2
    for numbers in (range(5), (2,)):
        with pytest.raises(BenchError, match=r"fails on row 17 of the 18 .*too far"):
            stages.ensemble(simulator, ROWS, numbers, True)


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
    several = Prefixes(10)
    for last in ("q", "r", "q"):  # a batch of five replicates counts as five
        several.run("rows", lambda: start, [step("p"), step(last)], many=5)
    assert ran[8:] == ["p", "q", "r", "q"]


def test_work_in_threads_keeps_its_order_and_its_errors(monkeypatch):
    for count in ("1", "4"):
        monkeypatch.setenv("BENCH_THREADS", count)
        assert threads() == int(count)
        assert in_threads(lambda item: item**2, range(20)) == [i**2 for i in range(20)]
        with pytest.raises(ZeroDivisionError):
            in_threads(lambda item: 1 / item, [1, 0])
    monkeypatch.delenv("BENCH_THREADS")
    assert threads() >= 1


@pytest.mark.parametrize("name", ["tail", "ring"])
def test_variants_are_simulated_at_once(monkeypatch, name):
    monkeypatch.setattr(Stages, "observables", None)  # one by one
    audible = _variants()[name][:2]  # nothing can be stacked on what has no taps at all
    made = Stages(WINDOW).variants(audible, ROWS, 3, True)
    assert all(one is not None for one in made)
