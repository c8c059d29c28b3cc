"""Recorded rows beside what the simulator says about the very same rows."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.crps import crps
from bench.discrepancy.compare.settings import FEWEST_TO_SCATTER, ROUNDING
from bench.discrepancy.data.grouped import means_by_group
from bench.discrepancy.data.observables import RANGE, Floats, Observables, observe
from bench.discrepancy.data.regression import rest_of
from bench.discrepancy.settings import KNOWN_SHARE, LARGE_ERROR_M, MAD_TO_STD
from bench.errors import BenchError

Simulate = Callable[[pd.DataFrame, int], pd.DataFrame]  # (rows, replicate) -> simulated rows


class NothingSharedError(BenchError):
    """No observable is known on both sides."""


@dataclass(frozen=True)
class Ensemble:
    """One recorded version and m simulated versions of n rows.

    `versions` [1 + m, n, p]: version 0 is recorded, the rest are simulated; NaN = unknown.
    `names` and `units` [p] describe the observables, `links` [n] are codes 0..L-1.
    """

    names: tuple[str, ...]
    units: tuple[str, ...]
    versions: Floats
    links: NDArray[np.intp]

    def place(self, name: str) -> int:
        """Return the position of an observable."""
        return self.names.index(name)

    @property
    def main(self) -> str:
        """The range error where there is one, else the first observable."""
        return RANGE if RANGE in self.names else self.names[0]

    def versions_of(self, name: str) -> Floats:
        """Return one observable of all versions [1 + m, n]."""
        return np.asarray(self.versions[..., self.place(name)])

    def recorded_of(self, name: str) -> Floats:
        """Return one recorded observable [n]."""
        return np.asarray(self.recorded[:, self.place(name)])

    def simulated_of(self, name: str) -> Floats:
        """Return one simulated observable [m, n]."""
        return np.asarray(self.simulated[..., self.place(name)])

    def residual_of(self, name: str) -> Floats:
        """Return recorded minus ensemble mean of one observable [n], in its unit."""
        return np.asarray(self.residual[:, self.place(name)])

    def scatter_of(self, name: str) -> float:
        """Return the standard deviation of one observable among simulated versions of a row.

        In its unit, as most rows have it (a few may be blocked); infinite with fewer than two.
        """
        simulated = self.simulated_of(name)
        spread = np.std(simulated, axis=0, ddof=1) if len(simulated) > 1 else np.array([np.inf])
        known = spread[~np.isnan(spread)]
        return float(np.median(known)) if len(known) else np.inf

    def links_scatter_of(self, name: str, over: Floats) -> float:
        """Return how simulated links scatter about a line over a number [n], in the unit's own.

        As most links have it; 0 with fewer than three.
        """
        middle = self.simulated_of(name).mean(axis=0)
        known = np.isfinite(middle) & np.isfinite(over)
        code = np.unique(self.links[known], return_inverse=True)[1]
        count = np.bincount(code)
        if len(count) < FEWEST_TO_SCATTER:
            return 0.0
        made = means_by_group(np.column_stack([middle, over])[known], code, count)
        line = np.column_stack([np.ones(len(count)), made[:, 1]])
        left = rest_of(made[:, 0], line)
        return MAD_TO_STD * float(np.median(np.abs(left)))

    @property
    def recorded(self) -> Floats:
        """Recorded observables [n, p]."""
        return np.asarray(self.versions[0])

    @property
    def simulated(self) -> Floats:
        """Simulated observables [m, n, p]."""
        return np.asarray(self.versions[1:])

    @property
    def residual(self) -> Floats:
        """Recorded minus ensemble mean [n, p], in the observables' units."""
        return np.asarray(self.recorded - self.simulated.mean(axis=0))

    @property
    def rounding(self) -> Floats:
        """How far every observable [p] may be off by rounding alone, as means of a constant are."""
        largest = np.nanmax(np.abs(self.versions), axis=(0, 1), initial=0.0)
        return np.asarray(ROUNDING * largest)

    def scores(self) -> Floats:
        """Return the CRPS per row and observable [n, p], in the observables' units.

        Range errors beyond `LARGE_ERROR_M` count by their logarithm: the CRPS of a strictly
        increasing function of a value is as proper (Allen et al. 2023), and a few blocked links no
        longer decide alone.
        """
        versions = self.versions
        if RANGE in self.names:
            which = self.place(RANGE)
            versions = versions.copy()
            versions[..., which] = LARGE_ERROR_M * np.arcsinh(versions[..., which] / LARGE_ERROR_M)
        return crps(versions[1:], versions[0])

    def ranks(self) -> Floats:
        """Return the rank of the recorded value among the members, scaled to 0..1 [n, p].

        Uniform where the simulator is right (probability integral transform); ties count half.
        """
        below = (self.simulated < self.recorded).sum(axis=0)
        equal = (self.simulated == self.recorded).sum(axis=0)
        rank = (below + 0.5 * equal + 0.5) / (len(self.simulated) + 1)
        return np.where(np.isfinite(self.residual), rank, np.nan)

    def first(self, members: int) -> Ensemble:
        """Return the ensemble of at most `members` simulated versions."""
        return Ensemble(self.names, self.units, self.versions[: 1 + members], self.links)

    def beside(self, own: int) -> Ensemble:
        """Return the recorded and the other versions beside the mean of the first `own` simulated.

        Where a row has hardly a simulated row of its own, scatter is borrowed from rows of similar
        links. Those differ from it at least as much as the recorded row should.
        """
        mean = self.versions[1 : 1 + own].mean(axis=0)
        kept = np.concatenate([self.versions[:1], self.versions[1 + own :]]) - mean
        return Ensemble(self.names, self.units, kept, self.links)

    def rows(self, keep: NDArray[np.intp] | NDArray[np.bool_]) -> Ensemble:
        """Return the ensemble of some rows."""
        return Ensemble(self.names, self.units, self.versions[:, keep], self.links[keep])


def resimulated(
    frame: pd.DataFrame, links: NDArray[np.intp], simulate: Simulate, members: int
) -> Ensemble:
    """Simulate every row again `members` times, at its own geometry and settings.

    Keeps the observables both sides have. Raises BenchError where they share none.
    """
    replicas = [observe(simulate(frame, replicate)) for replicate in range(members)]
    return stack(observe(frame), replicas, links)


def stack(recorded: Observables, replicas: list[Observables], links: NDArray[np.intp]) -> Ensemble:
    """Return the ensemble of what recorded and every replica have in common."""
    tables = (recorded, *replicas)
    shared = tuple(n for n in recorded.names if all(n in table.names for table in replicas))
    versions = np.stack([table.keep(shared).values for table in tables])
    usable = _usable(versions)
    if not usable.any():
        raise NothingSharedError(
            "the recorded and the simulated table have no observable in common"
        )
    versions = np.compress(usable, versions, axis=-1)
    versions[:, np.isnan(versions).any(axis=0)] = np.nan
    names = tuple(name for name, kept in zip(shared, usable, strict=True) if kept)
    return Ensemble(names, recorded.keep(names).units, versions, links)


def _usable(versions: Floats) -> NDArray[np.bool_]:
    """Return which observables of versions [1 + m, n, p] are known on both sides in enough rows."""
    known = np.isfinite(versions).sum(axis=0) == len(versions)
    share = np.sum(known, axis=0) / max(versions.shape[1], 1)
    return np.asarray(share >= KNOWN_SHARE, np.bool_)
