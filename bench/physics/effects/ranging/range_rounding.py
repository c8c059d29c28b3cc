"""Effect 23: ranges written down in steps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.batch import Batch, altered
from bench.physics.comb import Comb, comb
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.units import Floats

LEANS = (0.0, -0.5, 0.5)
LOWEST_ORIGIN = -0.49  # of a step: half a step below is the same point as half a step above
LEAST_ORIGIN = 1e-6  # of a step: less is how numbers are stored
CLEAR = 0.75  # coherence of a grid whose points scatter by an eighth of a step; steps that are
# half filled, as a bit that is stuck leaves them, have 2 / pi
LEAN_STEPS = 0.1  # off, at most: other causes move the mean as well
MEDIAN_ERROR = 2 * 1.2533 * 1.4826  # two standard errors of a median, of the median deviation


@dataclass(frozen=True)
class RangeRounding(Effect):
    """Ranges are rounded to a step, as firmware that prints centimetres or decimetres does.

    It scatters like jitter of step / sqrt(12), but every range is a point of a grid: `origin_m` is
    one of them. `lean` -0.5 cuts down to the grid, 0.5 up. `early` 1: rounded before the other
    effects on the range act, as where a host corrects what firmware printed. It is fitted by the
    grid itself (see `bench.physics.comb`): where none is seen, there is no rounding that matters.
    """

    name = "range-rounding"
    number = 23
    stage = "ranging"
    stackable = True
    source = "uniform quantisation: Widrow and Kollar, Quantization Noise, Cambridge 2008, ch. 5"
    signature = "ranges are points of a grid; error uniform within half a step; CIR unchanged"
    fitted: ClassVar[bool] = False
    marked: ClassVar[bool] = True
    values_unit: ClassVar[str] = "m"

    step_m: float = parameter(0.0, "m", 0, 1, "rounding step of the range", null=0)
    origin_m: float = parameter(0.0, "m", -1, 1, "a point of the grid")
    lean: float = parameter(0.0, "steps", -0.5, 0.5, "-0.5: cut down, 0: to the nearest")
    early: int = parameter(0, "0 or 1", 0, 1, "before other effects on the range", fitted=False)

    @property
    def last(self) -> bool:  # type: ignore[override]
        """Whether it acts on what the other effects on the range made."""
        return not self.early

    @property
    def first(self) -> bool:  # type: ignore[override]
        """Whether it acts before them."""
        return bool(self.early)

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Round the ranges to the grid."""
        if self.step_m == 0 or batch.range_m is None:
            return batch
        grid = Comb(self.step_m, self.origin_m, 1.0)
        return altered(batch, range_m=grid.nearest(np.asarray(batch.range_m), self.lean))

    def forms(self) -> tuple[Effect, ...]:
        """Return it to the nearest, down and up: they differ by a constant alone."""
        return tuple(replace(self, lean=lean) for lean in LEANS)

    def values(self) -> dict[str, float]:
        """Return step and origin of the grid in metres."""
        return {"step_m": self.step_m, "origin_m": self.origin_m} if self.step_m else {}

    @classmethod
    def fit_values(cls, frame: pd.DataFrame, residual_m: NDArray[np.float64]) -> Effect | None:
        """Return the rounding whose grid the measured ranges lie on, None without one.

        On the grid are the ranges themselves or, where others corrected them after, what is left
        of them without these corrections.
        """
        if not {"range_m", "true_range_m"} <= set(frame):
            return None
        measured, true = (frame[n].to_numpy(np.float64) for n in ("range_m", "true_range_m"))
        known = np.isfinite(measured) & np.isfinite(residual_m) & np.isfinite(true)
        links = _codes(frame)[known]
        measured, true, left = measured[known], true[known], residual_m[known]
        late, early = measured - left, true + left
        found = [_rounding(measured, late, links, 0), _rounding(early, true, links, 1)]
        seen = [one for one in found if one]
        return max(seen, key=lambda one: one[0])[1] if seen else None


def _codes(frame: pd.DataFrame) -> NDArray[np.intp]:
    """Return codes of links [n]; every row its own where links are not known."""
    names = frame["link"].astype(str) if "link" in frame else np.arange(len(frame))
    return np.asarray(np.unique(names, return_inverse=True)[1], np.intp)


def _rounding(
    measured_m: Floats, plain_m: Floats, links: NDArray[np.intp], early: int
) -> tuple[float, RangeRounding] | None:
    """Return how clear the grid of ranges [n] is, and the rounding; None where there is none."""
    links = np.unique(links, return_inverse=True)[1]
    grid = comb(measured_m, plain_m, links)
    if grid is None or grid.coherence < CLEAR:
        return None
    lean = _lean(measured_m - plain_m, links, grid.step_m)
    origin_m = grid.origin_m + grid.step_m * (grid.origin_m < LOWEST_ORIGIN * grid.step_m)
    origin_m *= abs(origin_m) > LEAST_ORIGIN * grid.step_m
    return grid.coherence, RangeRounding(grid.step_m, origin_m, lean, early)


def _lean(left_m: Floats, links: NDArray[np.intp], step_m: float) -> float:
    """Return the lean that makes the mean of what is left [n] nothing; 0 where none does.

    A lean is a constant of half a step: any other constant is no rounding.
    """
    mean = np.bincount(links, left_m) / np.bincount(links)
    middle = float(np.median(mean))
    error = MEDIAN_ERROR * float(np.median(np.abs(mean - middle))) / np.sqrt(len(mean))
    off = [abs(middle - lean * step_m) for lean in LEANS]
    able = [lean for lean, one in zip(LEANS, off, strict=True) if one < LEAN_STEPS * step_m + error]
    return able[0] if able else 0.0
