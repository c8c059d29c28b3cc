"""What simulated observables do over distance, kinds of links and headings: taken off matched rows.

Matching leaves a difference in each where the mixes differ; a regression on the simulated side
takes it out (bias-corrected matching: Abadie and Imbens 2011).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np
import pandas as pd

from bench.discrepancy.compare.over_distance import Walk, nearer, walks
from bench.discrepancy.compare.over_heading import OverHeading, over_heading
from bench.discrepancy.compare.over_kinds import OverKinds, over_kinds
from bench.discrepancy.compare.shared import alike, kinds
from bench.discrepancy.data.observables import Observables
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats


@dataclass(frozen=True)
class Over:
    """What simulated rows `range_m` [k] far do over distance, by kinds, and over headings."""

    range_m: Floats
    walks: Mapping[str, Walk]
    kinds: OverKinds
    heading: OverHeading

    def change(self, names: tuple[str, ...], ours_m: Floats, pick: Rows, but: str = "") -> Floats:
        """Return by how much observables [n, p], all `but` one, change from rows `pick` to ours."""
        over = {name: walk for name, walk in self.walks.items() if name != but}
        walked = nearer(names, over, ours_m, self.range_m[pick])
        stepped = self.kinds.change(names, pick) + self.heading.change(names, pick)
        return walked + stepped * [name != but for name in names]


def found_over(
    recorded: pd.DataFrame, simulated: pd.DataFrame, observed: Observables, range_m: Floats,
    links: Rows,
) -> Over:  # fmt: skip
    """Return what `observed` rows of `links` [k] do, and which kinds and headings ours have."""
    rows = range_m, links
    over = walks(observed, *rows, kinds(recorded, simulated))
    of_kinds = over_kinds(observed, over, *rows, alike(recorded, simulated))
    decades = np.log10(np.where(range_m > 0, range_m, 1.0))
    walked = {name: over.get(name, Walk(0.0)).at(decades) for name in observed.names}
    left = {
        name: observed.column(name) - walked[name] - of_kinds.steps(at)
        for at, name in enumerate(observed.names)
    }
    return Over(range_m, over, of_kinds, over_heading(recorded, simulated, left, links))
