"""What the planetarium hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the planetarium's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.planetarium_almanac import AHEAD, METRES, brights, glows, risings
from bench.challenge.families.planetarium_dome import (
    COVES,
    EVENING_S,
    LIGHT_M_US,
    TAGS,
    WAVE_M,
    Fee,
    Seating,
)
from bench.challenge.families.planetarium_faults import UNLISTED

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
ECLIPSED = {False: 0.2, True: 0.075}  # of links, and where these are rare
AGE_S = 0.095  # of places that are told, in the mean; by an exponential
JOINT_M, POTTED_M = 0.037, (0.02, 0.05, 0.13)  # late: each joint of a cable; tags
LASTS = 2.1  # replies from one message to the next
SPELLS, MAKERS_PPM, RATE_PPM = 4, (-0.5, 0.65), 0.0245  # of an evening; crystals; of these left
EVEN_C, SLOPE_M, BEND_M = 19.0, 0.0011, 1.75e-5  # no drift; each C; each C cubed
PATCH, PATCH_M, PATCH_DB = 1.4, 0.082, 5.4  # power of a cosine; late; weak
EVEN_DBM, FALLS_DB, BIAS_M = -83.0, 6.0, 0.045  # of bias: where it is none; how wide; how much
SCATTERS_M = 0.0395
LOSES_DB, HIGH_DB = 0.17, 0.24  # each m of way; each m of height
SHORTER = 0.0094  # parts, that counts of a metre are
STEP_M = 0.135
SEATS, ABOUT_M, SOONEST_M, LONGEST_M = 3, 3.1, 0.55, 4.5  # that return something; how far about
CARPET, CARPET_M, SCREED = 1.9 - 0.12j, (0.004, 0.014), 5.24 - 0.5j  # permittivities; how thick
LIKED_DBM, RUNG_DB, RUNGS, LESS_DB = -93.5, 3.2, 6, 0.72  # of gains; apart; how many; each
ARC_A, SPOTS_M = 34.0, np.array([[2.2, 9.0, 3.2], [19.6, 20.8, 3.2], [15.0, 2.0, 3.2]])


def _old(seating: Seating, strength: float) -> Fee:
    """Compare with places of any age, the older the fewer: by an exponential (Laguerre)."""
    ages, by = np.polynomial.laguerre.laggauss(4)
    ways = [seating.wanders_off(AGE_S * strength * age) for age in ages.tolist()]
    return Fee(by @ np.stack(ways))


def _exchange(seating: Seating, strength: float) -> Fee:
    """Give the mean of both round trips: of ways there, after a reply and after two."""
    reply_s = LASTS * strength * seating["reply_time_s"]
    return Fee(0.5 * seating.wanders_off(reply_s) + 0.25 * seating.wanders_off(2 * reply_s))


def _joints(seating: Seating, strength: float) -> Fee:
    """Be late by joints of coves' cables, of which there are ever more rarely more; by potting."""
    drawn = seating.alike(1)
    joints = JOINT_M * drawn.geometric(0.32, COVES).clip(max=8)
    potted = drawn.triangular(*POTTED_M, len(TAGS))
    return Fee(strength * (joints[seating.cove] + potted[seating.tag]))


def _makers(seating: Seating, strength: float) -> Fee:
    """Leave some of crystals' offset: coves' are of two makers, tags' are set anew each spell."""
    drawn = seating.alike(2)
    coves = drawn.choice(MAKERS_PPM, COVES) + drawn.uniform(-0.3, 0.3, COVES)
    tags = drawn.uniform(-1.3, 1.3, (SPELLS, len(TAGS)))
    spell = (seating["time_s"] / EVENING_S * SPELLS).astype(np.int64).clip(0, SPELLS - 1)
    ppm = RATE_PPM * strength * (tags[spell, seating.tag] - coves[seating.cove])
    return Fee(0.5 * LIGHT_M_US * ppm * seating["reply_time_s"])


def _cubic(seating: Seating, strength: float) -> Fee:
    """Drift with warmth as crystals do that are cut so: by a cubic."""
    off = seating["temperature_c"] - EVEN_C
    return Fee(strength * (SLOPE_M * off + BEND_M * off**3))


def lacking(turn: Floats) -> Floats:
    """Return what a patch gives less than most, by radians off its face [n]: all of it behind."""
    return np.asarray(1 - np.cos(turn).clip(0.0) ** PATCH)


def _patch(seating: Seating, strength: float) -> Fee:
    """Be late and weak off a patch's face; no later in the mean."""
    face = seating.alike(3).uniform(-np.pi, np.pi)
    lack = lacking(np.radians(seating["azimuth_deg"]) - face)
    mean = lacking(np.linspace(0.0, 2 * np.pi, 721)[1:]).mean()
    weak = -PATCH_DB * min(strength, 1.5) * lack
    return Fee(PATCH_M * strength * (lack - mean), first_db=weak)


def _bias(seating: Seating, strength: float) -> Fee:
    """Be early where it is loud, ever more so, and hardly late where it is weak."""
    over = (seating["rx_power_dbm"] - EVEN_DBM) / FALLS_DB
    return Fee(BIAS_M * strength * (1 - np.exp(over.clip(max=1.25))))


