"""What the watermill hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the watermill's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.watermill_faults import OF_THE_MILL
from bench.challenge.families.watermill_hopper import (
    AHEAD,
    LIGHT_M_NS,
    SAMPLE_NS,
    grains,
    heights,
    weighed,
)
from bench.challenge.families.watermill_race import (
    DAY_S,
    HATCHES,
    LIGHT_M_US,
    STOREYS_M,
    TAGS,
    WALL_M,
    WAVE_M,
    Due,
    Grist,
)

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
SHUT_OFF = {False: 0.2, True: 0.08}  # of links, and where these are rare
FILTER_S = 0.05  # of either pole of a filter that places come through
AGES_S, SHARES = (
    np.array([0.9358222, 3.3054073, 7.7587705]),
    np.array([0.5886815, 0.3912161, 0.0201024]),
)  # of what comes through two such poles (by Laguerre's quadrature)
CABLES_M, SPLICES_M, CAPS_M = 0.035, 0.1, 0.1  # late by hatches at least, by lots; by tags
WANDER_PPM, SLOWEST, WAVES = 0.017, 4.0, 5  # of crystals; of a day at most; of each
CUT_C, SPAN_C, WARM_M = 20.0, 15.0, 0.125  # of crystals: even; over which so much, but for a part
FLAT = 0.35  # of the cube's that the turn of the cut takes back
LOBE_M, LOBE_DB = (0.15, 0.105), 3.2  # of two lobes; weaker at most
BIAS_M, EVEN_DBM, SPAN_DB = 0.058, -80.5, 9.0  # at most; of none; until most
STAMPS_M = 0.105  # of either stamp
STEEPER, PAST_M, SHADE_DB, MOST_DB = 0.55, 2.0, 0.9, 10.0  # of distance; from; of links; at most
FAST = 0.0088  # parts that tags' clocks count more
STEPS_M = (0.1524, 0.1016, 0.2032)  # six inches, four and eight
SOONEST_M, LONGEST_M = 0.52, 5.5  # of ways by shafts, longer than straight ones
RODS_M: Floats = np.array([
    [3.4, 3.5], [8.6, 2.6], [14.2, 2.8], [8.8, 7.7], [2.2, 7.4], [16.0, 6.9], [5.6, 11.4],
    [12.8, 11.6], [0.7, 0.6], [17.4, 0.8],
])  # fmt: skip
"""Along and up, of line shafts, which run the whole mill across and return what they are met by."""
FLAGS, OILY = 6.2, 0.5  # permittivity of wet flags and oiled oak
ROUGH_M = 0.006  # by which floors are uneven
CASING_M = (0.5, 1.05)  # radii of casings of iron
KNEE_DBM, SOFT_DB, FLATTER, FEWER = -85.0, 2.5, 0.26, 0.42
FULL_A, HUMS_DB, PLAIN_DB = 60.0, 8.5, 0.3


def _filtered(grist: Grist, strength: float) -> Due:
    """Compare with places that came through a filter of two poles."""
    each = (
        share * grist.creeps_off(age * FILTER_S * strength)
        for age, share in zip(AGES_S, SHARES, strict=True)
    )
    return Due(sum(each))


def _thrice(grist: Grist, strength: float) -> Due:
    """Go ways of an exchange of three messages: the second counts twice."""
    reply_s = 2.6 * strength * grist["reply_time_s"]
    return Due(0.5 * grist.creeps_off(reply_s) + 0.25 * grist.creeps_off(2 * reply_s))


def _cables(grist: Grist, strength: float) -> Due:
    """Be late by cables of hatches and by caps of tags, of which there are two sorts."""
    drawn = grist.shared(1)
    cables = CABLES_M + SPLICES_M * drawn.weibull(1.6, HATCHES).clip(max=2.2)
    caps = CAPS_M * drawn.beta(0.5, 0.5, len(TAGS))
    return Due(strength * (cables[grist.hatch] + caps[grist.tag]))


def _wander(grist: Grist, strength: float) -> Due:
    """Leave some of crystals' wander: slow waves, the slower the larger (flicker)."""
    drawn = grist.shared(2)
    every = HATCHES + len(TAGS)
    rate = np.exp(drawn.uniform(np.log(1 / SLOWEST), np.log(6.0), (every, WAVES)))
    phase = drawn.uniform(-np.pi, np.pi, (every, WAVES))
    size = WANDER_PPM * drawn.uniform(0.4, 1.2, (every, 1)) * rate**-0.5

    def ppm(one: Integers) -> Floats:
        turn = 2 * np.pi * rate[one] * grist["time_s"][:, None] / DAY_S
        return np.asarray((size[one] * np.sin(turn + phase[one])).sum(axis=1))

    apart = ppm(grist.hatch) - ppm(HATCHES + grist.tag)
    return Due(0.5 * LIGHT_M_US * strength * apart * grist["reply_time_s"])


