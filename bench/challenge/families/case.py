"""What a case is: two tables, what was done to one of them, and what the truth would have given."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from importlib import import_module

import numpy as np
import pandas as pd
from numpy.typing import NDArray

Floats = NDArray[np.float64]
RATIOS = (1, 3, 8)
"""Simulated rows per recorded row."""
LADDER = (0.25, 0.5, 1.0, 2.0)
CONCEALS = ("plain", "aggregate", "decoy", "sparse", "scatter")
MODES = ("ranges", "CIR", "ranges again", "CIR again")
"""Another simulator's table without or with CIRs; the simulator run again without or with them."""
SCHEDULE = (
    ("ranges", "pottery"), ("CIR", "granary"), ("ranges again", "cathedral"),
    ("CIR again", "opera"), ("ranges", "mint"), ("CIR", "colliery"), ("ranges again", "pottery"),
    ("CIR again", "garage"), ("ranges", "watermill"), ("CIR", "pottery"),
    ("ranges again", "tramshed"), ("CIR again", "laundry"), ("ranges", "lighthouse"),
    ("CIR", "sawmill"), ("ranges again", "bowls"), ("CIR again", "pottery"),
    ("ranges", "distillery"), ("CIR", "circus"), ("ranges again", "pottery"),
    ("CIR again", "canal"), ("ranges", "roundhouse"), ("CIR", "manege"),
    ("ranges again", "saltworks"), ("CIR again", "breadworks"), ("ranges", "pottery"),
    ("CIR", "ropewalk"), ("ranges again", "observatory"), ("CIR again", "shipyard"),
    ("ranges", "brickworks"), ("CIR", "aviary"), ("ranges again", "planetarium"),
    ("CIR again", "baths"), ("ranges", "gasworks"), ("CIR", "pottery"),
    ("ranges again", "icerink"), ("CIR again", "pottery"),
)  # fmt: skip
"""Mode and family of cases in turn: any first part of a challenge holds all of them."""
FAMILIES = tuple(sorted({family for _, family in SCHEDULE}))
COARSE = (
    "blocked-path", "timestamp-jitter", "range-rounding", "path-loss", "level-control",
    "noise-floor",
)  # fmt: skip
"""Have a size or a scatter of their own: no histogram or scatter of the simulator hides them."""
KEPT = ("pottery",)
"""What was written last."""
WITH_WAVES = (
    "garage", "manege", "opera", "brickworks", "roundhouse",
    "aviary", "sawmill", "laundry", "bowls", "canal", "saltworks", "observatory", "baths", "circus",
    "colliery", "granary", "icerink", "breadworks", "shipyard",
    "ropewalk", "planetarium", "cathedral", "distillery", "mint", "watermill",
    "gasworks", "lighthouse", "tramshed", "pottery",
)  # fmt: skip
"""Families with ranges alone that have a module of their own for waveforms, `<family>_waves`."""

COUNTED = "level-control"  # is told from a path loss by counts


@dataclass(frozen=True)
class Draw:
    """What a case is to be: names of hidden effects, how they are hidden, how the tables relate.

    `strength` multiplies the family's usual size of an effect. `listed`: walls are written down in
    `obstacles`. `paired`: the simulated table has the same links; else other positions.
    `same_mix`: positions of both tables are drawn alike; else distances and rooms differ.
    `concealed`: one of `CONCEALS`. `counted`: the tables tell how many symbols were accumulated.
    """

    hidden: tuple[str, ...] = ()
    strength: float = 1.0
    ratio: int = 3
    paired: bool = True
    same_mix: bool = True
    listed: bool = True
    concealed: str = "plain"
    counted: bool = True

    @property
    def rare(self) -> str:
        """The effect whose cause is to be rare, empty unless the concealment is `sparse`."""
        return self.hidden[0] if self.concealed == "sparse" else ""

    @property
    def scatter(self) -> float:
        """How many times larger than usual ranges scatter in both tables."""
        return 3.0 if self.concealed == "scatter" else 1.0


@dataclass(frozen=True)
class Law:
    """What nobody's library has: the forms of law or faults of the set-up that say it.

    `value` is a constant of it in `unit` at strength 1 (`grows`: times the strength), for a fault
    of positions the length of the shift; `devices` are those that a fault concerns. No form: of a
    waveform, or of chance.
    """

    forms: tuple[str, ...] = ()
    value: float = 0.0
    unit: str = ""
    grows: bool = True
    devices: tuple[str, ...] = ()


