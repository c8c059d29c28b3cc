"""Effect 21 as well: the antennas move while the messages of one range are on their way."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.units import Floats


@dataclass(frozen=True)
class ExchangeMotion(Effect):
    """A range of several messages is a mean over their flights: error = share x reply time x speed.

    Half the reply time by default: the first and the last message of a single-sided exchange are
    one reply time apart. 1 m/s and 0.2 ms make 0.1 mm, 0.2 s make 0.1 m. Where every reply takes
    the same time this is a time lag. The speed is `radial_speed_m_per_s`; rows without it are
    left alone.
    """

    name = "exchange-motion"
    number = 21
    stage = "ranging"
    stackable = True
    source = "kinematics of two-way ranging: mean of the ranges at the first and the last message"
    signature = "error proportional to radial speed x reply time; zero at rest; CIR unchanged"
    everywhere = True
    control = "rows at rest"
    needs = (("radial_speed_m_per_s", "reply_time_s"),)

    share: float = parameter(0.5, "1", -2, 2, "of the reply time between truth and range", null=0)

    @classmethod
    def ways(cls, rows: Scene) -> tuple[Floats, ...] | None:
        """Return the way driven during the exchange."""
        speed = rows.number("radial_speed_m_per_s", 0.0)
        moved_m = (speed * rows.number("reply_time_s", 0.0))[:, None]
        return (moved_m,) if moved_m.any() else None

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges by what the antennas moved during the exchange."""
        return batch.longer(self.share * _moved_m(batch, 0.0))

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Rows at rest."""
        return np.asarray(np.abs(_moved_m(batch, np.inf)) < 1e-6)


def _moved_m(batch: Batch, unknown: float) -> Floats:
    """Return radial speed x reply time [n] in metres, `unknown` x reply time without a speed."""
    reply_s = batch.rows.number("reply_time_s", 0.0)
    speed = batch.rows.number("radial_speed_m_per_s", unknown)
    return np.asarray(np.where(reply_s > 0, speed * np.where(reply_s > 0, reply_s, 1.0), 0.0))