def secants(rng: np.random.Generator, rows: int) -> Floats:
    """Return what scatters by 1 by a hyperbolic secant's law [rows] (Fisher 1921)."""
    even = rng.uniform(1e-4, 1 - 1e-4, rows)
    return np.asarray(2 / np.pi * np.log(np.tan(0.5 * np.pi * even)))


def _jitter(seating: Seating, strength: float) -> Fee:
    return Fee(SCATTERS_M * strength * secants(seating.rng, seating.rows))


def _curtains(seating: Seating, strength: float) -> Fee:
    """Lose so much for each metre of way, and for each that it goes up, amid what hangs."""
    thick = seating.each(lambda n: seating.rng.lognormal(-0.04, 0.28, n).clip(0.4, 2.0))
    up = np.abs(seating.cove_m[:, 2] - seating.tag_m[:, 2])
    return Fee(all_db=-strength * thick * (LOSES_DB * seating.far + HIGH_DB * up))


def _shorter(seating: Seating, strength: float) -> Fee:
    """Count metres that are too short by a part, tags a little more or less so."""
    own = 1 + 0.16 * seating.alike(5).permutation(np.linspace(-1.0, 1.0, len(TAGS)))
    return Fee(SHORTER * strength * own[seating.tag] * seating.far)


def by_lot(rng: np.random.Generator, ranges: Floats, step_m: float) -> Floats:
    """Return either whole step beside ranges in m [n], by lot: the nearer one the more often."""
    return np.asarray(step_m * np.floor(ranges / step_m + rng.random(len(ranges))))


def _by_lot(seating: Seating, strength: float) -> Fee:
    ranges = seating["range_m"]
    return Fee(by_lot(seating.rng, ranges, STEP_M * strength) - ranges)


def slower(index: float, thick_m: Floats, sine: Floats) -> Floats:
    """Return how much later waves come through a sheet in m [n], by angles' sines (Snell)."""
    within = np.sqrt(index**2 - sine**2) - np.sqrt(1 - sine**2)
    return np.asarray(thick_m * within)


def _things(seating: Seating, strength: float) -> Fee:
    """Go through seats' backs, piers, panes and walls, all upright, as steep as ways are."""
    rng, each = seating.rng, seating.each
    level = np.sqrt(1 - ((seating.cove_m - seating.tag_m)[:, 2] / seating.far) ** 2)
    aslant = each(lambda n: np.cos(rng.uniform(-0.85, 0.85, n)))
    sine = np.sqrt(1 - (level * aslant) ** 2).clip(max=0.85)
    sheets: dict[str, tuple[float, Floats, float]] = {
        "wood": (1.41, 0.022 * (1 + each(lambda n: rng.poisson(3.0, n).clip(max=9))), 15.0),
        "concrete": (2.29, each(lambda n: rng.choice([0.1, 0.14, 0.2], n)), 19.0),
        "glass": (2.51, 0.01 * each(lambda n: rng.integers(1, 5, n)), 34.0),
        "plasterboard": (1.65, each(lambda n: rng.uniform(0.025, 0.11, n)), 11.0),
    }
    late, lost = np.zeros((2, seating.rows))
    for what, (index, thick_m, each_db) in sheets.items():
        there = seating.behind(what)
        late += there * slower(index, thick_m, sine)
        lost += there * (0.5 + each_db * thick_m / np.sqrt(1 - sine**2))
    return Fee(1.5 * strength * late, first_db=-min(strength, 1.5) * lost)


def by_seats(seating: Seating) -> Floats:
    """Return how much longer ways by some seats are, which lie evenly about tags, in m [n].

    The soonest of these that is later than SOONEST_M, if any, counts, else LONGEST_M.
    """
    rng, each = seating.rng, seating.each
    soonest = np.full(seating.rows, LONGEST_M)
    for _ in range(SEATS):
        out, turn = (
            each(lambda n: np.sqrt(rng.random(n))),
            each(lambda n: rng.uniform(-3.2, 3.2, n)),
        )
        off = ABOUT_M * out * np.stack([np.cos(turn), np.sin(turn), 0 * turn])
        rest = np.linalg.norm(seating.tag_m + off.T - seating.cove_m, axis=1)
        longer = ABOUT_M * out + rest - seating.far
        soonest = np.where(longer > SOONEST_M, np.minimum(soonest, longer), soonest)
    return soonest


def _by_seats(seating: Seating, strength: float) -> Fee:
    """Hear, out of sight, nothing but what seats about a tag return."""
    shut = seating.eclipsed(ECLIPSED[seating.rare])
    return Fee(shut * by_seats(seating) * strength**0.45, -1.3 * shut, -5.2 * shut)


def carpeted(sine: Floats, thick_m: Floats) -> Complexes:
    """Return what a screed under carpet returns of level waves that are so steep [n] (Airy)."""
    roots = [sine, np.sqrt(CARPET - 1 + sine**2), np.sqrt(SCREED - 1 + sine**2)]
    top, bottom = ((one - other) / (one + other) for one, other in pairwise(roots))
    turn = np.exp(-4j * np.pi * thick_m * roots[1] / WAVE_M)
    return np.asarray((top + bottom * turn) / (1 + top * bottom * turn))


