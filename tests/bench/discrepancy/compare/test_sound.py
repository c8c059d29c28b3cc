"""A simulator that cannot be one is refused, and what gives other numbers each time is said."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
import pytest

from bench.discrepancy.compare.sound import tried
from bench.discrepancy.compare.staged_simulation import Stages
from bench.discrepancy.data.observables import Window
from bench.errors import BenchError
from bench.physics import Base, Batch, Draws, Effect, Simulator, parameter
from bench.physics.scene import scene

FRAME = pd.DataFrame({"link": [f"l{i // 4}" for i in range(24)], "true_range_m": 5.0})


@dataclass(frozen=True)
class Own(Effect):
    """Somebody's own ranges: a constant, random numbers of its own, or of too few rows."""

    name = "own"
    stage = "ranging"
    source = "a test"
    by_m: float = parameter(0.1, "m", 0, 1e15, "longer")
    spread_m: float = parameter(0.0, "m", 0, 1, "of random numbers that no seed decides")
    lost: int = parameter(0, "rows", 0, 100, "rows too few")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        rng = np.random.default_rng()
        shift_m = self.by_m + self.spread_m * rng.standard_normal(len(batch) - self.lost)
        return batch.longer(shift_m)


def of(**values: float) -> Simulator:
    return Simulator(Base(), (Own(**values),), name="s-own")  # type: ignore[arg-type]


def test_metres_that_no_radio_reads_are_refused() -> None:
    said = r"'s-own': a range of 1e\+12 m where the true one is 5 m \(24 of 24 rows .* 1 km\)"
    with pytest.raises(BenchError, match=said):
        tried(of(by_m=1e12), Base(), FRAME, False)


def test_numbers_that_cannot_be_had_again_are_said() -> None:
    assert tried(of(), Base(), FRAME, True) == ()  # noise of samples follows the seed
    (line,) = tried(of(spread_m=0.1), Base(), FRAME, False)
    assert "'s-own' gives other numbers each time from one seed" in line


def test_what_knows_no_seed_is_said() -> None:
    (line,) = tried(of(), Base(), FRAME, False)
    assert "'s-own' gives the same numbers whatever the seed" in line


def test_what_keeps_something_between_calls_is_refused() -> None:
    """A counter that made every call a millimetre longer gave delays of 55 ns to all devices."""
    counter = of()
    calls = iter(range(1, 9))

    class Counting(Simulator):
        def observe(self, *rows: object, **more: object) -> object:  # type: ignore[override]
            made = counter.observe(*rows, **more)  # type: ignore[arg-type]
            return replace(made, range_m=made.range_m + 1e-3 * next(calls))

    with pytest.raises(BenchError, match=r"same rows and seed are \+0.001 m off when it is asked"):
        tried(Counting(Base(), (Own(),), name="s-own"), Base(), FRAME, False)


def test_too_few_values_are_counted_and_no_row_is_blamed_for_it() -> None:
    stages = Stages(Window(4, 40))
    assert tried(of(lost=3), Base(), FRAME, False) == ()  # said by row, where it is run
    said = "fails on 24 rows at once and on single ones: effect 'own' gave 21 values for 24 rows"
    with pytest.raises(BenchError, match=said):
        stages.observables(of(lost=3), scene(FRAME), 0, False)
