"""Laws and faults of the set-up that the ropewalk hides, which no library has.

numpy alone; shared by the ropewalk's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.ropewalk_walk import (
    ANNEXE,
    HALL_M,
    LOW_STEAM_BAR,
    NORTH,
    STRUTS,
    STRUTS_M,
    TRESTLE_M,
    ZHANG_M,
    Course,
    Due,
    Hank,
    drawn_in,
    laid,
    spun,
    wheeled,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
AT_A_METRE_DBM, FALLS, ROUND_M = -58.4, 9.5, 0.7  # of levels; a decade of distance's square
DUSTY, DUST_M = 0.0042, 17.0  # m a m for each g/m3 at the hackles; e times less by so many m
TAKES, HARDER, LONGER, GEARED = 0.032, 0.18, 0.3, 0.22  # each m; parts
BEAT_S = 0.5
BOWS_M, DEEP_CM = 0.45, 45.0  # of walls, amid the hall, with so much snow
ASKEW_RAD, HINGE_M = 0.052, (66.0, 0.0)  # of the annexe, about a corner
FACES_M = 0.46  # from the outer face of the north wall to the inner
BOOKED, MOST = 0.11, 0.3  # of answers, at strength 1, and at most


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - FALLS * np.log10(far**2 + ROUND_M**2))


def _tar(hank: Hank, strength: float) -> Due:
    """Come through tar on covers, of which the last does little: by an exponential."""
    return Due(-0.2 * strength * np.expm1(-hank["tar_g"] / 6.5))


def _twist(hank: Hank, strength: float) -> Due:
    """Come through strands over tags, which twist makes closer: by a power."""
    return Due(0.16 * strength * (hank["twist_rpm"] / 240.0) ** 1.7)


def _copper(hank: Hank, strength: float) -> Due:
    """Come past the copper, the later the closer it is swung."""
    return Due(0.13 * strength / hank["copper_gap_m"])


def _oakum(hank: Hank, strength: float) -> Due:
    """Come through oakum, so much for each bale."""
    return Due(0.0115 * strength * hank["oakum_bales"])


def _oil(hank: Hank, strength: float) -> Due:
    """Come later the longer ago hemp was dressed, as oil creeps: by a logarithm."""
    return Due(0.044 * strength * np.log1p(hank["dressed_h"] / 0.4))


def _trestles(hank: Hank, strength: float) -> Due:
    """Read long and short as yarn goes over trestles."""
    return Due(0.062 * strength * np.cos(2 * np.pi * hank["spun_m"] / TRESTLE_M - 0.7))


def _belt(hank: Hank, strength: float) -> Due:
    """Read longer while the engine's steam is low, when cells feed struts."""
    return Due(np.where(hank["steam_bar"] < LOW_STEAM_BAR, 0.102 * strength, 0.0))


def dust_m(one: Floats, other: Floats) -> Floats:
    """Return a way's length in m by how dusty it is, from places in m along the hall [n].

    As a part of the way along, so that ways across have all that there is of it.
    """
    least, long = np.minimum(one, other), np.abs(one - other).clip(1e-6)
    return np.asarray(-np.exp(-least / DUST_M) * np.expm1(-long / DUST_M) * DUST_M / long)


def _dust(hank: Hank, strength: float) -> Due:
    """Come by dust, which hangs in the west and is ever less along the hall."""
    part = dust_m(hank.strut_m[:, 0], hank.tag_m[:, 0])
    return Due(DUSTY * strength * hank["dust_g_m3"] * part * hank.far)


