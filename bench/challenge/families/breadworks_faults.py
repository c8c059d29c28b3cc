"""Laws and faults of the set-up that the breadworks hides, which no library has.

numpy alone; shared by the breadworks's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.breadworks_hall import (
    BRAZA_M,
    CORBELS,
    CORBELS_M,
    HALL_M,
    LINK_M,
    LOW_KG,
    OF_FLUE,
    Bake,
    Does,
    climbed,
    indexed,
    meandered,
    rolled,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, DECADE_DB, DUST_DB = -63.0, 17.3, 0.042  # of levels: the last for each metre
SLIPS, CLOGGED, WIDER, WORN_RAD = 0.13, 0.36, 0.26, 0.11
YEAST_M, WARM_C, TWICE_C = 0.027, 28.0, 10.0  # an hour at such warmth; by which it works twice
FLUE_M, BUCKLES_C, SAGS_M = (6.0, 50.0), 70.0, 0.42  # its ends; from when on; at 200 degrees more
FED = (0.011, 0.52)  # of a plan: a part by which it was fed aslant; m by which it slipped
MISSED, MOST = 0.4, 0.85  # of answers, at strength 1, and at most


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]: flour in the air takes its part."""
    return np.asarray(AT_A_METRE_DB - DECADE_DB * np.log10(far) - DUST_DB * far)


def _steam(bake: Bake, strength: float) -> Does:
    """Come through steam of which covers hold no more than so much, by Langmuir's law (1918)."""
    steam = bake["steam_l"]
    return Does(0.21 * strength * steam / (steam + 4.0))


def _swells(bake: Bake, strength: float) -> Does:
    """Come through dough that swells over troughs' rims: by a power of how high."""
    return Does(0.17 * strength * (bake["swollen_cm"] / 20.0) ** 1.55)


def _hook(bake: Bake, strength: float) -> Does:
    """Come past the hook that is hung close by: by one over the square of how close."""
    return Does(0.13 * strength / bake["hook_gap_m"] ** 2)


def _settles(bake: Bake, strength: float) -> Does:
    """Come through flour that settles on covers since these were swept: by a logarithm."""
    return Does(0.043 * strength * np.log1p(bake["swept_min"] / 5.5))


def _tins(bake: Bake, strength: float) -> Does:
    """Come past tins that are stacked alongside, so much for each of these."""
    return Does(0.0088 * strength * bake["tins"])


def _supports(bake: Bake, strength: float) -> Does:
    """Read long and short as supports of the cooler's belt pass."""
    return Does(0.061 * strength * np.cos(2 * np.pi * bake["spiral_m"] / LINK_M - 0.7))


def _sifter(bake: Bake, strength: float) -> Does:
    """Read longer while the sifter runs, as it does once the hopper is low."""
    return Does(np.where(bake["hopper_kg"] < LOW_KG, 0.094 * strength, 0.0))


def worked(hours: Floats, warm_c: Floats) -> Floats:
    """Return hours at WARM_C in which yeast works as much: by van 't Hoff's rule [n]."""
    return np.asarray(hours * 2 ** ((warm_c - WARM_C) / TWICE_C))


def _yeast(bake: Bake, strength: float) -> Does:
    """Come through froth of dough: as much as yeast has worked, by hours and by warmth."""
    return Does(YEAST_M * strength * worked(bake["proved_h"], bake["temperature_c"]))


def _astray(way: Callable[..., Floats], kind: str, part: float) -> Callable[[Bake, float], Does]:
    """Return what lets tags of a kind go otherwise by a part than is told of them."""

    def act(bake: Bake, strength: float) -> Does:
        own = np.flatnonzero(bake.are(kind))
        course = {name: one[own] for name, one in bake.course.items()}
        gone_s = course["goes"] * course["into_s"]
        moved = np.zeros((bake.rows, 3))
        moved[own] = way(course, gone_s, part * strength) - way(course, gone_s)
        return Does(bake.longer(moved))

    return act


def buckled_m(warm_c: Floats) -> Floats:
    """Return how far down the flue's middle is in m [n]: between two walls it can but give way.

    A strut whose ends hold it has half a sine's bow, whose height grows as the root of what it is
    too long by (Euler).
    """
    return np.asarray(SAGS_M * np.sqrt((warm_c - BUCKLES_C).clip(0.0) / 200.0))


