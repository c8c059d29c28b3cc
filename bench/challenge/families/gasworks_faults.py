"""Laws and faults of the set-up that the gasworks hides, which no library has.

numpy and pandas alone; shared by the gasworks' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.gasworks_yard import (
    AUNE_M,
    BRACKETS,
    BRACKETS_M,
    FLIGHT_M,
    RETORTS_M,
    SLAMS_MBAR,
    TANKS_M,
    YARD_M,
    Bill,
    Charge,
    Course,
    driven,
    hauled,
    rakes,
    spirals,
    strolls,
    wheeled,
)

Floats = NDArray[np.float64]
Act = Callable[[Charge, float], Bill]
AT_A_METRE_DBM, EACH_TENFOLD_DB = -60.2, 19.5  # of levels
WIDER, VEERS, STEEPER, SURGES, CUTS, SHORTER = 0.3, 0.05, 0.18, 0.9, 0.3, 0.35
"""Parts, radians for each m; see what has tags go."""
ROOF_M, SMOKE_M = 4.5, 0.0058  # over which smoke hangs; late for each m therein and mg
QUENCH_M: Floats = np.array([24.0, 17.0, 3.0])
STEAM_M, WAFTS_M = 0.021, 6.0  # late for each kg by a tower; to 1 / e of that
DOORS_FROM_M, GLOWS_M, HOT_K = 3.0, 0.3, 1450.0  # of benches; late at most, at so hot
DRAGS_S, DIAL_M = 900.0, 0.0045  # of a gauge; late for each mm
TICK_S = 0.42  # by which places are told
LEANS = 0.022  # up for each m away from the tank
SHRUNK = 0.013  # parts, along
SINKS_M, HEAP_M, HEAP_TO_M, FULL_T = 1.1, (24.0, 22.0), 13.0, 120.0
BELLIES_M, BENCH_C = 0.5, 240.0
STROKE_S, WAITS_M = 1.7, 0.17  # of an exhauster; late at most
DAMPED = 0.55  # of what a float keeps
YARD_FT_M, SHORT = 0.9144, 0.2  # parts by which inches are booked too long
DIAL_OFF_M, DIAL_TURN_M = 0.085, 5.3  # of a dial off its centre; of ranges for a turn
BENT: Floats = np.array([4.0, -7.0, -4.0]) / 9.0


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far))


def _tar(charge: Charge, strength: float) -> Bill:
    """Come by tar that clings until it drips (Langmuir 1918)."""
    tar = charge["tar_g"]
    return Bill(0.23 * strength * tar / (tar + 11.0))


def _naphthalene(charge: Charge, strength: float) -> Bill:
    """Come by crystals that grow in vents, ever less as these close."""
    return Bill(0.062 * strength * np.log1p(charge["frost_d"] / 1.1))


def _scurf(charge: Charge, strength: float) -> Bill:
    return Bill(0.0155 * strength * charge["scurf_mm"])


def _lime(charge: Charge, strength: float) -> Bill:
    """Come sooner the longer lime has been spent (a power, of what diffuses)."""
    return Bill(-0.15 * strength * (charge["lime_h"] / 40.0) ** 0.6)


def _jib(charge: Charge, strength: float) -> Bill:
    return Bill(0.1 * strength / charge["jib_m"])


def _holder(charge: Charge, strength: float) -> Bill:
    return Bill(0.19 * strength * (charge["lift_m"] / 6.0) ** 1.7)


def _exhauster(charge: Charge, strength: float) -> Bill:
    """Shake the more, the farther from the pace an exhauster was balanced at."""
    return Bill(9.5e-5 * strength * (charge["exhaust_rpm"] - 74.0) ** 2)


def _flights(charge: Charge, strength: float) -> Bill:
    return Bill(0.06 * strength * np.sin(2 * np.pi * charge["flights_m"] / FLIGHT_M + 0.4))


def _slams(charge: Charge, strength: float) -> Bill:
    return Bill(np.where(charge["main_mbar"] > SLAMS_MBAR, 0.094 * strength, 0.0))


def in_smoke_m(one: Floats, other: Floats) -> Floats:
    """Return how long straight ways between ends [n, 3] are under the retort roof, in m [n].

    In the retort house, and higher than ROOF_M.
    """
    way = np.where(np.abs(other - one) < 1e-9, 1e-9, other - one)
    west, high = (RETORTS_M - one[:, 0]) / way[:, 0], (ROOF_M - one[:, 2]) / way[:, 2]
    begins = np.maximum(np.where(way[:, 0] > 0, 0.0, west), np.where(way[:, 2] > 0, high, 0.0))
    ends = np.minimum(np.where(way[:, 0] > 0, west, 1.0), np.where(way[:, 2] > 0, 1.0, high))
    share = (ends.clip(0.0, 1.0) - begins.clip(0.0, 1.0)).clip(min=0.0)
    return np.asarray(share * np.linalg.norm(way, axis=1))


def _smoke(charge: Charge, strength: float) -> Bill:
    """Come by smoke under the retort house's roof, by the way therein."""
    within = in_smoke_m(charge.tag_m, charge.bracket_m)
    return Bill(SMOKE_M * strength * within * charge["smoke_mg"])


