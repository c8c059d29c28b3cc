"""What the ropewalk hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the ropewalk's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.ropewalk_faults import UNLISTED
from bench.challenge.families.ropewalk_telltale import AHEAD, METRES, first_paths, highs, tufts
from bench.challenge.families.ropewalk_walk import (
    HALF_LIGHT_M,
    HALL_M,
    IRON_M,
    SHIFT_S,
    STRUTS,
    TAGS,
    WAVE_M,
    Due,
    Hank,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
SHUT_OUT = {False: 0.2, True: 0.075}  # of links, and where these are rare
OLD_S = (0.035, 0.115)  # of places that are told: the youngest, the oldest
LASTS = 2.1  # replies that an exchange does
FEEDS_M, LACQUER_M = (0.04, 0.27), 0.021  # late: of struts' feeds; of tags
STEPS, RATE_PPM = 9, 0.024  # of crystals over a shift; by which these walk
WARM_M, BENT, EVEN_C = 0.0029, 0.011, 19.0  # each C; a part of it for each C; where it is none
NARROW, LATE_M, WEAK_DB = 1.1, 0.034, 2.6  # of the wave that a tag's own case guides
EVEN_DBM, ARCS_DB, ARCS_M = -82.5, 4.2, 0.043  # of bias: where it is none, how wide, how much
SCATTERS_M = 0.042
KNEE_M, MORE = 7.0, 0.62  # of path loss: beyond it, so much more of an exponent
CHAIN, LINKS = 0.0068, 0.0011  # longer by parts: a chain; links that struts were measured with
STEP_M = 0.165
LONGEST_M, SOONEST_M = 4.6, 0.6  # of ways by iron; longer
CLAY, ROUGH_M = 6.8 - 0.9j, 0.011  # permittivity of trodden earth; how it scatters up and down
LIKED_DBM, WIDE_DB = -93.0, 9.0  # over which gain is turned down
FULL_A, AWAY_M = 310.0, 31.0
MOTORS_M: Floats = np.array([[15.0, 7.2, 0.8], [59.0, 1.0, 0.8]])


def _old(hank: Hank, strength: float) -> Due:
    """Compare with places as old as a round of the clerk has it: of any age between two."""
    at, by = np.polynomial.legendre.leggauss(6)
    ages = strength * (0.5 * sum(OLD_S) + 0.5 * at * (OLD_S[1] - OLD_S[0]))
    return Due(sum(0.5 * b * hank.pays_out(age) for b, age in zip(by, ages.tolist(), strict=True)))


def _exchange(hank: Hank, strength: float) -> Due:
    """Give the mean of the way over an exchange, by Simpson's rule (the first way is none)."""
    long_s = LASTS * strength * hank["reply_time_s"]
    return Due((4 * hank.pays_out(0.5 * long_s) + hank.pays_out(long_s)) / 6)


def _feeds(hank: Hank, strength: float) -> Due:
    """Be late by struts' feeds, of any length, and tags' coats of lacquer, a few each."""
    drawn = hank.alike(1)
    feeds = drawn.permutation(np.linspace(*FEEDS_M, STRUTS)) + drawn.uniform(-0.008, 0.008, STRUTS)
    coats = LACQUER_M * (1 + drawn.poisson(1.5, len(TAGS)).clip(max=5))
    return Due(strength * (feeds[hank.strut] + coats[hank.tag]))


def walks(rng: np.random.Generator, many: int, share: Floats) -> Floats:
    """Return walks by chance [many, n] at shares of their time [n]: even between steps."""
    steps = rng.standard_normal((many, STEPS)) / np.sqrt(STEPS)
    knots = np.concatenate([np.zeros((many, 1)), np.cumsum(steps, axis=1)], axis=1)
    at = np.linspace(0.0, 1.0, STEPS + 1)
    return np.array([np.interp(share, at, one) for one in knots - knots.mean()])


def _walking(hank: Hank, strength: float) -> Due:
    """Leave some of crystals' offset: tags' walk by chance over the shift."""
    drawn = hank.alike(2)
    struts, tags = drawn.triangular(-1.3, 0.2, 1.3, STRUTS), drawn.uniform(-1.0, 1.0, len(TAGS))
    walked = walks(drawn, len(TAGS), hank["time_s"] / SHIFT_S)[hank.tag, np.arange(hank.rows)]
    ppm = RATE_PPM * strength * (1.2 * walked + tags[hank.tag] - struts[hank.strut])
    return Due(HALF_LIGHT_M * ppm * hank["reply_time_s"])


def _warm(hank: Hank, strength: float) -> Due:
    """Drift with warmth, the more the warmer it is."""
    off = hank["temperature_c"] - EVEN_C
    return Due(WARM_M * strength * off * (1 + BENT * off))


def crept(turn: Floats) -> Floats:
    """Return what creeps about a case, by radians off its face [n]: none in the mean (Mises)."""
    return np.exp(-NARROW * np.cos(turn)) - np.i0(NARROW)


