"""What a case of a family is, and the draw of what it hides."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from importlib import import_module

import numpy as np
import pandas as pd

FAMILIES = ("hall", "box")
RATIOS = (1, 3, 8)
"""Simulated rows per recorded row."""


@dataclass(frozen=True)
class Draw:
    """What a case is to be: names of hidden effects and how the two tables relate.

    `strength` multiplies the family's usual size of an effect. `listed`: walls are written down in
    `obstacles`. `paired`: the simulated table has the same links; else other positions.
    `same_mix`: positions of both tables are drawn alike; else distances and rooms differ.
    """

    hidden: tuple[str, ...] = ()
    strength: float = 1.0
    ratio: int = 3
    paired: bool = True
    same_mix: bool = True
    listed: bool = True


@dataclass(frozen=True)
class FamilyCase:
    """One case: the two tables, what is hidden, and which of it no library has."""

    family: str
    number: int
    draw: Draw
    recorded: pd.DataFrame
    simulated: pd.DataFrame
    outside: tuple[str, ...] = field(default=())


def make(family: str, number: int, seed: int) -> FamilyCase:
    """Return case `number` of a family; deterministic from all three.

    A quarter hides nothing (half of these with another mix), a fifth something no library names.
    Raises ValueError for an unknown family.
    """
    if family not in FAMILIES:
        raise ValueError(f"unknown family {family!r}; known: {', '.join(FAMILIES)}")
    world = import_module(f"bench.challenge.families.{family}")
    rng = np.random.default_rng([seed, number, FAMILIES.index(family)])
    drawn = draw(number, rng, world.KNOWN, world.OUTSIDE)
    recorded, simulated = world.tables(drawn, rng)
    outside = tuple(name for name in drawn.hidden if name in world.OUTSIDE)
    return FamilyCase(family, number, drawn, recorded, simulated, outside)


def draw(
    number: int, rng: np.random.Generator, known: Sequence[str], outside: Sequence[str]
) -> Draw:
    """Return what case `number` hides: of every 20, 5 nothing, 4 outside, 11 the library's."""
    turn = number % 20
    ratio = RATIOS[number % 3]
    paired = bool(rng.integers(2))
    strength = float(rng.choice([0.5, 1.0, 2.0]))
    listed = bool(rng.integers(4))
    if turn % 4 == 0:
        other = number % 8 == 0  # another mix: other positions, so never paired
        return Draw((), 1.0, ratio, paired and not other, not other, listed)
    if turn in (3, 7, 11, 15):
        return Draw((str(rng.choice(outside)),), strength, ratio, paired, True, listed)
    count = int(rng.choice([1, 1, 2]))
    names = tuple(map(str, rng.choice(known, count, replace=False)))
    return Draw(names, strength, ratio, paired, True, listed)
