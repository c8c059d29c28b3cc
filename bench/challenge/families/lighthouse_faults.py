"""Laws and faults of the set-up that the lighthouse hides, which no library has.

numpy and pandas alone; shared by the lighthouse's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.lighthouse_station import (
    CRESSETS,
    CRESSETS_M,
    FATHOM_M,
    RINGS_KM,
    ROCK_M,
    RUNG_M,
    TOWER_M,
    Course,
    Dues,
    Entries,
    drifts,
    hoisted,
    paces,
    revolves,
    wheels,
    winds,
)

Floats = NDArray[np.float64]
Act = Callable[[Entries, float], Dues]
AT_A_METRE_DBM, EACH_TENFOLD_DB = -59.6, 20.4  # of levels
ROUNDER, LONGER, WIDER, SWAYS_WIDER, STICKS, SOONER = 1.6, 0.55, 0.35, 0.7, 0.22, 1.1
"""Parts, radians; see what has tags go."""
WEATHER_M, SPRAY_M = 11.0, 0.0034  # from the western wall; late for each m therein and mg
DRAUGHT_M = 0.004  # late for each m in the tower and K
TURN_S, BEAM_RAD, BEAM_M = 10.0, 0.9, 0.24  # of the lamp; of its beam, to a half; late at most
STICTION_MM, WELL_M = 28.0, 0.0062  # of a float; late for each mm off
LOSES = 0.1  # of what passed since a watch began
STRETCHED, SHEARS = 0.05, 0.045  # parts of heights; along for each m across
BENDS_M, GALE_M_S = 0.62, 27.0  # of the tower's top, at so much wind
HEAVES, SWINGS_RAD = 0.014, 1.1  # for each m of tide; from which side the rock gives
WOUND_S, RUNS_DOWN_M = 5400.0, 0.2  # between windings; late at most
RECKONED, LEANS = 0.3, 0.2  # parts
LINE_M2 = 0.0005  # by which a line is longer for each m^2
KNOT_M, TOO_LARGE_M = 2.25, 0.034  # between knots; each counted so much too large
VERNIER_M, WRONG = 0.42, 0.5  # of a division; part that is told from its wrong end
BENT: Floats = np.array([6.0, 2.0, -3.0]) / 7.0


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far))


def _salt(entries: Entries, strength: float) -> Dues:
    """Come by salt that crusts until spray washes off as much."""
    return Dues(0.12 * strength * np.arctan(entries["salt_g"] / 7.0))


def _verdigris(entries: Entries, strength: float) -> Dues:
    """Come by rust of copper, which grows as the logarithm of days does."""
    return Dues(0.046 * strength * np.log1p(entries["green_d"] / 14.0))


def _guano(entries: Entries, strength: float) -> Dues:
    return Dues(0.0128 * strength * entries["guano_mm"])


def _mercury(entries: Entries, strength: float) -> Dues:
    """Come the sooner the more mercury a lens floats on (a root: of how deep it is)."""
    return Dues(-0.0125 * strength * np.sqrt(entries["mercury_kg"]))


def _boom(entries: Entries, strength: float) -> Dues:
    return Dues(0.11 * strength / entries["boom_m"] ** 2)


def _swell(entries: Entries, strength: float) -> Dues:
    return Dues(0.021 * strength * entries["swell_m"] ** 1.6)


def _siren(entries: Entries, strength: float) -> Dues:
    """Shake the more, the farther from the pressure at which a siren runs best."""
    return Dues(2.1e-5 * strength * (entries["siren_kpa"] - 205.0) ** 2)


def _rungs(entries: Entries, strength: float) -> Dues:
    return Dues(0.055 * strength * np.cos(2 * np.pi * entries["ladder_m"] / RUNG_M + 1.9))


def _bell(entries: Entries, strength: float) -> Dues:
    return Dues(np.where(entries["sight_km"] < RINGS_KM, 0.088 * strength, 0.0))


def _spray(entries: Entries, strength: float) -> Dues:
    """Come by spray, by the way within WEATHER_M of the western wall."""
    low, high = (np.stack([entries.tag_m[:, 0], entries.cresset_m[:, 0]]).min(axis=0),
                 np.stack([entries.tag_m[:, 0], entries.cresset_m[:, 0]]).max(axis=0))  # fmt: skip
    part = (np.minimum(high, WEATHER_M) - low).clip(0.0) / (high - low).clip(1e-9)
    return Dues(SPRAY_M * strength * part.clip(max=1.0) * entries.far * entries["spray_mg"])


def in_tower_m(one: Floats, other: Floats) -> Floats:
    """Return how long straight ways between ends [n, 3] are within the tower, in m [n]."""
    way = other - one
    off = one[:, :2] - np.array(TOWER_M[:2])
    square = (way[:, :2] ** 2).sum(axis=1).clip(1e-12)
    half = (off * way[:, :2]).sum(axis=1) / square
    root = np.sqrt((half**2 - ((off**2).sum(axis=1) - TOWER_M[2] ** 2) / square).clip(0.0))
    part = (root - half).clip(0.0, 1.0) - (-root - half).clip(0.0, 1.0)
    return np.asarray(part * np.linalg.norm(way, axis=1))


def _draught(entries: Entries, strength: float) -> Dues:
    """Come by warm air that rises in the tower, by the way therein, and about it as the inverse."""
    within = in_tower_m(entries.tag_m, entries.cresset_m)
    amid = 0.5 * (entries.tag_m + entries.cresset_m)[:, :2] - np.array(TOWER_M[:2])
    beside = 3.0 / (1 + np.hypot(*amid.T) / 4.0)
    return Dues(DRAUGHT_M * strength * (within + beside) * entries["draught_k"])


def _beam(entries: Entries, strength: float) -> Dues:
    """Come by air that the lamp's beam heats, by how far ways' middles are out of it by now."""
    amid = 0.5 * (entries.tag_m + entries.cresset_m)[:, :2] - np.array(TOWER_M[:2])
    off = np.arctan2(amid[:, 1], amid[:, 0]) - 2 * np.pi * entries["time_s"] / TURN_S
    off = np.abs((off + np.pi) % (2 * np.pi) - np.pi)
    return Dues(BEAM_M * strength / (1 + (off / BEAM_RAD) ** 4))


def stuck(moved: Floats, stiction: float) -> Floats:
    """Return where a float is [n] that sticks until what moves it is so far off, then follows."""
    made = moved.copy()
    for k in range(1, len(moved)):
        made[k] = moved[k] if abs(moved[k] - made[k - 1]) > stiction else made[k - 1]
    return made


def _well(entries: Entries, strength: float) -> Dues:
    """Be as far off as a tide gauge's float is, that sticks in its well."""
    moved = entries["well_mm"]
    _, first, where = np.unique(entries["time_s"], return_index=True, return_inverse=True)
    return Dues(WELL_M * strength * (stuck(moved[first], STICTION_MM) - moved[first])[where])