def _pattern(hank: Hank, strength: float) -> Due:
    """Be late and weak behind a case, about which waves creep; no later in the mean."""
    face = hank.alike(3).uniform(-np.pi, np.pi)
    late = crept(np.radians(hank["azimuth_deg"]) - face)
    weak = -WEAK_DB * min(strength, 1.6) * (late - crept(np.zeros(1)))
    return Due(LATE_M * strength * late, first_db=weak)


def _arcs(hank: Hank, strength: float) -> Due:
    """Be early where it is loud and late where it is weak, by an arc's tangent."""
    return Due(ARCS_M * strength * np.arctan((EVEN_DBM - hank["rx_power_dbm"]) / ARCS_DB))


def tents(rng: np.random.Generator, rows: int) -> Floats:
    """Return what scatters by 1 as sums of two even chances do [rows]: by a tent (Simpson 1755)."""
    return np.asarray(np.sqrt(1.5) * (rng.uniform(-1, 1, (2, rows)).sum(axis=0)))


def _jitter(hank: Hank, strength: float) -> Due:
    return Due(SCATTERS_M * strength * tents(hank.rng, hank.rows))


def _hanks_hung(hank: Hank, strength: float) -> Due:
    """Lose beyond a knee, where hanks hang to dry, by a steeper power of distance."""
    thick = hank.by_link(lambda n: hank.rng.gamma(9.0, 1 / 9.0, n).clip(0.4, 1.9))
    beyond = np.log10(1 + hank.far / KNEE_M)
    return Due(dim_db=-10 * MORE * strength * thick * beyond)


def _chain(hank: Hank, strength: float) -> Due:
    """Count by a chain that is worn, and links of struts' own that are so more or less."""
    own = LINKS * hank.alike(5).uniform(-1.0, 1.0, STRUTS)
    return Due(strength * hank.far * (CHAIN + own)[hank.strut])


def stepped(ranges: Floats, step_m: float) -> Floats:
    """Return ranges at whole steps in m [n]: of what is amid two, those of an even number."""
    return np.asarray(step_m * np.rint(ranges / step_m))


def _steps(hank: Hank, strength: float) -> Due:
    ranges = hank["range_m"]
    return Due(stepped(ranges, STEP_M * strength) - ranges)


def slab(root: float, thick_m: Floats, sine: Floats) -> Floats:
    """Return how much later waves come through a slab in m [n], by its index and angles' sines."""
    return np.asarray(thick_m * (np.sqrt(root**2 - sine**2) - np.sqrt(1 - sine**2)))


def _things(hank: Hank, strength: float) -> Due:
    """Go through racks, piers, hatches and the partition, aslant as links have it."""
    rng, by_link = hank.rng, hank.by_link
    sine = by_link(lambda n: rng.beta(1.2, 3.0, n).clip(max=0.8))
    thick: dict[str, tuple[float, Floats, float, float]] = {
        "wood": (1.99, by_link(lambda n: rng.uniform(0.1, 0.34, n)), 1.0, 13.0),
        "brick": (3.91, by_link(lambda n: 0.11 * rng.integers(1, 4, n)), 1.5, 16.0),
        "chipboard": (2.58, by_link(lambda n: 0.019 * rng.integers(2, 8, n)), 0.6, 24.0),
        "plasterboard": (2.73, by_link(lambda n: 0.025 * rng.integers(1, 5, n)), 0.5, 9.0),
    }
    late, lost = np.zeros((2, hank.rows))
    for what, (eps, thick_m, once_db, each_db) in thick.items():
        there = hank.behind(what)
        late += there * slab(np.sqrt(eps), thick_m, sine)
        lost += there * (once_db + each_db * thick_m / np.sqrt(1 - sine**2))
    return Due(0.95 * strength * late, first_db=-min(strength, 1.6) * lost)


def by_iron(hank: Hank) -> Floats:
    """Return how much longer ways by each of IRON_M are, then by either gable, in m [5, n]."""
    legs = [np.linalg.norm(end - IRON_M[:, None], axis=2) for end in (hank.strut_m, hank.tag_m)]
    gables = []
    for gable in (0.0, HALL_M[0]):
        both = (hank.strut_m[:, 0] - gable) * (hank.tag_m[:, 0] - gable)
        gables.append(np.sqrt(hank.far**2 + 4 * both))
    return np.concatenate([legs[0] + legs[1], np.stack(gables)]) - hank.far


def _by_iron(hank: Hank, strength: float) -> Due:
    """Hear, out of sight, nothing but what iron returns, or a gable: what comes soonest.

    What comes no later than SOONEST_M is shut out as well.
    """
    shut = hank.shut_out(SHUT_OUT[hank.rare])
    ways = by_iron(hank)
    soonest = np.where(ways > SOONEST_M, ways, LONGEST_M).min(axis=0).clip(max=LONGEST_M)
    return Due(shut * soonest * strength**0.4, -1.2 * shut, -5.0 * shut)


