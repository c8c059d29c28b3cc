"""Laws and faults of the set-up that the cathedral hides, which no library has.

numpy alone; shared by the cathedral's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.cathedral_nave import (
    BOSSES,
    BOSSES_M,
    FLAG_M,
    MIDDLE_M,
    PASSUS_M,
    SLACK_MM,
    Course,
    Dues,
    Vigil,
    files,
    hoists,
    paces,
    soars,
    swings,
    treads,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Act = Callable[[Vigil, float], Dues]
AT_A_METRE_DBM, EACH_TENFOLD_DB = -59.2, 19.6  # of levels
RACK_M: Floats = np.array([20.5, 13.0, 1.3])  # of candles, before the crossing
WARM_M, WARMS_M = 4.2, 0.26  # how far off it is warm; late where ways pass by all of them
WIDER, HALTS, SINKS, OVAL, FILLS, CUT = 0.22, 0.2, 0.09, 0.13, 0.055, 0.8
"""Parts; of sinking, m/s; of a drum that fills, for each s."""
QUARTER_S, LOSES_S = 900.0, 0.45  # between bells; what a clock loses until the next
LEANS = (0.021, -0.026)  # m for each m of height, along and across
ASKEW = 0.032  # of transepts: m along for each m across
COURSE_M = 0.68  # of stone
KEEPS_M = 0.17  # until answers are told anew
CHAIN_M, LINKS_M = 20.1168, 3.4  # Gunter's; what it is shorter by at twice


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far))


def _wax(vigil: Vigil, strength: float) -> Dues:
    """Come through wax, of which what is under keeps away what is over: as light is taken in."""
    return Dues(-0.165 * strength * np.expm1(-vigil["wax_mm"] / 6.2))


def _incense(vigil: Vigil, strength: float) -> Dues:
    """Come through incense, of which a little does much: by a power."""
    return Dues(0.17 * strength * (vigil["incense_g"] / 70.0) ** 0.6)


def _stands(vigil: Vigil, strength: float) -> Dues:
    """Come past candlestands, the later the closer: by one over that."""
    return Dues(0.088 * strength / vigil["stand_m"])


def _hassocks(vigil: Vigil, strength: float) -> Dues:
    """Come through hassocks, so much for each."""
    return Dues(0.0078 * strength * vigil["hassocks"])


def _pipes(vigil: Vigil, strength: float) -> Dues:
    """Come the sooner the longer ago pipes were stoked: by a logarithm."""
    return Dues(-0.043 * strength * np.log1p(vigil["stoked_min"] / 1.2))


def _damp(vigil: Vigil, strength: float) -> Dues:
    """Come off stone that is damp, by the square of how damp it is."""
    return Dues(0.155 * strength * (vigil["damp_pct"] / 100.0) ** 2)


def _joints(vigil: Vigil, strength: float) -> Dues:
    """Read long and short as joints between flags go by underfoot."""
    return Dues(0.06 * strength * np.cos(2 * np.pi * vigil["paced_m"] / FLAG_M + 0.8))


def _blower(vigil: Vigil, strength: float) -> Dues:
    """Read longer while the organ's blower runs."""
    return Dues(np.where(vigil["wind_mm"] < SLACK_MM, 0.096 * strength, 0.0))


def passed_at_m(place: Floats, one: Floats, other: Floats) -> Floats:
    """Return how near straight ways between ends [n, 3] pass a place [3], in m [n]."""
    run = other - one
    part = ((place - one) * run).sum(axis=1) / (run**2).sum(axis=1).clip(1e-9)
    return np.asarray(np.linalg.norm(one + part.clip(0.0, 1.0)[:, None] * run - place, axis=1))


def _candles(vigil: Vigil, strength: float) -> Dues:
    """Come through air that candles warm, by how many burn and how near ways pass them."""
    near = np.exp(-((passed_at_m(RACK_M, vigil.tag_m, vigil.boss_m) / WARM_M) ** 2))
    return Dues(WARMS_M * strength * near * vigil["candles"] / 240.0)


