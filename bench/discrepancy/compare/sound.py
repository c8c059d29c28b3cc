"""Whether a simulator gives what one may give: metres near the truth, and the same once more."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.settings import AS_ONE, SAME_M, SOUND_ROWS
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.outcome import Outcome
from bench.physics.scene import scene
from bench.physics.simulator import Simulator
from bench.physics.units import Floats
from bench.recordings.clean import LEVEL_COLUMNS, MAX_ERROR_M, MAX_LEVEL_DB
from bench.recordings.table import Recordings

COMPARED = ("range_m", *LEVEL_COLUMNS, "cir")
OTHER_NUMBERS = (
    "simulator {!r} gives other numbers each time from one seed: this diagnosis cannot be "
    "repeated; take all random numbers of an effect from its `draws`"
)
ONE_DRAW = (
    "simulator {!r} gives the same numbers whatever the seed: what recordings scatter by is named "
    "then; take random numbers of an effect from its `draws`"
)


def tried(
    simulated: Simulator | Recordings, base: Base, frame: pd.DataFrame, cir: bool
) -> tuple[str, ...]:
    """Return what a user should know of a simulator, after a few of the recorded rows [n].

    Of a table nothing: its rows were looked at when it was read. `base` has the settings of the
    recordings. What fails is said later, row by row. Raises BenchError where ranges or levels are
    what no recorded row may hold.
    """
    if isinstance(simulated, Recordings) or not simulated.effects:
        return ()
    simulator = replace(simulated, base=base)
    some = np.unique(np.linspace(0, len(frame) - 1, min(SOUND_ROWS, len(frame))).astype(int))
    try:
        rows = scene(frame.iloc[some].reset_index(drop=True), "recorded")
        once, again, other = (simulator.observe(rows, replicate=n, cir=cir) for n in (0, 0, 1))
    except BenchError:
        return ()
    _check(simulator.name, once)
    _check_still(simulator.name, again.range_m - once.range_m)
    if not _all_same(once, again):
        return (OTHER_NUMBERS.format(simulator.name),)
    return (ONE_DRAW.format(simulator.name),) if _all_same(once, other) else ()


def _all_same(one: Outcome, other: Outcome) -> bool:
    """Return whether two simulations gave the same in all that is compared."""
    return all(_same(getattr(one, name), getattr(other, name)) for name in COMPARED)


def _check(name: str, made: Outcome) -> None:
    """Raise BenchError where simulated ranges or levels are beyond all that is recorded."""
    far = np.abs(made.error_m)
    if np.nanmax(far, initial=0.0) > MAX_ERROR_M:
        at = int(np.nanargmax(far))
        raise BenchError(
            f"simulator {name!r}: a range of {made.range_m[at]:.4g} m where the true one is "
            f"{made.true_range_m[at]:.4g} m ({int((far > MAX_ERROR_M).sum())} of {len(far)} rows "
            f"tried are off by more than {MAX_ERROR_M / 1000:g} km): expected metres"
        )
    for column in LEVEL_COLUMNS:
        level = np.asarray(getattr(made, column))
        if np.nanmax(np.abs(level), initial=0.0) > MAX_LEVEL_DB:
            raise BenchError(
                f"simulator {name!r}: {column} is {level[np.nanargmax(np.abs(level))]:.4g}: "
                "expected dBm"
            )


def _check_still(name: str, moved_m: Floats) -> None:
    """Raise BenchError where ranges [n] of the second call are off those of the first as one.

    Random numbers that no seed decides differ from row to row, or from device to device.
    """
    mean_m, scatter_m = float(np.mean(moved_m)), float(np.std(moved_m))
    if abs(mean_m) > max(AS_ONE * scatter_m, SAME_M):
        raise BenchError(
            f"simulator {name!r}: ranges of the same rows and seed are {mean_m:+.4g} m off when it "
            "is asked again: expected a simulator that keeps nothing from one call to the next"
        )


def _same(one: Floats | None, other: Floats | None) -> bool:
    """Return whether two simulations gave the same values."""
    if one is None or other is None:
        return one is other
    return np.array_equal(one, other, equal_nan=True)
