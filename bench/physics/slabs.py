"""The delay and loss of every listed obstacle, from its kind, thickness and angle; kinds."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.physics.materials import excess_m, is_object, is_opaque, loss_db, material, obstacle
from bench.physics.scene import Scene
from bench.physics.units import Floats

UNLISTED = "unlisted"
ANY_GHZ = 6.5  # no permittivity of ITU-R P.2040-3, table 3, changes with the frequency


def slabs(rows: Scene, centre_ghz: float, thickness_scale: float = 1.0) -> tuple[Floats, Floats]:
    """Return excess path in metres and loss in dB of every obstacle [n, M], 0 where none.

    Remembered: not to be written into.
    """
    key = ("slabs", centre_ghz, thickness_scale)
    found: tuple[Floats, Floats] = rows.known.get(
        key, lambda: _slabs(rows, centre_ghz, thickness_scale)
    )
    return found


def _slabs(rows: Scene, centre_ghz: float, thickness_scale: float) -> tuple[Floats, Floats]:
    """Return `slabs`, worked out."""
    angle = np.radians(np.clip(rows.obstacle("obstacle_incidence_deg", 0.0), 0, 85))
    delay, loss = np.zeros(rows.kinds.shape), np.zeros(rows.kinds.shape)
    for code, kind in enumerate(rows.kind_names):
        made = obstacle(kind)
        permittivity = material(made.material).permittivity(centre_ghz)
        thick = rows.obstacle("obstacle_thickness_m", made.thickness_m) * thickness_scale
        at = rows.kinds == code
        delay[at] = excess_m(thick[at], permittivity, angle[at])
        loss[at] = loss_db(thick[at], permittivity, angle[at], centre_ghz)
    return delay, loss


def opaque(rows: Scene) -> NDArray[np.bool_]:
    """Return which obstacles [n, M] are of metal or bodies: nothing goes through, only around."""
    return np.isin(rows.kinds, [i for i, kind in enumerate(rows.kind_names) if is_opaque(kind)])


def of_objects(rows: Scene) -> NDArray[np.bool_]:
    """Return which obstacles [n, M] waves may go through or around, for all that is listed."""
    return np.isin(rows.kinds, [i for i, kind in enumerate(rows.kind_names) if is_object(kind)])


def of_kind(rows: Scene, kind: str) -> NDArray[np.bool_]:
    """Return which obstacles [n, M] are of one kind."""
    code = rows.kind_names.index(kind) if kind in rows.kind_names else -2
    return np.asarray(rows.kinds == code)


def unlisted(rows: Scene) -> NDArray[np.bool_]:
    """Return the rows [n] without line of sight whose obstacles are not listed."""
    return np.asarray(rows.blocked() & (rows.obstacle_count() == 0))


def kinds_crossed(rows: Scene) -> tuple[str, ...]:
    """Return the kinds of obstacles that these rows pass through, none opaque."""
    codes = np.unique(rows.kinds[(rows.kinds >= 0) & ~opaque(rows)])
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
