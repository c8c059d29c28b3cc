"""The delay and loss of every listed obstacle, from its kind, thickness and angle."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.physics.materials import excess_m, loss_db, material, obstacle
from bench.physics.scene import Scene
from bench.physics.units import Floats


def slabs(rows: Scene, centre_ghz: float, thickness_scale: float = 1.0) -> tuple[Floats, Floats]:
    """Return excess path in metres and loss in dB of every obstacle [n, M], 0 where none."""
    angle = np.radians(np.clip(rows.obstacle("obstacle_incidence_deg", 0.0), 0, 85))
    delay, loss = np.zeros(rows.kinds.shape), np.zeros(rows.kinds.shape)
    for kind in np.unique(rows.kinds[rows.kinds != ""]):
        made = obstacle(str(kind))
        permittivity = material(made.material).permittivity(centre_ghz)
        thick = rows.obstacle("obstacle_thickness_m", made.thickness_m) * thickness_scale
        at = rows.kinds == kind
        delay[at] = excess_m(thick[at], permittivity, angle[at])
        loss[at] = loss_db(thick[at], permittivity, angle[at], centre_ghz)
    return delay, loss


def of_metal(rows: Scene) -> NDArray[np.bool_]:
    """Return which obstacles [n, M] are of metal: nothing goes through, only around."""
    metal = [kind for kind in np.unique(rows.kinds) if kind and _is_metal(str(kind))]
    return np.isin(rows.kinds, metal)


def _is_metal(kind: str) -> bool:
    return obstacle(kind).material == "metal"
