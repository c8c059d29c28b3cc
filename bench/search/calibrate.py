"""What a network will cost before it is counted: fitted to a few that were."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from bench.search.space import Size

FEWEST = 4


@dataclass(frozen=True)
class CostModel:
    """ESTIMATED cycles from multiplications, results and layers; flash from weights and layers.

    Flash in bytes. No term is negative; fitted to counts relative to their size. `worst` is the
    largest relative error on the networks it was fitted to, of cycles and of flash.
    """

    cycles: tuple[float, ...]
    flash: tuple[float, ...]
    worst: tuple[float, float]

    def cycles_of(self, size: Size) -> float:
        """Return the estimated cycles."""
        return float(np.dot(self.cycles, _cycle_terms(size)))

    def flash_of(self, size: Size) -> float:
        """Return the estimated bytes of flash."""
        return float(np.dot(self.flash, _flash_terms(size)))


def cost_model(sizes: Sequence[Size], cycles: Sequence[float], flash: Sequence[float]) -> CostModel:
    """Fit to counted networks. Raises ValueError for fewer than four."""
    if len(sizes) < FEWEST:
        raise ValueError(f"{len(sizes)} counts: at least {FEWEST} are needed to calibrate")
    by_cycles = _fitted([_cycle_terms(one) for one in sizes], cycles)
    by_flash = _fitted([_flash_terms(one) for one in sizes], flash)
    return CostModel(by_cycles[0], by_flash[0], (by_cycles[1], by_flash[1]))


def _cycle_terms(size: Size) -> tuple[float, ...]:
    return size.macs, size.values, size.layers, 1.0


def _flash_terms(size: Size) -> tuple[float, ...]:
    return size.weights, size.layers, 1.0


def _fitted(
    terms: Sequence[tuple[float, ...]], counted: Sequence[float]
) -> tuple[tuple[float, ...], float]:
    from scipy.optimize import nnls

    relative = np.array(terms, np.float64) / np.array(counted, np.float64)[:, None]
    scale = relative.max(axis=0)
    found = nnls(relative / scale, np.ones(len(counted)))[0] / scale
    return tuple(map(float, found)), float(np.abs(relative @ found - 1).max())
