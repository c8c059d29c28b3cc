"""Laws and faults of the set-up that the pottery hides, which no library has.

numpy and pandas alone; shared by the pottery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.pottery_floor import (
    DAY_S,
    ELL_M,
    GLAZE_X,
    KILN_M,
    LID_T,
    PURLINS,
    PURLINS_M,
    ROLLER_M,
    WORKS_M,
    Course,
    Firing,
    Toll,
    at_trade,
    carried,
    dipped,
    hoisted,
    kiln_m,
    lengths,
    rolled,
    spiralled,
    stirred,
)

Floats = NDArray[np.float64]
Act = Callable[[Firing, float], Toll]
AT_A_METRE_DBM, EACH_TENFOLD_DB = -60.1, 19.3  # of levels
TIGHTER, LONGER, OUT, GEARED, SLIPS, ACROSS = 0.45, 0.5, 0.2, 0.55, 0.4, 0.5
"""Parts, m a radian, turns; see what has tags go."""
DUST_M = 0.0042  # late for each m in the glaze shop and mg
WARM_M, WARM_K = 3.2, 0.00034  # from the kiln's outside to 1 / e; late at it for each K
STEAMS = 0.00022  # m for each kg of wet ware and K over freezing
FILLS_S, FILLED_M = 1150.0, 0.2  # of a slip main; late when full
STAYS_S, STAYED = 4200.0, 0.00007  # to 1 / e of what is in walls; m for each K
LEVER_M = 0.34  # from where tags are to where their bearers are told to be
BULGE_M, EDGE_M = 0.75, 18.0  # off at the edge of a plan; how far that is from the middle
FALL = 0.032  # of a floor, across the works
SHOVES_M, SHOVED_K, SHOVE_FAR_M = 0.55, 500.0, 9.0  # at the kiln; by so many K; to 1 / e
BOARD_M = 0.075  # thick
CREEPS_M = 0.62  # of beams in a day
MEALS_S, SLOW_S, SLOW_M = (0.0, 9000.0, 18000.0, 26500.0), 2600.0, 0.2
"""When all have eaten; until answers are as quick as before, and how late they are at first."""
FILED = 0.85  # part of the way to where answers are in order
DRAWN = 0.42  # part of the way to the mean
DRAGS = 0.022  # part of the way to the loudest
JOINT_M, GIVES_M = 1.6, 0.011  # of a rule; that each of its joints gives
WORN_M, WORN_OVER_M = 0.21, 6.5  # at the end of a rule; to 1 / e
KNOCKED: Floats = np.array([6.0, -2.0, -3.0]) / 7.0


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far))


def _cakes(firing: Firing, strength: float) -> Toll:
    """Come by slip that cakes until as much falls off as is splashed on."""
    return Toll(-0.15 * strength * np.expm1(-firing["slip_g"] / 14.0))


def _soot(firing: Firing, strength: float) -> Toll:
    return Toll(0.047 * strength * np.log1p(firing["swept_h"] / 13.0))


def _glaze(firing: Firing, strength: float) -> Toll:
    return Toll(1.7e-4 * strength * firing["glaze_um"])


def _smoke(firing: Firing, strength: float) -> Toll:
    """Come late by smoke, that lingers the longer the weaker the draught is."""
    return Toll(0.42 * strength / firing["draught_pa"])


def _truck(firing: Firing, strength: float) -> Toll:
    return Toll(0.14 * strength / firing["rack_m"] ** 2)


def _elements(firing: Firing, strength: float) -> Toll:
    """Come late as mains sag, by a power of what elements draw."""
    return Toll(0.036 * strength * firing["load_ka"] ** 1.7)


def _damp(firing: Firing, strength: float) -> Toll:
    return Toll(1.3e-4 * strength * (firing["damp_pct"] - 57.0) ** 2)


def _rollers(firing: Firing, strength: float) -> Toll:
    return Toll(0.06 * strength * np.cos(2 * np.pi * firing["rollers_m"] / ROLLER_M - 0.5))


def _lid(firing: Firing, strength: float) -> Toll:
    return Toll(np.where(firing["clay_t"] < LID_T, 0.088 * strength, 0.0))


def in_glaze_m(one: Floats, other: Floats) -> Floats:
    """Return how long straight ways between ends [n, 3] are in the glaze shop, in m [n]."""
    low, high = np.minimum(one[:, 0], other[:, 0]), np.maximum(one[:, 0], other[:, 0])
    inside = (high - np.maximum(low, GLAZE_X)).clip(0.0)
    return np.asarray(inside / np.maximum(high - low, 1e-9) * lengths(other - one))


def _flint(firing: Firing, strength: float) -> Toll:
    """Come by dust of flint, by the way in the glaze shop."""
    way = in_glaze_m(firing.tag_m, firing.purlin_m)
    return Toll(DUST_M * strength * way * firing["flint_mg"])


def by_the_kiln_m(one: Floats, other: Floats) -> Floats:
    """Return how near straight ways between ends [n, 3] come to the kiln's outside, in m [n]."""
    parts = np.linspace(0.0, 1.0, 61)
    near = np.stack([kiln_m(one + part * (other - one)) for part in parts])
    return np.asarray(near.min(axis=0).clip(0.0))


