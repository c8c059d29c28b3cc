"""What every simulator must keep to: the same seed, the same rows, and a TOML that says it all."""

from __future__ import annotations

from itertools import islice

import numpy as np
import pandas as pd

from bench.checks.effects import sample_rows
from bench.checks.expect import expect
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.simulators import SimulatorPlugin
from bench.physics.toml_file import from_toml, to_toml

FEW = 64


def check_simulator(given: Simulator | SimulatorPlugin) -> None:
    """Check a simulator: numbers on any rows, the same from a seed, its TOML gives it back.

    Rows of its own have a true range (or positions) and a link, and are the same from a seed.
    """
    simulator = given if isinstance(given, Simulator) else given.simulator
    expect(isinstance(simulator, Simulator), f"got {type(simulator).__name__}, no Simulator")
    expect(from_toml(to_toml(simulator)) == simulator, "its TOML does not give it back")
    check_rows(simulator, sample_rows())
    if isinstance(given, SimulatorPlugin) and given.rows:
        check_geometry(given)


def check_rows(simulator: Simulator, rows: pd.DataFrame) -> None:
    """Check that rows come out as numbers, the same from the same seed and others from another."""
    known = scene(rows)
    first, again, other = (simulator.observe(known, seed) for seed in (1, 1, 2))
    expect(bool(np.isfinite(first.range_m).all()), "gave a range that is no number")
    assert first.cir is not None
    assert other.cir is not None
    expect(bool(np.isfinite(first.cir).all()), "gave a CIR that is no number")
    expect(bool(np.array_equal(first.range_m, again.range_m)), "one seed gave two answers")
    expect(not np.array_equal(first.cir, other.cir), "two seeds gave the same rows")


def check_geometry(plugin: SimulatorPlugin) -> None:
    """Check the rows that a simulator brings."""
    frames = [pd.concat(islice(plugin.geometry(FEW, 3), FEW), ignore_index=True) for _ in range(2)]
    expect(len(frames[0]) == FEW, f"gave {len(frames[0])} rows of its own, {FEW} were asked for")
    expect("link" in frames[0], "its rows have no link: they could not be split")
    pd.testing.assert_frame_equal(frames[0], frames[1])
    check_rows(plugin.simulator, frames[0])
