"""Bias over the heading as a curve, for patterns that two harmonics do not follow."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np

from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_values import as_tuples
from bench.physics.effects.propagation.antenna_pattern import heading_rad
from bench.physics.randomness import Draws
from bench.physics.units import Floats


@dataclass(frozen=True)
class PatternCurve(Effect):
    """Range error over the heading as a curve: `bias_m` at `headings_deg`, linear between, closed.

    For patterns that two harmonics do not follow, such as a narrow lobe. The heading is that of
    the library's `antenna-pattern`. `gain_db` at the same headings is added to levels that are
    reported: a direction that is late is weak as well. () where levels do not follow the heading.
    """

    name = "pattern-curve"
    explains: ClassVar[str] = "antenna-pattern"
    contains = ("antenna-pattern",)  # the library's two harmonics
    values_unit: ClassVar[str] = "m"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "Ledergerber and D'Andrea, IEEE Access 6 (2018); curve fitted to recordings"
    signature = (
        "periodic in the heading or the bearing from rx to tx, the same at all distances; values "
        "are beside their mean over all headings"
    )
    needs = (("azimuth_deg",), ("tx_x_m", "tx_y_m", "rx_x_m", "rx_y_m"))

    headings_deg: tuple[float, ...] = (0.0,)
    bias_m: tuple[float, ...] = (0.0,)
    gain_db: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        count = len(self.headings_deg)
        as_tuples(self, headings_deg=None, bias_m=count, gain_db=count if self.gain_db else 0)

    def values(self) -> dict[str, float]:
        """Return the bias at every heading in metres."""
        pairs = zip(self.headings_deg, self.bias_m, strict=True)
        return {f"bias_m[{heading:g} deg]": bias for heading, bias in pairs}

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges and raise levels by the curves at headings, where these are known."""
        turn = heading_rad(batch.rows)
        batch = batch.longer(np.nan_to_num(closed(turn, self.headings_deg, self.bias_m)))
        if not self.gain_db:
            return batch
        gain = np.nan_to_num(closed(turn, self.headings_deg, self.gain_db))
        return batch.reported_louder(gain)


def closed(heading: Floats, headings_deg: tuple[float, ...], values: tuple[float, ...]) -> Floats:
    """Return a closed curve at headings [n] in radians, NaN where one is not known."""
    return np.asarray(np.interp(np.degrees(heading), headings_deg, values, period=360.0))