def of_cut(warm_c: Floats) -> Floats:
    """Return how far crystals of an AT cut drift by warmth in deg C [n] (Bechmann 1956)."""
    off = (warm_c - CUT_C) / SPAN_C
    return np.asarray(off**3 - FLAT * off)


def _warms(grist: Grist, strength: float) -> Due:
    return Due(WARM_M * strength * of_cut(grist["temperature_c"]))


def _lobes(grist: Grist, strength: float) -> Due:
    """Be late where a mast is behind tags, soon where a plate is (von Mises' bells)."""
    facing = np.radians(grist["azimuth_deg"])
    mast, plate = np.exp(2.2 * (np.cos(facing - 2.5) - 1)), np.exp(1.4 * (np.cos(facing + 1.1) - 1))
    return Due(strength * (LOBE_M[0] * mast - LOBE_M[1] * plate), -LOBE_DB * strength * mast)


def _bias(grist: Grist, strength: float) -> Due:
    """Be early where it is loud, late where it is weak: half a wave of a sine, flat beyond."""
    over = ((EVEN_DBM - grist["rx_power_dbm"]) / SPAN_DB).clip(-1.0, 1.0)
    return Due(BIAS_M * strength * np.sin(0.5 * np.pi * over))


def _stamps(grist: Grist, strength: float) -> Due:
    """Tell stamps of either end by whole ticks: their difference is of a triangle's law."""
    both = grist.rng.random((2, grist.rows))
    return Due(STAMPS_M * strength * (both[0] - both[1]))


def _steeper(grist: Grist, strength: float) -> Due:
    """Lose by a greater power of distance past a break, links more or less so."""
    more = grist.each(lambda n: SHADE_DB * (grist.rng.gamma(2.0, 1.0, n).clip(max=5.0) - 1.0))
    lost = 10 * STEEPER * np.log10((grist.far / PAST_M).clip(1.0)) + more
    return Due(level_db=-strength * lost.clip(0.0, MOST_DB))


def _fast(grist: Grist, strength: float) -> Due:
    """Count parts too many, by the clock of the tag."""
    own = np.exp(grist.shared(3).uniform(-0.3, 0.3, len(TAGS)))
    return Due(FAST * strength * own[grist.tag] * grist.far)


def _steps(grist: Grist, strength: float) -> Due:
    """Tell ranges by middles of steps that a hatch was made with."""
    step, told = strength * np.array(STEPS_M)[grist.hatch % 3], grist["range_m"]
    return Due(step * (np.floor(told / step) + 0.5) - told)


def panes(slow: float, thick_m: Floats, sine: Floats) -> Floats:
    """Return how much longer ways are through panes of a permittivity, met so aslant, in m [n]."""
    return np.asarray(thick_m * (np.sqrt(slow - sine**2) - np.sqrt(1 - sine**2)))