def passes_m(one: Floats, other: Floats, place: Floats) -> Floats:
    """Return how close straight ways between ends [n, 3] pass to a place [3], in m [n]."""
    way = other - one
    part = ((place - one) * way).sum(axis=1) / np.maximum((way**2).sum(axis=1), 1e-9)
    return np.asarray(np.linalg.norm(one + part.clip(0.0, 1.0)[:, None] * way - place, axis=1))


def _steam(charge: Charge, strength: float) -> Bill:
    """Come by steam about the quenching tower, by how close ways pass it."""
    close = passes_m(charge.tag_m, charge.bracket_m, QUENCH_M)
    return Bill(STEAM_M * strength * charge["steam_kg"] * np.exp(-close / WAFTS_M))


def _fires(charge: Charge, strength: float) -> Bill:
    """Be late by what heats tags at benches: fires' fourth power (Stefan 1879), by the square.

    Of how far tags are from the line of doors along the retort house.
    """
    away = np.abs(charge.tag_m[:, 0] - DOORS_FROM_M)
    hot = ((charge["fire_c"] + 273.15) / HOT_K) ** 4
    return Bill(GLOWS_M * strength * hot / (1 + (away / 5.0) ** 2))


def dragged(time_s: Floats, moved: Floats) -> Floats:
    """Return where a gauge is that drags behind what moves it, at times in order [n] each."""
    made = moved.copy()
    for k in range(1, len(moved)):
        kept = np.exp(-(time_s[k] - time_s[k - 1]) / DRAGS_S)
        made[k] = kept * made[k - 1] + (1 - kept) * moved[k]
    return made


def _gauge(charge: Charge, strength: float) -> Bill:
    """Be as far off as a gauge of pressure is behind (of the first order)."""
    moved, time_s = charge["gauge_mm"], charge["time_s"]
    when, first, where = np.unique(time_s, return_index=True, return_inverse=True)
    return Bill(DIAL_M * strength * (dragged(when, moved[first]) - moved[first])[where])


