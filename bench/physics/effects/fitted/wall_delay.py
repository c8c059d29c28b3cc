"""What every kind of obstacle delays, for ranges without waveforms."""

from __future__ import annotations

from dataclasses import dataclass
from typing import ClassVar

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.physics.batch import Batch
from bench.physics.effect import Effect
from bench.physics.effects.fitted.device_values import as_tuples
from bench.physics.randomness import Draws
from bench.physics.slabs import crossed

MOST_M = 4.0


@dataclass(frozen=True)
class WallDelay(Effect):
    """Every kind of obstacle delays, and weakens, by a size of its own.

    `delays_m` of one obstacle of each of `kinds` that is as thick as usual and hit at a right
    angle, in metres, and `losses_db` in dB. Nothing goes through metal. `UNLISTED` stands for rows
    without line of sight that list nothing.
    """

    name = "wall-delay"
    explains: ClassVar[str] = "material-delay"
    values_unit: ClassVar[str] = "m"
    fitted: ClassVar[bool] = False
    stage = "ranging"
    stackable = True
    source = "ITU-R P.2040-3 (2023), section 2.2.2; a size of every kind, fitted to recordings"
    signature = "a positive step per wall, the same at all distances; the first path weaker"
    needs = (("obstacles",), ("los",))
    control = "rows with nothing in the straight line"

    kinds: tuple[str, ...] = ()
    delays_m: tuple[float, ...] = ()
    losses_db: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        losses = len(self.kinds) if self.losses_db else 0
        as_tuples(self, kinds=None, delays_m=len(self.kinds), losses_db=losses)
        if any(not 0 <= delay <= MOST_M for delay in self.delays_m):
            raise BenchError(f"effect 'wall-delay': delays_m expected within 0 to {MOST_M:g} m")

    def values(self) -> dict[str, float]:
        """Return what one obstacle of every kind delays, in metres."""
        pairs = zip(self.kinds, self.delays_m, strict=True)
        return {f"delay_m[{kind}]": delay for kind, delay in pairs}

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Lengthen ranges and lower the levels of every row with an obstacle."""
        walls = crossed(batch.rows, self.kinds)
        longer = batch.longer(walls @ np.array(self.delays_m))
        lost_db = walls @ np.array(self.losses_db) if self.losses_db else np.zeros(len(batch))
        return longer.reported_louder(-lost_db)

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Return the rows with nothing in the straight line."""
        return batch.rows.clear()
