"""Laws and faults of the set-up that the planetarium hides, which no library has.

numpy alone; shared by the planetarium's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.planetarium_dome import (
    COVES,
    COVES_M,
    MIDDLE_M,
    RADIUS_M,
    SAZHEN_M,
    TEETH_M,
    TRIPS_V,
    Course,
    Fee,
    Seating,
    climbs,
    orbits,
    slides,
    walks,
    wheels,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Act = Callable[[Seating, float], Fee]
AT_A_METRE_DBM, DECADE_DB, CLOSE_M = -62.4, 20.4, 0.3  # of levels
HAZY, HAZE_UP_M = 0.031, 7.0  # of a way, where all of it is so high
EQUANT, SLIPS, STRAIGHT, DEEPER, BACK = 1.0, 0.2, 0.75, 0.5, 0.022  # parts; radians each root of s
WOWS_S, WOW_S = 0.21, 2.3  # by which a tape is ahead; how long it is about it
SWELLS_M, FULL_SUN = 0.24, 900.0
DECLINES_RAD = 0.031
TAPED = 1.3  # of how much arcs are longer than heights
SMOOTH = 0.8  # of a range: weight of those before, next to its own
FAINT_DB, FAINTER_DB = -87.4, 2.2  # levels told as the last; more, where these are so at twice


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - DECADE_DB * np.log10(far + CLOSE_M))


def _felt(seating: Seating, strength: float) -> Fee:
    """Come through felt, of which the first half does most: as places are taken (Langmuir)."""
    felt = seating["felt_mm"]
    return Fee(0.21 * strength * felt / (felt + 5.5))


def _breath(seating: Seating, strength: float) -> Fee:
    """Come through felt that breath has dampened, by how damp it is squared."""
    return Fee(0.15 * strength * (seating["humid_pct"] / 100.0) ** 2)


def _tins(seating: Seating, strength: float) -> Fee:
    """Come past tins, the later the closer, by the square of it."""
    return Fee(0.105 * strength / seating["tins_gap_m"] ** 2)


def _programmes(seating: Seating, strength: float) -> Fee:
    """Come through programmes, so much for each."""
    return Fee(0.0082 * strength * seating["programmes"])


def _valves(seating: Seating, strength: float) -> Fee:
    """Come the sooner the longer valves have been warm."""
    return Fee(-0.041 * strength * np.log1p(seating["switched_min"] / 1.5))


def _fog(seating: Seating, strength: float) -> Fee:
    """Come through fog about tags, whose first breath does most: by a root."""
    return Fee(0.15 * strength * np.sqrt(seating["fog_ml"] / 60.0))


def _teeth(seating: Seating, strength: float) -> Fee:
    """Read long and short as teeth go by that are worn."""
    return Fee(0.058 * strength * np.sin(2 * np.pi * seating["rack_m"] / TEETH_M - 1.1))


def _dimmers(seating: Seating, strength: float) -> Fee:
    """Read longer while dimmers have tripped."""
    return Fee(np.where(seating["mains_v"] < TRIPS_V, 0.094 * strength, 0.0))


def square_mean(one: Floats, other: Floats) -> Floats:
    """Return the mean square of what goes evenly from one to the other [n]."""
    return np.asarray((one**2 + one * other + other**2) / 3)


def _haze(seating: Seating, strength: float) -> Fee:
    """Come by haze, which is by the square of how high it is: all that lies along the way."""
    thick = square_mean(seating.tag_m[:, 2], seating.cove_m[:, 2]) / HAZE_UP_M**2
    return Fee(HAZY * strength * thick * seating["haze_pct"] / 100.0 * seating.far)


def _otherwise(kind: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a kind go otherwise, by so much at strength 1, than is told."""

    def act(seating: Seating, strength: float) -> Fee:
        own = seating.of(kind)
        course = {name: one[own] for name, one in seating.course.items()}
        gone_s = course["goes"] * course["into_s"]
        off = np.zeros((seating.rows, 3))
        off[own] = way(course, gone_s, by * strength) - way(course, gone_s, 0.0)
        return Fee(seating.longer_m(off))

    return act


def _wows(seating: Seating, strength: float) -> Fee:
    """Compare with places off a tape, which is now ahead and now behind."""
    ahead_s = WOWS_S * np.sin(2 * np.pi * seating["time_s"] / WOW_S)
    return Fee(seating.wanders_off(strength * ahead_s))


def _swells(seating: Seating, strength: float) -> Fee:
    """Have the dome swell in the sun, its coves away from the middle, the wall's not."""
    out = (seating.cove_m - MIDDLE_M) / RADIUS_M
    high = (seating.cove_m[:, 2] > MIDDLE_M[2]) * seating["sun_w_m2"] / FULL_SUN
    return Fee(seating.longer_m(0.0, SWELLS_M * strength * high[:, None] * out))


def turned_m(at: Floats, by: float) -> Floats:
    """Return by how much places are off once turned about the middle by radians, in m [n, 3]."""
    east, north = (at - MIDDLE_M)[:, :2].T
    cosine, sine = np.cos(by) - 1, np.sin(by)
    return np.column_stack([east * cosine - north * sine, east * sine + north * cosine, 0 * east])


