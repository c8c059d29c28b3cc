"""What the ship lock hides in ranges and levels: effects in forms of its own.

numpy alone; shared by the lock's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.canal_chamber import (
    DAVITS,
    DAVITS_M,
    PER_PPM_M,
    TAGS,
    WAVE_M,
    Passage,
    Toll,
)
from bench.challenge.families.canal_faults import UNLISTED
from bench.challenge.families.canal_staff import FINE, HALF_AHEAD, METRES, WITHIN, half_come, spline

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
UNSEEN = {False: 0.2, True: 0.075}  # of links, and where these are rare
FIXES, FIX_S, KEEPS = 5, 0.052, 0.5  # that are smoothed; how far apart; what each keeps of the last
CURTIS = ((1 / 30, 0.0), (4 / 15, 0.5 - 0.125**0.5), (2 / 5, 0.5), (4 / 15, 0.5 + 0.125**0.5),
          (1 / 30, 1.0))  # fmt: skip
"""Weights of five places of an exchange, and where in it they are."""
CABINETS_M: Floats = np.array([14.0, 44.0])  # along the lock
SHORT, BATCHES_M = 0.0043, (0.0, 0.06, 0.15)  # of a metre of cable, not taken off; of tags
TURNS_C, BENDS = 24.0, 0.0011  # of tuning forks: where they turn; how much of 1/C2 stays
WARMS, COLD_C, READ_C = 36.0, 95.0, 18.0  # m C; below zero; at which it was calibrated
SHADE_DEG = 38.0  # until e times less
LOUDEST_DBM, SPAN_DB = -68.0, 30.0  # between which and how far below it biases turn over
TICK_M, ODDS = 0.041, (0.2, 0.6, 0.2)  # of a coarse clock; of one early, none, and one late
WORDS_M = (0.11, 0.17)  # steps of davits of the south and of the north
DIVIDERS = (0.0036, 0.0066, 0.0096)  # by how much tags' clocks are slow
PLANES: tuple[tuple[int, float], ...] = (
    (0, 4.0), (0, 52.5), (0, 60.0), (1, -5.5), (1, 14.5), (2, 11.9),
)  # fmt: skip
"""Gates, a bridge's pier, sheds, and a gantry's deck over all: axis and where, in m."""
WATER, STONE = 67.0 - 32.0j, 6.1 - 0.4j  # permittivities at 8 GHz
PUMPS_M: Floats = np.array([(31.0, -6.0), (1.0, 13.0)])


def _smoothed(passage: Passage, strength: float) -> Toll:
    """Compare with fixes that are smoothed: each is a part of itself, else what was before."""
    kept = KEEPS ** np.arange(FIXES)
    parts = [passage.onward_by(strength * FIX_S * (k + 0.6)) for k in range(FIXES)]
    return {"m": np.average(parts, axis=0, weights=kept)}


def _curtis(passage: Passage, strength: float) -> Toll:
    """Give the mean of the way over an exchange, by Clenshaw's and Curtis' rule (1960)."""
    whole_s = 2.2 * strength * passage.of("reply_time_s")
    weights, places = np.array(CURTIS).T
    return {"m": weights @ np.stack([passage.onward_by(at * whole_s) for at in places])}


def _cabled(passage: Passage, strength: float) -> Toll:
    """Be late by cables from the nearer cabinet, and by the batch that tags are of."""
    drawn = passage.same(1)
    cable = np.abs(DAVITS_M[:, :1] - CABINETS_M).min(axis=1) + DAVITS_M[:, 2]
    batch = np.array(BATCHES_M)[drawn.permutation(np.arange(len(TAGS)) % len(BATCHES_M))]
    own = SHORT * cable + drawn.exponential(0.018, DAVITS).clip(max=0.08)
    return {"m": strength * (own[passage.davit] + batch[passage.tag])}


def _forks(passage: Passage, strength: float) -> Toll:
    """Leave some of crystals' offset, of tags' by a parabola of warmth, as tuning forks have it."""
    drawn = passage.same(2)
    davits = drawn.laplace(0.0, 0.5, DAVITS).clip(-1.4, 1.4)[passage.davit]
    tags = drawn.uniform(-1.2, 1.4, len(TAGS))[passage.tag]
    tags = tags - BENDS * (passage.of("temperature_c") - TURNS_C) ** 2
    ppm = 0.017 * strength * (tags - davits)
    return {"m": PER_PPM_M * ppm * passage.of("reply_time_s")}


def _curie(passage: Passage, strength: float) -> Toll:
    """Drift as ceramics do, the less the warmer: by Curie's and Weiss' law (1907)."""
    warm = passage.of("temperature_c") + COLD_C
    return {"m": WARMS * strength * (1 / warm - 1 / (READ_C + COLD_C))}


def _cusp(passage: Passage, strength: float) -> Toll:
    """Be late and weak behind a mast: by e the less, each so many degrees off it."""
    off = passage.of("azimuth_deg") - passage.same(3).uniform(0.0, 360.0)
    shade = np.exp(-np.abs((off + 180.0) % 360.0 - 180.0) / SHADE_DEG)
    late = strength * (0.19 * shade - 0.19 * SHADE_DEG / 180.0)
    return {"m": late, "first": -5.5 * min(strength, 1.5) * shade}


def _fifth(passage: Passage, strength: float) -> Toll:
    """Be early where it is loud, late where it is weak: by a fifth power level at both ends."""
    part = ((LOUDEST_DBM - passage.of("rx_power_dbm")) / SPAN_DB).clip(0.0, 1.0)
    over = part**3 * (part * (6.0 * part - 15.0) + 10.0)
    return {"m": strength * (0.188 * over - 0.108)}


def _ticks(passage: Passage, strength: float) -> Toll:
    """Scatter by a bell and, now and then, by a tick of a coarse clock too many or too few."""
    ticks = passage.rng.choice([-1.0, 0.0, 1.0], len(passage.far), p=ODDS)
    bell = passage.rng.normal(0.0, 0.021, len(passage.far)).clip(-0.075, 0.075)
    return {"m": strength * (TICK_M * ticks + bell)}


def _root(passage: Passage, strength: float) -> Toll:
    """Lose by the root of the way, as where vapour drifts in shreds; more on some links."""
    thick = passage.each(lambda n: passage.rng.gamma(9.0, 1 / 9, n))
    return {"all": -1.4 * strength * thick * np.sqrt(passage.far)}


def _divided(passage: Passage, strength: float) -> Toll:
    """Count by tags' clocks that are slow, by one of three dividers."""
    slow = np.array(DIVIDERS)[passage.same(5).permutation(np.arange(len(TAGS)) % 3)]
    return {"m": strength * slow[passage.tag] * passage.far}


