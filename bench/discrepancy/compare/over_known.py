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
    UNKNOWN_SHARE,
    WALK_CLIP,
)
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
    """What blocks do to `names` [p], each beside those before it."""

    names: tuple[str, ...]
    taken: tuple[Taken, ...]

    def change(self, names: tuple[str, ...], pick: Rows) -> Floats:
        """Return by how much observables [n, q] change from simulated rows `pick` [n] to ours."""
        made = np.zeros((len(pick), len(self.names)))
        for one in self.taken:
            made += (one.block.ours - one.block.theirs[pick]) @ one.size
        at = [self.names.index(name) if name in self.names else -1 for name in names]
        return np.where(np.array(at) >= 0, made[:, at], 0.0)


def over_known(observed: Observables, links: Rows, blocks: Sequence[Block]) -> OverKnown:
    """Return what blocks do to what is left of observables beside distance and kinds of links.

    Over means of a link's rows that have about the same in a block, `links` [k]; each beside all
    others, again and again (backfitting): devices may have been warm, and warm ones late.
    """
    left, taken = observed.values.copy(), [_nothing(one, observed) for one in blocks]
    for _ in range(KNOWN_PASSES):
        for at, block in enumerate(blocks):
            beside = left + block.theirs @ taken[at].size
            taken[at] = _taken(beside, links, block) or _nothing(block, observed)
            left = beside - block.theirs @ taken[at].size
    return OverKnown(observed.names, tuple(one for one in taken if one.told.any()))


def _nothing(block: Block, observed: Observables) -> Taken:
    many = len(observed.names)
    return Taken(block, np.zeros((block.theirs.shape[1], many)), np.zeros(many))


def _taken(values: Floats, links: Rows, block: Block) -> Taken | None:
    """Return what a block does to values [k, p], as far as that is plain; None of few links."""
    code = of_links(links * (1 + int(block.part.max())) + block.part, links)[0]
    many, columns = len(np.unique(links)), np.linalg.matrix_rank(block.theirs)
    if many < max(KNOWN_LINKS, 2 * (columns + 1)) or not columns:
        return None
    high, base = _means(_filled(values), code), _means(block.theirs, code)
    base = base - base.mean(axis=0)
    basis, spread, turn = np.linalg.svd(base, full_matrices=False)
    kept = spread > LEAST_SPREAD * spread[0]
    basis = basis[:, kept]
    high = _usual(high - high.mean(axis=0), basis)
    swing = basis.T @ high
    noise = ((high - basis @ swing) ** 2).sum(axis=0) / max(len(high) - len(swing) - 1, 1)
    ratio = (swing**2).sum(axis=0) / len(swing) / np.maximum(noise, LEAST_VARIANCE)
    plain = variance_ratio.sf(ratio, len(swing), many - len(swing) - 1) < KNOWN_P
    plain &= np.isfinite(values).mean(axis=0) > 1 - UNKNOWN_SHARE
    told = np.where(plain, 1 - 1 / np.maximum(ratio, 1.0), 0.0)
    return Taken(block, (turn[kept].T / spread[kept]) @ swing * told, told)


def _filled(values: Floats) -> Floats:
    """Return values [k, p] with unknown ones at the mean of the known."""
    known = np.isfinite(values)
    mean = np.where(known, values, 0.0).sum(axis=0) / np.maximum(known.sum(axis=0), 1)
    return np.where(known, values, mean)


def _usual(high: Floats, basis: Floats) -> Floats:
    """Return means [c, p], at most as far from what `basis` [c, w] makes of them as is usual."""
    fit = basis @ (basis.T @ high)
    most = WALK_CLIP * np.median(np.abs(high - fit), axis=0)
    return np.asarray(fit + np.clip(high - fit, -most, most))


def _means(values: Floats, code: Rows) -> Floats:
    """Return means [c, p] of values [k, p] by code."""
    sums = np.zeros((int(code.max()) + 1, values.shape[1]))
    np.add.at(sums, code, values)
    return np.asarray(sums / np.bincount(code)[:, None])
