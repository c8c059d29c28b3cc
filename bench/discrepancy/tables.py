"""Comparing with a table from another simulator: rows paired by link, or matched by covariates.

Where both tables have a link, its rows are compared with each other. Otherwise every recorded
link is compared with the simulated links nearest to it in the known covariates, so a difference in
the MIX of covariates is not mistaken for one in the physics: it is reported on its own.
Effects act on the table's rows: on range and receive level, and on the CIR where both have one.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bench.discrepancy.covariates import MEASURED
from bench.discrepancy.ensemble import Ensemble, stack
from bench.discrepancy.observables import (
    SCALARS,
    Floats,
    Observables,
    Window,
    around,
    collect,
    observe,
    shape_observables,
)
from bench.discrepancy.split import Rows, link_codes
from bench.discrepancy.staged import Stages
from bench.discrepancy.world import Added, View, measured
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.foreign import ForeignTable
from bench.physics.simulator import Simulator

MATCHED_ON = ("true_range_m", "reply_time_s", "temperature_c", "azimuth_deg", "tx_z_m", "rx_z_m")
CHANGED = ("error_m", "rx_power_dbm")
KEPT_TABLES = 24
FAR = 1.0  # standard deviations: a recorded row farther from any simulated one has no counterpart


@dataclass(frozen=True)
class TableWorld:
    """Rows of another simulator's table as the counterpart of recorded rows."""

    frame: pd.DataFrame
    window: Window
    seed: int = 0

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
        picks = self._matches(view, members, first)
        if added and any(name.startswith("profile_db") for name in seen.names):
            numbers = range(first, first + members)
            made = [self._with_cir(view, p, added, n) for p, n in zip(picks, numbers, strict=True)]
            return stack(view.recorded, made, view.links)
        replicas = []
        for number, pick in enumerate(picks):
            values = seen.values[pick] + self._change(seen, view, added, first + number)
            replicas.append(Observables(seen.names, seen.units, values))
        return stack(view.recorded, replicas, view.links)

    def _with_cir(
        self, view: View, pick: NDArray[np.intp], added: Added, replicate: int
    ) -> Observables:
        """Return matched rows with effects on their CIRs too, at the recorded rows' settings."""
        key = (id(view.rows), pick.tobytes())
        if key not in self._tables:
            while len(self._tables) >= KEPT_TABLES:
                self._tables.pop(next(iter(self._tables)))
            self._tables[key] = view.rows, ForeignTable(self._rows_at(view, pick))
        made = self._tables[key][1].observe(added, self.seed, replicate)
        scalars = {name: np.asarray(getattr(made, name), np.float64) for name in SCALARS}
        assert made.cir is not None
        assert made.first_path_index is not None
        period = np.full(len(made), made.sample_period_ns)
        cir = around(made.cir, made.first_path_index, period, self.window)
        shape = shape_observables(*cir, scalars["preamble_count"], scalars["noise_std"])
        return collect(scalars, shape)

    @cached_property
    def _tables(self) -> dict[tuple[int, bytes], tuple[Rows, ForeignTable]]:
        """Matched tables that are remembered, with the rows they were matched to."""
        return {}

    def _rows_at(self, view: View, pick: NDArray[np.intp]) -> pd.DataFrame:
        """Return matched rows: what was measured from the table, all else as recorded."""
        theirs = self.frame.iloc[pick].reset_index(drop=True)
        known = [name for name in view.frame if name not in MEASURED]
        error = self.observed.column("error_m")[pick]
        kept = theirs[[name for name in theirs if name in MEASURED]]
        out = pd.concat([view.frame[known].reset_index(drop=True), kept], axis=1)
        return out.assign(error_m=error, range_m=view.scene.true_range_m + error)

    def _change(self, seen: Observables, view: View, added: Added, replicate: int) -> Floats:
        """Return what the effects change, [n, p]; zero for observables of the waveform."""
        change = np.zeros((len(view.rows), len(seen.names)))
        if not added:
            return change
        bare = Simulator(Base(), (), self.seed)
        see = self.stages.observables
        without = see(bare, view.scene, replicate, False)
        within = see(Simulator(Base(), added, self.seed), view.scene, replicate, False)
        for name in CHANGED:
            if name in seen.names and name in within.names and name in without.names:
                change[:, seen.names.index(name)] = within.column(name) - without.column(name)
        return change

    def _matches(self, view: View, members: int, first: int) -> list[NDArray[np.intp]]:
        """Return for each member the simulated row that stands for each recorded row [n]."""
        if self.paired(view):
            return self._by_link(view, members, first)
        return self._by_covariates(view, members)

    def paired(self, view: View) -> bool:
        """Return whether every recorded link is in the simulated table too."""
        if "link" not in self.frame:
            return False
        return bool(set(view.frame["link"].astype(str)) <= set(self.frame["link"].astype(str)))

    def _by_link(self, view: View, members: int, first: int) -> list[NDArray[np.intp]]:
        """Return rows drawn from the simulated rows of the same link."""
        rng = np.random.default_rng([self.seed, first])
        rows = self.frame.groupby(self.frame["link"].astype(str)).indices
        names = view.frame["link"].astype(str).to_numpy()
        out = np.empty((members, len(names)), np.intp)
        for name in np.unique(names):
            here = np.flatnonzero(names == name)
            pool = rows[name]
            for member in range(members):
                out[member, here] = pool[rng.integers(len(pool), size=len(here))]
        return list(out)

    def _shared(self, view: View) -> list[str]:
        """Return the covariates rows are matched on."""
        return [
            name
            for name in MATCHED_ON
            if np.isfinite(measured(view.frame, name)).all()
            and np.isfinite(measured(self.frame, name)).all()
        ]

    def _points(self, view: View) -> tuple[Floats, Floats]:
        """Return recorded and simulated rows in the matched covariates, in standard deviations."""
        names = self._shared(view)
        if not names:
            raise BenchError("the two tables share no covariate to match rows on (true_range_m?)")
        left = np.stack([measured(view.frame, name) for name in names], axis=1)
        right = np.stack([measured(self.frame, name) for name in names], axis=1)
        centre, scale = left.mean(axis=0), np.maximum(left.std(axis=0), 1e-9)
        return (left - centre) / scale, (right - centre) / scale

    def _by_covariates(self, view: View, members: int) -> list[NDArray[np.intp]]:
        """Return rows of the simulated links nearest to each recorded link."""
        left, right = self._points(view)
        distance = cKDTree(right).query(left)[0]
        if np.mean(distance > FAR) > 0.5:
            raise BenchError(
                "no overlap of covariates: most recorded rows have no simulated row within one "
                f"standard deviation of {', '.join(self._shared(view))}"
            )
        count = int(self.links.max()) + 1
        centres = np.stack([right[self.links == link].mean(axis=0) for link in range(count)])
        tree = cKDTree(centres)
        out = np.empty((members, len(left)), np.intp)
        for link in np.unique(view.links):
            here = np.flatnonzero(view.links == link)
            near = np.atleast_1d(tree.query(left[here].mean(axis=0), k=min(members, count))[1])
            for member in range(members):
                pool = np.flatnonzero(self.links == near[member % len(near)])
                closest = np.atleast_1d(cKDTree(right[pool]).query(left[here])[1])
                out[member, here] = pool[closest]
        return list(out)

    def mix(self, view: View) -> dict[str, tuple[float, float]]:
        """Return per matched covariate (recorded - simulated mean, in recorded std; p of equality).

        A two-sample Kolmogorov-Smirnov test over link means: the MIX, not the physics.
        """
        from scipy.stats import ks_2samp

        out = {}
        for name in self._shared(view):
            left = _link_means(measured(view.frame, name), view.links)
            right = _link_means(measured(self.frame, name), self.links)
            shift = (left.mean() - right.mean()) / max(float(left.std()), 1e-9)
            out[name] = float(shift), float(ks_2samp(left, right).pvalue)
        return out


def _link_means(values: Floats, links: NDArray[np.intp]) -> Floats:
    code = np.unique(links, return_inverse=True)[1]
    return np.asarray(np.bincount(code, values) / np.bincount(code), np.float64)