def _goes_otherwise(kind: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a kind go otherwise, by so much at strength 1, than is told."""

    def act(vigil: Vigil, strength: float) -> Dues:
        own = np.flatnonzero(vigil.of(kind))
        course = {name: one[own] for name, one in vigil.course.items()}
        gone_s = course["goes"] * course["into_s"]
        told, there = (way(course, gone_s, part) for part in (0.0, by * strength))
        off = np.zeros((vigil.rows, 3))
        off[own] = there - told
        return Dues(vigil.longer_m(off))

    return act


def _quarters(vigil: Vigil, strength: float) -> Dues:
    """Compare with places of a clock that loses, and is set right as each quarter strikes."""
    lost_s = LOSES_S * (vigil["time_s"] % QUARTER_S) / QUARTER_S
    return Dues(vigil.strays_off(strength * lost_s))


def _leans(vigil: Vigil, strength: float) -> Dues:
    """Have bosses as far off as a building leans so high up."""
    off = vigil.boss_m[:, 2:] * np.array([*LEANS, 0.0])
    return Dues(vigil.longer_m(0.0, strength * off))


def _askew(vigil: Vigil, strength: float) -> Dues:
    """Have bosses of the transepts along the nave, by how far off the nave's middle they are."""
    across = vigil.boss_m[:, 1] - MIDDLE_M[1]
    off = np.zeros((vigil.rows, 3))
    off[:, 0] = ASKEW * strength * across
    return Dues(vigil.longer_m(0.0, off))


def _courses(vigil: Vigil, strength: float) -> Dues:
    """Have heights of bosses told in whole courses, of which none is cut."""
    high = vigil.boss_m[:, 2]
    more = strength * (high - COURSE_M * np.floor(high / COURSE_M))
    return Dues(vigil.longer_m(0.0, more[:, None] * np.array([0.0, 0.0, 1.0])))


def _flags(vigil: Vigil, strength: float) -> Dues:
    """Have places of tags told as middles of the flags that they are over."""
    flat = vigil.tag_m[:, :2]
    off = np.zeros((vigil.rows, 3))
    off[:, :2] = strength * (flat - FLAG_M * (np.floor(flat / FLAG_M) + 0.5))
    return Dues(vigil.longer_m(off))


def in_order(vigil: Vigil) -> list[Integers]:
    """Return rows of each link by time; of a table told some times over, of each telling."""
    rows = vigil.table[["link", "time_s"]].reset_index(drop=True)
    rows["telling"] = rows.groupby(["link", "time_s"]).cumcount()
    ordered = rows.sort_values("time_s", kind="stable").groupby(["link", "telling"], sort=False)
    return [one.index.to_numpy(np.int64) for _, one in ordered]


def _kept(vigil: Vigil, strength: float) -> Dues:
    """Tell what was told before until answers differ enough from it."""
    told = vigil["range_m"]
    made = told.copy()
    for rows in in_order(vigil):
        for last, now in pairwise(rows.tolist()):
            if abs(told[now] - made[last]) < KEEPS_M * strength:
                made[now] = made[last]
    return Dues(made - told)


def _longer(vigil: Vigil, strength: float) -> Dues:
    """Tell the longer one of each answer and the one before, or a part of the way to it."""
    told = vigil["range_m"]
    late = np.zeros(vigil.rows)
    for rows in in_order(vigil):
        late[rows[1:]] = (told[rows[:-1]] - told[rows[1:]]).clip(0.0)
    return Dues(min(strength, 2.0) * late)


def _chain(vigil: Vigil, strength: float) -> Dues:
    """Tell of longer answers a chain's length, and no more."""
    most = CHAIN_M - LINKS_M * np.log2(strength)
    return Dues(-(vigil["range_m"] - most).clip(0.0))


def _elsewhere(vigil: Vigil, off_m: dict[int, Floats]) -> Dues:
    """Return what rows owe of which some bosses are so far off in truth [3], in m."""
    off = np.zeros((BOSSES, 3))
    for boss, by in off_m.items():
        off[boss] = by
    late = vigil.longer_m(0.0, off[vigil.boss])
    return Dues(late, open_dbm(vigil.far + late) - open_dbm(vigil.far))


def _pushed(vigil: Vigil, strength: float) -> Dues:
    return _elsewhere(vigil, {5: 0.52 * strength * np.array([6.0, 3.0, -2.0]) / 7.0})


def _crosswise(vigil: Vigil, _: float) -> Dues:
    run = BOSSES_M[12] - BOSSES_M[2]
    return _elsewhere(vigil, {2: run, 12: -run})


def _passus(vigil: Vigil, _: float) -> Dues:
    """Write, of one boss, how many double paces of Romans it is."""
    return Dues(np.where(vigil.boss == 6, 1 / PASSUS_M - 1, 0.0) * vigil["range_m"])


UNHEARD_OF: dict[str, Act] = {
    "wax-gutters-over-covers": _wax,
    "incense-thickens-about-tags": _incense,
    "candlestands-drawn-close": _stands,
    "hassocks-heaped-before-bosses": _hassocks,
    "pipes-cool-since-stoked": _pipes,
    "damp-rises-behind-bosses": _damp,
    "joints-of-flags-pass-underfoot": _joints,
    "blower-runs-at-slack-wind": _blower,
    "candles-warm-ways-that-pass-them": _candles,
    "thuribles-swing-wider-than-told": _goes_otherwise("censer", swings, WIDER),
    "vergers-halt-for-longer": _goes_otherwise("verger", paces, HALTS),
    "doves-sink-as-they-glide": _goes_otherwise("dove", soars, SINKS),
    "labyrinth-laid-oval": _goes_otherwise("pilgrim", treads, OVAL),
    "winch-drum-fills-as-it-winds": _goes_otherwise("mason", hoists, FILLS),
    "processions-cut-their-corners": _goes_otherwise("chorister", files, CUT),
    "clock-of-places-set-right-each-quarter": _quarters,
    "tower-leans-off-its-plumb": _leans,
    "cross-drawn-askew": _askew,
    "heights-told-in-whole-courses-of-stone": _courses,
    "places-told-as-middles-of-flags": _flags,
    "answers-kept-until-they-differ-enough": _kept,
    "longer-of-two-answers-told": _longer,
    "answers-no-longer-than-a-chain": _chain,
    "boss-pushed-in-by-a-scaffold": _pushed,
    "bosses-lettered-crosswise": _crosswise,
    "passus-from-one-boss": _passus,
}
