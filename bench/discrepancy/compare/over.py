"""What simulated observables do over all that is known of a row: taken off matched rows.

Matching leaves a difference in each where the mixes differ; a regression on the simulated side
takes it out (bias-corrected matching: Abadie and Imbens 2011).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd

from bench.discrepancy.compare.known_blocks import Block, known_blocks
from bench.discrepancy.compare.over_distance import Walk, nearer, walks
from bench.discrepancy.compare.over_kinds import OverKinds, beside_walk, over_kinds
from bench.discrepancy.compare.over_known import OverKnown, over_known
from bench.discrepancy.compare.settings import OVER_PASSES
from bench.discrepancy.compare.shared import alike, kinds
from bench.discrepancy.data.observables import Observables
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats


@dataclass(frozen=True)
class Over:
    """What simulated rows `range_m` [k] far do over distance, by kinds, and over what is known."""

    range_m: Floats
    walks: Mapping[str, Walk]
    kinds: OverKinds
    known: OverKnown

    def change(self, names: tuple[str, ...], ours_m: Floats, pick: Rows, but: str = "") -> Floats:
        """Return by how much observables [n, p], all `but` one, change from rows `pick` to ours."""
        over = {name: walk for name, walk in self.walks.items() if name != but}
        walked = nearer(names, over, ours_m, self.range_m[pick])
        stepped = self.kinds.change(names, pick) + self.known.change(names, pick)
        return walked + stepped * [name != but for name in names]


def found_over(
    recorded: pd.DataFrame, simulated: pd.DataFrame, observed: Observables, range_m: Floats,
    links: Rows,
) -> Over:  # fmt: skip
    """Return what `observed` rows of `links` [k] do, and what is known of recorded ones."""
    ways = kinds(recorded, simulated), alike(recorded, simulated)
    blocks = tuple(known_blocks(recorded, simulated))
    made = _beside(OverKnown(observed.names, ()), observed, range_m, links, ways, blocks)
    for _ in range(OVER_PASSES):
        if not made.known.taken:
            break
        made = _beside(made.known, observed, range_m, links, ways, blocks)
    return made


def _beside(
    known: OverKnown,
    observed: Observables,
    range_m: Floats,
    links: Rows,
    ways: tuple[Rows, Sequence[tuple[Rows, Rows]]],
    blocks: tuple[Block, ...],
) -> Over:
    """Return what distance and kinds do beside what is `known` already, and that beside them anew.

    By turns (backfitting: Buja, Hastie and Tibshirani 1989): devices that stand far away, or are
    heard from one side there, would else be taken for the distance in part.
    """
    every, alone = ways
    free = replace(observed, values=observed.values - known.done())
    over = walks(free, range_m, links, every)
    of_kinds = over_kinds(free, over, range_m, links, alone)
    steps = np.stack([of_kinds.steps(at) for at in range(len(observed.names))], axis=1)
    left = replace(observed, values=beside_walk(observed, over, range_m) - steps)
    return Over(range_m, over, of_kinds, over_known(left, links, blocks))
