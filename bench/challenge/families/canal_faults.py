"""Laws and faults of the set-up that the ship lock hides, which no library has.

numpy alone; shared by the lock's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.canal_chamber import (
    DAVITS,
    DAVITS_M,
    DAY_S,
    FROST_C,
    LEAF_M,
    ROEDE_M,
    SLOSH_S,
    Passage,
    Toll,
    leaf_angle,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_NEPER_DB = -60.9, 8.4  # of levels
BLUNT_M = 0.8  # added to ways, of which levels are
HALF_SLIME_UM = 32.0  # at which half of the most is there
WASH_CM = 26.0  # high, the highest waves
VERDIGRIS_MG = 2.5  # a dose
FALLS = 9.81  # m/s2
BEHIND_S = 17.0  # that water in the gauge's well is behind that of the chamber
WIDER = 0.09  # by what part leaves turn further than their shafts' coders
APART_M = 0.23  # of each of two antennas, from the middle of both
RESTART = 0.36  # of the day
SETTLES_S, LATE_M = 5200.0, 0.21  # until e times less; at first
CABINET: tuple[int, ...] = (0, 3, 6, 9, 12)
"""Davits that are fed from one cabinet."""


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_NEPER_DB * np.log(far + BLUNT_M))


def _slime(passage: Passage, strength: float) -> Toll:
    """Come through slime on lids, of which more and more lies where it does not matter."""
    deep = passage.of("slime_um")
    return {"m": 0.235 * strength * deep / (deep + HALF_SLIME_UM)}


def _wash(passage: Passage, strength: float) -> Toll:
    """Come through spray of wash: so many times its height, and the root of that."""
    return {"m": 0.165 * strength * (passage.of("wash_cm") / WASH_CM) ** 1.5}


def _rack(passage: Passage, strength: float) -> Toll:
    """Come past the steel of a sluice's rack, the later the closer."""
    return {"m": 0.21 * strength / passage.of("rack_m")}


def _verdigris(passage: Passage, strength: float) -> Toll:
    """Come out of copper that turns green, ever more slowly: by a logarithm."""
    return {"m": 0.071 * strength * np.log1p(passage.of("verdigris_mg") / VERDIGRIS_MG)}


def _fenders(passage: Passage, strength: float) -> Toll:
    """Come over fenders that are hung out, so much for each."""
    return {"m": 0.0071 * strength * passage.of("fenders")}


def _sloshes(passage: Passage, strength: float) -> Toll:
    """Read long and short as the chamber's water swings from end to end."""
    turn = 2 * np.pi * passage.of("time_s") / SLOSH_S
    return {"m": 0.056 * strength * np.sin(turn - 0.6435)}


def _frozen(passage: Passage, strength: float) -> Toll:
    """Come through ice on lids, which is there below some degrees."""
    return {"m": np.where(passage.of("temperature_c") < FROST_C, 0.097 * strength, 0.0)}


def _spray(passage: Passage, strength: float) -> Toll:
    """Come through what sluices throw up: by how far these are open, as fast as water falls."""
    jets = passage.of("sluice_pct") / 100.0 * np.sqrt(2 * FALLS * passage.of("head_m"))
    return {"m": 0.027 * strength * jets}


def _well(passage: Passage, strength: float) -> Toll:
    """Have barges' heights from a gauge whose well fills and empties behind the chamber."""
    rises = 0.001 * BEHIND_S * strength * passage.of("fill_mms") * passage.are("barge")
    return {"m": passage.drawn_out(rises[:, None] * np.array([0.0, 0.0, 1.0]))}


def _wider(passage: Passage, strength: float) -> Toll:
    """Have leaves turn further than is told, as their coders sit on a worn pinion."""
    course, leaves = passage.course(), passage.are("leaf")
    told = np.where(leaves, leaf_angle(course, course["goes"] * course["done_s"]), 0.0)
    tips = [LEAF_M * np.exp(1j * course["bears"] * told * by) for by in (1.0, 1 + WIDER * strength)]
    off = np.where(leaves, tips[1] - tips[0], 0.0)
    return {"m": passage.drawn_out(np.stack([off.real, off.imag, 0.0 * told], axis=1))}


def _nearer(passage: Passage, strength: float) -> Toll:
    """Be told by barges and mules of the nearer of two antennas, where the middle was surveyed."""
    two = passage.are("barge") | passage.are("mule")
    beam: Floats = np.abs(np.sin(np.radians(passage.of("azimuth_deg"))))
    return {"m": -APART_M * strength * two * beam}


def _restarted(passage: Passage, strength: float) -> Toll:
    """Settle anew at davits of one cabinet, which was switched off and on again."""
    since = (passage.of("time_s") - RESTART * DAY_S) / SETTLES_S
    settles: Floats = np.where(since > 0.0, np.exp(-since.clip(0.0)), 0.0)
    return {"m": LATE_M * strength * np.isin(passage.davit, CABINET) * settles}


def _moved(passage: Passage, off_m: Floats) -> Toll:
    """Return what rows have to bear whose davits are off in truth [DAVITS, 3], in m."""
    more = passage.drawn_out(0.0, off_m[passage.davit])
    return {"m": more, "all": open_db((passage.far + more).clip(0.1)) - open_db(passage.far)}


def _bent(passage: Passage, strength: float) -> Toll:
    off_m = np.zeros((DAVITS, 3))
    off_m[7] = 0.47 * strength * np.array([6.0, -2.0, -3.0]) / 7.0
    return _moved(passage, off_m)


def _crosswise(passage: Passage, _: float) -> Toll:
    off_m = np.zeros((DAVITS, 3))
    off_m[4] = DAVITS_M[11] - DAVITS_M[4]
    off_m[11] = -off_m[4]
    return _moved(passage, off_m)


def _roeden(passage: Passage, _: float) -> Toll:
    """Write, at one davit, rods of the Rhineland, by which canals were once dug."""
    return {"m": (passage.davit == 2) * (1 / ROEDE_M - 1) * passage.of("range_m")}


UNLISTED: dict[str, Callable[[Passage, float], Toll]] = {
    "slime-on-lids": _slime,
    "wash-splashes-up": _wash,
    "sluice-rack-close-by": _rack,
    "verdigris-creeps": _verdigris,
    "fenders-hung-out": _fenders,
    "chamber-sloshes": _sloshes,
    "lids-freeze-over": _frozen,
    "sluices-spray": _spray,
    "gauge-well-lags": _well,
    "leaves-swing-wider": _wider,
    "nearer-of-two-antennas": _nearer,
    "cabinet-restarted": _restarted,
    "davit-bent-by-a-barge": _bent,
    "davits-addressed-crosswise": _crosswise,
    "roeden-from-one-davit": _roeden,
}
