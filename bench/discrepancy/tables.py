"""Comparing with a table from another simulator: rows paired by link, or matched by covariates.

Where both tables have a link, its rows are compared with each other. Otherwise every recorded
link is compared with the simulated links nearest to it in the known covariates, so a difference in
the MIX of covariates is not mistaken for one in the physics: it is reported on its own.
Only effects on the range act on a table; those on paths and waveforms need the simulator itself.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import pandas as pd
from numpy.typing import NDArray
from scipy.spatial import cKDTree

from bench.discrepancy.ensemble import Ensemble, stack
from bench.discrepancy.observables import Floats, Observables, Window, observe
from bench.discrepancy.split import link_codes
from bench.discrepancy.world import Added, View, measured
from bench.errors import BenchError
from bench.physics.base import Base
from bench.physics.batch import Batch
from bench.physics.randomness import Draws
from bench.physics.scene import scene

MATCHED_ON = ("true_range_m", "reply_time_s", "temperature_c", "azimuth_deg", "tx_z_m", "rx_z_m")
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

    def ensemble(self, view: View, added: Added, members: int, first: int = 0) -> Ensemble:
        """Return recorded rows beside `members` matched simulated rows, with effects `added`.

        Raises BenchError where an effect is not one on the range.
        """
        seen = self._with(added, first)
        picks = self._matches(view, members, first)
        replicas = [
            Observables(seen.names, seen.units, self._adjusted(seen, pick, view)) for pick in picks
        ]
        return stack(view.recorded, replicas, view.links)

    def _with(self, added: Added, replicate: int) -> Observables:
        """Return the simulated observables with effects on the range added."""
        late = [effect for effect in added if effect.stage != "ranging" or not effect.on_tables]
        if late:
            raise BenchError(f"effect {late[0].name!r} needs the simulator itself, not its table")
        if not added or "error_m" not in self.observed.names:
            return self.observed
        batch = self._batch
        assert batch.range_m is not None
        before = batch.range_m
        for effect in added:
            batch = effect.apply(batch, Draws(self.seed, replicate, effect.name, 0))
        assert batch.range_m is not None
        values = self.observed.values.copy()
        values[:, self.observed.names.index("error_m")] += batch.range_m - before
        return Observables(self.observed.names, self.observed.units, values)

    @cached_property
    def _batch(self) -> Batch:
        """The table's rows as a detected batch without a waveform."""
        from dataclasses import replace

        base = Base()
        batch = base.detected(base.counted(base.paths(scene(self.frame, "simulated"))))
        power = measured(self.frame, "rx_power_dbm")
        level = np.where(np.isfinite(power), power, batch.level())
        return replace(batch, level_dbm=level)

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

    def _adjusted(self, seen: Observables, pick: NDArray[np.intp], view: View) -> Floats:
        """Return the matched observables [n, p]."""
        return np.asarray(seen.values[pick])

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
