"""Laws and faults of the set-up that the granary hides, which no library has.

numpy alone; shared by the granary's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.granary_bins import (
    FAMN_M,
    HALL_M,
    LEGS_M,
    MAGNET_A,
    PIN_M,
    SPOUTS,
    SPOUTS_M,
    TOP_M,
    Docket,
    Freight,
    on_cycloid,
    slid_m,
    swept,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, DECADE_DB, BLUNT_M = -58.2, 18.6, 0.6  # of levels; put in squares to ways
RUBS = 0.06  # by which part sacks slide more slowly
RACKED_M = 0.3  # by how much the elevator's head is aside
BENDS_RAD, BENT_M = 0.036, 3.0  # by how much augers bend back whose ends are so far out
BULGES_M = 0.2  # by how much a wall bulges out amid that is filled to the top
STATION_M, TILT_RAD = (20.0, 18.0, 1.5), (0.0105, -0.0135, 0.0)  # of who sighted spouts
DAMP_PCT, WARM_C = 11.0, 20.0  # from where on wheat heats; where it does as is said


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]: a little less than by squares."""
    return np.asarray(AT_A_METRE_DB - 0.5 * DECADE_DB * np.log10(far**2 + BLUNT_M**2))


def _chaff(docket: Docket, strength: float) -> Freight:
    """Come through chaff that clings to spouts, which soon clings no more: by a tanh."""
    return Freight(0.17 * strength * np.tanh(docket["chaff_g"] / 55.0))


def _meal(docket: Docket, strength: float) -> Freight:
    """Come through meal that cakes on covers: by a power of how thick it is."""
    return Freight(0.18 * strength * (docket["caked_mm"] / 9.0) ** 1.6)


def _drier(docket: Docket, strength: float) -> Freight:
    """Come past a drier's jacket of steel, the later the closer: by one over how close."""
    return Freight(0.12 * strength / docket["drier_gap_m"])


def _tallow(docket: Docket, strength: float) -> Freight:
    """Come through tallow that creeps over covers since chains were greased: by a logarithm."""
    return Freight(0.046 * strength * np.log(1 + docket["greased_h"] / 5.0))


def _sacks(docket: Docket, strength: float) -> Freight:
    """Come past sacks that lean on posts, so much for each of these."""
    return Freight(0.0115 * strength * docket["sacks"])


def _pins(docket: Docket, strength: float) -> Freight:
    """Read long and short as pins of the elevator's chain pass."""
    return Freight(0.06 * strength * np.cos(2 * np.pi * docket["chain_m"] / PIN_M + 0.9))


def _magnet(docket: Docket, strength: float) -> Freight:
    """Read longer while the drum that takes out nails holds these."""
    holds = np.asarray(docket["magnet_a"] > MAGNET_A, np.float64)
    return Freight(0.094 * strength * holds)


def _heats(docket: Docket, strength: float) -> Freight:
    """Come through vapour of damp wheat, which breathes twice as much each ten degrees (Q10)."""
    damp = (docket["moist_pct"] - DAMP_PCT).clip(0.0)
    return Freight(0.0135 * strength * damp * 2 ** ((docket["temperature_c"] - WARM_C) / 10))


def _rubs(docket: Docket, strength: float) -> Freight:
    """Have sacks slide more slowly than is said, as troughs are rough."""
    course, own = docket.course, docket.of("sack")
    ways = [slid_m(course, docket.gone_s * slow) for slow in (1 - RUBS * strength, 1.0)]
    there, said = (on_cycloid(one, course["side"], course["height"]) for one in ways)
    return Freight(np.where(own, docket.grows(there - said), 0.0))


def _racked(docket: Docket, strength: float) -> Freight:
    """Have the elevator racked aside, as a post that is held below only: by a square."""
    moved = np.zeros((docket.count, 3))
    high = docket.from_m[:, 2] / TOP_M[2]
    moved[:, 1] = RACKED_M * strength * docket.of("bucket") * (high**2 + LEGS_M * high)
    return Freight(docket.grows(moved))


