"""What the cathedral hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the cathedral's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.cathedral_faults import UNHEARD_OF
from bench.challenge.families.cathedral_lectern import AHEAD, METRES, chimes, loudness, readings
from bench.challenge.families.cathedral_nave import (
    BOSSES,
    FEAST_S,
    LIGHT_M_US,
    TAGS,
    WAVE_M,
    Dues,
    Vigil,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
SHUT_OFF = {False: 0.2, True: 0.075}  # of links, and where these are rare
OLDEST_S = 0.19  # of places that are told: any age up to this
LATER = 2.2  # replies from where places are told to where ways are gone
MAKES_M, OF_MAKES_M, FIXED_M = (0.03, 0.115), 0.014, 0.05  # late: makes of boards; of these; tags
WARMS, WARM_S = 0.15, 3600.0  # less, once all is warm; to 1 / e
SPREAD_PPM, AGES_PPM = 0.019, 0.012  # of crystals left; and over a feast
EVEN_C, COLD_M, HOT_M = (13.0, 21.0), 0.0072, 0.0088  # no drift between; each C below, above
LOBES_M, LOBES_DB, THIRD = 0.075, 5.0, 0.3  # late; weak; of lobes three to a turn
BIAS_M, EVEN_DBM, OVER_DB = 0.056, -81.0, 4.5  # at most; of none; until it is nearly most
SCATTERS_M = 0.042
BREAK_M, STEEPER_DB = 7.0, 12.0  # ways that lose no more; of the longer, each tenfold
SHORT = 0.0087  # parts, that counts of a metre are
STEP_M = 0.15
WEBS_M = (5.6, 9.2, 14.7)  # how high arches, aisles' and nave's vaults are
SOONEST_M, LONGEST_M = 0.55, 4.6  # of ways by these, longer than straight ones
STONE, ROUGH_M = 7.6, 0.0035  # of floors: permittivity; how deep these are worn
KNEE_DBM, SOFT_DB, LESS = -88.0, 2.5, 0.3  # of gains; how soft that is; dB for each over it
ORGANS_M: Floats = np.array([[1.5, 13.0, 7.0], [32.0, 8.5, 4.0]])
FULL_KW, HUMS_DB, HUM_M = 15.0, 6.4, 8.0


def _old(vigil: Vigil, strength: float) -> Dues:
    """Compare with the mean of places over some time that has just gone (Gauss)."""
    places, weights = np.polynomial.legendre.leggauss(3)
    ages = 0.5 * OLDEST_S * strength * (1 + places)
    return Dues(0.5 * weights @ np.stack([vigil.strays_off(age) for age in ages.tolist()]))


def _exchange(vigil: Vigil, strength: float) -> Dues:
    """Go the way when all replies have been sent, not when it was asked."""
    return Dues(vigil.strays_off(LATER * strength * vigil["reply_time_s"]))


def _boards(vigil: Vigil, strength: float) -> Dues:
    """Be late by boards of two makes, and by tags; the less the longer all has been on."""
    drawn = vigil.alike(1)
    makes = drawn.choice(MAKES_M, BOSSES) + OF_MAKES_M * drawn.standard_normal(BOSSES).clip(-2, 2)
    tags = FIXED_M * drawn.weibull(2.2, len(TAGS))
    on = 1 - WARMS * (1 - np.exp(-vigil["time_s"] / WARM_S))
    return Dues(strength * on * (makes[vigil.boss] + tags[vigil.tag]))


def _ageing(vigil: Vigil, strength: float) -> Dues:
    """Leave some of crystals' offset, which ages evenly over the feast, each its own way."""
    drawn = vigil.alike(2)
    parts = drawn.standard_normal((2, BOSSES + len(TAGS))).clip(-2.5, 2.5)
    hours = vigil["time_s"] / FEAST_S - 0.5
    ppm = [
        SPREAD_PPM * parts[0, one] + AGES_PPM * parts[1, one] * hours
        for one in (BOSSES + vigil.tag, vigil.boss)
    ]
    return Dues(0.5 * LIGHT_M_US * strength * (ppm[0] - ppm[1]) * vigil["reply_time_s"])


def _beyond(vigil: Vigil, strength: float) -> Dues:
    """Drift by nothing where boards make up for it, and evenly on either side of that."""
    warm = vigil["temperature_c"]
    drift = HOT_M * (warm - EVEN_C[1]).clip(0.0) - COLD_M * (EVEN_C[0] - warm).clip(0.0)
    return Dues(strength * drift)


def lobed(bearing: Floats) -> Floats:
    """Return what antennas lack at bearings in radians, of a mean of a half [...]."""
    return np.asarray(0.5 * (1 - (1 - THIRD) * np.cos(bearing) - THIRD * np.cos(3 * bearing)))


def _lobes(vigil: Vigil, strength: float) -> Dues:
    """Be late and weak where antennas lack, which have lobes."""
    lacks = strength * lobed(np.radians(vigil["azimuth_deg"]))
    return Dues(LOBES_M * lacks, -LOBES_DB * lacks)


