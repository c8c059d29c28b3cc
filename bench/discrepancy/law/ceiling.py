"""Ranges that read no more than so much: a register, a filter or a gate that cuts them off."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from bench.discrepancy.law.forms import Named
from bench.discrepancy.law.likelihood import fixed
from bench.discrepancy.law.material import Floats, Material
from bench.discrepancy.law.settings import LAW_DEVICE_ROWS, LAW_FAR, LAW_SAME_PLACE_M, LAW_STEPS
from bench.discrepancy.law.structures import Fitted


@dataclass(frozen=True)
class Ceiling:
    """Where a range would read more than `most`, that is measured instead."""

    form: str = "ceiling"
    fault: str = "ceiling"
    free: int = 1
    choices: int = 2  # it is so or not
    where: str = ""
    columns: tuple[str, ...] = ("range_m",)
    expression: str = "(range_m > most) * (most - range_m)"

    def fitted(self, given: Material) -> Fitted:
        """Return it at the ceiling that does best: of places where measured ranges lie."""
        measured = given.range_m + given.residual_m
        far = measured[measured > np.percentile(measured, LAW_FAR)]
        places = np.unique(np.percentile(far, np.linspace(0, 100, 4 * LAW_STEPS)))
        tried = [fixed(_cut(given, float(one)), given.residual_m) for one in places]
        best = int(np.argmax([one.likelihood for one in tried]))
        return Fitted((("most", float(places[best]), "m"),), tried[best])

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return how much shorter ranges are [n]: what is above the ceiling."""
        return _cut(given, constants[0][1])

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        return f"no range reads more than {shown['most']}: longer ones are cut off there"


def _cut(given: Material, most_m: float) -> Floats:
    return np.minimum(most_m - given.range_m, 0.0)


def ceilings(given: Material) -> Iterator[Ceiling]:
    """Yield the fault where the longest measured ranges are short of true ones, and alike."""
    if len(given.range_m) < LAW_DEVICE_ROWS:
        return
    longest = np.argsort(given.range_m)[-LAW_DEVICE_ROWS:]
    if float(np.median(given.residual_m[longest])) < -LAW_SAME_PLACE_M:
        yield Ceiling()