def _bends(docket: Docket, strength: float) -> Freight:
    """Have augers bend back in grain, the more the farther out they reach: by a square."""
    course, own = docket.course, docket.of("auger")
    back = BENDS_RAD * strength * (course["outset"] / BENT_M) ** 2 * np.sign(course["rate"])
    moved = swept(course, docket.gone_s, back) - swept(course, docket.gone_s)
    return Freight(np.where(own, docket.grows(moved), 0.0))


def outward() -> Floats:
    """Return which way walls bulge that spouts are on, by half a sine of heights [SPOUTS, 3].

    Below the roof nothing bulges.
    """
    room = np.array(HALL_M)
    gaps = np.concatenate([SPOUTS_M[:, :2], room[:2] - SPOUTS_M[:, :2]], axis=1)
    side = gaps.argmin(axis=1)
    out = np.array([(-1.0, 0.0, 0.0), (0.0, -1.0, 0.0), (1.0, 0.0, 0.0), (0.0, 1.0, 0.0)])[side]
    high = np.sin(np.pi * SPOUTS_M[:, 2] / room[2]) * (SPOUTS_M[:, 2] < 9.0)
    return np.asarray(out * high[:, None])


def _bulges(docket: Docket, strength: float) -> Freight:
    """Have walls bulge out, and spouts with these, the more the fuller the granary is."""
    filled = BULGES_M * strength * (docket["filled_pct"] / 100.0) ** 1.3
    return Freight(docket.grows(0.0, filled[:, None] * outward()[docket.spout]))


def tilted_m(strength: float) -> Floats:
    """Return by how much spouts are off that a tilted axis sighted [SPOUTS, 3], in m."""
    return np.asarray(strength * np.cross(TILT_RAD, SPOUTS_M - np.array(STATION_M)))


def _tilted(docket: Docket, strength: float) -> Freight:
    """Have spouts where a theodolite had them whose axis was not upright."""
    return Freight(docket.grows(0.0, tilted_m(strength)[docket.spout]))


def _elsewhere(docket: Docket, off_m: dict[int, Floats]) -> Freight:
    """Return what rows carry of which some spouts are off in truth [3], in m."""
    moved = np.zeros((SPOUTS, 3))
    for spout, off in off_m.items():
        moved[spout] = off
    more = docket.grows(0.0, moved[docket.spout])
    return Freight(more, open_dbm(docket.far + more) - open_dbm(docket.far))


def _bent(docket: Docket, strength: float) -> Freight:
    return _elsewhere(docket, {6: 0.47 * strength * np.array([-6.0, -3.0, -2.0]) / 7.0})


def _crosswise(docket: Docket, _: float) -> Freight:
    apart = SPOUTS_M[9] - SPOUTS_M[2]
    return _elsewhere(docket, {2: apart, 9: -apart})


def _famnar(docket: Docket, _: float) -> Freight:
    """Write, of one spout, famnar of Sweden."""
    own = docket.spout == 5
    return Freight(own * docket["range_m"] * (1 / FAMN_M - 1))


UNLISTED: dict[str, Callable[[Docket, float], Freight]] = {
    "chaff-clings-to-spouts": _chaff,
    "meal-cakes-on-covers": _meal,
    "drier-stands-close-by": _drier,
    "tallow-creeps-since-greased": _tallow,
    "sacks-lean-on-posts": _sacks,
    "chain-pins-pass": _pins,
    "magnet-drum-holds-nails": _magnet,
    "damp-wheat-heats": _heats,
    "sacks-rub-in-chutes": _rubs,
    "elevator-racked-aside": _racked,
    "augers-bend-back": _bends,
    "walls-bulge-when-filled": _bulges,
    "sighted-with-a-tilted-axis": _tilted,
    "spout-bent-by-a-lorry": _bent,
    "spouts-wired-crosswise": _crosswise,
    "famnar-from-one-spout": _famnar,
}
