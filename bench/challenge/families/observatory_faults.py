"""Laws and faults of the set-up that the observatory hides, which no library has.

numpy alone; shared by the observatory's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.observatory_hall import (
    CANNA_M,
    LATITUDE_RAD,
    ROLLERS_M,
    SCONCES,
    SCONCES_M,
    WIDE_DEG,
    Exposure,
    Toll,
    aimed,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_DECADE_DB, BLUNT_M = -59.9, 19.0, 0.7  # of levels
MILAN_RAD = 0.063  # Brera's latitude less the Roman College's
LOWER = 0.055  # part of heights by which stairs rise less than was told
RED: tuple[int, ...] = (0, 2, 5, 8, 10)
"""Sconces with red lamps."""
NORTH, LEANS_RAD = (3, 4, 5), 0.027  # sconces of a wall; how far it is off plumb


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_DECADE_DB * np.log10(np.hypot(far, BLUNT_M)))


def _dew(shot: Exposure, strength: float) -> Toll:
    """Come through dew on glass of sconces, which runs off once there is much of it."""
    return Toll(0.2 * strength * (1 - np.exp(-shot["dew_um"] / 45.0)))


def _hoar(shot: Exposure, strength: float) -> Toll:
    """Come by a roof on which hoar grows: by a power."""
    return Toll(0.168 * strength * (shot["hoar_mm"] / 9.0) ** 1.6)


def _pier(shot: Exposure, strength: float) -> Toll:
    """Come past a pier of iron, the later the closer."""
    return Toll(0.215 * strength / shot["pier_m"])


def _tarnish(shot: Exposure, strength: float) -> Toll:
    """Come off a mirror whose silver tarnishes, ever more slowly: by a logarithm."""
    return Toll(0.074 * strength * np.log1p(shot["tarnish_nm"] / 2.2))


def _guests(shot: Exposure, strength: float) -> Toll:
    """Come round guests who lean on rails, so much for each."""
    return Toll(0.0114 * strength * shot["guests"])


def _rollers(shot: Exposure, strength: float) -> Toll:
    """Read long and short as rollers of the dome's curb pass."""
    return Toll(0.059 * strength * np.sin(2 * np.pi * shot["curb_m"] / ROLLERS_M + 2.1))


def _slit(shot: Exposure, strength: float) -> Toll:
    """Come later while the dome's slit stands wide open."""
    return Toll(np.where(shot["slit_deg"] > WIDE_DEG, 0.092 * strength, 0.0))


def _mist(shot: Exposure, strength: float) -> Toll:
    """Come through mist: by the square of how damp it is, and by how far the slit is open."""
    return Toll(0.46 * strength * (shot["damp_pct"] / 100.0) ** 2 * shot["slit_deg"] / 100.0)


def _pole(shot: Exposure, strength: float) -> Toll:
    """Have tubes turn about a pole that was set for Milan, and be told of as if for Rome."""
    course = shot.course
    gone_s = course["moves"] * course["into_s"]
    both = [aimed(course, gone_s, one) for one in (LATITUDE_RAD + MILAN_RAD * strength,
                                                   LATITUDE_RAD)]  # fmt: skip
    return Toll(shot.longer(shot.is_("tube")[:, None] * (both[0] - both[1])))


def _stairs(shot: Exposure, strength: float) -> Toll:
    """Have climbers, whose heights are steps counted from the floor, be lower than that."""
    less = LOWER * strength * shot.inner[:, 2] * shot.is_("climber")
    return Toll(shot.longer(less[:, None] * np.array([0.0, 0.0, -1.0])))


def _red_lamps(shot: Exposure, strength: float) -> Toll:
    """Be late at sconces that have red lamps, by what these draw."""
    return Toll(0.0062 * strength * np.isin(shot.sconce, RED) * shot["lamp_w"])


def _stands(shot: Exposure, off_m: Floats) -> Toll:
    """Return what rows bear whose sconces are off in truth [SCONCES, 3], in m."""
    more = shot.longer(0.0, off_m[shot.sconce])
    return Toll(more, open_db(shot.far + more) - open_db(shot.far))


def _leans(shot: Exposure, strength: float) -> Toll:
    """Have a wall lean out, and its sconces the more the higher they are."""
    off_m = np.zeros((SCONCES, 3))
    off_m[NORTH, 1] = LEANS_RAD * strength * SCONCES_M[NORTH, 2]
    return Toll(shot.longer(0.0, off_m[shot.sconce]))


def _knocked(shot: Exposure, strength: float) -> Toll:
    off_m = np.zeros((SCONCES, 3))
    off_m[7] = 0.45 * strength * np.array([-2.0, 6.0, 3.0]) / 7.0
    return _stands(shot, off_m)


def _crosswise(shot: Exposure, _: float) -> Toll:
    off_m = np.zeros((SCONCES, 3))
    off_m[[1, 9]] = SCONCES_M[[9, 1]] - SCONCES_M[[1, 9]]
    return _stands(shot, off_m)


def _canne(shot: Exposure, _: float) -> Toll:
    """Write, at one sconce, canne of Roman architects."""
    return Toll(np.where(shot.sconce == 4, shot["range_m"] * (1 / CANNA_M - 1), 0.0))


UNLISTED: dict[str, Callable[[Exposure, float], Toll]] = {
    "dew-films-sconces": _dew,
    "hoar-grows-on-roof": _hoar,
    "iron-pier-close-by": _pier,
    "silvering-tarnishes": _tarnish,
    "guests-lean-on-rails": _guests,
    "dome-rollers-pass": _rollers,
    "slit-stands-wide-open": _slit,
    "mist-comes-in-by-the-slit": _mist,
    "pole-set-for-another-city": _pole,
    "stairs-of-a-lower-rise": _stairs,
    "red-lamps-warm-their-sconces": _red_lamps,
    "north-wall-leans-out": _leans,
    "sconce-knocked-by-a-ladder": _knocked,
    "sconces-lettered-crosswise": _crosswise,
    "canne-from-one-sconce": _canne,
}
