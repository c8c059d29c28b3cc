"""Comparing with a table from another simulator: rows paired by link, or matched by covariates.

Where both tables have a link, its rows are compared with each other. Otherwise every recorded
link is compared with the simulated links nearest to it in the known covariates, so a difference in
the MIX of covariates is not mistaken for one in the physics: it is reported on its own.
Effects act on the table's rows: on range and receive level, and on the CIR where both have one.
"""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.compare.as_simulated import AsReceived, AsSimulated
from bench.discrepancy.compare.ensemble import Ensemble, stack
from bench.discrepancy.compare.matching import (
    by_link,
    by_neighbours,
    link_means,
    same_links,
)
from bench.discrepancy.compare.over import Over, found_over
from bench.discrepancy.compare.settings import (
    LEAST_STD,
    MIX_DIGITS,
    MOST_VERSIONS,
    OVERLAP_LINKS,
    OVERLAP_SHARE,
)
from bench.discrepancy.compare.shared import (
    NUMBERS,
    far_apart,
    in_reach,
    no_overlap,
    shared,
    shared_with_categories,
)
from bench.discrepancy.compare.staged_simulation import Stages
from bench.discrepancy.compare.table_waveforms import TableWaveforms
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import (
    LEVEL,
    RANGE,
    Floats,
    Observables,
    Window,
    observe,
)
from bench.discrepancy.data.split import Rows, link_codes
from bench.discrepancy.data.two_samples import two_samples
from bench.discrepancy.settings import (
    KEPT_MATCHES,
    KEPT_PATH_REPLICATES,
)
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.memory import Memory
from bench.physics.outcome import Outcome
from bench.physics.simulator import Simulator

CHANGED = ("error_m", "rx_power_dbm")


