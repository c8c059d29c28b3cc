"""Ranks with intervals and tie groups, from the pairs that could be told apart."""

from __future__ import annotations

import re
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from reports.ranking.families import Family, separate
from reports.ranking.paired import Paired


@dataclass(frozen=True)
class Ranked:
    """One model: its MAE in metres, the interval of its rank, and the letters of its tie groups.

    Models that share a letter cannot be told apart on this data.
    """

    name: str
    mae_m: float
    best_rank: int
    worst_rank: int
    letters: str

    @property
    def groups(self) -> tuple[str, ...]:
        """The tie groups one by one: "ab1c" is a, b1 and c."""
        return tuple(re.findall(r"[a-z]\d*", self.letters))

    @property
    def ranks(self) -> str:
        """The interval of the rank as text."""
        if self.best_rank == self.worst_rank:
            return str(self.best_rank)
        return f"{self.best_rank}-{self.worst_rank}"


@dataclass(frozen=True)
class Ranking:
    """The models in the order of their MAE, and the family of tests behind their ranks."""

    models: tuple[Ranked, ...]
    family: Family

    @property
    def links(self) -> int:
        """How many links the comparison rests on."""
        return self.family.paired.links

    @property
    def detectable_m(self) -> float:
        """The median over pairs of the smallest difference that this data would show."""
        known = self.family.detectable_m[self.family.error_m > 0]
        return float(np.median(known)) if len(known) else float("nan")

    def find(self, name: str) -> Ranked:
        """Return one model. Raises KeyError where there is none of that name."""
        return {one.name: one for one in self.models}[name]


def rank(paired: Paired, seed: int = 0) -> Ranking:
    """Return ranks, their intervals and tie groups. Raises ValueError for fewer than two models.

    A rank lies between one more than the number of models that are better for certain and the
    number of models less those worse for certain; as the family holds at 5 %, all intervals
    together hold at 95 % (Mogstad, Romano, Shaikh and Wilhelm, Rev. Econ. Stud. 91, 2024).
    """
    family = separate(paired, seed)
    better = _better(family)
    order = np.argsort(paired.mae_m, kind="stable")
    letters = _letters(better | better.T, order)
    models = [
        Ranked(
            paired.names[at],
            float(paired.mae_m[at]),
            1 + int(better[:, at].sum()),
            len(order) - int(better[at].sum()),
            letters[at],
        )
        for at in order
    ]
    return Ranking(tuple(models), family)


def _better(family: Family) -> NDArray[np.bool_]:
    """Return [models, models]: True where the row's model is better than the column's."""
    count = len(family.paired.names)
    first, second = family.paired.pairs
    found = np.zeros((count, count), bool)
    won = family.apart & (family.difference_m < 0)
    lost = family.apart & (family.difference_m > 0)
    found[first[won], second[won]] = True
    found[second[lost], first[lost]] = True
    return found


def _letters(apart: NDArray[np.bool_], order: NDArray[np.intp]) -> dict[int, str]:
    """Return letters such that two models share one exactly where they are not apart.

    Insert and absorb (Piepho, J. Comput. Graph. Stat. 13, 2004).
    """
    groups: list[frozenset[int]] = [frozenset(int(at) for at in order)]
    for i, j in zip(*np.nonzero(np.triu(apart)), strict=True):
        both = [group for group in groups if i in group and j in group]
        halves = [group - {out} for group in both for out in (int(i), int(j))]
        groups = _absorbed([group for group in groups if group not in both] + halves)
    place = {int(at): position for position, at in enumerate(order)}
    groups.sort(key=lambda group: sorted(place[at] for at in group))
    names = {group: _letter(number) for number, group in enumerate(groups)}
    return {at: "".join(names[group] for group in groups if at in group) for at in place}


def _absorbed(groups: Sequence[frozenset[int]]) -> list[frozenset[int]]:
    """Return the groups that lie in no other one."""
    distinct = list(dict.fromkeys(groups))
    return [group for group in distinct if not any(group < other for other in distinct)]


def _letter(number: int) -> str:
    """Return a, b, ..., z, a1, b1, ..."""
    turn, at = divmod(number, 26)
    return chr(ord("a") + at) + (str(turn) if turn else "")
