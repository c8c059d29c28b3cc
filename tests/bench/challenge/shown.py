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