@dataclass(frozen=True)
class TableComparison:
    """Rows of another simulator's table as the counterpart of recorded rows."""

    frame: pd.DataFrame
    window: Window
    seed: int = 0
    base: Base = field(default_factory=Base)

    @cached_property
    def links(self) -> NDArray[np.intp]:
        """Link codes of the simulated rows."""
        return link_codes(self.frame)

    @cached_property
    def observed(self) -> Observables:
        """Observables of the simulated rows as they are."""
        return observe(self.frame, self.window)

    @cached_property
    def stages(self) -> Stages:
        """Simulates what an effect changes."""
        return Stages(self.window)

    def ensemble(self, view: View, added: Added, members: int, first: int = 0) -> Ensemble:
        """Return recorded rows beside `members` matched simulated rows, with effects `added`.

        Without CIRs, what the effects do to range and level is computed at each recorded row's own
        geometry and settings (with against without them, on the same random numbers) and added.
        """
        seen = self.observed
        count = min(view.rich * members, max(members, len(self.versions(view))))
        first, picks = view.rich * first, self._matches(view, count)
        if added and any(name.startswith("profile_db") for name in seen.names):
            numbers = range(first, first + count)
            made = self.waveforms.changed(view, picks, added, numbers)
            near = [self._nearer(one, view, p, RANGE) for one, p in zip(made, picks, strict=True)]
            pairs = zip(made, near, strict=True)
            made = [replace(one, values=one.values + more) for one, more in pairs]
            return stack(view.recorded, made, view.links)
        whole = any(e.last or e.first or e.own_curve for e in added)
        changes = (
            [self._of_whole(seen, view, added, first + i, p) for i, p in enumerate(picks)]
            if whole
            else self._changes(seen, view, added, range(first, first + count))
        )
        replicas = []
        for pick, change in zip(picks, changes, strict=True):
            values = seen.values[pick] + self._nearer(seen, view, pick) + change
            replicas.append(Observables(seen.names, seen.units, values))
        return stack(view.recorded, replicas, view.links)

    def outcome(self, view: View, added: Added, number: int) -> Outcome:
        """Return one matched version of recorded rows with its samples, with effects `added`."""
        versions = self.versions(view)
        return self.waveforms.outcome(view, versions[number % len(versions)], added, number)

    def _changes(self, seen: Observables, view: View, added: Added, numbers: range) -> list[Floats]:
        """Return what the effects change in every replicate, each [n, p].

        What draws nothing changes all replicates alike: two that are equal stand for the rest,
        unless the effects strike so rarely that two may be equal by chance.
        """
        made = self._change(seen, view, added, numbers[:2])
        rare = any(type(e).per_link or type(e).strikes for e in added)
        if len(made) > 1 and not rare and np.array_equal(made[0], made[1], equal_nan=True):
            return made + made[:1] * (len(numbers) - 2)
        return made + self._change(seen, view, added, numbers[2:])

    def _of_whole(
        self, seen: Observables, view: View, added: Added, replicate: int, pick: Rows
    ) -> Floats:
        """Return what the effects change [n, p] where one acts on what was simulated as a whole.

        Rounding depends on what is rounded: the matched row's own error is in the range. What
        follows the level does so with the matched row's level.
        """
        numbers = range(replicate, replicate + 1)
        given_m, given_db = np.zeros(len(view.rows)), np.zeros(len(view.rows))
        if RANGE in seen.names and any(effect.last or effect.first for effect in added):
            given_m = np.nan_to_num(self._error_m(view, pick))
            added = (AsSimulated(given_m), *added)
        if LEVEL in seen.names and any(effect.own_curve for effect in added):
            received = self._received(seen, view, replicate, pick)
            given_db, added = received.level_db, (received, *added)
        change = self._change(seen, view, added, numbers)[0]
        for name, given in ((RANGE, given_m), (LEVEL, given_db)):
            if name in seen.names:
                change[:, seen.names.index(name)] -= given
        return change

    def _received(self, seen: Observables, view: View, replicate: int, pick: Rows) -> AsReceived:
        """Return what levels of matched rows depart by from the bare base; remembered."""

        def departs() -> AsReceived:
            here = self._nearer(seen, view, pick)[:, seen.names.index(LEVEL)]
            bare = self._bare(view, replicate).column(LEVEL)
            return AsReceived(np.nan_to_num(seen.column(LEVEL)[pick] + here - bare))

        return self._departures.get((view.number, replicate, pick.tobytes()), departs)

    @cached_property
    def _departures(self) -> Memory[AsReceived]:
        """What levels of replicates depart by, remembered: one and the same is no other effect."""
        return Memory(KEPT_PATH_REPLICATES)

    @cached_property
    def waveforms(self) -> TableWaveforms:
        """Changes the waveforms of matched rows."""
        return TableWaveforms(self.frame, self._error_m, self.window, self.seed, self.base)

    def _change(self, seen: Observables, view: View, added: Added, numbers: range) -> list[Floats]:
        """Return what the effects change in replicates, [n, p]; 0 for what waveforms show."""
        changes = [np.zeros((len(view.rows), len(seen.names))) for _ in numbers]
        if not added:
            return changes
        with_them = Simulator(self.base, added, self.seed)
        every = self.stages.ensemble(with_them, view.scene, numbers, False)
        for change, number, within in zip(changes, numbers, every, strict=True):
            without = self._bare(view, number)
            for name in CHANGED:
                if name in seen.names and name in within.names and name in without.names:
                    made = within.column(name) - without.column(name)
                    change[:, seen.names.index(name)] = made
        return changes

    def _bare(self, view: View, replicate: int) -> Observables:
        """Return what the bare base gives for the rows in one replicate; remembered."""
        bare = Simulator(self.base, (), self.seed)
        return self._bares.get(
            (view.number, replicate),
            lambda: self.stages.observables(bare, view.scene, replicate, False),
        )

    @cached_property
    def _bares(self) -> Memory[Observables]:
        """Bare replicates that are remembered."""
        return Memory(KEPT_PATH_REPLICATES)

    def crowding(self, view: View) -> float:
        """Return how much wider a mean over recorded links scatters than permutations say.

        The same simulated links stand for several recorded ones: beside the scatter of L recorded
        links a mean has that of the K simulated ones, sqrt(1 + L / K) in all.
        """
        recorded = len(np.unique(view.links))
        return float(np.sqrt(1 + recorded / max(len(np.unique(self.links)), 1)))

    def _matches(self, view: View, members: int) -> list[NDArray[np.intp]]:
        """Return for each member the simulated row that stands for each recorded row [n].

        Members beyond the matched versions repeat them.
        """
        versions = self.versions(view)
        return [versions[member % len(versions)] for member in range(members)]

    def versions(self, view: View) -> list[NDArray[np.intp]]:
        """Return the matched versions of the recorded rows (see `matching`).

        Those from the same links first; where they are few, rows of similar links follow, so that
        a score has enough members.
        """
        return self._matched(view)[0]

    def _matched(self, view: View) -> tuple[list[Rows], int]:
        """Return the matched versions, and how many of them, the first, are of one kind."""

        def match() -> tuple[list[Rows], int]:
            own = self._same_links(view) if self.paired(view) else []
            more = self._similar_links(view)[bool(own) :] if len(own) < MOST_VERSIONS else []
            versions = (own + more)[:MOST_VERSIONS]
            return versions, len(own) or len(versions)

        return self._versions.get(view.number, match)

    @cached_property
    def _versions(self) -> Memory[tuple[list[Rows], int]]:
        """Matched versions that are remembered."""
        return Memory(KEPT_MATCHES)

    def distinct(self, view: View) -> int:
        """Return how many versions, the first ones, a permutation may swap with the recorded."""
        return self._matched(view)[1]

    def alike(self, view: View) -> int:
        """Return how many versions there are, of the same links and then of similar ones."""
        return len(self.versions(view))

    def _similar_links(self, view: View) -> list[Rows]:
        """Match rows with those of the simulated links nearest in all that both tables know."""
        both = shared_with_categories(view.frame, self.frame)
        return by_neighbours(both.left, both.right, view.links, self.links, MOST_VERSIONS)

    def _same_links(self, view: View) -> list[NDArray[np.intp]]:
        """Match rows with those of the same link."""
        both = shared(view.frame, self.frame, tuple(view.covariates.numbers))
        rows = self.frame.groupby(self.frame["link"].astype(str)).indices
        names = view.frame["link"].astype(str).to_numpy()
        labels, codes = np.unique(names, return_inverse=True)
        pools = [np.asarray(rows[label], np.intp) for label in labels]
        return by_link(both.left, both.right, codes, pools, MOST_VERSIONS)

    def paired(self, view: View) -> bool:
        """Return whether every recorded link is in the simulated table too."""
        return same_links(view.frame, self.frame)

    def covered(self, frame: pd.DataFrame) -> NDArray[np.bool_]:
        """Return which recorded rows [n] belong to links that have a simulated counterpart.

        Every link that both tables have; else links near a simulated one in all that both know.
        Raises BenchError where most have none.
        """
        if same_links(frame, self.frame):
            return np.ones(len(frame), bool)
        both = in_reach(frame, self.frame)
        categories = shared_with_categories(frame, self.frame)
        if not both.names:
            raise BenchError("the two tables share no covariate to match rows on (true_range_m?)")
        code = link_codes(frame)
        ours, theirs = link_means(both.left, code), link_means(both.right, self.links)
        apart = far_apart(both.names, ours, theirs)
        far = apart.any(axis=0)
        unknown = np.bincount(code, categories.unknown) > 0
        inside = ~(far | unknown)[code]
        few = len(np.unique(code[inside])) < OVERLAP_LINKS
        if few and inside.mean() < OVERLAP_SHARE:
            named = apart[1:]  # before the covariates stands a constant
            raise BenchError(no_overlap(both.names, named, unknown))
        return np.asarray(inside)

    def _nearer(self, seen: Observables, view: View, pick: Rows, but: str = "") -> Floats:
        """Return by how much observables [n, p], all `but` one, change from their place to ours."""
        ours = np.asarray(view.scene.true_range_m, np.float64)
        return self.over(view).change(seen.names, ours, pick, but)

    def _error_m(self, view: View, pick: Rows) -> Floats:
        """Return errors [n] of matched rows at our distances, before effects (rounding) act."""
        seen = self.observed
        near = self._nearer(seen, view, pick)[:, seen.names.index(RANGE)]
        return np.asarray(seen.column(RANGE)[pick] + near, np.float64)

    @cached_property
    def true_range_m(self) -> Floats:
        """The true ranges of the simulated rows, NaN where unknown."""
        return numeric(self.frame, "true_range_m")

    def over(self, view: View) -> Over:
        """Return what simulated observables do over distance, kinds and headings; remembered."""

        def found() -> Over:
            rows = self.observed, self.true_range_m, self.links
            return found_over(view.frame, self.frame, *rows)

        return self._overs.get(view.number, found)

    @cached_property
    def _overs(self) -> Memory[Over]:
        """What observables do over distance, kinds and headings, as views know these."""
        return Memory(KEPT_MATCHES)

    def mix(self, view: View) -> dict[str, tuple[float, float]]:
        """Return per matched covariate (recorded - simulated mean, in recorded std; p of equality).

        A two-sample Kolmogorov-Smirnov test over link means: the MIX, not the physics.
        """
        out = {}
        for name in shared(view.frame, self.frame, NUMBERS).names:
            left = link_means(numeric(view.frame, name), view.links)
            right = link_means(numeric(self.frame, name), self.links)
            shift = (left.mean() - right.mean()) / max(float(left.std()), LEAST_STD)
            chance = two_samples(left.round(MIX_DIGITS), right.round(MIX_DIGITS))[1]
            out[name] = float(shift), chance
        return out