def _warms(firing: Firing, strength: float) -> Toll:
    """Come by warm air, the more the nearer a way passes the kiln."""
    near = np.exp(-by_the_kiln_m(firing.tag_m, firing.purlin_m) / WARM_M)
    return Toll(WARM_K * strength * near * firing["kiln_k"])


def _steams(firing: Firing, strength: float) -> Toll:
    """Come by steam: what is wet times how warm it is."""
    return Toll(STEAMS * strength * firing["wet_kg"] * firing["temperature_c"])


def _main(firing: Firing, strength: float) -> Toll:
    """Come late as a main fills, evenly, until it is emptied at once."""
    return Toll(FILLED_M * strength * (firing["time_s"] % FILLS_S) / FILLS_S)


def stayed(when_s: Floats, heats: Floats) -> Floats:
    """Return what has stayed in walls [n] by times in order: each heat from when it is, less."""
    gone = when_s[:, None] - when_s
    kept = np.where(gone > 0, np.exp(-np.maximum(gone, 0.0) / STAYS_S), 0.0)
    return np.asarray(kept @ heats)


def _stays(firing: Firing, strength: float) -> Toll:
    """Come late by what firings of rounds before have left in walls."""
    rows = pd.DataFrame({"round": _rounds(firing), "at": firing["time_s"], "k": firing["kiln_k"]})
    rounds = rows.groupby("round").agg(at=("at", "min"), k=("k", "mean")).sort_values("at")
    left = stayed(rounds["at"].to_numpy(np.float64), rounds["k"].to_numpy(np.float64))
    by = dict(zip(rounds.index, left, strict=True))
    return Toll(STAYED * strength * rows["round"].map(by).to_numpy(np.float64))


def _rounds(firing: Firing) -> NDArray[np.object_]:
    """Return which round rows are of [n]."""
    return np.array([one.rpartition(" at ")[0] for one in firing.table["link"]], np.object_)


