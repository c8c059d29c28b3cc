"""Effect 23: ranges written down in steps."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import ClassVar

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.batch import Batch, altered
from bench.physics.comb import EXACT, comb
from bench.physics.device_combs import device_combs
from bench.physics.device_leans import LEAN_STEPS, LEANS, choice_nats, device_leans, middle_of
from bench.physics.effect import Effect, parameter
from bench.physics.effects.fitted.device_values import as_tuples, at_end
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats

LOWEST_ORIGIN = -0.49  # of a step: half a step below is the same point as half a step above
LEAST_ORIGIN = 1e-6  # of a step: less is how numbers are stored
CLEAR = 0.75  # coherence of a grid whose points scatter by an eighth of a step; steps that are
# half filled, as a bit that is stuck leaves them, have 2 / pi
SAME_STEP = 0.1  # by which two steps may differ, of their size, that one firmware prints
LEAN_CHI2 = 2 * 3.0  # another way of rounding is as likely that is within 3 nats
COARSER = 2.0  # steps of devices over that of all: else they are its own
GROWTHS = (0.0, 0.5, 1.0, -1.0)  # even steps; codes of roots, of logarithms and of squares
REFERENCE_M = 10.0  # of even steps, which are the same everywhere
LEAST_M = 1e-3  # of a range, of which a logarithm is taken


@dataclass(frozen=True)
class RangeRounding(Effect):
    """Ranges are rounded to a step, as firmware that prints centimetres or decimetres does.

    It scatters like jitter of step / sqrt(12), but every range is a point of a grid: `origin_m` is
    one of them. `lean` -0.5 cuts down to the grid, 0.5 up. `early` 1: rounded before the other
    effects on the range act, as where a host corrects what firmware printed. It is fitted by the
    grid itself (see `bench.physics.comb`): where none is seen, there is no rounding that matters.
    `devices` at the end `of` have `steps_m` and `origins_m` of their own, 0 where they do not
    round; `step_m` is then what they scatter by in the mean square. Or they have `leans` of their
    own. Steps grow as the range to the power of `growth`, and are of `step_m` at `reference_m`.
    `untold`: other leans that recordings, of which it was fitted, do not tell from its own; they
    change nothing here.
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

    of: str = ""
    devices: tuple[str, ...] = ()
    steps_m: tuple[float, ...] = ()
    origins_m: tuple[float, ...] = ()
    leans: tuple[float, ...] = ()
    untold: tuple[float, ...] = ()
    growth: float = parameter(
        0.0, "1", -1, 1, "0: even steps, 1: steps in proportion to ranges, -1: to their inverse"
    )
    reference_m: float = parameter(
        REFERENCE_M, "m", 1e-3, 1e4, "range at which steps are of `step_m`"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(tuple(self.devices))
        able = {"steps_m": self.steps_m, "origins_m": self.origins_m, "leans": self.leans}
        lengths = {name: count if len(tuple(values)) else 0 for name, values in able.items()}
        as_tuples(self, devices=None, untold=None, **lengths)

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
        step, origin = self._grids(batch.rows)
        even = evened(np.asarray(batch.range_m), self.growth, self.reference_m)
        number = np.rint((even - origin) / np.where(step > 0, step, 1) + self._leans(batch.rows))
        made = np.where(step > 0, number * step + origin, even)
        return altered(batch, range_m=unevened(made, self.growth, self.reference_m))

    def place(self, range_m: Floats) -> Floats:
        """Return the number of the grid's point that is nearest to ranges [n]."""
        even = evened(range_m, self.growth, self.reference_m)
        return np.asarray(np.rint((even - self.origin_m) / self.step_m))

    def step_at(self, range_m: Floats) -> Floats:
        """Return how long a step is at ranges [n], in metres."""
        return np.asarray(self.step_m * (range_m / self.reference_m) ** self.growth)

    def leant_m(self, rows: Scene) -> Floats:
        """Return what it does to the ranges of rows [n] in the mean, in metres."""
        step = self._grids(rows)[0] * (rows.true_range_m / self.reference_m) ** self.growth
        return np.asarray(self._leans(rows) * step)

    def _grids(self, rows: Scene) -> tuple[Floats, Floats]:
        """Return step and origin for every row [n], in metres."""
        if not self.steps_m:
            return np.full(len(rows), self.step_m), np.full(len(rows), self.origin_m)
        own, origin = (
            at_end(rows, self.of, self.devices, values) for values in (self.steps_m, self.origins_m)
        )
        listed = self._listed(rows)
        return np.where(listed, own, self.step_m), np.where(listed, origin, self.origin_m)

    def _listed(self, rows: Scene) -> NDArray[np.bool_]:
        """Return which rows [n] are of a device that is listed."""
        ones = (1.0,) * len(self.devices)
        return np.asarray(at_end(rows, self.of, self.devices, ones) > 0)

    def _leans(self, rows: Scene) -> Floats:
        """Return the lean of every row [n], in steps: of devices that are not listed the common."""
        if not self.leans:
            return np.full(len(rows), self.lean)
        own = at_end(rows, self.of, self.devices, self.leans)
        return np.where(self._listed(rows), own, self.lean)

    def forms(self) -> tuple[Effect, ...]:
        """Return it to the nearest, down and up: a constant apart; and as devices lean.

        With steps of devices as well: what each is off by besides may be a delay of its own.
        """
        if not self.leans:
            return tuple(replace(self, lean=lean, untold=()) for lean in LEANS)
        alike = replace(self, of="", devices=(), leans=())
        return *alike.forms(), self

    def not_told_from(self, alike: tuple[Effect, ...]) -> Effect:
        """Return it with the leans of other forms, which differ from it by a constant."""
        others = [one for one in alike if isinstance(one, RangeRounding) and not one.leans]
        leans = {one.lean for one in others if replace(one, lean=self.lean) == self}
        return replace(self, untold=tuple(sorted(leans - {self.lean})))

    def forms_as_likely(self) -> tuple[Effect, ...]:
        """Return it with every lean that is not told from its own."""
        return tuple(replace(self, lean=lean) for lean in self.untold)

    @property
    def chosen_nats(self) -> float:
        """What it costs that each device has a lean of its own."""
        return choice_nats(len(self.leans))

    def values(self) -> dict[str, float]:
        """Return step and origin of the grid in metres; of devices the step of each."""
        if self.steps_m:
            pairs = zip(self.devices, self.steps_m, strict=True)
            return {f"step_m[{device}]": step for device, step in pairs if step}
        return {"step_m": self.step_m, "origin_m": self.origin_m} if self.step_m else {}

    @classmethod
    def fit_values(cls, frame: pd.DataFrame, residual_m: NDArray[np.float64]) -> Effect | None:
        """Return the rounding whose grid the measured ranges lie on, None without one.

        On the grid are the ranges themselves or, where others corrected them after, what is left
        of them without these corrections. Where all together lie on none exactly, or on a much
        finer one to which ranges are printed, the ranges of each device may lie on one of its own.
        """
        if not {"range_m", "true_range_m"} <= set(frame):
            return None
        measured, true = (frame[n].to_numpy(np.float64) for n in ("range_m", "true_range_m"))
        known = np.isfinite(measured) & np.isfinite(residual_m) & np.isfinite(true)
        links = _codes(frame)[known]
        measured, true, left = measured[known], true[known], residual_m[known]
        late, early = measured - left, true + left
        both = ((measured, late, 0), (early, true, 1))
        rows = frame[known]
        found = [
            _rounding(rows, (one, plain), links, way, g)
            for one, plain, way in both
            for g in GROWTHS
        ]
        seen = [one for one in found if one]
        best = max(seen, key=lambda one: one[0], default=(0.0, None))
        own = _by_device(rows, measured, late, links)
        print_m = best[1].step_m if best[1] and best[0] > EXACT[0] else 0.0
        return own if own and own.step_m > COARSER * print_m else best[1]

    def borne_by(self, frame: pd.DataFrame) -> bool:
        """Return whether the ranges of another table lie on a grid of about this step."""
        if "true_range_m" not in frame or not {"range_m", "error_m"} & set(frame):
            return False
        true = frame["true_range_m"].to_numpy(np.float64)
        measured = frame["range_m"] if "range_m" in frame else true + frame["error_m"]
        rows = frame.assign(range_m=measured)
        found = self.fit_values(rows, rows["range_m"].to_numpy(np.float64) - true)
        step_m = found.step_m if isinstance(found, RangeRounding) else np.inf
        return bool(abs(np.log(step_m / self.step_m)) < SAME_STEP)


def _codes(frame: pd.DataFrame) -> NDArray[np.intp]:
    """Return codes of links [n]; every row its own where links are not known."""
    names = frame["link"].astype(str) if "link" in frame else np.arange(len(frame))
    return np.asarray(np.unique(names, return_inverse=True)[1], np.intp)


def _rounding(
    frame: pd.DataFrame,
    ranges_m: tuple[Floats, Floats],
    links: NDArray[np.intp],
    early: int,
    growth: float,
) -> tuple[float, RangeRounding] | None:
    """Return how clear the grid of ranges [n] is, and the rounding; None where there is none.

    `ranges_m` are those on the grid and as they would be without it.
    """
    measured_m, plain_m = ranges_m
    middle_m = max(float(np.median(measured_m)), LEAST_M) if growth else REFERENCE_M
    measured_m, plain_m = (evened(one, growth, middle_m) for one in (measured_m, plain_m))
    links = np.unique(links, return_inverse=True)[1]
    grid = comb(measured_m, plain_m, links)
    if grid is None or grid.coherence < CLEAR:
        return None
    off_steps = (measured_m - plain_m) / grid.step_m
    of, own = device_leans(frame, off_steps, links)
    origin_m = grid.origin_m + grid.step_m * (grid.origin_m < LOWEST_ORIGIN * grid.step_m)
    origin_m *= abs(origin_m) > LEAST_ORIGIN * grid.step_m
    return grid.coherence, RangeRounding(
        grid.step_m,
        origin_m,
        _lean(off_steps, links),
        early,
        of,
        tuple(own),
        leans=tuple(own.values()),
        growth=growth,
        reference_m=middle_m,
    )


def evened(range_m: Floats, growth: float, reference_m: float) -> Floats:
    """Return ranges [n] on a scale on which all steps are alike, in metres at `reference_m`."""
    if not growth:
        return range_m
    times = np.maximum(range_m, LEAST_M) / reference_m
    even = np.log(times) if growth == 1 else (times ** (1 - growth) - 1) / (1 - growth)
    return np.asarray(reference_m * even)


def unevened(even_m: Floats, growth: float, reference_m: float) -> Floats:
    """Return the ranges [n] of places on the scale of `evened`."""
    if not growth:
        return even_m
    even = even_m / reference_m
    if growth == 1:
        return np.asarray(reference_m * np.exp(even))
    root = np.maximum(1 + (1 - growth) * even, 0.0)
    return np.asarray(reference_m * root ** (1 / (1 - growth)))


def _by_device(
    frame: pd.DataFrame, measured_m: Floats, plain_m: Floats, links: NDArray[np.intp]
) -> RangeRounding | None:
    """Return the rounding of ranges [n] to grids of devices, None where these have none."""
    end, found = device_combs(frame, measured_m, plain_m, links)
    if not found:
        return None
    names = frame[end].astype(str).to_numpy(object)
    steps = {str(n): found[n].step_m if n in found else 0.0 for n in np.unique(names)}
    origins = (found[name].origin_m if name in found else 0.0 for name in steps)
    step = np.array([steps[name] for name in names])
    mine = step > 0
    codes = np.unique(links[mine], return_inverse=True)[1]
    lean, untold = _leans_of((measured_m - plain_m)[mine] / step[mine], codes)
    scatter_m, own = float(np.sqrt(np.mean(step**2))), (tuple(steps.values()), tuple(origins))
    return RangeRounding(scatter_m, 0.0, lean, 0, end, tuple(steps), *own, untold=untold)


def _leans_of(off_steps: Floats, links: NDArray[np.intp]) -> tuple[float, tuple[float, ...]]:
    """Return the lean nearest to the mean of what is off [n], in steps, and others as likely.

    What rounding leaves of a link that stands still is anything within half a step.
    """
    mean = np.bincount(links, off_steps) / np.bincount(links)
    error = max(float(np.std(mean)), np.sqrt(1 / 12)) / np.sqrt(len(mean))
    off = {lean: abs(float(mean.mean()) - lean) / error for lean in LEANS}
    best = min(off, key=lambda lean: off[lean])
    near = {lean for lean in LEANS if off[lean] ** 2 < off[best] ** 2 + LEAN_CHI2}
    return best, tuple(sorted(near - {best}))


def _lean(off_steps: Floats, links: NDArray[np.intp]) -> float:
    """Return the lean that makes the mean of what is off [n], in steps, nothing; 0 where none does.

    A lean is a constant of half a step: any other constant is no rounding.
    """
    middle, error = middle_of(off_steps, links)
    able = [lean for lean in LEANS if abs(middle - lean) < LEAN_STEPS + error]
    return able[0] if able else 0.0
