"""Laws and faults of the set-up that the watermill hides, which no library has.

numpy and pandas alone; shared by the watermill's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.watermill_race import (
    COG_M,
    ELL_M,
    HATCHES,
    HATCHES_M,
    PENSTOCK_CM,
    STOREYS_M,
    WALL_M,
    Course,
    Due,
    Grist,
    drifts,
    goes_round,
    gone_to,
    is_hoisted,
    is_lifted,
    walks_round,
    winds_out,
)

Floats = NDArray[np.float64]
Act = Callable[[Grist, float], Due]
AT_A_METRE_DBM, EACH_TENFOLD_DB, BREAK_M = -60.6, 17.5, 9.0  # of levels; from where steeper
HEAVY, WIDER, ROUNDER, DRAGS, TIGHTER, SLIPS = 0.13, 0.9, 2.2, 0.17, 0.25, 0.09
"""Radians and parts; see what has tags go."""
SPRAY_M = 0.0022  # late for each m in the wheel house and g of spray
STEAM_M, EACH_C = 0.075, 0.055  # late at most damp and 20 deg C; of e-folds for a deg C
PLAY_MM, ROD_M = 11.0, 0.0048  # to either side; off for each mm
AHEAD_S, STEP_S = 0.55, 0.05  # by which places are foretold; by which paces are told
SAGS_M, SPAN_M, FULL_T = 0.5, 20.0, 9.0  # at most, amid floors, under full bins
SHAFT_M, TWISTS = (10.0, 9.0), 0.0048  # of the upright shaft; radians for each m up
LENGTH_M, SHORT_M = 4.0, 0.06  # of a chain; by which each is short
DRAWN_M: Floats = np.array([0.0, 0.42, -0.38])  # by which storeys stand higher than drawn
CHARGES_M, CHARGES_S = 0.12, 0.9  # late at most; until charged again, to 1 / e
NOTCH_M = 0.13
HALVES = 0.24  # of changes that is left out
LINE_M2 = 2.3e-5  # taken off for each m^3
SHOVED: Floats = np.array([2.0, -6.0, 3.0]) / 7.0


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]: steeper past a break."""
    beyond = 2.0 * np.log10(1 + (far / BREAK_M) ** 4)
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far) - beyond)


def _meal(grist: Grist, strength: float) -> Due:
    """Come by hatches that meal cakes about, till it falls off as fast."""
    return Due(0.16 * strength * -np.expm1(-grist["meal_g"] / 8.0))


def _thatch(grist: Grist, strength: float) -> Due:
    """Come through thatch that soaks up rain, ever less so."""
    return Due(0.066 * strength * np.log1p(grist["rain_h"] / 0.9))


def _sacks(grist: Grist, strength: float) -> Due:
    return Due(0.0135 * strength * grist["sacks"])


def _bran(grist: Grist, strength: float) -> Due:
    return Due(-0.16 * strength * np.sqrt(grist["swept_h"] / 30.0))


def _crane(grist: Grist, strength: float) -> Due:
    return Due(0.095 * strength / grist["crane_m"])


def _pond(grist: Grist, strength: float) -> Due:
    """Come from a breast that bows as water presses: half of its depth's square (Stevin 1586)."""
    return Due(0.19 * strength * (grist["pond_m"] / 2.4) ** 2)


def _tenters(grist: Grist, strength: float) -> Due:
    """Come by stones that shake the least where they are neither too near nor too far."""
    return Due(0.052 * strength * (grist["tenter_mm"] - 1.7) ** 2)


def _cogs(grist: Grist, strength: float) -> Due:
    return Due(0.062 * strength * np.sin(2 * np.pi * grist["spur_m"] / COG_M - 0.7))


def _penstock(grist: Grist, strength: float) -> Due:
    return Due(np.where(grist["penstock_cm"] > PENSTOCK_CM, -0.092 * strength, 0.0))


def in_the_wheel_house(one: Floats, other: Floats) -> Floats:
    """Return how long straight ways between ends [n, 3] are in the wheel house, in m [n]."""
    ends = np.sort(np.stack([one[:, 0], other[:, 0]]), axis=0)
    across = np.maximum(ends[1] - ends[0], 1e-9)
    share = ((ends[1] - np.maximum(ends[0], WALL_M)) / across).clip(0.0, 1.0)
    return np.asarray(share * np.linalg.norm(other - one, axis=1))


def _spray(grist: Grist, strength: float) -> Due:
    """Come by drops that hang in the wheel house, by the way therein."""
    within = in_the_wheel_house(grist.tag_m, grist.hatch_m)
    return Due(SPRAY_M * strength * within * grist["spray_g"])


