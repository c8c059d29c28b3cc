"""The tables of one hidden effect of a family, and what it does to ranges, for their tests."""

from __future__ import annotations

from functools import cache
from typing import Any

import numpy as np
import pandas as pd

from bench.challenge.families.case import Draw, Tables, world_of


@cache
def tables_of(
    family: str, name: str, strength: float = 1.0, mode: str = "ranges", ratio: int = 1
) -> Tables:
    """Return the tables of a family that hide an effect, of no name those that hide nothing."""
    world: Any = world_of(family, mode)
    made: Tables = world.tables(Draw((name,) if name else (), strength, ratio), 9)
    return made


@cache
def nothing_of(family: str, seed: int, mode: str = "ranges") -> Tables:
    """Return the tables of a family that hide nothing, drawn from a seed."""
    world: Any = world_of(family, mode)
    made: Tables = world.tables(Draw(ratio=1), seed)
    return made


def shift_of(family: str, name: str, strength: float = 1.0, mode: str = "ranges") -> np.ndarray:
    """Return what an effect of a family does to the recorded ranges [n], in metres."""
    made = tables_of(family, name, strength, mode)
    return (made.recorded["error_m"] - made.clean["error_m"]).to_numpy()


@cache
def known_of(family: str) -> pd.DataFrame:
    """Return what is known of the rows of `tables_of`, and what nobody is told."""
    world: Any = world_of(family)
    made: pd.DataFrame = world.known(Draw(), 9)
    return made


def rows_of(family: str) -> pd.DataFrame:
    """Return the recorded rows of `tables_of` that hide nothing."""
    return tables_of(family, "").recorded


def column_of(family: str, column: str) -> np.ndarray:
    """Return a column of `rows_of`, as numbers [n]."""
    return rows_of(family)[column].to_numpy(np.float64)


def are_of(family: str, *kinds: str) -> np.ndarray:
    """Return which of `rows_of` are of tags of some kinds [n]."""
    return np.asarray(rows_of(family)["tx"].str.startswith(kinds), bool)


def moved_of(family: str, name: str, mode: str = "ranges") -> tuple[float, float]:
    """Return the share of ranges that a fault moves, and by how many times their scatter."""
    shift = shift_of(family, name, mode=mode)
    moved = np.abs(shift) > 1e-9
    size = float(np.sqrt((shift[moved] ** 2).mean()))
    return float(moved.mean()), size / float(
        tables_of(family, "", mode=mode).recorded["error_m"].std()
    )


def with_speed(family: str, name: str) -> float:
    """Return how what an effect does to ranges goes with how fast these grow: a correlation."""
    rows = rows_of(family).assign(shift=shift_of(family, name))
    links = [one for _, one in rows.groupby("link") if len(one) > 2]
    speeds = [np.gradient(one["true_range_m"], one["time_s"])[1:-1] for one in links]
    shifts = [one["shift"].to_numpy()[1:-1] for one in links]
    return float(np.corrcoef(np.concatenate(speeds), np.concatenate(shifts))[0, 1])


def assert_blocked_behind_things(family: str, least_m: float) -> np.ndarray:
    """Return what blocked ways add in m where they do: only behind something, and so much."""
    for mode in ("ranges", "CIR"):
        rows = tables_of(family, "", mode=mode).recorded
        assert np.array_equal(rows["los"], rows["obstacles"].str.len().eq(0))
        assert 0.25 < rows["los"].mean() < 0.65
    free, late = rows_of(family)["los"].to_numpy(), shift_of(family, "blocked-path")
    assert not late[free].any()
    assert not shift_of(family, "material-delay")[free].any()
    free = tables_of(family, "", mode="CIR").recorded["los"].to_numpy()
    assert np.abs(shift_of(family, "obstructed-path", mode="CIR")[free]).max() < 0.06
    assert (late[late != 0] > least_m).all()
    return np.asarray(late[late != 0])


def assert_mixes_overlap(family: str) -> None:
    """Assert that another mix shares some links, that are neither the near nor the far ones."""
    for mode in ("ranges", "CIR"):
        world: Any = world_of(family, mode)
        made = world.tables(Draw(ratio=1, paired=False, same_mix=False), 5)
        both = [t.groupby("link")["true_range_m"].mean() for t in (made.recorded, made.simulated)]
        assert both[0].max() > 1.1 * both[1].min()
        assert both[0].min() < 0.8 * both[1].min()
        assert both[1].max() > 1.2 * both[0].max()
        amid = [one.between(both[1].min(), both[0].max()).mean() for one in both]
        assert 0.2 < min(amid) < max(amid) < 0.7