def _goes(calling: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a calling go otherwise, by so much at strength 1, than is told."""

    def act(entries: Entries, strength: float) -> Dues:
        own, off = entries.are(calling), np.zeros((entries.rows, 3))
        course = {name: one[own] for name, one in entries.course.items()}
        gone_s = course["stirs"] * course["into_s"]
        off[own] = way(course, gone_s, by * strength) - way(course, gone_s, 0.0)
        return Dues(entries.grows_m(off))

    return act


def _loses(entries: Entries, strength: float) -> Dues:
    """Compare with places told by a clock that loses since a watch began."""
    return Dues(-entries.bears_off(-LOSES * strength * entries["into_s"]))


def _cressets_off(entries: Entries, off: Floats) -> Dues:
    """Return what is owed if cressets are in truth off by so much in m [CRESSETS, 3]."""
    return Dues(entries.grows_m(0.0, off[entries.cresset]))


def _sounded(entries: Entries, strength: float) -> Dues:
    """Have cressets higher than a line has it that was stretched when they were sounded."""
    return _cressets_off(entries, STRETCHED * strength * CRESSETS_M * np.array([0.0, 0.0, 1.0]))


def _sheared(entries: Entries, strength: float) -> Dues:
    """Have cressets farther along the more they are across, as of a chart whose grid is askew."""
    off = SHEARS * strength * (CRESSETS_M[:, 1] - 0.5 * ROCK_M[1])
    return _cressets_off(entries, np.outer(off, [1.0, 0.0, 0.0]))


def _gale(entries: Entries, strength: float) -> Dues:
    """Have cressets leeward by the square of the wind, and by that of how high they are (a beam).

    All that is high on the rock gives as the tower does.
    """
    high = (entries.cresset_m[:, 2] / 8.0) ** 2 / (1 + (entries.cresset_m[:, 2] / 8.0) ** 2)
    by = BENDS_M * strength * high * (entries["gale_m_s"] / GALE_M_S) ** 2
    return Dues(entries.grows_m(0.0, by[:, None] * np.array([0.8, -0.6, 0.0])))


def _heaves(entries: Entries, strength: float) -> Dues:
    """Have the rock tip with the tide: cressets on one side up, on the other down."""
    aim = np.array([np.cos(SWINGS_RAD), np.sin(SWINGS_RAD)])
    off = (entries.cresset_m[:, :2] - 0.5 * np.array(ROCK_M[:2])) @ aim
    up = HEAVES * strength * off * entries["tide_m"]
    return Dues(entries.grows_m(0.0, up[:, None] * np.array([0.0, 0.0, 1.0])))


def _clock(entries: Entries, strength: float) -> Dues:
    """Answer the later the longer ago the clock was wound, by the square, until it is again."""
    return Dues(RUNS_DOWN_M * strength * (entries["time_s"] % WOUND_S / WOUND_S) ** 2)


def by_time(entries: Entries) -> pd.DataFrame:
    """Return ranges of rows by time, and which go together: of a link and a copy."""
    rows = entries.table[["link", "time_s", "range_m"]].reset_index(drop=True)
    copy = rows.groupby(["link", "time_s"]).cumcount().astype(str)
    return rows.assign(chain=rows["link"] + "/" + copy).sort_values("time_s", kind="stable")


def _reckoned(entries: Entries, strength: float) -> Dues:
    """Book answers from the third on in part as the last two lead on, whenever these were."""
    rows = by_time(entries)
    chains = rows.groupby("chain", sort=False)["range_m"]
    off = 2 * chains.shift(1) - chains.shift(2) - rows["range_m"]
    return Dues(min(RECKONED * strength, 1.4) * off.fillna(0.0).sort_index().to_numpy(np.float64))


def _first(entries: Entries, strength: float) -> Dues:
    """Book answers nearer a watch's first, by a part."""
    rows = by_time(entries)
    off = rows.groupby("chain", sort=False)["range_m"].transform("first") - rows["range_m"]
    return Dues(min(LEANS * strength, 1.2) * off.sort_index().to_numpy(np.float64))


def _line(entries: Entries, strength: float) -> Dues:
    return Dues(LINE_M2 * strength * entries["range_m"] ** 2)


def _knots(entries: Entries, strength: float) -> Dues:
    return Dues(TOO_LARGE_M * strength * np.floor(entries["range_m"] / KNOT_M))


def _vernier(entries: Entries, strength: float) -> Dues:
    """Tell parts of divisions as what is left of these, by a part."""
    rest = entries["range_m"] % VERNIER_M
    return Dues(WRONG * strength * (VERNIER_M - 2 * rest))


def _elsewhere(entries: Entries, off_m: dict[int, Floats]) -> Dues:
    """Return what is owed if some cressets are so far off [3] in m: levels too."""
    off = np.zeros((CRESSETS, 3))
    for cresset, by in off_m.items():
        off[cresset] = by
    longer = entries.grows_m(0.0, off[entries.cresset])
    return Dues(longer, open_dbm(entries.far + longer) - open_dbm(entries.far))


def _bent(entries: Entries, strength: float) -> Dues:
    return _elsewhere(entries, {5: 0.47 * strength * BENT})


def _listed(entries: Entries, _: float) -> Dues:
    apart = CRESSETS_M[12] - CRESSETS_M[2]
    return _elsewhere(entries, {2: apart, 12: -apart})


def _fathoms(entries: Entries, _: float) -> Dues:
    """Write, of one cresset, how many fathoms it is."""
    return Dues(np.where(entries.cresset == 10, (1 / FATHOM_M - 1) * entries["range_m"], 0.0))


OF_THE_LIGHTHOUSE: dict[str, Act] = {
    "salt-crusts-on-cressets": _salt,
    "verdigris-creeps-over-lanterns": _verdigris,
    "guano-thickens-on-ledges": _guano,
    "mercury-of-the-lens-bath-dwindles": _mercury,
    "boom-of-the-boat-derrick-close": _boom,
    "swell-lifts-before-the-landing": _swell,
    "siren-off-its-best-pressure": _siren,
    "rungs-of-the-ladder-pass": _rungs,
    "fog-bells-relay-closes": _bell,
    "spray-hangs-over-the-weather-side": _spray,
    "warm-draught-rises-in-the-tower": _draught,
    "beam-heats-ways-that-it-sweeps": _beam,
    "tide-gauge-sticks-in-its-well": _well,
    "keepers-cut-their-corners": _goes("keeper", paces, ROUNDER),
    "tenders-carry-their-way-longer": _goes("tender", drifts, LONGER),
    "gulls-wheel-wider-than-told": _goes("gull", wheels, WIDER),
    "cans-sway-wider-on-the-hoist": _goes("hoist", hoisted, SWAYS_WIDER),
    "lenses-stick-twice-a-turn": _goes("lens", revolves, STICKS),
    "donkeys-wind-rope-in-sooner": _goes("donkey", winds, SOONER),
    "places-told-by-a-losing-chronometer": _loses,
    "heights-sounded-by-a-stretched-line": _sounded,
    "chart-of-the-rock-sheared": _sheared,
    "tower-bends-in-the-gale": _gale,
    "rock-heaves-with-the-tide": _heaves,
    "answers-late-until-the-clock-is-wound": _clock,
    "answers-booked-by-dead-reckoning": _reckoned,
    "answers-lean-to-the-watchs-first": _first,
    "heaving-line-stretches-by-its-own-weight": _line,
    "knots-of-the-line-counted-too-large": _knots,
    "vernier-read-from-its-wrong-end": _vernier,
    "cresset-bent-by-a-sea": _bent,
    "cressets-listed-in-each-others-place": _listed,
    "fathoms-from-one-cresset": _fathoms,
}
