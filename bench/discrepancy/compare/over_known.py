"""What a simulated table's observables do over devices, clocks, temperatures and headings.

Where other links stand for the recorded ones, a matched row is of another device, another
temperature and another heading. A simulator that has delays, a drift or an antenna pattern is off
by these in what stands for a row. What they plainly do there is taken off, as what a distance does
is (see `over_distance`): on the simulated side, so that what only recordings have stays.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.stats import f as variance_ratio

from bench.discrepancy.compare.known_blocks import Block
from bench.discrepancy.compare.over_distance import of_links
from bench.discrepancy.compare.settings import (
    KNOWN_LINKS,
    KNOWN_P,
    KNOWN_PASSES,
    LEAST_SPREAD,
    LEAST_VARIANCE,
    MOST_LEVER,
    UNKNOWN_SHARE,
    WALK_CLIP,
)
from bench.discrepancy.data.grouped import group_sums
from bench.discrepancy.data.observables import Observables
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats


@dataclass(frozen=True)
class Taken:
    """What one `block` does to observables: `size` [w, p] of its columns.

    `told` [p]: the part of that which is not taken for chance, 0 where it does nothing plain.
    """

    block: Block
    size: Floats
    told: Floats


@dataclass(frozen=True)
class OverKnown:
    """What blocks do to `names` [p], each beside those before it.

    `led` [k, p]: by how much less would be taken off simulated rows had their links no part in it,
    as recorded ones have none; None where nothing is taken off.
    """

    names: tuple[str, ...]
    taken: tuple[Taken, ...]
    led: Floats | None = None

    def change(self, names: tuple[str, ...], pick: Rows) -> Floats:
        """Return by how much observables [n, q] change from simulated rows `pick` [n] to ours."""
        made = np.zeros((len(pick), len(self.names)))
        for one in self.taken:
            made += (one.block.ours - one.block.theirs[pick]) @ one.size
        if self.led is not None:
            made += self.led[pick]
        at = [self.names.index(name) if name in self.names else -1 for name in names]
        return np.where(np.array(at) >= 0, made[:, at], 0.0)

    def done(self) -> Floats | float:
        """Return what blocks do to the simulated rows themselves [k, p], 0 where nothing plain."""
        return sum((one.block.theirs @ one.size for one in self.taken), start=0.0)


def over_known(observed: Observables, links: Rows, blocks: Sequence[Block]) -> OverKnown:
    """Return what blocks do to what is left of observables beside distance and kinds of links.

    Over means of a link's rows that have about the same in a block, `links` [k]; each beside all
    others, again and again (backfitting): devices may have been warm, and warm ones late.
    """
    fits = [fit for fit in (_fit(block, links) for block in blocks) if fit]
    left, many = observed.values.copy(), len(observed.names)
    sizes = [np.zeros((fit.block.theirs.shape[1], many)) for fit in fits]
    taken = [Taken(f.block, size, np.zeros(many)) for f, size in zip(fits, sizes, strict=True)]
    for _ in range(KNOWN_PASSES):
        for at, fit in enumerate(fits):
            beside = left + fit.block.theirs @ taken[at].size
            taken[at] = fit.taken(beside)
            left = beside - fit.block.theirs @ taken[at].size
    plain = tuple(one for one in taken if one.told.any())
    if not plain:
        return OverKnown(observed.names, ())
    lever = sum(f.leverage()[:, None] * one.told for f, one in zip(fits, taken, strict=True))
    return OverKnown(observed.names, plain, _led(left, links, np.asarray(lever)))


def _led(left: Floats, links: Rows, lever: Floats) -> Floats:
    """Return how far rows [k, p] lead a fit towards what they are `left` with.

    A link whose `lever` on it is h leaves 1 - h of what it would leave a fit without it (Allen
    1974): that is what a recorded link leaves. Of the mean of its rows.
    """
    code = of_links(links, links)[0]
    counts = np.bincount(code)
    mean = group_sums(_filled(left), code, len(counts)) / counts[:, None]
    share = np.clip(lever, 0.0, MOST_LEVER)
    return np.asarray((mean - mean.mean(axis=0))[code] * share / (1 - share))


@dataclass(frozen=True)
class _Fit:
    """How a block is fitted to means over cells [c] of rows: those of a link that have its values.

    `order` [k] puts rows of a cell together, `starts` [c] and `counts` [c] say where each begins
    and how many it has. `basis` [c, w] are orthogonal columns, `back` [columns, w] leads from these
    to the block's own. `free`: the degrees of freedom that so many links leave.
    """

    block: Block
    order: Rows
    starts: Rows
    counts: Rows
    basis: Floats
    back: Floats
    free: int

    def leverage(self) -> Floats:
        """Return the lever of rows' cells on their own fit [k]: the diagonal of the hat matrix."""
        out = np.empty(len(self.order))
        out[self.order] = np.repeat(_levers(self.basis), self.counts)
        return out

    def taken(self, values: Floats) -> Taken:
        """Return what the block does to values [k, p], as far as that is plain."""
        high = _means(_filled(values), self.order, self.starts, self.counts)
        high = _usual(high - high.mean(axis=0), self.basis)
        swing, many = self.basis.T @ high, self.basis.shape[1]
        noise = ((high - self.basis @ swing) ** 2).sum(axis=0) / max(len(high) - many - 1, 1)
        ratio = (swing**2).sum(axis=0) / many / np.maximum(noise, LEAST_VARIANCE)
        plain = variance_ratio.sf(ratio, many, self.free) < KNOWN_P
        plain &= np.isfinite(values).mean(axis=0) > 1 - UNKNOWN_SHARE
        told = np.where(plain, 1 - 1 / np.maximum(ratio, 1.0), 0.0)
        return Taken(self.block, self.back @ swing * told, told)