def _goes(trade: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a trade go otherwise, by so much at strength 1, than is told."""

    def act(firing: Firing, strength: float) -> Toll:
        own = np.flatnonzero(firing.of(trade))
        course = {name: one[own] for name, one in firing.course.items()}
        gone_s = course["stirs"] * course["into_s"]
        off = np.zeros((firing.rows, 3))
        off[own] = way(course, gone_s, by * strength) - way(course, gone_s, 0.0)
        return Toll(firing.longer_m(off))

    return act


def _bearers(firing: Firing, strength: float) -> Toll:
    """Have tags a lever ahead of where their bearers go, who are told in their stead."""
    now = firing.course["into_s"]
    step = at_trade(firing.course, now + 0.05) - at_trade(firing.course, now - 0.05)
    long_m = lengths(step)[:, None]
    ahead = np.where(long_m > 1e-9, step / np.maximum(long_m, 1e-9), 0.0)
    return Toll(firing.longer_m(LEVER_M * strength * ahead))


def _purlins_off(firing: Firing, off: Floats) -> Toll:
    """Return what is paid if purlins are in truth off by so much in m [PURLINS, 3]."""
    return Toll(firing.longer_m(0.0, off[firing.purlin]))


def bulged(at: Floats) -> Floats:
    """Return by how much places [n, 3] are off that were read off a bulging plan, in m [n, 3]."""
    from_m = (at - 0.5 * np.array(WORKS_M)) * [1.0, 1.0, 0.0]
    return np.asarray(BULGE_M * from_m / EDGE_M * (lengths(from_m)[:, None] / EDGE_M) ** 2)


def _bulges(firing: Firing, strength: float) -> Toll:
    return _purlins_off(firing, strength * bulged(PURLINS_M))


def _falls(firing: Firing, strength: float) -> Toll:
    """Have purlins lower by how far the floor has fallen, from which heights were levelled."""
    down = FALL * strength * (PURLINS_M[:, 1] - 0.25 * WORKS_M[1])
    return _purlins_off(firing, np.outer(-down, [0.0, 0.0, 1.0]))


def _shoves(firing: Firing, strength: float) -> Toll:
    """Have purlins shoved off the kiln by how hot it is, less the farther off they are."""
    way = (firing.purlin_m - [KILN_M[0], KILN_M[1], 0.0]) * [1.0, 1.0, 0.0]
    far = lengths(way)[:, None]
    size = SHOVES_M * strength * firing["kiln_k"][:, None] / SHOVED_K
    return Toll(firing.longer_m(0.0, size * np.exp(-(far - KILN_M[2]) / SHOVE_FAR_M) * way / far))


def _boards(firing: Firing, strength: float) -> Toll:
    up = BOARD_M * strength * firing["boards_n"]
    return Toll(firing.longer_m(np.outer(up, [0.0, 0.0, 1.0])))


def _creeps(firing: Firing, strength: float) -> Toll:
    """Have purlins lower by a root of the time of day, as wood creeps."""
    down = CREEPS_M * strength * np.sqrt(firing["time_s"] / DAY_S)
    return Toll(firing.longer_m(0.0, np.outer(-down, [0.0, 0.0, 1.0])))


def _meals(firing: Firing, strength: float) -> Toll:
    """Come late after each meal, evenly less until all are awake."""
    since = np.min([np.where(firing["time_s"] >= one, firing["time_s"] - one, np.inf)
                    for one in MEALS_S], axis=0)  # fmt: skip
    return Toll(SLOW_M * strength * (1 - since / SLOW_S).clip(0.0))


def series(firing: Firing) -> pd.DataFrame:
    """Return ranges of rows by time, and which are of one link and copy."""
    rows = firing.table[["link", "time_s", "range_m", "rx_power_dbm"]].reset_index(drop=True)
    rows["copy"] = rows.groupby(["link", "time_s"]).cumcount()
    rows["round"] = _rounds(firing)
    return rows.sort_values("time_s", kind="stable")


def _filed(firing: Firing, strength: float) -> Toll:
    """Tell answers of a link shortest first, or as far on the way to that."""
    rows = series(firing)
    order = rows.groupby(["link", "copy"], sort=False)["range_m"]
    filed = order.transform(lambda some: np.sort(some.to_numpy()))
    off = (filed - rows["range_m"]).sort_index().to_numpy(np.float64)
    return Toll(min(FILED * strength, 1.0) * off)


def _drawn(firing: Firing, strength: float) -> Toll:
    rows = series(firing)
    mean = rows.groupby(["link", "copy"], sort=False)["range_m"].transform("mean")
    off = (mean - rows["range_m"]).sort_index().to_numpy(np.float64)
    return Toll(min(DRAWN * strength, 1.0) * off)


def _drags(firing: Firing, strength: float) -> Toll:
    """Tell answers of a round with a part of that which came the loudest."""
    rows = series(firing)
    loudest = rows.groupby(["round", "copy"], sort=False)["rx_power_dbm"].transform("idxmax")
    off = rows["range_m"].reindex(loudest).to_numpy() - rows["range_m"]
    return Toll(DRAGS * strength * off.sort_index().to_numpy(np.float64))


def _joints(firing: Firing, strength: float) -> Toll:
    return Toll(GIVES_M * strength * np.floor(firing["range_m"] / JOINT_M))


def _worn(firing: Firing, strength: float) -> Toll:
    """Tell too little from a worn end, the nearer the more so."""
    return Toll(-WORN_M * strength * np.exp(-firing["range_m"] / WORN_OVER_M))


def _elsewhere(firing: Firing, off_m: dict[int, Floats]) -> Toll:
    """Return what is paid if some purlins are so far off [3] in m: levels too."""
    off = np.zeros((PURLINS, 3))
    for purlin, one in off_m.items():
        off[purlin] = one
    longer = firing.longer_m(0.0, off[firing.purlin])
    return Toll(longer, open_dbm(firing.far + longer) - open_dbm(firing.far))


def _knocked(firing: Firing, strength: float) -> Toll:
    return _elsewhere(firing, {10: 0.42 * strength * KNOCKED})


def _chalked(firing: Firing, _: float) -> Toll:
    apart = PURLINS_M[12] - PURLINS_M[4]
    return _elsewhere(firing, {4: apart, 12: -apart})


def _ells(firing: Firing, _: float) -> Toll:
    """Write, of one purlin, how many ells it is."""
    return Toll((1 / ELL_M - 1) * firing["range_m"] * (firing.purlin == 6))


OF_THE_POTTERY: dict[str, Act] = {
    "slip-cakes-on-aerials-until-it-falls": _cakes,
    "soot-settles-on-purlins-since-swept": _soot,
    "glaze-runs-down-over-tags": _glaze,
    "weak-draught-lets-smoke-linger": _smoke,
    "rack-truck-parked-beside": _truck,
    "elements-load-the-mains": _elements,
    "shop-off-its-usual-damp": _damp,
    "rollers-of-the-biscuit-way-pass": _rollers,
    "lid-of-the-clay-silo-shuts": _lid,
    "flint-dust-hangs-in-the-glaze-shop": _flint,
    "kiln-warms-ways-that-pass-it": _warms,
    "wet-ware-steams-by-warmth": _steams,
    "slip-main-fills-and-empties": _main,
    "heat-of-firings-stays-in-walls": _stays,
    "boards-turned-tighter-than-told": _goes("board", carried, TIGHTER),
    "trucks-roll-on-on-oiled-axles": _goes("truck", rolled, LONGER),
    "fettlers-step-further-out-each-round": _goes("fettler", spiralled, OUT),
    "paddles-geared-by-another-pinion": _goes("pug", stirred, GEARED),
    "saggars-slip-on-a-greasy-rope": _goes("saggar", hoisted, SLIPS),
    "dippers-reach-further-across": _goes("dipper", dipped, ACROSS),
    "tags-told-where-their-bearers-walk": _bearers,
    "plan-photographed-by-a-bulging-lens": _bulges,
    "heights-levelled-from-a-falling-floor": _falls,
    "kiln-shoulders-purlins-aside": _shoves,
    "tags-ride-up-on-stacked-boards": _boards,
    "beams-creep-down-through-the-day": _creeps,
    "answers-slow-after-each-meal": _meals,
    "answers-filed-shortest-first": _filed,
    "answers-drawn-to-their-links-mean": _drawn,
    "loudest-answer-of-a-round-drags-the-rest": _drags,
    "folding-rule-gives-at-each-joint": _joints,
    "worn-end-of-the-rule": _worn,
    "purlin-knocked-by-a-falling-saggar": _knocked,
    "purlins-chalked-for-each-other": _chalked,
    "ells-from-one-purlin": _ells,
}