def _steam(grist: Grist, strength: float) -> Due:
    """Come by what damp grain gives off, as vapours do by warmth (Clausius 1850)."""
    vapour = np.exp(EACH_C * (grist["warm_c"] - 20.0))
    return Due(STEAM_M * strength * vapour * (grist["damp_pct"] - 10.0) / 11.0)


def played(moved: Floats, half: float) -> Floats:
    """Return where what is moved through play is, in turn, half to either side [n]."""
    made, at = np.empty(len(moved)), float(moved[0])
    for k, one in enumerate(moved):
        at = min(max(at, one - half), one + half)
        made[k] = at
    return made


def _play(grist: Grist, strength: float) -> Due:
    """Be as far off as rods that have play lag behind a governor (hysteresis, Prandtl 1928)."""
    moved, time_s = grist["governor_mm"], grist["time_s"]
    _, first, where = np.unique(time_s, return_index=True, return_inverse=True)
    lags = played(moved[first], PLAY_MM) - moved[first]
    return Due(ROD_M * strength * lags[where])


def _strays(kind: str, gang: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a kind go otherwise, by so much at strength 1, than is told."""

    def act(grist: Grist, strength: float) -> Due:
        own, off = np.flatnonzero(grist.of(kind)), np.zeros((grist.rows, 3))
        course = {name: one[own] for name, one in grist.course.items()}
        gone_s = course["astir"] * course["into_s"]
        off[own] = gang(course, gone_s, strength * by) - gang(course, gone_s, 0.0)
        return Due(grist.stretched_m(off))

    return act


def _foretold(grist: Grist, strength: float) -> Due:
    """Compare with places told from where tags were, and how fast, some time before."""
    course, ago_s = grist.course, AHEAD_S * np.sqrt(strength)
    then, before = (gone_to(course, course["into_s"] - ago_s - early) for early in (0.0, STEP_S))
    told = then + ago_s / STEP_S * (then - before)
    return Due(grist.stretched_m(gone_to(course, course["into_s"]) - told))


def _hatches_off(grist: Grist, off: Floats) -> Due:
    """Return what is due if hatches are in truth off by so much in m [HATCHES, 3]."""
    return Due(grist.stretched_m(0.0, off[grist.hatch]))


def upstairs() -> NDArray[np.int64]:
    """Return on which storeys hatches are [HATCHES]; 0 in the wheel house."""
    inner = HATCHES_M[:, 0] < WALL_M
    return np.where(inner, np.searchsorted(STOREYS_M, HATCHES_M[:, 2]) - 1, 0)


def _sags(grist: Grist, strength: float) -> Due:
    """Have hatches on upper floors lower, as beams bend amid walls under full bins."""
    along = (HATCHES_M[:, 0] / SPAN_M).clip(0.0, 1.0)
    bent = (upstairs() > 0) * np.sin(np.pi * along)
    down_m = SAGS_M * strength * bent[grist.hatch] * grist["bin_t"] / FULL_T
    return Due(grist.stretched_m(0.0, -np.outer(down_m, [0.0, 0.0, 1.0])))


def _twists(grist: Grist, strength: float) -> Due:
    """Have hatches turned about the shaft, the more the higher they are (Saint-Venant 1855)."""
    east, north = (HATCHES_M[:, :2] - np.array(SHAFT_M)).T
    turn = TWISTS * strength * HATCHES_M[:, 2]
    return _hatches_off(grist, np.stack([-turn * north, turn * east, 0.0 * turn], axis=1))


def _chained(grist: Grist, strength: float) -> Due:
    """Have hatches farther east by a link for each whole length of a chain."""
    off = SHORT_M * strength * np.floor(HATCHES_M[:, 0] / LENGTH_M)
    return _hatches_off(grist, np.outer(off, [1.0, 0.0, 0.0]))


def _alike(grist: Grist, strength: float) -> Due:
    """Have hatches higher or lower as their storeys are than a plan has these."""
    return _hatches_off(grist, np.outer(strength * DRAWN_M[upstairs()], [0.0, 0.0, 1.0]))


def since_last_s(grist: Grist) -> Floats:
    """Return how long ago each row's hatch answered last, in s [n]; a day if never."""
    made, time_s = np.full(grist.rows, 86400.0), grist["time_s"]
    for hatch in range(HATCHES):
        own = grist.hatch == hatch
        if own.any():
            when, where = np.unique(time_s[own], return_inverse=True)
            made[own] = np.diff(when, prepend=when[0] - 86400.0)[where]
    return made


def _charging(grist: Grist, strength: float) -> Due:
    """Answer late until a hatch's store is charged again since it answered last."""
    return Due(CHARGES_M * strength * np.exp(-since_last_s(grist) / CHARGES_S))


def _notch(grist: Grist, strength: float) -> Due:
    """Tell a notch that is stuck: where it should be none, ranges are longer by it."""
    notch_m = NOTCH_M * strength
    return Due(np.where(np.floor(grist["range_m"] / notch_m) % 2 == 0, notch_m, 0.0))


def in_turn(grist: Grist) -> tuple[pd.DataFrame, list[str]]:
    """Return links, ranges and tellings of rows by time, and what tells which go together."""
    rows = grist.table[["link", "time_s", "range_m"]].reset_index(drop=True)
    rows["telling"] = rows.groupby(["link", "time_s"]).cumcount()
    return rows.sort_values("time_s", kind="stable"), ["link", "telling"]


def _nails(grist: Grist, strength: float) -> Due:
    """Tell of a link what was on the nail before; first what is."""
    rows, which = in_turn(grist)
    behind = int(np.ceil(strength))
    told = rows.groupby(which, sort=False)["range_m"].shift(behind).fillna(rows["range_m"])
    return Due(told.sort_index().to_numpy(np.float64) - grist["range_m"])


def _by_halves(grist: Grist, strength: float) -> Due:
    """Tell changes since a link's first range by less than these are."""
    rows, which = in_turn(grist)
    since = rows["range_m"] - rows.groupby(which, sort=False)["range_m"].transform("first")
    return Due(-min(HALVES * strength, 0.95) * since.sort_index().to_numpy(np.float64))


def _line(grist: Grist, strength: float) -> Due:
    """Take off what a taut line of such a length would sag by (by its cube, of chains)."""
    return Due(-LINE_M2 * strength * grist.far**3)


def _elsewhere(grist: Grist, off_m: dict[int, Floats]) -> Due:
    """Return what is due if some hatches are so far off [3] in m: levels too."""
    off = np.zeros((HATCHES, 3))
    for hatch, by in off_m.items():
        off[hatch] = by
    longer = grist.stretched_m(0.0, off[grist.hatch])
    return Due(longer, open_dbm(grist.far + longer) - open_dbm(grist.far))


def _shoved(grist: Grist, strength: float) -> Due:
    return _elsewhere(grist, {9: 0.49 * strength * SHOVED})


def _hooks(grist: Grist, _: float) -> Due:
    apart = HATCHES_M[14] - HATCHES_M[2]
    return _elsewhere(grist, {2: apart, 14: -apart})


def _ells(grist: Grist, _: float) -> Due:
    """Write, of one hatch, how many ells it is."""
    return Due(np.where(grist.hatch == 5, (1 / ELL_M - 1) * grist["range_m"], 0.0))


OF_THE_MILL: dict[str, Act] = {
    "meal-cakes-about-hatches": _meal,
    "thatch-soaks-since-it-rains": _thatch,
    "sacks-stacked-before-hatches": _sacks,
    "bran-settles-since-swept": _bran,
    "stone-crane-hung-close": _crane,
    "pond-presses-on-the-breast": _pond,
    "stones-tentered-too-near-or-too-far": _tenters,
    "cogs-of-the-great-spur-pass": _cogs,
    "penstock-lifted-past-its-stop": _penstock,
    "spray-hangs-in-the-wheel-house": _spray,
    "steam-of-damp-grain-by-warmth": _steam,
    "rods-of-the-governor-have-play": _play,
    "wheel-runs-ahead-on-its-heavy-side": _strays("paddle", goes_round, HEAVY),
    "sacks-sway-wider-than-told": _strays("sack", is_hoisted, WIDER),
    "millers-round-their-corners": _strays("miller", walks_round, ROUNDER),
    "drift-drags-behind-the-stream": _strays("drift", drifts, DRAGS),
    "carts-wind-in-tighter": _strays("cart", winds_out, TIGHTER),
    "buckets-slip-with-their-belt": _strays("bucket", is_lifted, SLIPS),
    "places-foretold-straight-on": _foretold,
    "floors-sag-under-full-bins": _sags,
    "mill-twists-about-its-shaft": _twists,
    "chain-a-link-short-each-length": _chained,
    "storeys-drawn-all-alike": _alike,
    "answers-late-until-charged-again": _charging,
    "notch-stuck-in-the-tally-stick": _notch,
    "slips-hung-one-nail-behind": _nails,
    "changes-of-ranges-told-by-halves": _by_halves,
    "sag-of-a-line-taken-off": _line,
    "hatch-shoved-by-ice": _shoved,
    "hatches-hung-on-each-others-hooks": _hooks,
    "ells-from-one-hatch": _ells,
}
