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
from bench.physics.effects.propagation.material_delay import unlisted
from bench.physics.materials import excess_m, material, obstacle
from bench.physics.randomness import Draws
from bench.physics.scene import Scene
from bench.physics.slabs import of_metal, slabs
from bench.physics.units import Floats

UNLISTED = "unlisted"
ANY_GHZ = 6.5  # no permittivity of ITU-R P.2040-3, table 3, changes with the frequency
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


def kinds_crossed(rows: Scene) -> tuple[str, ...]:
    """Return the kinds of obstacles that these rows pass through, none of metal."""
    codes = np.unique(rows.kinds[(rows.kinds >= 0) & ~of_metal(rows)])
    listed = sorted(rows.kind_names[code] for code in codes)
    return (*listed, *([UNLISTED] if unlisted(rows).any() else []))


def crossed(rows: Scene, kinds: tuple[str, ...]) -> Floats:
    """Return how many usual obstacles of every kind are in the way [n, k].

    One that is twice as thick, or hit aslant so that the way through it delays as much, counts two.
    """
    delay_m = slabs(rows, ANY_GHZ)[0]
    out = np.zeros((len(rows), len(kinds)))
    for place, kind in enumerate(kinds):
        if kind == UNLISTED:
            out[:, place] = unlisted(rows)
        elif kind in rows.kind_names:
            here = rows.kinds == rows.kind_names.index(kind)
            out[:, place] = np.where(here, delay_m, 0.0).sum(axis=1) / _usual_m(kind)
    return out


def _usual_m(kind: str) -> float:
    """Return what one obstacle of a kind delays by the tables, in metres."""
    made = obstacle(kind)
    permittivity = material(made.material).permittivity(ANY_GHZ)
    return float(excess_m(np.array([made.thickness_m]), permittivity, np.zeros(1))[0])