def _words(passage: Passage, strength: float) -> Toll:
    """Write whole steps, which davits of either side have of their own length."""
    step = strength * np.where(DAVITS_M[:, 1] < 0.0, *WORDS_M)[passage.davit]
    told = passage.of("range_m")
    return {"m": step * np.rint(told / step) - told}


def mixed(dense: tuple[float, ...], parts: tuple[Floats, ...]) -> Floats:
    """Return permittivities of what is mixed of parts [n]: logarithms add up (Lichtenecker)."""
    return np.asarray(np.exp(np.tensordot(np.log(dense), np.stack(parts), 1)))


def slabs_m(thick: Floats, dense: Floats | float, sine: Floats) -> Floats:
    """Return how much later it is behind slabs that are met aslant, in m [n]."""
    return np.asarray(thick * (np.sqrt(dense - sine**2) - np.sqrt(1 - sine**2)))


def _through(passage: Passage, strength: float) -> Toll:
    """Go through wet timber, edges of copings aslant, hatches and panes."""
    each, drawn = passage.each, passage.rng
    wet = each(lambda n: drawn.beta(2.0, 12.0, n))
    timber = mixed((1.99, 60.0), (1 - wet, wet))
    sine = each(lambda n: drawn.uniform(0.0, 0.8, n))
    thick: dict[str, Floats] = {
        "wood": each(lambda n: drawn.gamma(5.0, 0.033, n).clip(0.05, 0.3)),
        "concrete": each(lambda n: drawn.triangular(0.04, 0.13, 0.27, n)),
        "plywood": each(lambda n: drawn.uniform(0.018, 0.06, n)),
        "glass": each(lambda n: drawn.choice([0.006, 0.01, 0.022], n)),
    }
    dense: dict[str, Floats | float] = {
        "wood": timber,
        "concrete": 5.24,
        "plywood": 2.71,
        "glass": 6.31,
    }
    per_m: dict[str, Floats | float] = {
        "wood": 9.0 + 60.0 * wet,
        "concrete": 24.0,
        "plywood": 36.0,
        "glass": 40.0,
    }
    late, lost = np.zeros((2, len(sine)))
    for what, deep in thick.items():
        met = passage.cross(what)
        late += met * slabs_m(deep, dense[what], sine)
        lost += met * (0.8 + per_m[what] * deep)
    return {"m": strength * late, "first": -min(strength, 1.5) * lost}