@dataclass(frozen=True)
class Tables:
    """The tables of a case: recorded, the same without what is hidden, simulated, simulated truly.

    `truth` is the simulated table as it would be with the hidden physics in it, drawn anew.
    `shifts_m` [effects, n]: what each hidden effect adds to the recorded ranges; None where an
    effect acts on the waveform. Without `simulated` the library's simulator is run again.
    """

    recorded: pd.DataFrame
    clean: pd.DataFrame
    simulated: pd.DataFrame | None
    truth: pd.DataFrame
    shifts_m: Floats | None = None


@dataclass(frozen=True)
class Turn:
    """Which case: its mode and family, and its number within these."""

    mode: str
    family: str
    number: int


def turn_of(number: int, families: Sequence[str] = ()) -> Turn:
    """Return the mode, family and number within both of case `number` of a challenge.

    Of all families, or of some.
    """
    asked = [one for one in SCHEDULE if not families or one[1] in families]
    lap, place = divmod(number, len(asked))
    own = asked.count(asked[place]) * lap + asked[:place].count(asked[place])
    return Turn(*asked[place], own)


def world_of(family: str, mode: str = "ranges") -> object:
    """Return the module of a family for a mode. Raises ValueError for an unknown family."""
    if family not in FAMILIES:
        raise ValueError(f"unknown family {family!r}; known: {', '.join(FAMILIES)}")
    part = "_waves" if "CIR" in mode and family in WITH_WAVES else ""
    return import_module(f"bench.challenge.families.{family}{part}")


def draw(
    turn: Turn, seed: int, known: Sequence[str], outside: Sequence[str], rarely: Sequence[str] = ()
) -> Draw:
    """Return what a case hides: of every 20, 5 nothing, 4 outside, 11 the library's.

    `rarely` are the effects whose cause can be made rare. A third of the tables tells no counts,
    but where these alone tell what is hidden.
    """
    made = _drawn(turn, seed, known, outside, rarely)
    place = SCHEDULE.index((turn.mode, turn.family))
    other = np.random.default_rng([seed, turn.number, place, 14])
    return replace(made, counted=COUNTED in made.hidden or bool(other.integers(3)))


def _drawn(
    turn: Turn, seed: int, known: Sequence[str], outside: Sequence[str], rarely: Sequence[str]
) -> Draw:
    rng = np.random.default_rng([seed, turn.number, SCHEDULE.index((turn.mode, turn.family)), 11])
    place = turn.number % 20
    again = turn.mode.endswith("again")
    ratio = int(rng.choice(RATIOS))
    paired, listed = again or bool(rng.integers(2)), bool(rng.integers(4))
    strength = float(rng.choice(LADDER))
    if place % 4 == 0:
        other = turn.number % 8 == 0 and not again  # another mix: other positions, never paired
        return Draw((), 1.0, ratio, paired and not other, not other, listed)
    count = 1 if place in (3, 7, 11, 15) else int(rng.choice([1, 1, 2, 3]))
    among = outside if place in (3, 7, 11, 15) else known
    names = tuple(map(str, rng.choice(list(among), min(count, len(among)), replace=False)))
    ways = [way for way in CONCEALS if way != "sparse" or (count == 1 and names[0] in rarely)]
    if set(names) & {*COARSE, *outside}:
        ways = [way for way in ways if way not in ("aggregate", "scatter")]
    way = "plain" if "CIR" in turn.mode else str(rng.choice(ways))
    return Draw(names, strength, ratio, paired, True, listed, way)


def mapped(tables: Tables) -> Tables:
    """Return the tables with recorded errors ranked into the histogram of the clean ones.

    The truth goes the same way, so no aggregate differs any more.
    """
    error = tables.recorded["error_m"].to_numpy(np.float64)
    knots, values = np.sort(error), np.sort(tables.clean["error_m"].to_numpy(np.float64))
    recorded, truth = (
        _with_error(frame, np.interp(frame["error_m"], knots, values))
        for frame in (tables.recorded, tables.truth)
    )
    return Tables(recorded, tables.clean, tables.simulated, truth, tables.shifts_m)


def _with_error(frame: pd.DataFrame, error: Floats) -> pd.DataFrame:
    return frame.assign(error_m=error, range_m=frame["true_range_m"] + error)


def decoyed(tables: Tables, hidden: Sequence[str], causes: Mapping[str, str], seed: int) -> Tables:
    """Return the tables with a column correlated 0.8 with each cause of what is hidden."""
    rng = np.random.default_rng([seed, 12])
    recorded = tables.recorded.copy()
    columns = {causes[n] for n in hidden if causes.get(n) in recorded}
    for number, name in enumerate(sorted(columns)):
        value = recorded[name].to_numpy(np.float64)
        value = (value - value.mean()) / max(float(value.std()), 1e-9)
        recorded[f"sensor_{number}"] = 0.8 * value + 0.6 * rng.normal(size=len(recorded))
    return Tables(recorded, tables.clean, tables.simulated, tables.truth, tables.shifts_m)
