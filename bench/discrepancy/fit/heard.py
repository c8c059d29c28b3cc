"""What clocks are fitted to: rows with their devices, times, temperatures and residual ranges."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array
from scipy.sparse.linalg import lsqr

from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.fit.least_squares import ends, incidence
from bench.discrepancy.fit.settings import MEAN_TOLD_SHARE
from bench.discrepancy.settings import CLOCK_FOLDS, CLOCK_LINK_FOLDS, CLOCK_STRETCHES
from bench.physics.effects.fitted.device_clock import DeviceClock
from bench.physics.units import C_M_PER_NS

Floats = NDArray[np.float64]
Rows = NDArray[np.intp]
TIME, WARM = "time_s", "temperature_c"  # what offsets go by


@dataclass(frozen=True)
class Heard:
    """What clocks are fitted to: rows with their devices, times and residual ranges.

    `residual_m` [n]; `warm_c` [n] temperatures, NaN if unknown; `per_ppm` [n] metres per ppm;
    `links` [n] codes; `tx`, `rx` [n] numbers of `names`.
    """

    names: tuple[str, ...]
    tx: Rows
    rx: Rows
    time_s: Floats
    warm_c: Floats
    per_ppm: Floats
    residual_m: Floats
    links: Rows
    view: View

    @classmethod
    def of(cls, view: View, residual_m: Floats) -> Heard:
        """Return the rows of a view with their residual ranges [n]."""
        names, tx, rx = ends(view)
        time, warm = (numeric(view.frame, name) for name in (TIME, WARM))
        reply_s = np.nan_to_num(numeric(view.frame, "reply_time_s"))
        per_ppm = C_M_PER_NS * reply_s / 2 * 1e3
        return cls(names, tx, rx, time, warm, per_ppm, residual_m, view.links, view)

    @cached_property
    def reference_s(self) -> float:
        """The middle of the recording, 0 without times."""
        return _middle(self.time_s)

    @cached_property
    def reference_c(self) -> float:
        """The temperature in the middle, 0 where none is known."""
        return _middle(self.warm_c)

    def since(self, over: str) -> Floats:
        """Return hours or degrees since the middle [n], 0 where they are not known."""
        hours = (self.time_s - self.reference_s) / 3600
        return np.nan_to_num(hours if over == TIME else self.warm_c - self.reference_c)

    def error(self, clock: DeviceClock, rows: Rows) -> float:
        """Return the mean abs. residual that a clock leaves on some rows, in metres."""
        guess = clock.offset_ppm(self.view.scene)[rows] * self.per_ppm[rows]
        left = np.abs(self.residual_m[rows] - guess)
        return float(np.nanmean(left)) if np.isfinite(left).any() else 0.0

    @cached_property
    def with_mean(self) -> bool:
        """Whether a constant of all ranges, which no clock makes, is told from clocks.

        Where roles are swapped or reply times differ. Elsewhere, as where tags always ask and
        anchors answer, all of it may be the offsets of tags from anchors.
        """
        known = np.isfinite(self.residual_m)
        ones = known.astype(np.float64)
        design = self.design(np.arange(len(self.links))).multiply(ones[:, None])
        rest = lsqr(csr_array(design), ones, atol=1e-12)[3]
        return bool(rest**2 > MEAN_TOLD_SHARE * max(known.sum(), 1))

    def design(self, rows: Rows) -> csr_array:
        """Return metres per ppm of every device's offset [n, D] in some rows."""
        pair = incidence(self.tx[rows], self.rx[rows], -1.0, len(self.names))
        return csr_array(pair.multiply(self.per_ppm[rows][:, None]))

    @cached_property
    def stretches(self) -> Rows:
        """Fold of each row [n]: alternate stretches of every pair of devices and link."""
        fold = np.zeros(len(self.links), np.intp)
        keys = np.stack([self.links, self.tx, self.rx], axis=1)
        code = np.unique(keys, axis=0, return_inverse=True)[1].ravel()
        for pair in np.unique(code):
            rows = np.flatnonzero(code == pair)
            rows = rows[np.argsort(self.time_s[rows], kind="stable")]
            fold[rows] = (np.arange(len(rows)) * CLOCK_STRETCHES // len(rows) + pair) % CLOCK_FOLDS
        return fold

    @cached_property
    def parts(self) -> Rows:
        """Fold of each row [n]: whole links."""
        names = np.unique(self.links)
        return np.asarray(
            np.searchsorted(names, self.links) % max(min(CLOCK_LINK_FOLDS, len(names)), 1)
        )


def _middle(values: Floats) -> float:
    """Return the median of the values that are known, 0 without any."""
    known = np.isfinite(values)
    return float(np.median(values[known])) if known.any() else 0.0