def _fit(block: Block, links: Rows) -> _Fit | None:
    """Return how a block is fitted to simulated rows of `links` [k]; None where links are few."""
    code = of_links(links * (1 + int(block.part.max())) + block.part, links)[0]
    order, counts = np.argsort(code, kind="stable"), np.bincount(code)
    starts = np.cumsum(counts) - counts
    base = _means(block.theirs, order, starts, counts)
    basis, spread, turn = np.linalg.svd(base - base.mean(axis=0), full_matrices=False)
    kept = spread > max(LEAST_SPREAD * float(spread[0]), LEAST_VARIANCE)
    columns, many = int(kept.sum()), len(np.unique(links))
    if not columns or many < max(KNOWN_LINKS, 2 * (columns + 1)):
        return None
    back = turn[kept].T / spread[kept]
    return _Fit(block, order, starts, counts, basis[:, kept], back, many - columns - 1)


def _filled(values: Floats) -> Floats:
    """Return values [k, p] with unknown ones at the mean of the known."""
    known = np.isfinite(values)
    mean = np.where(known, values, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    return np.where(known, values, mean)


def _usual(high: Floats, basis: Floats) -> Floats:
    """Return means [c, p], at most as far from what `basis` [c, w] makes of them as is usual."""
    fit = basis @ (basis.T @ high)
    most = WALK_CLIP * np.median(np.abs(high - fit), axis=0)
    high = _as_others(high, fit, _levers(basis)[:, None], most)
    fit = basis @ (basis.T @ high)
    return np.asarray(fit + np.clip(high - fit, -most, most))


def _levers(basis: Floats) -> Floats:
    """Return the lever of every cell on a fit to `basis` [c, w]: [c]."""
    return np.asarray((basis**2).sum(axis=1))


def _as_others(high: Floats, fit: Floats, lever: Floats, most: Floats) -> Floats:
    """Return means [c, p], none more than `most` [p] farther from zero than others make of it.

    `fit` [c, p] is that of all, on which each has a `lever` [c, 1].
    Of two links of a device one that missed its first path is half of what is fitted to both: by
    how far it is from that it is not told, but by what is fitted without it (Allen 1974). None is
    moved away from zero, as the others may be those that are far off.
    """
    rest = 1 - np.minimum(lever, MOST_LEVER)
    others = np.where(lever < MOST_LEVER, (fit - lever * high) / rest, 0.0)
    near = others + np.clip(high - others, -most, most)
    return np.where(np.abs(near) < np.abs(high), near, high)


def _means(values: Floats, order: Rows, starts: Rows, counts: Rows) -> Floats:
    """Return means [c, p] of values [k, p] over cells (see `_Fit`)."""
    return np.asarray(np.add.reduceat(values[order], starts, axis=0) / counts[:, None])
