"""Laws and faults of the set-up that the shipyard hides, which no library has.

numpy alone; shared by the shipyard's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.shipyard_slip import (
    AFLOAT,
    AFLOAT_M,
    DERRICKS,
    DERRICKS_M,
    ON_DECK,
    RIB_M,
    SPAN_M,
    Berth,
    Course,
    Toll,
    rolled_on,
    run_down,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, FOLD_DB, WITHIN_M = -60.5, 8.45, 0.5  # of levels: the second for each e of distance
STIFF, THINNER = 0.24, 0.14  # parts: of cradles' speed, of drums
LEEWAY: Floats = np.array([0.1, 0.16, 0.0])  # m/s, down the wind
MIST, RIDES, MEAN_TIDE_M = 0.0062, 0.35, 2.7  # of ways in mist; of the tide; that plans are for
LISTS_RAD, LADEN_T, KEEL_M = 0.024, 64.0, (19.0, 1.5)  # with so much aside; north and up
RAKE, AMIDSHIPS_M = 1 / 36, 33.0  # of the keel, about which heights are right
SENT, MOST = 0.45, 0.9  # of answers, at strength 1, and at most


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]: no more than so much close by."""
    return np.asarray(AT_A_METRE_DB - FOLD_DB * np.log(far + WITHIN_M))


def _salt(berth: Berth, strength: float) -> Toll:
    """Come through salt, of which covers hold so much: as mass grows with speed, to an end."""
    salt = berth["salt_g"]
    return Toll(0.19 * strength * salt / np.sqrt(salt**2 + 5.0**2))


def _weed(berth: Berth, strength: float) -> Toll:
    """Come through weed on fenders, whose first fingers' breadths do the most: by a power."""
    return Toll(0.165 * strength * (berth["weed_cm"] / 20.0) ** 0.55)


def _anvil(berth: Berth, strength: float) -> Toll:
    """Come past an anvil, the later the closer: by a power of how close, three halves of one."""
    return Toll(0.125 * strength * berth["anvil_gap_m"] ** -1.5)


def _caulking(berth: Berth, strength: float) -> Toll:
    """Come the sooner the longer ago caulking was wetted: by a logarithm."""
    return Toll(-0.047 * strength * np.log1p(berth["wetted_h"] / 0.45))


def _shackles(berth: Berth, strength: float) -> Toll:
    """Come past shackles, so much for each of these."""
    return Toll(0.0098 * strength * berth["shackles"])


def _ribs(berth: Berth, strength: float) -> Toll:
    """Read long and short as a crane passes ribs of the hull."""
    return Toll(0.06 * strength * np.sin(2 * np.pi * berth["keel_m"] / RIB_M + 0.4))


def _caisson(berth: Berth, strength: float) -> Toll:
    """Read longer while the caisson floats, whose pumps then run on the derricks' cells."""
    return Toll(np.where(berth["draught_m"] > AFLOAT_M, 0.098 * strength, 0.0))


def in_mist(low: Floats, high: Floats, mist: Floats) -> Floats:
    """Return what part of ways is below a height in m, by ends' heights in any order [n]."""
    least, most = np.minimum(low, high), np.maximum(low, high)
    return np.asarray(((mist - least) / (most - least).clip(1e-6)).clip(0.0, 1.0))


def _mist(berth: Berth, strength: float) -> Toll:
    """Come by what of the way is in mist, which lies on the water up to a height."""
    part = in_mist(berth.tag_m[:, 2], berth.top_m[:, 2], berth["fog_m"])
    return Toll(MIST * strength * part * berth.far)


def _otherwise(
    berth: Berth, kind: str, way: Callable[[Course, Floats, float], Floats], by: float
) -> Toll:
    """Return what rows pay of which tags of a kind go otherwise by a part than is told."""
    own = np.flatnonzero(berth.of(kind))
    course = {name: one[own] for name, one in berth.course.items()}
    gone_s = course["goes"] * course["into_s"]
    off = np.zeros((berth.rows, 3))
    off[own] = way(course, gone_s, by) - way(course, gone_s, 0.0)
    return Toll(berth.longer(off))


def _stiffens(berth: Berth, strength: float) -> Toll:
    """Have cradles come to a lesser speed, as grease stiffens."""
    return _otherwise(berth, "cradle", run_down, STIFF * strength)


def _thinner(berth: Berth, strength: float) -> Toll:
    """Have drums turn more on their way, as they roll on flanges that are worn."""
    return _otherwise(berth, "drum", rolled_on, THINNER * strength)