def by_planes(passage: Passage) -> Floats:
    """Return how much longer the shortest way by a plane is in m [n], of ways that come apart."""
    found = np.full(len(passage.far), np.inf)
    for axis, plane_m in PLANES:
        off = [one[:, axis] - plane_m for one in (passage.afloat, passage.ashore)]
        more = np.sqrt(passage.far**2 + 4 * off[0] * off[1]) - passage.far
        found = np.where((off[0] * off[1] > 0) & (more > 0.45), np.minimum(found, more), found)
    return found


def _by_a_plane(passage: Passage, strength: float) -> Toll:
    """Hear, out of sight, nothing but what the best placed of gates and walls returns."""
    hidden = passage.shut_off(UNSEEN[passage.rare])
    late = by_planes(passage).clip(max=4.6) * (0.44 + 0.56 * strength)
    return {"m": hidden * late, "all": -1.4 * hidden, "first": -4.3 * hidden}


def unruffled(heave: Floats, down: Floats) -> Floats:
    """Return what is left of what a rough floor returns [n] (Boithias 1987, as in ITU-R P.1812).

    `heave`: how its height scatters, in m; `down`: the sine of how steeply waves come down.
    """
    rough = 0.5 * (4 * np.pi * heave * down / WAVE_M) ** 2
    return np.asarray(1 / np.sqrt(3.2 * rough - 2 + np.sqrt((3.2 * rough) ** 2 - 7 * rough + 9)))