def _buckles(bake: Bake, strength: float) -> Does:
    """Have the flue buckle as ovens heat it, and corbels that hang from it come down."""
    along = (bake.corbel_m[:, 0] - FLUE_M[0]) / (FLUE_M[1] - FLUE_M[0])
    down = np.zeros((bake.rows, 3))
    hangs = np.isin(bake.corbel, OF_FLUE)
    down[:, 2] = -strength * hangs * buckled_m(bake["oven_c"]) * np.sin(np.pi * along)
    return Does(bake.longer(0.0, down))


def fed_m(strength: float) -> Floats:
    """Return by how much corbels are off that were read off a plan, in m [CORBELS, 3].

    It was fed aslant into a scanner, whose rollers slipped ever more.
    """
    off = np.zeros((CORBELS, 3))
    off[:, 1] = FED[0] * (CORBELS_M[:, 0] - 0.5 * HALL_M[0])
    off[:, 0] = FED[1] * (CORBELS_M[:, 0] / HALL_M[0]) ** 2
    return strength * off


def _fed(bake: Bake, strength: float) -> Does:
    """Have corbels where a plan had them that was fed askew."""
    return Does(bake.longer(0.0, fed_m(strength)[bake.corbel]))


def foretold(bake: Bake) -> Floats:
    """Return ranges in m that are on a line through a link's two before [n]; else its own.

    Rows of a table that is told some times over have their own kind before them.
    """
    rows = bake.table
    told = rows.groupby(["link", "time_s"], sort=False).cumcount()
    links = rows.groupby([rows["link"], told], sort=False)
    once, twice = (links["range_m"].shift(k) for k in (1, 2))
    when, before = (links["time_s"].shift(k) for k in (1, 2))
    slope = (once - twice) / (when - before)
    line = once + slope * (rows["time_s"] - when)
    return np.asarray(line.fillna(rows["range_m"]), np.float64)


def _missed(bake: Bake, strength: float) -> Does:
    """Put answers that are missed on a line through the two before."""
    missed = bake.rng.random(bake.rows) < min(MISSED * strength, MOST)
    return Does(np.where(missed, foretold(bake) - bake["range_m"], 0.0))


def _elsewhere(bake: Bake, off_m: Floats) -> Does:
    """Return what rows get if corbels are off by so much in truth [CORBELS, 3], in m."""
    more = bake.longer(0.0, off_m[bake.corbel])
    return Does(more, open_dbm(bake.far + more) - open_dbm(bake.far))


def _rammed(bake: Bake, strength: float) -> Does:
    off = np.zeros((CORBELS, 3))
    off[3] = 0.52 * strength * np.array([6.0, -2.0, 3.0]) / 7.0
    return _elsewhere(bake, off)


def _each_other(bake: Bake, _: float) -> Does:
    off = np.zeros((CORBELS, 3))
    off[[2, 7]] = CORBELS_M[[7, 2]] - CORBELS_M[[2, 7]]
    return _elsewhere(bake, off)


def _brazas(bake: Bake, _: float) -> Does:
    """Write, of one corbel, brazas of Castile."""
    return Does(np.where(bake.corbel == 8, (1 / BRAZA_M - 1) * bake["range_m"], 0.0))


UNLISTED: dict[str, Callable[[Bake, float], Does]] = {
    "steam-let-into-ovens": _steam,
    "dough-swells-over-troughs": _swells,
    "hook-hung-close-by": _hook,
    "flour-settles-since-swept": _settles,
    "tins-stacked-alongside": _tins,
    "supports-of-the-belt-pass": _supports,
    "sifter-runs-on-a-low-hopper": _sifter,
    "yeast-works-by-warmth-and-hours": _yeast,
    "belts-slip-round-coolers": _astray(climbed, "tray", SLIPS),
    "castors-clogged-with-dough": _astray(rolled, "rack", CLOGGED),
    "porters-sway-wider-than-told": _astray(meandered, "porter", WIDER),
    "cams-worn-between-stands": _astray(indexed, "mould", WORN_RAD),
    "flue-buckles-as-ovens-heat": _buckles,
    "plan-fed-askew": _fed,
    "missed-answers-put-on-a-line": _missed,
    "corbel-rammed-by-a-rack": _rammed,
    "corbels-entered-in-each-others-lines": _each_other,
    "brazas-from-one-corbel": _brazas,
}
