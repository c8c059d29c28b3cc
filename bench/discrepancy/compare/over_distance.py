"""What a simulated table's observables do over the distance: a matched row is rarely just as far.

Matching on covariates leaves a difference where the mixes differ; a regression on the simulated
side takes it out (bias-corrected matching: Abadie and Imbens 2011), errors too: a leading-edge
detector walks with the level. A law that only recordings have stays. Free space is the first guess
of levels, none of all else; so accumulators that are scaled to one peak are seen to be.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.discrepancy.compare.settings import FREE_SPACE_DB, SLOPE_LINKS, WALK_CLIP
from bench.discrepancy.data.grouped import beside_means
from bench.discrepancy.data.observables import Observables
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats

LEVELS = (
    "rx_power_dbm", "first_path_power_dbm", "energy_db", "max_amplitude_db", "peak_counts_db",
)  # fmt: skip  # observables that follow the distance in free space


@dataclass(frozen=True)
class Walk:
    """How an observable walks over x decades of distance: by slope * x + bend * x^2.

    `told`: the parts of the slope, and of the bend beside it, that are not taken for chance.
    """

    slope: float
    bend: float = 0.0
    told: tuple[float, float] = (0.0, 0.0)

    def at(self, decades: Floats) -> Floats:
        """Return the walk at distances [n] in decades, in the observable's unit."""
        return np.asarray(self.slope * decades + self.bend * decades**2, np.float64)


def walks(
    observed: Observables, range_m: Floats, links: Rows, kinds: Rows | None = None
) -> dict[str, Walk]:
    """Return how every observable walks over the distance.

    Over means of `links` [n], by least squares; as far as it is told from the first guess. Links of
    one of `kinds` [n] are compared: matched rows are of one kind, and far ones stand behind walls.
    """
    decades = _decades(range_m)
    kinds = np.zeros(len(links), np.intp) if kinds is None else kinds
    first = {name: FREE_SPACE_DB * (name in LEVELS) for name in observed.names}
    return {
        name: _walk(observed.column(name), decades, links, kinds, of) for name, of in first.items()
    }


def nearer(
    names: tuple[str, ...], over: Mapping[str, Walk], ours: Floats, theirs: Floats
) -> Floats:
    """Return by how much observables [n, p] change from one distance [n] in metres to our own."""
    here, there = _decades(ours), _decades(theirs)
    walked = [over.get(name, Walk(0.0)) for name in names]
    slopes, bends = (np.array([getattr(one, of) for one in walked]) for of in ("slope", "bend"))
    change = np.multiply.outer(here - there, slopes) + np.multiply.outer(here**2 - there**2, bends)
    return np.asarray(np.nan_to_num(change))


def of_links(links: Rows, kinds: Rows) -> tuple[Rows, Rows]:
    """Return the number of every row's link [n], and the kind of every link [L]."""
    _, some, code = np.unique(links, return_index=True, return_inverse=True)
    return np.asarray(code, np.intp), kinds[some]


def _walk(values: Floats, decades: Floats, links: Rows, kinds: Rows, first: float) -> Walk:
    """Return a walk, nearer to the first guess the less it is told from that."""
    known = np.isfinite(values) & np.isfinite(decades)
    code, kind = of_links(links[known], kinds[known])
    count, kind = np.bincount(code), np.unique(kind, return_inverse=True)[1]
    free = len(count) - len(np.unique(kind)) - 2
    if len(count) < SLOPE_LINKS or free < 1:
        return Walk(first)
    far, high = (np.bincount(code, one[known]) / count for one in (decades, values))
    x, square = (beside_means(one, kind) for one in (far, far**2))
    if not x @ x > 0:
        return Walk(first)
    tilt = float(x @ square) / float(x @ x)  # of the square, which a slope says as well
    left = beside_means(high - first * far, kind)
    size, told = _told(x, square - tilt * x, left, free)
    more, bend = (float(one) for one in size * told)
    return Walk(first + more - bend * tilt, bend, (float(told[0]), float(told[1])))


def _told(x: Floats, bow: Floats, high: Floats, free: int) -> tuple[Floats, Floats]:
    """Return the sizes of orthogonal `x` and `bow` in `high` [L], and which part of each is told.

    Links that are far off (a blocked path) count as far as is usual.
    """
    basis = np.stack([x, bow], axis=1)
    fit = basis @ np.linalg.lstsq(basis, high)[0]
    usual = WALK_CLIP * float(np.median(np.abs(high - fit)))
    high = fit + np.clip(high - fit, -usual, usual)
    size = np.asarray(np.linalg.lstsq(basis, high)[0], np.float64)
    noise = float(((high - basis @ size) ** 2).sum()) / free
    power = size**2 * (basis**2).sum(axis=0)
    return size, np.asarray(power / np.maximum(power + noise, 1e-30), np.float64)


def _decades(range_m: Floats) -> Floats:
    """Return the logarithm of distances, unknown where they are none."""
    return np.asarray(np.log10(np.where(range_m > 0, range_m, np.nan)), np.float64)
