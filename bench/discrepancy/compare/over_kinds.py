"""What a simulated table's observables are behind one kind of obstacles, and behind another.

Where few links stand behind three walls, those that are near in all else stand behind one or two.
What that makes of an observable is taken out as what a distance makes is (see `over_distance`):
on the simulated side, so that what only recordings have stays.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from bench.discrepancy.compare.over_distance import Walk, of_links
from bench.discrepancy.compare.settings import WALK_CLIP
from bench.discrepancy.data.observables import Observables
from bench.discrepancy.data.split import Rows
from bench.physics.units import Floats


@dataclass(frozen=True)
class OverKinds:
    """Kinds of recorded rows `ours` [n] and simulated ones `theirs` [k]; what each does, `step`.

    `step` [kinds, p]: how far `names` of a kind are off all others, NaN where that is unknown.
    """

    ours: Rows
    theirs: Rows
    names: tuple[str, ...]
    step: Floats

    def change(self, names: tuple[str, ...], pick: Rows) -> Floats:
        """Return by how much observables [n, q] change from simulated rows `pick` [n] to ours."""
        made = np.nan_to_num(self.step[self.ours] - self.step[self.theirs[pick]])
        at = [self.names.index(name) if name in self.names else -1 for name in names]
        return np.asarray(made[:, at] * (np.array(at) >= 0))


def over_kinds(
    observed: Observables, over: Mapping[str, Walk], range_m: Floats, links: Rows, ours: Rows,
    theirs: Rows,
) -> OverKinds:  # fmt: skip
    """Return what kinds of simulated rows do, of kinds `theirs` [k], to rows of kinds `ours` [n].

    Means over `links` [k] beside the walk `over` the distance, each nearer to zero the less it is
    told from it (a random effect: Robinson 1991).
    """
    many = 1 + int(max(ours.max(initial=0), theirs.max(initial=0)))
    decades = np.log10(np.where(range_m > 0, range_m, 1.0))
    step = np.full((many, len(observed.names)), np.nan)
    for at, name in enumerate(observed.names if many > 1 else ()):
        walked = over.get(name, Walk(0.0)).at(decades)
        kind, step_of = _steps(observed.column(name) - walked, links, theirs)
        step[kind, at] = step_of
    return OverKinds(ours, theirs, observed.names, step)


def _steps(values: Floats, links: Rows, kinds: Rows) -> tuple[Rows, Floats]:
    """Return the kinds that rows have, and the steps of one observable; none of too few links."""
    known = np.isfinite(values)
    code, each = of_links(links[known], kinds[known])
    count = np.bincount(code)
    kind, at = np.unique(each, return_inverse=True)
    if len(kind) < 2 or len(count) <= len(kind):
        return kind[:0], np.zeros(0)
    high = np.bincount(code, values[known]) / count
    many, middle = np.bincount(at), np.array([np.median(high[at == k]) for k in range(len(kind))])
    usual = WALK_CLIP * float(np.median(np.abs(high - middle[at])))
    high = middle[at] + np.clip(high - middle[at], -usual, usual)
    mean = np.bincount(at, high) / many
    noise = float(((high - mean[at]) ** 2).sum()) / (len(high) - len(kind))
    off = mean - np.average(mean, weights=many)
    between = max(float(np.average(off**2 - noise / many, weights=many)), 0.0)
    return kind, off * between / np.maximum(between + noise / many, 1e-30)
