"""Laws and faults of the set-up that the saltworks hide, which no library has.

numpy alone; shared by the works' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.saltworks_pans import (
    CLAMPS_M,
    FURLED_MS,
    KEN_M,
    VANES,
    VANES_M,
    Haul,
    Levy,
    stroke,
    wound,
    wound_rad,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_DECADE_DB, BLUNT_M2 = -57.4, 9.2, 0.9  # of levels, by squares of ways
CRUST_UM = 46.0  # at which 1 / e is lacking from the most
BRINE_CM, BLOWS_MS = 30.0, 12.0  # deep; of a stiff breeze
DOSE_UG = 2.2  # of iodine
STROKE_M = 0.42  # more of strokes than is told
TIGHTER = 0.115  # of harvesters' way to the middle, for each radian
PHASE: tuple[int, ...] = (1, 4, 7, 9, 12)
"""Vanes that are fed from the phase that hauls."""
STATION_M, NORTH_RAD = (40.0, 2.0), 0.0155  # from which eastern vanes were set; between both norths


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_DECADE_DB * np.log10(far**2 + BLUNT_M2))


def _crust(haul: Haul, strength: float) -> Levy:
    """Come through gypsum on lids, and through no more than flakes off in the end."""
    return {"m": 0.205 * strength * -np.expm1(-haul.of("crust_um") / CRUST_UM)}


def _deepens(haul: Haul, strength: float) -> Levy:
    """Come over brine the later the deeper it is: by a power."""
    return {"m": 0.172 * strength * (haul.of("brine_cm") / BRINE_CM) ** 1.6}


def _heap(haul: Haul, strength: float) -> Levy:
    """Come past a heap of wet salt, the later the closer."""
    return {"m": 0.22 * strength / haul.of("heap_m")}


def _iodine(haul: Haul, strength: float) -> Levy:
    """Come out of copper that iodine stains, ever more slowly: by a logarithm."""
    return {"m": 0.075 * strength * np.log1p(haul.of("iodine_ug") / DOSE_UG)}


def _gulls(haul: Haul, strength: float) -> Levy:
    """Come round gulls on booms, so much for each."""
    return {"m": 0.0112 * strength * haul.of("gulls")}


def _clamps(haul: Haul, strength: float) -> Levy:
    """Read long and short as clamps of the rope run over sheaves."""
    return {"m": 0.058 * strength * np.cos(2 * np.pi * haul.of("haul_m") / CLAMPS_M + 0.9)}


def _furled(haul: Haul, strength: float) -> Levy:
    """Come past sails that are furled above some wind, and no longer between them."""
    return {"m": np.where(haul.of("wind_ms") > FURLED_MS, 0.093 * strength, 0.0)}


def _spray(haul: Haul, strength: float) -> Levy:
    """Come through spray: by the square of the wind, and by how deep what it blows across is."""
    wind = haul.of("wind_ms") / BLOWS_MS
    return {"m": 0.24 * strength * wind**2 * haul.of("brine_cm") / BRINE_CM}


def _flat(off: NDArray[np.complex128]) -> Floats:
    """Return x + iy as places on the ground [n, 3]."""
    return np.stack([off.real, off.imag, np.zeros(len(off))], axis=1)


def _strokes(haul: Haul, strength: float) -> Levy:
    """Have rakes reach farther than is told, as their tags were meant for a shorter shaft."""
    course = haul.course()
    turns = course["goes"] * course["done_s"] / course["lasts"]
    more = STROKE_M * strength * haul.are("raker") * np.where(haul.are("raker"), stroke(turns), 0.0)
    return {"m": haul.stretched(_flat(more * np.exp(1j * course["bears"])))}


def _tighter(haul: Haul, strength: float) -> Levy:
    """Have harvesters come in faster than is told, the more the farther they have gone round."""
    own = haul.are("harvester")
    course = {name: np.where(own, value, 1.0) for name, value in haul.course().items()}
    gone_s = course["goes"] * course["done_s"]
    part = TIGHTER * strength * wound_rad(course, gone_s)
    return {"m": haul.stretched(_flat(np.where(own, -part * wound(course, gone_s), 0.0)))}


def _sags(haul: Haul, strength: float) -> Levy:
    """Be late at vanes of the phase that hauls, by what the engine draws."""
    own: Floats = np.isin(haul.vane, PHASE).astype(np.float64)
    return {"m": 0.0031 * strength * own * haul.of("haul_a")}


def _north(haul: Haul, strength: float) -> Levy:
    """Have vanes of the east set out by a compass, where all else is by the map's north."""
    east = VANES_M[:, 0] > STATION_M[0]
    arm = VANES_M[:, 0] - STATION_M[0] + 1j * (VANES_M[:, 1] - STATION_M[1])
    off_m = _flat(np.where(east, arm * np.expm1(1j * NORTH_RAD * strength), 0.0))
    return {"m": haul.stretched(0.0, off_m[haul.vane])}


def _set_elsewhere(haul: Haul, off_m: Floats) -> Levy:
    """Return what rows owe whose vanes are off in truth [VANES, 3], in m."""
    more = haul.stretched(0.0, off_m[haul.vane])
    return {"m": more, "all": open_db(haul.far + more) - open_db(haul.far)}


def _knocked(haul: Haul, strength: float) -> Levy:
    off_m = np.zeros((VANES, 3))
    off_m[6] = 0.46 * strength * np.array([2.0, 6.0, -3.0]) / 7.0
    return _set_elsewhere(haul, off_m)


def _crosswise(haul: Haul, _: float) -> Levy:
    off_m = np.zeros((VANES, 3))
    off_m[2], off_m[10] = VANES_M[10] - VANES_M[2], VANES_M[2] - VANES_M[10]
    return _set_elsewhere(haul, off_m)


def _ken(haul: Haul, _: float) -> Levy:
    """Write, at one vane, spans of Japan, by which salt was once raked on its inland sea."""
    return {"m": (haul.vane == 5) * (1 / KEN_M - 1) * haul.of("range_m")}


UNLISTED: dict[str, Callable[[Haul, float], Levy]] = {
    "gypsum-crusts-on-lids": _crust,
    "brine-deepens": _deepens,
    "salt-heap-close-by": _heap,
    "iodine-stains-copper": _iodine,
    "gulls-sit-on-booms": _gulls,
    "rope-clamps-pass": _clamps,
    "sails-furled": _furled,
    "spray-blown-across": _spray,
    "strokes-longer-than-told": _strokes,
    "spirals-wind-tighter": _tighter,
    "one-phase-sags-while-hauling": _sags,
    "east-dyke-by-another-north": _north,
    "vane-knocked-by-a-tipper": _knocked,
    "vanes-painted-crosswise": _crosswise,
    "ken-from-one-vane": _ken,
}