def _bias(vigil: Vigil, strength: float) -> Dues:
    """Be early where it is loud and late where it is weak, by no more than so much."""
    over = (EVEN_DBM - vigil["rx_power_dbm"]) / OVER_DB
    return Dues(BIAS_M * strength * over / np.sqrt(1 + over**2))


def logistic(rng: np.random.Generator, rows: int) -> Floats:
    """Return what scatters by 1 by a logistic law [rows]."""
    return np.asarray(rng.logistic(0.0, np.sqrt(3) / np.pi, rows).clip(-5.5, 5.5))


def _jitter(vigil: Vigil, strength: float) -> Dues:
    return Dues(SCATTERS_M * strength * logistic(vigil.rng, vigil.rows))


def _beyond_a_break(vigil: Vigil, strength: float) -> Dues:
    """Lose more with each tenfold from a break on, links more or less so."""
    own = vigil.each(lambda n: 0.6 + 0.8 * vigil.rng.beta(2.0, 2.0, n))
    tenfolds = np.log10(vigil.far / BREAK_M).clip(0.0)
    return Dues(level_db=-STEEPER_DB * strength * own * tenfolds)


def _short(vigil: Vigil, strength: float) -> Dues:
    """Count metres that are too short by a part, which each boss has its own a little."""
    own = 1 + 0.15 * vigil.alike(3).uniform(-1.0, 1.0, BOSSES)
    return Dues(SHORT * strength * own[vigil.boss] * vigil.far)


def to_steps(ranges: Floats, step_m: float, off_m: Floats) -> Floats:
    """Return the nearest of steps that begin somewhere, in m [n]."""
    return np.asarray(off_m + step_m * np.rint((ranges - off_m) / step_m))


def _steps(vigil: Vigil, strength: float) -> Dues:
    """Tell ranges in whole steps, which begin elsewhere at each boss."""
    step_m = STEP_M * strength
    off_m = step_m * vigil.alike(4).random(BOSSES)[vigil.boss]
    return Dues(to_steps(vigil["range_m"], step_m, off_m) - vigil["range_m"])


def chord(aside: Floats) -> Floats:
    """Return how long chords of circles are, of diameters, by how far aside, of radii [n]."""
    return np.asarray(np.sqrt((1 - aside**2).clip(0.0)))


def _stone(vigil: Vigil, strength: float) -> Dues:
    """Go through stalls, round piers, panes in lead and the pulpitum."""
    rng, each = vigil.rng, vigil.each
    aslant = 1 / np.sqrt(1 - 0.6 * each(lambda n: rng.random(n)) ** 2)
    through = {
        "wood": (0.42, 0.03 * aslant * each(lambda n: rng.integers(1, 6, n)), 14.0),
        "brick": (0.98, each(lambda n: 0.24 * chord(rng.random(n))), 22.0),
        "glass": (1.5, 0.012 * aslant * each(lambda n: 1 + rng.poisson(1.1, n).clip(max=4)), 30.0),
        "concrete": (1.29, 0.11 * aslant * each(lambda n: rng.uniform(0.8, 1.7, n)), 18.0),
    }
    late, lost = np.zeros(vigil.rows), np.zeros(vigil.rows)
    for what, (slower, thick_m, each_db) in through.items():
        there = vigil.behind(what)
        late += there * slower * thick_m
        lost += there * (0.6 + each_db * thick_m)
    return Dues(1.2 * strength * late, first_db=-lost * min(strength, 1.5))


def by_webs(vigil: Vigil) -> Floats:
    """Return how much longer ways by some web of a vault are, in m [n]."""
    high = vigil.each(lambda n: vigil.rng.choice(WEBS_M, n))
    both = (high - vigil.tag_m[:, 2]) * (high - vigil.boss_m[:, 2])
    longer = np.sqrt(vigil.far**2 + 4 * both.clip(0.0)) - vigil.far
    return np.asarray(longer.clip(SOONEST_M, LONGEST_M))


def _by_webs(vigil: Vigil, strength: float) -> Dues:
    """Hear, out of sight, nothing but what vaults return."""
    shut = vigil.shut_off(SHUT_OFF[vigil.rare])
    return Dues(shut * by_webs(vigil) * strength**0.4, -1.5 * shut, -5.0 * shut)


def returned_by_stone(sine: Floats, rough_m: Floats) -> Floats:
    """Return what a stone floor returns of upright waves that are so steep [n] (Fresnel, Ament)."""
    root = np.sqrt(STONE - 1 + sine**2)
    smooth = (STONE * sine - root) / (STONE * sine + root)
    return np.asarray(smooth * np.exp(-2 * (2 * np.pi * rough_m * sine / WAVE_M) ** 2))