def _declines(seating: Seating, strength: float) -> Fee:
    """Have coves' bearings told from magnetic north."""
    return Fee(seating.longer_m(0.0, turned_m(seating.cove_m, DECLINES_RAD * strength)))


def lower_m(high: Floats) -> Floats:
    """Return by how much places up the dome are lower than how far up it these are, in m [n]."""
    arc = (high - MIDDLE_M[2]).clip(0.0)
    return np.asarray(arc - RADIUS_M * np.sin(arc / RADIUS_M))


def _taped(seating: Seating, strength: float) -> Fee:
    """Have heights of coves taped along the dome, which curves."""
    down = -TAPED * strength * lower_m(seating.cove_m[:, 2])
    return Fee(seating.longer_m(0.0, down[:, None] * np.array([0.0, 0.0, 1.0])))


def chained(seating: Seating) -> tuple[Integers, Integers]:
    """Return of each row the number of its link, and how many came before on this, [n] each.

    Links of a table that is told some times over are as many links of their own.
    """
    rows = seating.table[["link", "time_s"]].reset_index(drop=True)
    telling = rows.groupby(["link", "time_s"], sort=False).cumcount()
    link = rows.groupby(["link", telling], sort=False)
    return np.asarray(link.ngroup(), np.int64), np.asarray(link.cumcount(), np.int64)


def _after_another(seating: Seating, told: Callable[[Floats, Floats, Integers], Floats]) -> Floats:
    """Return ranges in m [n] that are told of ranges, by what was told before on their links."""
    chain, place = chained(seating)
    made = seating["range_m"].copy()
    last = np.zeros(int(chain.max()) + 1)
    for k in range(int(place.max()) + 1):
        rows = np.flatnonzero(place == k)
        if k:
            made[rows] = told(made[rows], last[chain[rows]], rows)
        last[chain[rows]] = made[rows]
    return made


def _smoothed(seating: Seating, strength: float) -> Fee:
    """Tell of each range a mean of it and of what was told before."""
    old = SMOOTH * strength / (1 + SMOOTH * strength)
    told = _after_another(seating, lambda now, last, _: now + old * (last - now))
    return Fee(told - seating["range_m"])


def _faint(seating: Seating, strength: float) -> Fee:
    """Tell what was told before where it is weak."""
    weak = seating["rx_power_dbm"] < FAINT_DB + FAINTER_DB * np.log2(strength)
    told = _after_another(seating, lambda now, last, rows: np.where(weak[rows], last, now))
    return Fee(told - seating["range_m"])


def _stands(seating: Seating, off_m: dict[int, Floats]) -> Fee:
    """Return what rows pay of which some coves stand so far off in truth [3], in m."""
    every = np.zeros((COVES, 3))
    for cove, off in off_m.items():
        every[cove] = off
    more = seating.longer_m(0.0, every[seating.cove])
    return Fee(more, all_db=open_dbm(seating.far + more) - open_dbm(seating.far))


def _leant_on(seating: Seating, strength: float) -> Fee:
    return _stands(seating, {6: 0.55 * strength * np.array([2.0, -2.0, 1.0]) / 3.0})


def _crosswise(seating: Seating, _: float) -> Fee:
    apart = COVES_M[8] - COVES_M[3]
    return _stands(seating, {3: apart, 8: -apart})


def _sazhens(seating: Seating, _: float) -> Fee:
    """Write, of one cove, how many sazhens it is."""
    return Fee((1 / SAZHEN_M - 1) * seating["range_m"] * (seating.cove == 10))


UNLISTED: dict[str, Act] = {
    "felt-glued-over-covers": _felt,
    "breath-dampens-the-felt": _breath,
    "slide-tins-stacked-near": _tins,
    "programmes-piled-on-coves": _programmes,
    "valves-warm-since-switched-on": _valves,
    "fog-blown-about-tags": _fog,
    "worn-teeth-pass-on-racks": _teeth,
    "dimmers-trip-at-low-mains": _dimmers,
    "haze-gathers-under-the-dome": _haze,
    "planets-driven-by-an-equant": _otherwise("planet", orbits, EQUANT),
    "moons-slip-on-their-wheels": _otherwise("moon", wheels, SLIPS),
    "ushers-walk-a-heptagon": _otherwise("usher", walks, STRAIGHT),
    "wires-sag-under-comets": _otherwise("comet", slides, DEEPER),
    "trolleys-roll-back": _otherwise("trolley", climbs, BACK),
    "places-read-off-a-tape-that-wows": _wows,
    "dome-swells-in-the-sun": _swells,
    "bearings-from-magnetic-north": _declines,
    "heights-taped-along-the-dome": _taped,
    "answers-smoothed-as-they-come": _smoothed,
    "weak-answers-told-as-the-last": _faint,
    "cove-leant-on-by-a-ladder": _leant_on,
    "coves-wired-crosswise": _crosswise,
    "sazhens-from-one-cove": _sazhens,
}
