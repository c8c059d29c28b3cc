"""Effect 21: the clock of the truth and the clock of the radio disagree."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats

TYPICAL_LAG_S = 0.1


@dataclass(frozen=True)
class TimeLag(Effect):
    """The truth is read at another moment than the range: error = lag x radial speed.

    A lag is positive where the range was measured later than its truth says. The speed comes from
    `radial_speed_m_per_s`, which follows from `true_range_m` and `time_s`; rows without it are
    left alone.
    """

    name = "time-lag"
    number = 21
    stage = "ranging"
    stackable = True
    source = "kinematics: range(t + lag) - range(t) = lag x d(range)/dt to first order"
    signature = "error proportional to radial speed; sign flips with the direction; CIR unchanged"
    everywhere = True
    control = "rows at rest"
    setup_fault = "time shift"
    needs = (("radial_speed_m_per_s",),)

    lag_s: float = parameter(0, "s", -2, 2, "truth to range: below zero, ranges are old", null=0)

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return the radial speed x a typical lag."""
        speed = rows.number("radial_speed_m_per_s", 0.0)
        return (TYPICAL_LAG_S * speed[:, None],) if speed.any() else None

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by lag x radial speed."""
        return batch.longer(self.lag_s * batch.rows.number("radial_speed_m_per_s", 0.0))

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Rows at rest."""
        return np.asarray(np.abs(batch.rows.number("radial_speed_m_per_s", np.inf)) < 1e-3)