def off_the_carpet(seating: Seating, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each."""
    low, high = seating.tag_m[:, 2], seating.cove_m[:, 2]
    way = np.sqrt(seating.far**2 + 4 * low * high)
    thick_m = seating.each(lambda n: seating.rng.uniform(*CARPET_M, n))
    open_ = seating.each(lambda n: 1 - 0.7 * seating.rng.random(n) ** 2)
    share = 1.25 * np.sqrt(strength) * open_ * seating.far / way
    share = share * carpeted((low + high) / way, thick_m)
    share = share * np.exp(-2j * np.pi * (way - seating.far) / WAVE_M)
    return way - seating.far, share / np.maximum(1.0, np.abs(share) / 0.82)


def rise_of_two(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As almanacs have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(longer_m.shape, 77.2)
    both = glows(top) + share[:, None] * glows(top + longer_m / METRES)
    at = risings(both, np.full(longer_m.shape, 1e-6))
    return METRES * (at + AHEAD - top), brights(both, at)


def _carpet(seating: Seating, strength: float) -> Fee:
    """Be where both pulses rise: that of the floor comes later."""
    late, high = rise_of_two(*off_the_carpet(seating, strength))
    return Fee(late.clip(-0.2, 0.25), 20 * np.log10(high.clip(0.4)))


def about_a_drum(
    radius: Floats, aside: Floats, ends: tuple[Floats, Floats]
) -> tuple[Floats, Floats]:
    """Return how much longer the way about a drum is in m, and what it takes in dB, [n] each.

    It is a drum's `radius`, whose axis is `aside` of the straight way and `ends` along it. Waves
    creep as far round as the way turns, and leave all along (Franz 1954).
    """
    straight, turned, tangents = np.zeros(len(radius)), np.zeros(len(radius)), np.zeros(len(radius))
    for end in ends:
        out = np.maximum(np.hypot(end, aside), 1.02 * radius)
        straight += np.sqrt(out**2 - aside**2)
        tangents += np.sqrt(out**2 - radius**2)
        turned += np.arccos(aside / out) - np.arccos(radius / out)
    leaves = 2.02 * (np.pi * radius / WAVE_M) ** (1 / 3)
    return tangents + radius * turned - straight, 20 / np.log(10) * leaves * turned


def _drum(seating: Seating, strength: float) -> Fee:
    """Creep about the orrery's drum of iron."""
    iron, rng, each = seating.behind("metal"), seating.rng, seating.each
    radius = np.sqrt(strength) * each(lambda n: rng.uniform(0.2, 0.55, n))
    aside = radius * each(lambda n: 1 - 0.7 * rng.beta(1.3, 1.3, n))
    at = seating.far * each(lambda n: rng.uniform(0.2, 0.6, n))
    longer, lost = about_a_drum(radius, aside, (at, seating.far - at))
    late = longer + strength * each(lambda n: rng.gamma(5.0, 0.021, n).clip(0.04, 0.2))
    return Fee(iron * late.clip(0.0, 0.47), first_db=-iron * (2.0 + lost).clip(1.0, 17.0))


def _ladder(seating: Seating, strength: float) -> Fee:
    """Turn gain down by a rung for each so many dB over a level."""
    over = (seating["rx_power_dbm"] - LIKED_DBM) / RUNG_DB
    less = LESS_DB * min(strength, 2.2) * np.floor(over).clip(0.0, RUNGS)
    return Fee(all_db=-less, count_db=-1.1 * less)


def _spots(seating: Seating, strength: float) -> Fee:
    """Hear arcs of spots, whose current does ever less more; of each spot by its distance."""
    own = seating.alike(4).gamma(4.0, 0.16, COVES).clip(max=1.5)[seating.cove]
    away = np.linalg.norm(seating.cove_m - SPOTS_M[:, None], axis=2)
    near = (1 / (1 + (away / 6.0) ** 2)).sum(axis=0)
    drawn = -np.expm1(-seating["arc_a"] / ARC_A)
    db = strength * (own + 7.2 * drawn * near.clip(max=1.0))
    weak = 10 ** ((-89.5 - seating["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Fee(0.017 * seating.rng.standard_normal(seating.rows) * weak.clip(max=7.0), noise_db=db)


EFFECTS: dict[str, Callable[[Seating, float], Fee]] = {
    "antenna-delay": _joints,
    "antenna-pattern": _patch,
    "blocked-path": _by_seats,
    "clock-offset": _makers,
    "diffraction": _drum,
    "exchange-motion": _exchange,
    "ground-bounce": _carpet,
    "level-control": _ladder,
    "material-delay": _things,
    "noise-floor": _spots,
    "path-loss": _curtains,
    "power-bias": _bias,
    "range-rounding": _by_lot,
    "range-scale": _shorter,
    "temperature-drift": _cubic,
    "time-lag": _old,
    "timestamp-jitter": _jitter,
    **UNLISTED,
}
