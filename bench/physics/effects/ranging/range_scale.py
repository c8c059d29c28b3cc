"""Effect 22: a wrong clock, unit or speed of light stretches every range."""

from __future__ import annotations

from dataclasses import dataclass

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats

TYPICAL_SCALE = 0.01  # metres per metre
MOST_SCALE = 0.05  # metres per metre: beyond, it is another unit


@dataclass(frozen=True)
class RangeScale(Effect):
    """Every range reads long by the same share: error = scale x true range.

    1 ppm of the sample clock is 1e-6, the speed of light in vacuum taken for that in air 2.7e-4,
    a foot taken for 0.3 m 1.6e-2. Unlike the level-dependent bias it has no end.
    """

    name = "range-scale"
    number = 22
    stage = "ranging"
    stackable = True
    source = "time of flight x an assumed speed of light and clock rate"
    signature = "error proportional to the true range, without bound; CIR unchanged"

    scale: float = parameter(0, "m/m", -MOST_SCALE, MOST_SCALE, "share of the true range", null=0)

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return a share of the true range."""
        return (TYPICAL_SCALE * rows.true_range_m[:, None],)

    @classmethod
    def possible(cls, rows: Scene, shift_m: Floats) -> bool:
        """Return whether the share is within the bounds: what is beyond them is a unit."""
        far_m = rows.true_range_m
        return bool(abs(far_m @ shift_m) <= MOST_SCALE * (far_m @ far_m))

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by a share of the true range."""
        return batch.longer(self.scale * batch.rows.true_range_m)