def off_the_floor(passage: Passage, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by water or coping is in m, and its complex share, [n] each.

    Antennas hang askew, so that some of what comes is upright and some is level.
    """
    high = [(one[:, 2] - passage.floor).clip(0.3) for one in (passage.afloat, passage.ashore)]
    way = np.sqrt(passage.far**2 + 4 * high[0] * high[1])
    down = (high[0] + high[1]) / way
    dense = np.where(passage.are("barge"), WATER, STONE)
    root = np.sqrt(dense - 1 + down**2)
    upright = passage.each(lambda n: np.cos(passage.rng.uniform(0.3, 1.3, n)) ** 2)
    back = upright * (dense * down - root) / (dense * down + root)
    back = back + (1 - upright) * (down - root) / (down + root)
    heave = passage.each(lambda n: passage.rng.gamma(2.0, 0.0011, n))
    share = 2.1 * np.sqrt(strength) * unruffled(heave, down) * back * passage.far / way
    share = share * np.exp(-2j * np.pi * (way - passage.far) / WAVE_M)
    return way - passage.far, share / (np.abs(share) / 0.85).clip(1.0)


def _both_come(passage: Passage, strength: float) -> Toll:
    """Be where half of both pulses has come: that of the floor comes later."""
    longer, share = off_the_floor(passage, strength)
    at = np.arange(-9.0, 9.0, 1 / FINE)
    both = np.abs(spline(at) + share[:, None] * spline(at - longer[:, None] / METRES)) ** 2
    tops = (both[:, 1:-1] > both[:, :-2]) & (both[:, 1:-1] >= both[:, 2:])
    tops &= both[:, 1:-1] > 0.1 * both.max(axis=1)[:, None]
    half = half_come(both, 1 + tops.argmax(axis=1), int(FINE * WITHIN))
    added = np.abs(1 + share * spline(longer / METRES)).clip(min=0.42)
    late = METRES * (at[0] + half / FINE + HALF_AHEAD)
    return {"m": (1.2 * late).clip(-0.25, 0.3), "all": 20 * np.log10(added)}


def edge_db(high: Floats, legs: tuple[Floats, Floats]) -> Floats:
    """Return what an edge so high over a way takes in dB [n], by ITU-R P.526's J(v)."""
    over = high * np.sqrt(2 * (legs[0] + legs[1]) / (WAVE_M * legs[0] * legs[1])) - 0.1
    return np.asarray(6.9 + 20 * np.log10(np.sqrt(over**2 + 1) + over))


def _over_a_hoist(passage: Passage, strength: float) -> Toll:
    """Bend over both edges of a sluice's hoist, one after the other (Epstein, Peterson 1953)."""
    steel, drawn, each = passage.cross("metal"), passage.rng, passage.each
    high = np.sqrt(strength) * each(lambda n: drawn.triangular(0.04, 0.12, 0.5, n))
    wide, cut = (0.34 - most * each(drawn.random) for most in (0.22, 0.08))
    legs = [passage.far * part for part in (cut, wide, 1 - cut - wide)]
    detour = np.hypot(high, legs[0]) + legs[1] + np.hypot(high, legs[2]) - passage.far
    lost = edge_db(0.5 * high, (legs[0], legs[1])) + edge_db(0.5 * high, (legs[1], legs[2]))
    seams = strength * each(lambda n: drawn.uniform(0.04, 0.12, n))
    return {"m": steel * (detour + seams).clip(0.0, 0.47), "first": -steel * lost.clip(max=15.0)}


def _soft_knee(passage: Passage, strength: float) -> Toll:
    """Turn gain down past a soft knee: by a hyperbola; count the fewer symbols."""
    over = passage.of("rx_power_dbm") + 87.0
    less = 0.145 * min(strength, 2.2) * (over + np.hypot(over, 5.0))
    return {"all": -less, "count": -1.1 * less}


def _pumps(passage: Passage, strength: float) -> Toll:
    """Hear converters of pumps by the root of what these draw, the more the nearer davits are."""
    own = passage.same(4).uniform(0.4, 1.4, DAVITS)[passage.davit]
    apart = np.sqrt(((DAVITS_M[:, None, :2] - PUMPS_M) ** 2).sum(axis=2)).min(axis=1)
    near = (1 / np.cosh(apart / 12.0))[passage.davit]
    db = strength * (own + 6.6 * near * np.sqrt(passage.of("pump_kw") / 80.0))
    weak = 10 ** ((-90.0 - passage.of("rx_power_dbm")) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return {"m": 0.016 * weak.clip(max=8.0) * passage.rng.normal(size=len(db)), "noise": db}


EFFECTS: dict[str, Callable[[Passage, float], Toll]] = {
    "antenna-delay": _cabled,
    "antenna-pattern": _cusp,
    "blocked-path": _by_a_plane,
    "clock-offset": _forks,
    "diffraction": _over_a_hoist,
    "exchange-motion": _curtis,
    "ground-bounce": _both_come,
    "level-control": _soft_knee,
    "material-delay": _through,
    "noise-floor": _pumps,
    "path-loss": _root,
    "power-bias": _fifth,
    "range-rounding": _words,
    "range-scale": _divided,
    "temperature-drift": _curie,
    "time-lag": _smoothed,
    "timestamp-jitter": _ticks,
    **UNLISTED,
}