def _goes(hank: Hank, kind: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Due:
    """Return what rows owe of which tags of a kind go otherwise, by so much, than is told."""
    own = hank.of(kind)
    course = {name: one[own] for name, one in hank.course.items()}
    gone_s = course["goes"] * course["into_s"]
    off = np.zeros((hank.rows, 3))
    off[own] = way(course, gone_s, by) - way(course, gone_s, 0.0)
    return Due(hank.more_m(0.0, off))


def _taken_up(hank: Hank, strength: float) -> Due:
    """Have spinners come less far, of whom is told how much they drew."""
    return _goes(hank, "spinner", spun, TAKES * strength)


def _hardens(hank: Hank, strength: float) -> Due:
    """Have sledges drawn in sooner."""
    return _goes(hank, "sledge", drawn_in, HARDER * strength)


def _long_laid(hank: Hank, strength: float) -> Due:
    """Have tops' tags turn less on their way."""
    return _goes(hank, "top", laid, LONGER * strength)


def _geared(hank: Hank, strength: float) -> Due:
    """Have bobbins' cradles turn more often."""
    return _goes(hank, "bobbin", wheeled, GEARED * strength)


def _beats(hank: Hank, strength: float) -> Due:
    """Compare with places of the nearest beat, which is over or still to come."""
    over_s = (hank["time_s"] + 0.5 * BEAT_S) % BEAT_S - 0.5 * BEAT_S
    return Due(hank.pays_out(strength * over_s))


def _bows(hank: Hank, strength: float) -> Due:
    """Have the walls bow out under snow, amid the hall the most, and struts with them."""
    arch = np.sin(np.pi * hank.strut_m[:, 0] / HALL_M[0])
    side = np.tanh(2 * (hank.strut_m[:, 1] - 0.5 * HALL_M[1]))
    out = BOWS_M * strength * arch * side * hank["snow_cm"] / DEEP_CM
    return Due(hank.more_m(out[:, None] * np.array([0.0, 1.0, 0.0])))


def turned_m(at: Floats, by: float) -> Floats:
    """Return by how much places [n, 3] are off once turned about HINGE_M by radians [n, 3]."""
    east, north = (at[:, :2] - HINGE_M).T
    cosine, sine = np.cos(by) - 1, np.sin(by)
    return np.column_stack([east * cosine - north * sine, east * sine + north * cosine, 0 * east])


def _askew(hank: Hank, strength: float) -> Due:
    """Have struts of the annexe be where it was rebuilt, and not where they were surveyed."""
    own = hank.at(ANNEXE)[:, None]
    return Due(hank.more_m(own * turned_m(hank.strut_m, ASKEW_RAD * strength)))


def _outer_face(hank: Hank, strength: float) -> Due:
    """Have the north row stand further in, by how thick the wall is."""
    own = hank.at(NORTH)[:, None]
    return Due(hank.more_m(own * np.array([0.0, -FACES_M * strength, 0.0])))


def before(hank: Hank) -> Integers:
    """Return the row that was answered before on each row's strand, or it itself [n].

    Rows of a table that is told some times over have their own kind before them.
    """
    rows = hank.table[["link", "time_s"]].reset_index(drop=True)
    strand = rows["link"].str.extract(r"(\d+)")[0]
    telling = rows.groupby(["link", "time_s"], sort=False).cumcount()
    number = rows.index.to_series().astype(np.float64)
    last = number.groupby([strand, telling], sort=False).shift(1)
    return np.asarray(last.fillna(number)).astype(np.int64)


def _booked(hank: Hank, strength: float) -> Due:
    """Book, of some answers, the one before of the strand, whoever called for it."""
    late = hank.rng.random(hank.rows) < min(BOOKED * strength, MOST)
    ranges = hank["range_m"]
    return Due(np.where(late, ranges[before(hank)] - ranges, 0.0))


def _stand(hank: Hank, off_m: dict[int, Floats]) -> Due:
    """Return what rows owe of which some struts stand so far off in truth [3], in m."""
    every = np.zeros((STRUTS, 3))
    every[list(off_m)] = list(off_m.values())
    more = hank.more_m(every[hank.strut])
    return Due(more, dim_db=open_dbm(hank.far + more) - open_dbm(hank.far))


def _shoved(hank: Hank, strength: float) -> Due:
    return _stand(hank, {6: 0.53 * strength * np.array([6.0, 2.0, -3.0]) / 7.0})


def _chalked(hank: Hank, _: float) -> Due:
    apart = STRUTS_M[9] - STRUTS_M[3]
    return _stand(hank, {3: apart, 9: -apart})


def _zhang(hank: Hank, _: float) -> Due:
    """Write, of one strut, how many zhang it is."""
    return Due((1 / ZHANG_M - 1) * hank["range_m"] * hank.at((11,)))


UNLISTED: dict[str, Callable[[Hank, float], Due]] = {
    "tar-clings-to-covers": _tar,
    "twist-stiffens-strands-over-tags": _twist,
    "copper-swung-close-by": _copper,
    "oakum-bales-stacked-before": _oakum,
    "oil-creeps-since-hemp-was-dressed": _oil,
    "trestles-pass-underneath": _trestles,
    "belt-thrown-off-at-low-steam": _belt,
    "hemp-dust-hangs-by-the-hackles": _dust,
    "yarn-taken-up-as-it-twists": _taken_up,
    "strands-harden-and-draw-sledges-sooner": _hardens,
    "rope-laid-longer-than-told": _long_laid,
    "cradles-geared-by-another-wheel": _geared,
    "places-looked-up-at-nearest-beats": _beats,
    "walls-bow-out-under-snow": _bows,
    "annexe-rebuilt-askew-since-the-survey": _askew,
    "north-row-taped-from-the-outer-face": _outer_face,
    "answers-booked-to-who-answers-next": _booked,
    "strut-shoved-by-a-bale-truck": _shoved,
    "struts-chalked-with-each-others-numbers": _chalked,
    "zhang-from-one-strut": _zhang,
}