def _goes(trade: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a trade go otherwise, by so much at strength 1, than is told."""

    def act(charge: Charge, strength: float) -> Bill:
        own, off = charge.are(trade), np.zeros((charge.rows, 3))
        course = {name: one[own] for name, one in charge.course.items()}
        gone_s = course["works"] * course["into_s"]
        off[own] = way(course, gone_s, by * strength) - way(course, gone_s, 0.0)
        return Bill(charge.longer_m(off))

    return act


def _ticks(charge: Charge, strength: float) -> Bill:
    """Compare with places that are told anew at each tick of a master clock."""
    since_s = charge["time_s"] % (TICK_S * strength)
    return Bill(-charge.gets_away(-since_s))


def _brackets_off(charge: Charge, off: Floats) -> Bill:
    """Return what is charged if brackets are in truth off by so much in m [BRACKETS, 3]."""
    return Bill(charge.longer_m(0.0, off[charge.bracket]))


def _leans(charge: Charge, strength: float) -> Bill:
    """Have brackets higher the farther from the gasholder, whose tank levels were sighted to."""
    away = np.linalg.norm(BRACKETS_M[:, :2] - TANKS_M[-1, :2], axis=1)
    return _brackets_off(charge, np.outer(LEANS * strength * away, [0.0, 0.0, 1.0]))


def _shrunk(charge: Charge, strength: float) -> Bill:
    """Have brackets farther from the yard's middle than a print has it that shrank along."""
    off = SHRUNK * strength * (BRACKETS_M[:, 0] - 0.5 * YARD_M[0])
    return _brackets_off(charge, np.outer(off, [1.0, 0.0, 0.0]))


def _ground(charge: Charge, strength: float) -> Bill:
    """Have brackets sink about a heap of coal, as ground does that a load is on (Winkler 1867)."""
    away = np.linalg.norm(BRACKETS_M[:, :2] - np.array(HEAP_M), axis=1)[charge.bracket]
    down = SINKS_M * strength * np.exp(-away / HEAP_TO_M) * charge["coal_t"] / FULL_T
    return Bill(charge.longer_m(0.0, -np.outer(down, [0.0, 0.0, 1.0])))


def _bellies(charge: Charge, strength: float) -> Bill:
    """Have brackets on the retort house's outer walls farther out by how hot benches are."""
    inner = BRACKETS_M[:, 0] < RETORTS_M
    out = np.where(inner, np.sin(np.pi * BRACKETS_M[:, 2] / YARD_M[2]), 0.0)
    away = BRACKETS_M[:, :2] - np.array([0.5 * RETORTS_M, 0.5 * YARD_M[1]])
    toward = np.column_stack([away / np.linalg.norm(away, axis=1)[:, None], np.zeros(BRACKETS)])
    by = BELLIES_M * strength * (charge["bench_c"] - 15.0) / BENCH_C
    return Bill(charge.longer_m(0.0, by[:, None] * (out[:, None] * toward)[charge.bracket]))


def _strokes(charge: Charge, strength: float) -> Bill:
    """Answer at an exhauster's stroke: the later the sooner after the last it was asked."""
    part = charge["time_s"] % STROKE_S / STROKE_S
    return Bill(WAITS_M * strength * (1 - part))


def in_order(charge: Charge) -> tuple[pd.DataFrame, list[str]]:
    """Return links, times, ranges and copies of rows by time, and what tells which go together."""
    rows = charge.table[["link", "time_s", "range_m"]].reset_index(drop=True)
    rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
    return rows.sort_values("time_s", kind="stable"), ["link", "copy"]


def _thirds(charge: Charge, strength: float) -> Bill:
    """Tell of a link's each third answer a part of what came before; all of it at 1 and on."""
    rows, which = in_order(charge)
    groups = rows.groupby(which, sort=False)
    before, number = groups["range_m"].shift(1), groups.cumcount()
    off = (before - rows["range_m"]).where(number % 3 == 2, 0.0) * min(strength, 1.0)
    return Bill(off.sort_index().to_numpy(np.float64))


def floated(ranges: Floats, kept: float) -> Floats:
    """Return ranges [k] as a float tells them that keeps a part of where it was."""
    made = ranges.copy()
    for k in range(1, len(made)):
        made[k] = kept * made[k - 1] + (1 - kept) * ranges[k]
    return made


def _float(charge: Charge, strength: float) -> Bill:
    """Tell answers of a link by a damped float."""
    rows, which = in_order(charge)
    kept = DAMPED ** (1 / strength)
    told = rows.groupby(which, sort=False)["range_m"].transform(
        lambda one: floated(one.to_numpy(np.float64), kept)
    )
    return Bill((told - rows["range_m"]).sort_index().to_numpy(np.float64))


def _inches(charge: Charge, strength: float) -> Bill:
    """Book inches past whole yards too long, as of a yard of thirty."""
    return Bill(SHORT * strength * (charge["range_m"] % YARD_FT_M))


def _dial(charge: Charge, strength: float) -> Bill:
    """Read ranges off a dial whose pointer is not hung at its middle."""
    turn = 2 * np.pi * charge["range_m"] / DIAL_TURN_M
    return Bill(DIAL_OFF_M * strength * np.sin(turn + 0.5))


def _elsewhere(charge: Charge, off_m: dict[int, Floats]) -> Bill:
    """Return what is charged if some brackets are so far off [3] in m: levels too."""
    off = np.zeros((BRACKETS, 3))
    for bracket, by in off_m.items():
        off[bracket] = by
    longer = charge.longer_m(0.0, off[charge.bracket])
    return Bill(longer, open_dbm(charge.far + longer) - open_dbm(charge.far))


def _bent(charge: Charge, strength: float) -> Bill:
    return _elsewhere(charge, {6: 0.51 * strength * BENT})


def _numbers(charge: Charge, _: float) -> Bill:
    apart = BRACKETS_M[15] - BRACKETS_M[3]
    return _elsewhere(charge, {3: apart, 15: -apart})


def _aunes(charge: Charge, _: float) -> Bill:
    """Write, of one bracket, how many aunes it is."""
    return Bill(np.where(charge.bracket == 11, (1 / AUNE_M - 1) * charge["range_m"], 0.0))


OF_THE_GASWORKS: dict[str, Act] = {
    "tar-clings-to-brackets": _tar,
    "naphthalene-grows-in-vents": _naphthalene,
    "scurf-thickens-on-mouthpieces": _scurf,
    "lime-spends-itself-in-purifiers": _lime,
    "jib-of-the-coke-crane-close": _jib,
    "holder-lifts-before-brackets": _holder,
    "exhauster-off-its-best-speed": _exhauster,
    "flights-of-the-conveyor-pass": _flights,
    "governor-valve-slams-shut": _slams,
    "smoke-hangs-under-the-retort-roof": _smoke,
    "steam-of-quenched-coke-drifts": _steam,
    "fires-glow-through-open-doors": _fires,
    "gauge-drags-behind-its-pressure": _gauge,
    "stokers-reach-further-than-told": _goes("stoker", rakes, WIDER),
    "barrows-veer-on-a-worn-wheel": _goes("barrow", wheeled, VEERS),
    "bells-turn-in-steeper-guides": _goes("bell", spirals, STEEPER),
    "skips-surge-on-their-rope": _goes("skip", hauled, SURGES),
    "lamplighters-cut-their-eights": _goes("lamplighter", strolls, CUTS),
    "rams-driven-by-a-shorter-rod": _goes("ram", driven, SHORTER),
    "places-told-at-the-last-tick": _ticks,
    "yard-leans-towards-the-tank": _leans,
    "print-of-the-yard-has-shrunk": _shrunk,
    "made-ground-gives-under-coal": _ground,
    "retort-wall-bellies-as-it-heats": _bellies,
    "answers-wait-for-the-exhausters-stroke": _strokes,
    "third-answers-told-as-the-second": _thirds,
    "answers-come-by-a-damped-float": _float,
    "inches-booked-to-a-short-yard": _inches,
    "dial-hung-off-its-centre": _dial,
    "bracket-bent-by-a-ladder": _bent,
    "brackets-painted-with-each-others-numbers": _numbers,
    "aunes-from-one-bracket": _aunes,
}