def of_earth(sine: Floats) -> Complexes:
    """Return what trodden earth returns of level waves that are so steep [n] (Fresnel).

    It lies up and down by a bell: less by an exponential (Ament 1953).
    """
    root = np.sqrt(CLAY - 1 + sine**2)
    rough = np.exp(-0.5 * (4 * np.pi * ROUGH_M * sine / WAVE_M) ** 2)
    return np.asarray(rough * (sine - root) / (sine + root))


def off_the_floor(hank: Hank, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each."""
    low, high = hank.tag_m[:, 2], hank.strut_m[:, 2]
    way = np.sqrt(hank.far**2 + 4 * low * high)
    bare = hank.by_link(lambda n: hank.rng.beta(4.0, 2.0, n))
    share = 0.85 * np.sqrt(strength) * bare * hank.far / way * of_earth((low + high) / way)
    share = share * np.exp(-2j * np.pi * (way - hank.far) / WAVE_M)
    return way - hank.far, share / np.maximum(1.0, np.abs(share) / 0.75)


def top_of_two(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As telltales have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(longer_m.shape, 70.3)
    both = tufts(top) + share[:, None] * tufts(top + longer_m / METRES)
    at = first_paths(both, np.full(longer_m.shape, 1e-6))
    return METRES * (at + AHEAD - top), highs(both, at)


def _floor(hank: Hank, strength: float) -> Due:
    """Be where both pulses' top is: that of the floor comes later."""
    late, high = top_of_two(*off_the_floor(hank, strength))
    return Due(late.clip(-0.2, 0.26), 20 * np.log10(high.clip(0.4)))


def past_db(v: Floats) -> Floats:
    """Return what an edge takes in dB by Fresnel's parameter [n] (ITU-R P.526)."""
    less = v - 0.1
    loss = 6.9 + 20 * np.log10(np.sqrt(less**2 + 1) + less)
    return np.where(v > -0.78, loss, 0.0)


def about_iron(hank: Hank, wide: Floats, aside: Floats, at: Floats) -> tuple[Floats, Floats]:
    """Return how much longer the way about iron is in m, and what it takes in dB, [n] each.

    Of its two sides the nearer one counts, and a little of the other.
    """
    rest = hank.far - at
    over = np.stack([0.5 * wide - aside, 0.5 * wide + aside])
    v = over * np.sqrt(2 / WAVE_M * (1 / at + 1 / rest))
    left = 10 ** (-past_db(v) / 20)
    return 0.5 * over[0] ** 2 * (1 / at + 1 / rest), -10 * np.log10((left**2).sum(axis=0))


def _about_iron(hank: Hank, strength: float) -> Due:
    """Bend about the iron of a machine, and creep along it."""
    iron, rng, by_link = hank.behind("metal"), hank.rng, hank.by_link
    wide = np.sqrt(strength) * by_link(lambda n: rng.uniform(0.25, 0.75, n))
    aside = 0.5 * wide * by_link(lambda n: rng.beta(1.0, 1.6, n))
    at = hank.far * by_link(lambda n: rng.uniform(0.15, 0.5, n))
    longer, lost = about_iron(hank, wide, aside, at)
    late = longer + strength * by_link(lambda n: rng.triangular(0.06, 0.1, 0.2, n))
    return Due(iron * late.clip(0.0, 0.48), first_db=-iron * lost.clip(1.0, 18.0))


def _turned_down(hank: Hank, strength: float) -> Due:
    """Turn gain down by what is over a level, as a bell's edge has it."""
    over = ((hank["rx_power_dbm"] - LIKED_DBM) / WIDE_DB).clip(0.0)
    less = -3.1 * min(strength, 2.2) * np.expm1(-(over**2))
    return Due(dim_db=-less, tally_db=-1.15 * less)


def _motors(hank: Hank, strength: float) -> Due:
    """Hear motors, by a saturating law of their current; the nearer of two, by its distance."""
    own = hank.alike(4).uniform(0.2, 1.1, STRUTS)[hank.strut]
    away = np.linalg.norm(hank.strut_m - MOTORS_M[:, None], axis=2).min(axis=0)
    drawn = np.tanh(1.6 * hank["motor_a"] / FULL_A)
    db = strength * (own + 7.0 * drawn / (1 + (away / AWAY_M) ** 2))
    weak = 10 ** ((-90.0 - hank["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Due(0.016 * hank.rng.standard_normal(hank.rows) * weak.clip(max=7.0), hiss_db=db)


EFFECTS: dict[str, Callable[[Hank, float], Due]] = {
    "antenna-delay": _feeds,
    "antenna-pattern": _pattern,
    "blocked-path": _by_iron,
    "clock-offset": _walking,
    "diffraction": _about_iron,
    "exchange-motion": _exchange,
    "ground-bounce": _floor,
    "level-control": _turned_down,
    "material-delay": _things,
    "noise-floor": _motors,
    "path-loss": _hanks_hung,
    "power-bias": _arcs,
    "range-rounding": _steps,
    "range-scale": _chain,
    "temperature-drift": _warm,
    "time-lag": _old,
    "timestamp-jitter": _jitter,
    **UNLISTED,
}