def _through(grist: Grist, strength: float) -> Due:
    """Go through floors as steeply as ways are, and through walls, piers, hoppers and screens."""
    rng, each = grist.rng, grist.each
    level = np.hypot(*(grist.tag_m - grist.hatch_m)[:, :2].T) / grist.far
    aslant = each(lambda n: np.sin(rng.uniform(0.0, 1.1, n)))
    kinds = {
        "wood": (1.99, each(lambda n: rng.uniform(0.05, 0.11, n)), 26.0, level.clip(max=0.96)),
        "brick": (3.91, each(lambda n: rng.choice([0.12, 0.25], n)), 15.0, aslant),
        "plywood": (2.71, 0.02 * each(lambda n: rng.uniform(1.0, 3.5, n)), 40.0, aslant),
        "glass": (6.31, 0.005 * each(lambda n: rng.uniform(1.0, 3.0, n)), 40.0, aslant),
        "concrete": (5.24, each(lambda n: rng.uniform(0.1, 0.25, n)), 21.0, aslant),
    }
    late, lost = np.zeros(grist.rows), np.zeros(grist.rows)
    for what, (slow, thick_m, db, sine) in kinds.items():
        late += grist.behind(what) * panes(slow, thick_m, sine)
        lost += grist.behind(what) * (0.5 + db * thick_m)
    return Due(strength * late.clip(max=0.6), first_db=-min(strength, 1.4) * lost.clip(max=9.0))


def by_rods(grist: Grist) -> Floats:
    """Return how much longer ways by one of the three nearest line shafts are, in m [n].

    Where thin cylinders are met, waves leave these by the angle that they come by (Keller 1962).
    """
    aside = sum(np.linalg.norm(end[:, None, 1:] - RODS_M, axis=2)
                for end in (grist.tag_m, grist.hatch_m))  # fmt: skip
    across = (grist.tag_m - grist.hatch_m)[:, :1]
    order = np.sort(np.hypot(aside, across) - grist.far[:, None], axis=1)
    which = grist.each(lambda n: grist.rng.choice(3, n, p=[0.2, 0.4, 0.4])).astype(np.int64)
    return np.asarray(order[np.arange(grist.rows), which].clip(SOONEST_M, LONGEST_M))


def _by_rods(grist: Grist, strength: float) -> Due:
    """Hear, out of sight, nothing but what line shafts return."""
    shut = grist.shut_off(SHUT_OFF[grist.rare])
    return Due(shut * by_rods(grist) * strength**0.4, -0.8 * shut, -6.2 * shut)


def lying_waves(sine: Floats, slow: complex) -> Complexes:
    """Return what a floor so dense returns of waves that lie, so steep [n] (Fresnel)."""
    root = np.sqrt(slow - 1 + sine**2 + 0j)
    return np.asarray((sine - root) / (sine + root))


