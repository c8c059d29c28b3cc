"""Truth from a floor plan: radios measure the slanted way between heights, a plan has none."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.law.forms import Named
from bench.discrepancy.law.likelihood import fixed
from bench.discrepancy.law.material import Material
from bench.discrepancy.law.settings import LAW_SAME_PLACE_M
from bench.discrepancy.law.structures import Fitted

Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Floor:
    """True ranges are distances on the floor; what ranges are longer by follows from heights."""

    form: str = "floor"
    fault: str = "floor"
    free: int = 0
    choices: int = 2  # it is so or not
    where: str = ""
    columns: tuple[str, ...] = ("true_range_m", "tx_z_m", "rx_z_m")
    expression: str = "sqrt(true_range_m ** 2 + (rx_z_m - tx_z_m) ** 2) - true_range_m"

    def fitted(self, given: Material) -> Fitted:
        """Return it; there is nothing to fit."""
        return Fitted((), fixed(self.shift_m(given, ()), given.residual_m))

    def shift_m(self, given: Material, constants: tuple[Named, ...]) -> Floats:
        """Return how much longer the way between the heights is than that on the floor [n]."""
        if given.rise_m is None:
            return np.zeros(len(given.true_range_m))
        return np.hypot(given.true_range_m, given.rise_m) - given.true_range_m

    def words(self, shown: dict[str, str]) -> str:
        """Return it for people."""
        return (
            "true_range_m is the distance on the floor plan, without the difference of the heights "
            "tx_z_m and rx_z_m; expected the straight way between the antennas"
        )


def floors(given: Material) -> Iterator[Floor]:
    """Yield the fault where heights are known that the truth may lack (see `Material.rise_m`).

    Not where they hardly lengthen the way: what does nearly nothing would pass for a small law.
    """
    made = Floor()
    if float(np.median(made.shift_m(given, ()))) > LAW_SAME_PLACE_M:
        yield made
