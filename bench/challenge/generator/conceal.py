"""Hides effects in a simulator's own table, in a stated way, and keeps the truth for scoring."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.generator.shapes import LIBRARY, OUTSIDE, RESPONSIBLE, SHAPES

Floats = NDArray[np.float64]
Conceal = Literal["plain", "aggregate", "decoy", "sparse", "scatter", "waveform"]
CONCEALS: tuple[Conceal, ...] = ("plain", "aggregate", "decoy", "sparse", "scatter")
IN_METRES = ("material-delay", "blocked-path")  # have a size of their own: never enlarged
RANDOM = ("blocked-path",)  # strike links at random
NATURAL_M = {"blocked-path": 0.8}  # rms at which they are hidden, where not from the ladder
JITTER_M = 0.024
LADDER = (0.25, 0.5, 1.0, 2.0, 4.0)  # strengths in multiples of the jitter, rms over touched rows
SCATTER = 1.5  # under nuisance scatter: the jitter is this much larger than the hidden effect


@dataclass(frozen=True)
class Hidden:
    """What a case hides: names (library names, or of `OUTSIDE`), strengths in metres rms."""

    names: tuple[str, ...]
    strengths_m: tuple[float, ...]
    conceal: Conceal

    @property
    def rare(self) -> str | None:
        """The effect whose cause is to be rare, None unless the concealment is `sparse`."""
        return self.names[0] if self.conceal == "sparse" and self.names else None

    @property
    def jitter_m(self) -> float:
        """Standard deviation of the simulator's own range scatter in metres."""
        if self.conceal == "scatter" and self.names:
            return max(JITTER_M, SCATTER * max(self.strengths_m))
        return JITTER_M


@dataclass(frozen=True)
class Concealed:
    """A recorded table and the truth: `shifts_m` [effects, n] as hidden, and the rank map.

    `knots_m` and `mapped_m` are the monotone map from error to recorded error (the identity
    unless every aggregate was made equal to the simulator's). `source` is the table before.
    """

    table: pd.DataFrame
    shifts_m: Floats
    knots_m: Floats
    mapped_m: Floats
    source: pd.DataFrame
    hidden: Hidden

    def truth(self, error_m: Floats, rows: NDArray[np.intp], seed: int) -> Floats:
        """Return simulated errors [m, rows] with the true effect added, as an oracle would.

        Effects that strike links at random (`RANDOM`) strike afresh in every member: to know the
        effect is to know how often, not where.
        """
        shifted = np.array(error_m, np.float64)
        for name, strength, own in zip(
            self.hidden.names, self.hidden.strengths_m, self.shifts_m, strict=True
        ):
            for member in range(len(shifted)):
                again = np.random.default_rng([seed, member, 5])
                rare = name == self.hidden.rare
                fresh = _sized(self.source, name, strength, rare, again) if name in RANDOM else own
                shifted[member] += fresh[rows]
        return np.asarray(np.interp(shifted, self.knots_m, self.mapped_m))


def conceal(table: pd.DataFrame, hidden: Hidden, seed: int) -> Concealed:
    """Return the table with the hidden effects in its ranges, concealed as asked.

    `table` holds the simulator's own ranges (`range_m`, `error_m`, `true_range_m`, ...).
    """
    rng = np.random.default_rng([seed, 2])
    shifts = np.zeros((len(hidden.names), len(table)))
    for i, (name, strength) in enumerate(zip(hidden.names, hidden.strengths_m, strict=True)):
        shifts[i] = _sized(table, name, strength, name == hidden.rare, rng)
    own = table["error_m"].to_numpy(np.float64)
    error = own + shifts.sum(axis=0)
    if hidden.conceal == "aggregate" and hidden.names:
        knots, mapped = np.sort(error), np.sort(own)
        error = np.interp(error, knots, mapped)
    else:
        knots = mapped = np.array([-1e3, 1e3])
    out = table.assign(error_m=error, range_m=table["true_range_m"] + error)
    if hidden.conceal == "decoy":
        out = _with_decoys(out, hidden, rng)
    shown = out.drop(columns="_rare", errors="ignore")
    return Concealed(shown, shifts, knots, mapped, table, hidden)


def _sized(
    table: pd.DataFrame, name: str, strength: float, rare: bool, rng: np.random.Generator
) -> Floats:
    """Return the shift [n] of one effect with its rms in metres over the rows it touches."""
    shape = SHAPES[name](table, rng, rare)
    few = table["_rare"].to_numpy(bool)
    if rare and name not in IN_METRES:
        shape = np.where(few, shape - np.median(shape[~few]), 0.0)
    touched = np.abs(shape) > 1e-9
    rms = float(np.sqrt(np.mean(shape[touched] ** 2))) if touched.any() else 1.0
    scale = strength / rms
    return np.asarray(shape * (min(scale, 1.0) if name in IN_METRES else scale))


def _with_decoys(table: pd.DataFrame, hidden: Hidden, rng: np.random.Generator) -> pd.DataFrame:
    """Return the table with a column correlated 0.8 with each responsible covariate."""
    out = table.copy()
    for number, name in enumerate(dict.fromkeys(RESPONSIBLE[n] for n in hidden.names)):
        value = out[name].to_numpy(np.float64)
        value = (value - value.mean()) / max(float(value.std()), 1e-9)
        out[f"sensor_{number}"] = 0.8 * value + 0.6 * rng.normal(size=len(out))
    return out


def draw_case(number: int, seed: int) -> Hidden:
    """Return what case `number` hides: of every 20, 5 nothing, 2 outside, 13 the library's."""
    rng = np.random.default_rng([seed, number, 3])
    turn = number % 20
    if turn % 4 == 0:
        return Hidden((), (), "plain")
    if turn in (7, 14):
        names: tuple[str, ...] = (str(rng.choice(OUTSIDE)),)
    else:
        count = 2 if turn in (9, 18) else 1
        names = tuple(map(str, rng.choice(LIBRARY, count, replace=False)))
    alone = len(names) == 1 and names[0] in LIBRARY
    never = set() if alone else {"sparse"}
    # Metres neither fit into the histogram of a jitter of centimetres nor under it.
    never |= {"scatter", "aggregate"} if set(names) & set(NATURAL_M) else set()
    ways = [way for way in CONCEALS if way not in never]
    way = ways[int(rng.integers(len(ways)))]
    drawn = [float(s) for s in rng.choice(JITTER_M * np.array(LADDER), len(names))]
    strengths = tuple(NATURAL_M.get(n, s) for n, s in zip(names, drawn, strict=True))
    return Hidden(names, strengths, way)