def _leeway(berth: Berth, strength: float) -> Toll:
    """Have punts go down the wind meanwhile, all alike."""
    gone_s = berth.course["goes"] * berth.course["into_s"] * berth.of("punt")
    return Toll(berth.longer(strength * gone_s[:, None] * LEEWAY))


def _rides(berth: Berth, strength: float) -> Toll:
    """Have the pontoon ride up and down with the tide, and its derricks."""
    up = RIDES * strength * (berth["tide_m"] - MEAN_TIDE_M) * berth.on(AFLOAT)
    return Toll(berth.longer(0.0, up[:, None] * np.array([0.0, 0.0, 1.0])))


def listed_m(at: Floats, turn: Floats) -> Floats:
    """Return by how much places [n, 3] are off once the hull has turned about its keel [n, 3]."""
    aside, high = at[:, 1] - KEEL_M[0], at[:, 2] - KEEL_M[1]
    cosine, sine = np.cos(turn), np.sin(turn)
    return np.column_stack([0 * turn, aside * (cosine - 1) - high * sine,
                            aside * sine + high * (cosine - 1)])  # fmt: skip


def _lists(berth: Berth, strength: float) -> Toll:
    """Have the hull list as ballast lies to one side, and derricks on its deck with it."""
    turn = LISTS_RAD * strength * berth["ballast_t"] / LADEN_T * berth.on(ON_DECK)
    return Toll(berth.longer(0.0, listed_m(berth.top_m, turn)))


def _raking(berth: Berth, strength: float) -> Toll:
    """Have heights of derricks told above a keel that rakes, as if it lay level."""
    up = RAKE * strength * (berth.top_m[:, 0] - AMIDSHIPS_M)
    return Toll(berth.longer(0.0, up[:, None] * np.array([0.0, 0.0, 1.0])))


def middles(berth: Berth) -> Floats:
    """Return the middle one of each range and the two before it of its link, in m [n].

    Of first and second ones these themselves. Rows of a table that is told some times over have
    their own kind before them.
    """
    rows = berth.table
    telling = rows.groupby(["link", "time_s"], sort=False).cumcount()
    ranges = rows.groupby([rows["link"], telling], sort=False)["range_m"]
    three = np.column_stack([rows["range_m"], ranges.shift(1), ranges.shift(2)])
    return np.where(np.isnan(three).any(axis=1), three[:, 0], np.median(three, axis=1))


def _medians(berth: Berth, strength: float) -> Toll:
    """Send, of some answers, the middle one of three."""
    sent = berth.rng.random(berth.rows) < min(SENT * strength, MOST)
    return Toll(sent * (middles(berth) - berth["range_m"]))


def _stand_off(berth: Berth, off_m: dict[int, Floats]) -> Toll:
    """Return what rows pay of which some derricks stand so far off in truth [3], in m."""
    every = np.zeros((DERRICKS, 3))
    for derrick, off in off_m.items():
        every[derrick] = off
    more = berth.longer(0.0, every[berth.derrick])
    return Toll(more, dim_db=open_dbm(berth.far + more) - open_dbm(berth.far))


def _nudged(berth: Berth, strength: float) -> Toll:
    return _stand_off(berth, {4: 0.51 * strength * np.array([-4.0, 7.0, -4.0]) / 9.0})


def _signals(berth: Berth, _: float) -> Toll:
    apart = DERRICKS_M[5] - DERRICKS_M[1]
    return _stand_off(berth, {1: apart, 5: -apart})


def _spans(berth: Berth, _: float) -> Toll:
    """Write, of one derrick, how many hands' spans it is."""
    return Toll((1 / SPAN_M - 1) * berth["range_m"] * berth.on((2,)))


UNLISTED: dict[str, Callable[[Berth, float], Toll]] = {
    "salt-crusts-on-covers": _salt,
    "weed-grows-on-fenders": _weed,
    "anvil-dragged-close-by": _anvil,
    "caulking-dries-since-wetted": _caulking,
    "shackles-heaped-beside": _shackles,
    "ribs-of-the-hull-pass": _ribs,
    "caisson-floats-at-a-draught": _caisson,
    "mist-lies-up-to-a-height": _mist,
    "grease-stiffens-on-the-ways": _stiffens,
    "drums-roll-on-thinner-flanges": _thinner,
    "punts-make-leeway": _leeway,
    "pontoon-rides-the-tide": _rides,
    "hull-lists-with-its-ballast": _lists,
    "heights-told-above-a-raking-keel": _raking,
    "medians-of-three-sent": _medians,
    "derrick-nudged-by-a-bowsprit": _nudged,
    "derricks-given-each-others-signals": _signals,
    "spans-from-one-derrick": _spans,
}
