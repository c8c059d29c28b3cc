"""Effect 7: obstacles in the straight line delay and weaken it."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.physics.batch import Batch
from bench.physics.effect import Effect, parameter
from bench.physics.materials import excess_m, loss_db, material, obstacle
from bench.physics.randomness import Draws
from bench.physics.units import C_M_PER_NS, Floats


@dataclass(frozen=True)
class MaterialDelay(Effect):
    """Every slab in the straight line delays it by a fixed step and lowers its power.

    Excess path t (sqrt(eps_r - sin^2 theta) - cos theta) and the loss of the complex
    permittivity; kinds and thicknesses from `obstacles` and `obstacle_thickness_m`. Rows without
    line of sight whose obstacles are not listed get `unlisted_walls` brick walls.
    """

    name = "material-delay"
    number = 7
    stage = "propagation"
    source = "ITU-R P.2040-3 (2023), equations (31)-(38), table 3"
    signature = "a positive step per wall, the same at all distances; the first path weaker"
    control = "rows with nothing in the straight line"

    thickness_scale: float = parameter(1, "ratio", 0, 4, "of the listed thickness", null=0)
    delay_scale: float = parameter(1, "ratio", 0, 4, "of the slab's excess delay")
    loss_scale: float = parameter(1, "ratio", 0, 4, "of the slab's loss in dB")
    unlisted_walls: float = parameter(1, "walls", 0, 10, "0.14 m of brick each, where unlisted")

    def apply(self, batch: Batch, draws: Draws) -> Batch:
        """Delay and weaken the straight path of every row with an obstacle."""
        delay_m, loss = self._slabs(batch)
        loss = np.minimum(loss * self.loss_scale, 90.0)
        return batch.direct_changed(loss, delay_m * self.delay_scale / C_M_PER_NS)

    def inert(self, batch: Batch) -> NDArray[np.bool_]:
        """Rows with nothing in the straight line."""
        return np.asarray(~batch.rows.blocked() & (batch.rows.obstacle_count() == 0))

    def _slabs(self, batch: Batch) -> tuple[Floats, Floats]:
        """Return the summed excess path in metres and loss in dB [n] of each row's slabs."""
        rows = batch.rows
        angle = np.radians(np.clip(rows.obstacle("obstacle_incidence_deg", 0.0), 0, 85))
        delay, loss = np.zeros(len(rows)), np.zeros(len(rows))
        for kind in np.unique(rows.kinds[rows.kinds != ""]):
            made = obstacle(str(kind))
            thick = rows.obstacle("obstacle_thickness_m", made.thickness_m) * self.thickness_scale
            at = rows.kinds == kind
            d, loss_kind = _slab(made.material, thick, angle, batch.centre_ghz)
            delay += np.sum(np.where(at, d, 0), axis=1)
            loss += np.sum(np.where(at, loss_kind, 0), axis=1)
        unlisted = rows.blocked() & (rows.obstacle_count() == 0)
        wall = np.array([obstacle("wall").thickness_m * self.thickness_scale])
        d, loss_kind = _slab("brick", wall, np.zeros(1), batch.centre_ghz)
        return (
            delay + unlisted * self.unlisted_walls * d,
            loss + unlisted * self.unlisted_walls * loss_kind,
        )


def _slab(name: str, thick: Floats, angle: Floats, centre_ghz: float) -> tuple[Floats, Floats]:
    """Return excess path (m) and loss (dB) of slabs of one material."""
    permittivity = material(name).permittivity(centre_ghz)
    return excess_m(thick, permittivity, angle), loss_db(thick, permittivity, angle, centre_ghz)