def off_the_floor(vigil: Vigil, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each."""
    up = vigil.tag_m[:, 2] + vigil.boss_m[:, 2]
    way = np.sqrt(vigil.far**2 + 4 * vigil.tag_m[:, 2] * vigil.boss_m[:, 2])
    worn_m = vigil.each(lambda n: vigil.rng.exponential(ROUGH_M, n).clip(max=0.012))
    free = vigil.each(lambda n: vigil.rng.uniform(0.45, 1.0, n))
    share = 1.9 * np.sqrt(strength) * free * vigil.far / way * returned_by_stone(up / way, worn_m)
    longer = way - vigil.far
    return longer, share.clip(-0.8, 0.8) * np.exp(-2j * np.pi * longer / WAVE_M)


def read_of_two(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As lecterns have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(longer_m.shape, 80.4)
    both = chimes(top) + share[:, None] * chimes(top + longer_m / METRES)
    at = readings(both)
    return METRES * (at + AHEAD - top), loudness(both, at, np.full(longer_m.shape, 1e-6))


def _floor(vigil: Vigil, strength: float) -> Dues:
    """Be where both pulses are read: that of the floor comes later."""
    late, high = read_of_two(*off_the_floor(vigil, strength))
    return Dues(late.clip(-0.22, 0.26), first_db=20 * np.log10(high.clip(0.4, 2.0)))


def edge_db(high: Floats, one: Floats, other: Floats) -> Floats:
    """Return what an edge takes in dB [n] that is so high, in m, over a line between ends so far.

    6 dB where it is grazed, and far behind it what Kirchhoff has.
    """
    by = high.clip(0.0) * np.sqrt(2 / WAVE_M * (1 / one + 1 / other))
    return np.asarray(10 * np.log10(4 + 2 * (np.pi * by) ** 2))


def over_two_edges(
    far: Floats, before: Floats, thick: Floats, high: Floats
) -> tuple[Floats, Floats]:
    """Return how much longer ways over two edges are in m, and what these take in dB, [n] each.

    Both are so `high`; the first is so far `before`, the other as `thick` behind it. What each
    takes is added up, of the way from the edge before to what follows (Epstein, Peterson 1953).
    """
    rest = far - before - thick
    longer = np.hypot(before, high) + thick + np.hypot(rest, high) - far
    first = edge_db(high * thick / (before + thick), before, thick)
    return longer, first + edge_db(high * thick / (rest + thick), thick, rest)


def _gate(vigil: Vigil, strength: float) -> Dues:
    """Go round the posts of the choir's gate, of which either has two edges."""
    iron, rng, each = vigil.behind("metal"), vigil.rng, vigil.each
    high = np.sqrt(strength) * each(lambda n: rng.uniform(0.3, 0.9, n))
    before = vigil.far * each(lambda n: rng.uniform(0.2, 0.5, n))
    longer, lost = over_two_edges(
        vigil.far, before, each(lambda n: rng.uniform(0.15, 0.6, n)), high
    )
    return Dues(iron * longer.clip(0.0, 0.47), first_db=-iron * lost.clip(1.0, 12.0))


def _knee(vigil: Vigil, strength: float) -> Dues:
    """Turn gain down over a knee that is soft, and sum fewer symbols."""
    over = SOFT_DB * np.logaddexp(0.0, (vigil["rx_power_dbm"] - KNEE_DBM) / SOFT_DB)
    less = min(strength, 2.2) * LESS * over.clip(max=16.0)
    return Dues(level_db=-less, summed_db=-0.9 * less)


def _organs(vigil: Vigil, strength: float) -> Dues:
    """Hear blowers of organs, bosses near these the more; some have more noise anyway."""
    own = vigil.alike(5).exponential(0.5, BOSSES).clip(max=1.6)[vigil.boss]
    away = np.linalg.norm(vigil.boss_m - ORGANS_M[:, None], axis=2)
    near = 0.35 + np.exp(-away / HUM_M).sum(axis=0)
    db = strength * (own + HUMS_DB * near.clip(max=1.0) * vigil["organ_kw"] / FULL_KW)
    weak = 10 ** ((-85.5 - vigil["rx_power_dbm"]) / 20) * np.sqrt(np.expm1(db * np.log(10) / 10))
    late = 0.016 * vigil.rng.standard_normal(vigil.rows) * weak.clip(max=7.0)
    return Dues(late, noise_db=db)


EFFECTS: dict[str, Callable[[Vigil, float], Dues]] = {
    "antenna-delay": _boards,
    "antenna-pattern": _lobes,
    "blocked-path": _by_webs,
    "clock-offset": _ageing,
    "diffraction": _gate,
    "exchange-motion": _exchange,
    "ground-bounce": _floor,
    "level-control": _knee,
    "material-delay": _stone,
    "noise-floor": _organs,
    "path-loss": _beyond_a_break,
    "power-bias": _bias,
    "range-rounding": _steps,
    "range-scale": _short,
    "temperature-drift": _beyond,
    "time-lag": _old,
    "timestamp-jitter": _jitter,
    **UNHEARD_OF,
}