def off_the_floor(grist: Grist, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Of the storey of whichever end is lower; uneven floors return less, the steeper (Ament 1953).
    """
    tag, hatch = grist.tag_m, grist.hatch_m
    lower = np.minimum(tag[:, 2], hatch[:, 2])
    upper = np.array(STOREYS_M)[np.searchsorted(STOREYS_M, lower, side="right") - 1]
    floor = np.where(np.maximum(tag[:, 0], hatch[:, 0]) > WALL_M, 0.0, upper)
    heights_m = (tag[:, 2] - floor) * (hatch[:, 2] - floor)
    way = np.sqrt(grist.far**2 + 4 * heights_m)
    sine = (tag[:, 2] + hatch[:, 2] - 2 * floor) / way
    uneven = np.exp(-2 * (2 * np.pi * ROUGH_M * sine / WAVE_M) ** 2)
    clear = grist.each(lambda n: grist.rng.uniform(0.45, 1.0, n))
    size = (np.sqrt(strength) * 1.25 * clear * uneven * grist.far / way).clip(max=0.78)
    share = size * lying_waves(sine, FLAGS - 1j * OILY)
    return way - grist.far, share * np.exp(-2j * np.pi * (way - grist.far) / WAVE_M)


def told_of_both(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As hoppers have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(len(longer_m), 77.4)
    each_m = LIGHT_M_NS * SAMPLE_NS
    both = grains(top) + share[:, None] * grains(top + longer_m / each_m)
    at = weighed(both)
    alone = heights(grains(top[:1]).astype(np.complex128), top[:1] - AHEAD, np.full(1, 1e-7))
    return each_m * (at - top + AHEAD), heights(both, at, np.full(len(top), 1e-7)) / alone


def _floor(grist: Grist, strength: float) -> Due:
    """Be where a hopper has both pulses: that of the floor comes later."""
    late, high = told_of_both(*off_the_floor(grist, strength))
    return Due(late.clip(-0.25, 0.25), first_db=20 * np.log10(high.clip(0.4, 2.2)))


def round_casings(far: Floats, part: Floats, radius: Floats) -> tuple[Floats, Floats]:
    """Return how much longer ways round casings are in m, and what they take in dB, [n] each.

    Their middles are amid straight ways, a part of these from one end. Waves creep along them and
    are shed (Keller 1956).
    """
    one, other = part * far, (1 - part) * far
    bent = np.pi - np.arccos(radius / one) - np.arccos(radius / other)
    straight = np.sqrt(one**2 - radius**2) + np.sqrt(other**2 - radius**2)
    sheds = 1.019 * np.cos(np.pi / 6) * np.cbrt(np.pi * radius / WAVE_M) * bent
    return straight + radius * bent - far, 20 / np.log(10) * sheds


def _casings(grist: Grist, strength: float) -> Due:
    """Creep round casings of iron."""
    rng, iron = grist.rng, grist.behind("metal")
    part = grist.each(lambda n: rng.uniform(0.3, 0.7, n))
    radius = np.sqrt(strength) * grist.each(lambda n: rng.uniform(*CASING_M, n))
    radius = np.minimum(radius, 0.45 * grist.far * np.minimum(part, 1 - part))
    longer, lost = round_casings(grist.far, part, radius)
    return Due(iron * longer.clip(0.0, 0.45), first_db=-iron * lost.clip(1.0, 10.0))


def _flatter(grist: Grist, strength: float) -> Due:
    """Tell levels past a soft knee by less than they rise, and sum fewer symbols there."""
    over = SOFT_DB * np.logaddexp(0.0, (grist["rx_power_dbm"] - KNEE_DBM) / SOFT_DB).clip(max=7.0)
    level = -min(FLATTER * strength, 0.75) * over
    return Due(level_db=level, count_db=-FEWER * min(strength, 2.0) * over)


def _dynamo(grist: Grist, strength: float) -> Due:
    """Hear a dynamo by the square of its current, hatches more or less so."""
    own = grist.shared(4).uniform(0.3, 1.0, HATCHES)[grist.hatch]
    db = strength * (PLAIN_DB + HUMS_DB * own * (grist["dynamo_a"] / FULL_A) ** 2)
    weak = 10 ** ((-81.0 - grist["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    chance = grist.rng.laplace(0.0, 0.7071, grist.rows).clip(-3.5, 3.5)
    return Due(0.011 * chance * weak.clip(max=6.0), noise_db=db)


EFFECTS: dict[str, Callable[[Grist, float], Due]] = {
    "antenna-delay": _cables,
    "antenna-pattern": _lobes,
    "blocked-path": _by_rods,
    "clock-offset": _wander,
    "diffraction": _casings,
    "exchange-motion": _thrice,
    "ground-bounce": _floor,
    "level-control": _flatter,
    "material-delay": _through,
    "noise-floor": _dynamo,
    "path-loss": _steeper,
    "power-bias": _bias,
    "range-rounding": _steps,
    "range-scale": _fast,
    "temperature-drift": _warms,
    "time-lag": _filtered,
    "timestamp-jitter": _stamps,
    **OF_THE_MILL,
}
