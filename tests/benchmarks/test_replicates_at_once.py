"""Replicates and variants that are simulated as one batch take less time than one by one.

Of some sixty rows, calls cost most: there a stack must take two thirds of the time at most.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from time import process_time

import pytest

from bench.discrepancy.compare.staged_simulation import Stages
from bench.discrepancy.data.observables import Window
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.rooms import Rooms
from bench.physics.scene import scene

ROWS, REPLICATES, VARIANTS, RUNS = 60, 4, 12, 9
MOST = 0.67  # of the time one by one
STACKED = "bench.discrepancy.compare.staged_simulation.STACKED_ROWS"
WINDOW = Window(4, 110)


def _least(run: Callable[[int], object]) -> float:
    """Return the least processor time in seconds of several runs, each of a seed of its own."""
    taken = []
    for seed in range(RUNS):
        began = process_time()
        run(seed)
        taken.append(process_time() - began)
    return min(taken[1:])  # the first compiles


def test_a_stack_costs_less_than_its_parts(monkeypatch: pytest.MonkeyPatch) -> None:
    """Print and compare milliseconds of replicates and of variants, stacked and one by one."""
    world = Rooms()
    simulator = replace(
        world.simulator, base=replace(world.simulator.base, cir_lead=4, cir_samples=114)
    )
    rows = scene(world.generate(ROWS).frame)
    walls = [MaterialDelay(thickness_scale=1 + 0.01 * n, spill=0.6) for n in range(VARIANTS)]

    def replicates(seed: int) -> None:
        Stages(WINDOW).ensemble(replace(simulator, seed=seed), rows, range(REPLICATES), True)

    def variants(seed: int) -> None:
        many = [replace(simulator, seed=seed).with_effect(wall) for wall in walls]
        Stages(WINDOW).variants(many, rows, 0, True)

    for run in (replicates, variants):
        stacked = _least(run)
        with monkeypatch.context() as alone:
            alone.setattr(STACKED, 0)
            single = _least(run)
        print(f"\n{run.__name__}: {1e3 * stacked:.1f} ms, one by one {1e3 * single:.1f} ms")
        assert stacked < MOST * single
