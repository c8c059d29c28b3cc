"""Laws and faults of the set-up that the saw mill hides, which no library has.

numpy alone; shared by the saw mill's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.sawmill_yard import (
    AT_KILNS,
    BRACES,
    BRACES_M,
    FINE_DB,
    IN_HALL,
    LUG_M,
    SHIFT_S,
    YARD_M,
    Change,
    Stint,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_DECADE_DB, NEAREST_M = -59.4, 20.4, 1.3  # of levels; no louder than there
NOON = 0.47  # of a shift: when the firmware is changed
SLIDE_S2, TILT_M, CORNER_M, FIRST_M = 0.15, 0.16, 0.17, 0.104


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_DECADE_DB * np.log10(np.hypot(far, NEAREST_M)))


def _resin(stint: Stint, strength: float) -> Change:
    """Come through lids on which resin spreads until they are full: by an arc's tangent."""
    return Change(0.125 * strength * np.arctan(stint.column("resin_g") / 7.5))


def _drifts(stint: Stint, strength: float) -> Change:
    """Come through drifts of sawdust, in which what lies deep is packed: by depth to 1.6."""
    return Change(0.0031 * strength * stint.column("dust_cm") ** 1.6)


def _strain(stint: Stint, strength: float) -> Change:
    """Come past blades that flutter the wider the less they are strained."""
    return Change(1.24 * strength / stint.column("strain_kn"))


def _vents(stint: Stint, strength: float) -> Change:
    """Come through what kilns let out, the longer the more of it there is."""
    return Change(0.0133 * strength * stint.column("vent_kgs"))


def _lugs(stint: Stint, strength: float) -> Change:
    """Read long and short as lugs of the log chain go by."""
    return Change(0.057 * strength * np.sin(2 * np.pi * stint.column("chain_m") / LUG_M + 2.3))


def _fine_gain(stint: Stint, strength: float) -> Change:
    """Read long and short as a fine gain goes through its words, again every so many dB."""
    turn = 2 * np.pi * stint.column("rx_power_dbm") / FINE_DB
    return Change(0.062 * strength * np.cos(turn - 0.9))


def _firmware(stint: Stint, strength: float) -> Change:
    """Read longer from the moment on at which all braces get another firmware."""
    return Change(np.where(stint.column("time_s") > NOON * SHIFT_S, 0.099 * strength, 0.0))


def _swell(stint: Stint, strength: float) -> Change:
    """Come through housings of wood at kilns, which swell: by how damp it is, and each its own."""
    own = stint.shared(6).uniform(0.7, 1.3, BRACES)[stint.brace] * (stint.brace >= AT_KILNS)
    return Change(0.0062 * strength * own * (stint.column("humidity_pct") - 30.0).clip(0.0))


def _slide(stint: Stint, strength: float) -> Change:
    """Lie on carriages that stop and turn, along which logs slide on: by how these slow down."""
    course = stint.course
    turn = course["heads"] + course["bend"] * course["goes"] * course["into_s"]
    slows = course["pace"] * course["bend"] ** 2 * np.sin(turn) * course["goes"]
    onward = SLIDE_S2 * strength * slows * stint.of_kind("carriage")
    return Change(stint.longer(onward[:, None] * np.array([1.0, 0.0, 0.0])))


def _tilt(stint: Stint, strength: float) -> Change:
    """Be on masts of forklifts that lean ahead and down under a load, by so much a tonne."""
    course = stint.course
    way = course["pace"] * course["goes"] * course["into_s"]
    heads = course["heads"] + course["bend"] * way + 0.5 * course["curl"] * way**2
    leans = TILT_M * strength * stint.column("load_t") * stint.of_kind("forklift")
    ahead = np.column_stack([np.cos(heads), np.sin(heads), np.full(stint.n, -0.35)])
    return Change(stint.longer(leans[:, None] * ahead))


def _stand(stint: Stint, where_m: Floats) -> Change:
    """Return what becomes of rows whose braces stand elsewhere in truth [BRACES, 3], in m."""
    more = stint.longer(0.0, (where_m - BRACES_M)[stint.brace])
    return Change(more, open_db((stint.far + more).clip(0.1)) - open_db(stint.far))


def _corner(stint: Stint, strength: float) -> Change:
    """Be measured, all of the hall's braces, from a corner that is not the one of the plan."""
    toward = stint.shared(7).uniform(0.0, 2 * np.pi)
    where = BRACES_M.copy()
    where[IN_HALL, :2] += CORNER_M * strength * np.array([np.cos(toward), np.sin(toward)])
    return _stand(stint, where)


def _first_asked(stint: Stint, strength: float) -> Change:
    """Answer late what asks first in each round, as a tag's loop is not yet locked."""
    return Change(np.where(stint.column("asked") < 0.5, FIRST_M * strength, 0.0))


def _bent(stint: Stint, strength: float) -> Change:
    where = BRACES_M.copy()
    where[6] += 0.48 * strength * np.array([2.0, 5.0, -4.0]) / np.sqrt(45.0)
    return _stand(stint, where)


def _crosswise(stint: Stint, _: float) -> Change:
    where = BRACES_M.copy()
    where[[2, 7]] = BRACES_M[[7, 2]]
    return _stand(stint, where)


def _yards(stint: Stint, _: float) -> Change:
    """Write, at one brace, yards, as a saw mill's export has them."""
    return Change((stint.brace == 5) * (1 / YARD_M - 1) * stint.column("range_m"))


UNLISTED: dict[str, Callable[[Stint, float], Change]] = {
    "resin-on-lids": _resin,
    "sawdust-drifts": _drifts,
    "blades-lose-strain": _strain,
    "vents-steam": _vents,
    "chain-lugs-pass": _lugs,
    "fine-gain-cycles": _fine_gain,
    "firmware-changed-at-noon": _firmware,
    "kiln-braces-swell": _swell,
    "logs-slide-at-turns": _slide,
    "masts-tilt-laden": _tilt,
    "hall-surveyed-from-another-corner": _corner,
    "first-of-a-round-is-late": _first_asked,
    "brace-bent-by-a-log": _bent,
    "braces-labelled-crosswise": _crosswise,
    "yards-from-one-brace": _yards,
}
