"""Two devices that have each other's name, as a structure: in every row they take part in."""

from __future__ import annotations

import json
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, replace
from itertools import combinations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.law.forms import Named
from bench.discrepancy.law.likelihood import fixed
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.settings import LAW_SAME_PLACE_M
from bench.discrepancy.law.structures import Fitted

Floats = NDArray[np.float64]
FAR_END = {"tx": "rx", "rx": "tx"}


@dataclass(frozen=True)
class Still:
    """A device that stands still: its name, its place in metres, the ends it is recorded at."""

    name: str
    place: tuple[float, ...]
    ends: tuple[str, ...]


@dataclass(frozen=True)
class Swap:
    """Two devices that stand still have each other's name, whichever end they are at."""

    both: tuple[Still, Still]
    known: str
    choices: int
    free: int = 0
    form: str = "swap"
    fault: str = "swap"

    @property
    def pair(self) -> tuple[str, str]:
        """The names of both devices."""
        return self.both[0].name, self.both[1].name

    @property
    def columns(self) -> tuple[str, ...]:
        """The names' columns."""
        return tuple(end for end in FAR_END if any(end in one.ends for one in self.both))

    @property
    def where(self) -> str:
        """Both devices."""
        return " and ".join(self.pair)

    @property
    def _turns(self) -> Iterator[tuple[Still, Still, str, str]]:
        """Every device with the other one, an end, and the letter of where it really stands."""
        one, two = self.both
        for mine, other, letter in ((one, two, "q"), (two, one, "p")):
            yield from ((mine, other, end, letter) for end in mine.ends)

    @property
    def expression(self) -> str:
        """The distance to the other's place, minus that to the own."""
        return " + ".join(self._of(*turn) for turn in self._turns)

    def _of(self, mine: Still, other: Still, end: str, letter: str) -> str:
        """Return the expression of the rows of one device at one end.

        Those between both devices are as long as the plan says.
        """
        away = FAR_END[end]
        far = " + ".join(f"({away}_{a}_m - {letter}{a}) ** 2" for a in self.known)
        here = f"({end} == {json.dumps(mine.name)})"
        here += f" * (1 - ({away} == {json.dumps(other.name)}))" if away in other.ends else ""
        return f"{here} * (sqrt({far}) - true_range_m)"

    def fitted(self, given: Material) -> Fitted:
        """Return it; there is nothing to fit."""
        constants = [
            (f"{letter}{axis}", value, "m")
            for letter, one in zip("pq", self.both, strict=True)
            for axis, value in zip("xyz", one.place, strict=True)
            if axis in self.known
        ]
        return Fitted(tuple(constants), fixed(self.shift_m(given, ()), given.residual_m))

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return what it says of rows."""
        total = np.zeros(len(given.residual_m))
        for mine, other, end, _ in self._turns:
            away = FAR_END[end]
            here = given.devices[end] == mine.name
            if away in other.ends:
                here = here & (given.devices[away] != other.name)
            far = np.linalg.norm(given.ends[away] - np.array(other.place), axis=1)
            total = np.where(here, far - given.true_range_m, total)
        return total

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        at = "" if len(self.columns) > 1 else f" ({self.columns[0]})"
        return f"devices {self.pair[0]} and {self.pair[1]}{at} are swapped"


def swaps(given: Material) -> Iterator[Swap]:
    """Yield a swap for every two devices that stand still and are at one end, or both, alike.

    Each is one of as many as there are of devices at these ends.
    """
    pairs = [
        (one, two)
        for one, two in combinations(still(given), 2)
        if one.name != two.name and {*one.ends} & {*two.ends}
    ]
    made = sorted((Swap(both, given.axes, 1) for both in pairs), key=lambda one: one.columns)
    often = Counter(one.columns for one in made)
    yield from (replace(one, choices=often[one.columns]) for one in made)


def still(given: Material) -> list[Still]:
    """Return the devices that are recorded at one place.

    A name that has one place at each end, and not the same, is that of two devices.
    """
    found: list[Still] = []
    for name in sorted({str(one) for names in given.devices.values() for one in names}):
        at = {end: given.ends[end][names == name] for end, names in given.devices.items()}
        at = {end: places for end, places in at.items() if len(places)}
        whole = _still(name, np.concatenate([*at.values()]), tuple(at))
        found += whole or [
            one for end, places in at.items() for one in _still(name, places, (end,))
        ]
    return found


def _still(name: str, places: Floats, ends: tuple[str, ...]) -> list[Still]:
    """Return the device of some rows' places [n, 3], nothing where it moves."""
    middle = np.median(places, axis=0)
    if np.abs(places - middle).max() >= LAW_SAME_PLACE_M:
        return []
    return [Still(name, tuple(middle.tolist()), ends)]
