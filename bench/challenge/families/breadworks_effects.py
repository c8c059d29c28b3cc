"""What the breadworks hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the breadworks's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.breadworks_balance import (
    AHEAD,
    METRES,
    first_paths,
    heights,
    loaves,
)
from bench.challenge.families.breadworks_faults import UNLISTED
from bench.challenge.families.breadworks_hall import (
    CORBELS,
    HALL_M,
    METRES_OF_PPM_MS,
    TAGS,
    WAVE_M,
    Bake,
    Does,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OUT_OF_SIGHT = {False: 0.2, True: 0.075}  # of links, and where these are rare
OLD_S, KEPT = 0.0265, (1.0, 2.0, 3.0, 2.0, 1.0)  # from one place kept to the next; their weights
THREE = ((0.0, 0.25), (1.0, 0.5), (2.6, 0.25))  # messages: after how many replies, and their weight
SETTLES_S = 1500.0
CURIE_C, CERAMIC, MEET_C = -42.0, 25.0, 28.0  # where ceramics would turn; m degrees; no drift
RACK_M, RACK_DB = 0.092, 6.5  # late and weak straight through the rack that carries a tag
EVEN_DBM, GUIDE_DB, GUIDE_M = -85.0, 3.3, 0.068  # of bias: where it is none, how wide, its most
SCATTERS_M, TWO = 0.036, 0.75  # of edges; the part that is of two ways to be late
FLOUR_M, FLOUR_DB = 5.0, 2.1  # within so much flour hardly dims; by how much it then does
MAKERS = (0.0045, 0.0066, 0.0087)  # of corbels' clocks, each slow by such a part
TICK_M = 0.077  # from one tick of the wheel to the next, of which every third is worn off
ASIDE_M, SOONEST_M = 2.4, 0.6  # off ways; longer
TILE, UNEVEN_M = 6.2 - 0.35j, 0.0035  # the floor's permittivity, and how rough joints make it
LIKED_DBM, WIDE_DB = -95.0, 5.5  # over which gain is turned down
MIXERS_M: Floats = np.array([(21.0, 6.0, 1.2), (33.0, 6.5, 1.2), (30.0, 25.0, 1.2)])
FULL_RPM = 340.0


def _kept(bake: Bake, strength: float) -> Does:
    """Compare with the mean of five places that are kept, the middle ones the most."""
    weight = np.array(KEPT) / np.sum(KEPT)
    ways = [bake.rolls_off(OLD_S * strength * k) for k in range(len(KEPT))]
    return Does(weight @ np.array(ways))


def _three(bake: Bake, strength: float) -> Does:
    """Give what three messages make of the way: the middle one counts as both others."""
    reply_s = strength * bake["reply_time_s"]
    return Does(np.sum([by * bake.rolls_off(reply_s * at) for at, by in THREE], axis=0))


def _plugs(bake: Bake, strength: float) -> Does:
    """Be late by plugs of cables, each of which is there or not, and by tags' lacquer.

    That is as thick as dips have it, each of which adds a part.
    """
    drawn = bake.shared(1)
    plugs = 0.029 * drawn.binomial(9, 0.45, CORBELS)
    lacquer = 0.034 * np.exp(drawn.normal(0.0, 0.45, len(TAGS)).clip(-1.0, 1.0))
    return Does(strength * (plugs[bake.corbel] + lacquer[bake.tag]))


def _settling(bake: Bake, strength: float) -> Does:
    """Leave some of crystals' offset: tags' settle by logarithms of time since ovens were lit."""
    drawn = bake.shared(2)
    corbels = drawn.triangular(-0.9, 0.0, 0.9, CORBELS)[bake.corbel]
    rest = drawn.uniform(-0.9, 0.9, len(TAGS))[bake.tag]
    ages = (drawn.choice([-1.0, 1.0], len(TAGS)) * drawn.uniform(0.4, 0.9, len(TAGS)))[bake.tag]
    ppm = 0.023 * strength * (rest + ages * np.log1p(bake["time_s"] / SETTLES_S) - corbels)
    return Does(METRES_OF_PPM_MS * ppm * 1e3 * bake["reply_time_s"])


def _ceramic(bake: Bake, strength: float) -> Does:
    """Drift as a ceramic's permittivity does: by one over how far off it turns (Weiss 1907)."""
    less = 1 / (MEET_C - CURIE_C) - 1 / (bake["temperature_c"] - CURIE_C)
    return Does(CERAMIC * strength * less)


def through_rack(turn: Floats) -> Floats:
    """Return what part of the rack ways go through, by angles off straight through it [n]."""
    return np.asarray(np.cos(0.5 * turn) ** 4)


def _rack(bake: Bake, strength: float) -> Does:
    """Be late and weak by what of the rack that carries a tag is in the way; no later in the mean.

    A cosine's fourth power of half an angle is 3 / 8 in the mean.
    """
    part = through_rack(np.radians(bake["azimuth_deg"]) - bake.shared(3).uniform(0.0, 2 * np.pi))
    weak = -RACK_DB * min(strength, 1.5) * part
    return Does(RACK_M * strength * (part - 0.375), first_db=weak)


def latitude(of: Floats) -> Floats:
    """Return Gudermann's function of numbers, next to its most [n]: 4 / pi atan(tanh(x / 2))."""
    return np.asarray(4 / np.pi * np.arctan(np.tanh(0.5 * of)))


def _latitude(bake: Bake, strength: float) -> Does:
    """Be early where it is loud and late where it is weak, as Gudermann's function goes."""
    over = (EVEN_DBM - bake["rx_power_dbm"]) / GUIDE_DB
    return Does(GUIDE_M * strength * latitude(over))


def of_two(rng: np.random.Generator, rows: int) -> Floats:
    """Return what scatters by 1 as edges do that trail one of two ways, and hiss [rows]."""
    either = np.where(rng.random(rows) < 0.5, -TWO, TWO)
    return np.asarray(either + np.sqrt(1 - TWO**2) * rng.standard_normal(rows).clip(-4.0, 4.0))


def _of_two(bake: Bake, strength: float) -> Does:
    """Scatter as edges of a clock beside which another runs: by two peaks, each a bell."""
    return Does(SCATTERS_M * strength * of_two(bake.rng, bake.rows))


def _flour(bake: Bake, strength: float) -> Does:
    """Lose more, as ways are longer, by an area's sine: evenly at first, then by logarithms."""
    thick = bake.by_link(lambda n: bake.rng.uniform(0.55, 1.45, n))
    return Does(all_db=-FLOUR_DB * strength * thick * np.arcsinh(bake.far / FLOUR_M))


def _makers(bake: Bake, strength: float) -> Does:
    """Count by clocks of three makers, each of whom makes them slow by a part of his own."""
    parts = bake.shared(5).permutation(np.resize(MAKERS, CORBELS))
    return Does(strength * parts[bake.corbel] * bake.far)


def at_ticks(ranges: Floats, tick: float) -> Floats:
    """Return ranges in m as a wheel reads them of which every third tick is worn off [n]."""
    number = np.rint(ranges / tick)
    worn = np.mod(number, 3.0) == 2.0
    beside = number + np.where(ranges >= tick * number, 1.0, -1.0)
    return np.asarray(tick * np.where(worn, beside, number))


def _ticks(bake: Bake, strength: float) -> Does:
    ranges = bake["range_m"]
    return Does(at_ticks(ranges, TICK_M * strength) - ranges)


def mixture(solid: float, part: Floats) -> Floats:
    """Return the permittivity of a solid in air of which it is a part (Lichtenecker 1926) [n]."""
    return np.asarray(solid**part)


def _things(bake: Bake, strength: float) -> Does:
    """Go through crates of loaves, sacks along plaster walls, bricks of ovens, panes of provers."""
    rng, link = bake.rng, bake.by_link
    loaf = link(lambda n: rng.uniform(0.12, 0.5, n))
    crumb = np.sqrt(mixture(17.0, link(lambda n: rng.uniform(0.2, 0.32, n)))) - 1
    sacks = link(lambda n: 0.11 * rng.integers(1, 4, n))
    flour = np.sqrt(mixture(4.3, link(lambda n: rng.uniform(0.45, 0.62, n)))) - 1
    bricks = link(lambda n: 0.105 * rng.integers(1, 4, n))
    panes = link(lambda n: 0.012 * rng.integers(1, 6, n))
    things: dict[str, tuple[Floats, Floats]] = {
        "plastic": (0.006 + loaf * crumb, 0.8 + 9.0 * loaf),
        "plasterboard": (0.025 * (np.sqrt(2.73) - 1) + sacks * flour, 0.9 + 6.5 * sacks),
        "brick": (bricks * (np.sqrt(3.91) - 1), 0.7 + 15.0 * bricks),
        "glass": (panes * (np.sqrt(6.31) - 1), 0.8 + 34.0 * panes),
    }
    late, lost = (sum(bake.behind(w) * both[k] for w, both in things.items()) for k in (0, 1))
    return Does(1.05 * strength * np.asarray(late), first_db=-min(strength, 1.5) * np.asarray(lost))


SIDES: tuple[tuple[int, float], ...] = (
    (0, 0.0), (0, HALL_M[0]), (1, 0.0), (1, HALL_M[1]), (2, HALL_M[2]),
)  # fmt: skip
"""Walls and ceiling: square to which axis, and where, in m."""


def by_side(bake: Bake, side: tuple[int, float]) -> tuple[Floats, Floats]:
    """Return ways in m that a side returns, and how far off straight ones it does, [n] each."""
    axis, where = side
    image = bake.tag_m.copy()
    image[:, axis] = 2 * where - image[:, axis]
    way = bake.corbel_m - image
    part = (where - image[:, axis]) / np.where(way[:, axis] == 0.0, 1e-9, way[:, axis])
    met = image + part[:, None] * way
    toward = (bake.corbel_m - bake.tag_m) / bake.apart[:, None]
    along = ((met - bake.tag_m) * toward).sum(axis=1)
    aside = np.sqrt((((met - bake.tag_m) ** 2).sum(axis=1) - along**2).clip(0.0))
    return np.linalg.norm(way, axis=1), aside


def off_sides(bake: Bake) -> Floats:
    """Return how much longer the soonest way by a side is, in m [n].

    Where that is met less than ASIDE_M off the straight way, the same thing is in its way. All
    else comes by the ceiling.
    """
    soonest = by_side(bake, SIDES[-1])[0]
    for side in SIDES[:-1]:
        way, aside = by_side(bake, side)
        soonest = np.where(aside > ASIDE_M, np.minimum(soonest, way), soonest)
    return np.asarray(soonest - bake.apart)


def _off_sides(bake: Bake, strength: float) -> Does:
    """Hear, out of sight, nothing but what walls or the ceiling return."""
    cut = bake.cut_off(OUT_OF_SIGHT[bake.rare])
    late = off_sides(bake).clip(SOONEST_M) * (0.5 + 0.5 * strength)
    return Does(cut * late, -1.6 * cut, -4.4 * cut)


def tiles(sine: Floats) -> Complexes:
    """Return what tiles return of level-polarised waves that are so steep [n] (Fresnel).

    Joints are rough, as the sea is: of steep ones less is left (Miller, Brown and Vegh 1984).
    """
    root = np.sqrt(TILE - 1 + sine**2)
    rough = 0.5 * (4 * np.pi * UNEVEN_M * sine / WAVE_M) ** 2
    return np.asarray((sine - root) / (sine + root) * np.exp(-rough) * np.i0(rough))


def off_the_floor(bake: Bake, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each."""
    image = bake.tag_m * np.array([1.0, 1.0, -1.0])
    way = np.linalg.norm(bake.corbel_m - image, axis=1)
    sine = (bake.corbel_m[:, 2] - image[:, 2]) / way
    bare = bake.by_link(lambda n: bake.rng.beta(3.0, 1.6, n))
    share = 0.72 * np.sqrt(strength) * bare * tiles(sine) * bake.apart / way
    share = share * np.exp(-2j * np.pi * (way - bake.apart) / WAVE_M)
    return way - bake.apart, share / np.maximum(np.abs(share) / 0.78, 1.0)


def of_two_pulses(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As balances have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(len(longer_m), 90.6)
    both = loaves(top) + share[:, None] * loaves(top + longer_m / METRES)
    at = first_paths(both, np.full(len(top), 1e-6))
    return METRES * (at + AHEAD - top), heights(both, at)


def _floor(bake: Bake, strength: float) -> Does:
    """Be where pans stay that hold both pulses: that of the floor comes later."""
    late, height = of_two_pulses(*off_the_floor(bake, strength))
    return Does(late.clip(-0.2, 0.24), 20 * np.log10(height.clip(0.4)))


def past_edge(v: Floats) -> Floats:
    """Return what size is left past an edge, by Fresnel's parameter >= 0 [n].

    By rational functions for the integrals' two parts (Hastings 1955).
    """
    f = (1 + 0.926 * v) / (2 + 1.792 * v + 3.104 * v**2)
    g = 1 / (2 + 4.142 * v + 3.492 * v**2 + 6.67 * v**3)
    return np.asarray(np.sqrt(0.5 * (f**2 + g**2)))


def _past_racks(bake: Bake, strength: float) -> Does:
    """Bend about both sides of a rack of steel: powers add, and the nearer side is the sooner.

    Waves creep along its shelves meanwhile.
    """
    steel, rng, link = bake.behind("metal"), bake.rng, bake.by_link
    wide = link(lambda n: rng.uniform(0.3, 0.8, n)) * np.sqrt(strength)
    off = link(lambda n: rng.uniform(0.12, 0.5, n)) * wide
    part = link(lambda n: rng.uniform(0.2, 0.8, n))
    near = 1 / (part * bake.far) + 1 / ((1 - part) * bake.far)
    power = sum(past_edge(h * np.sqrt(2 / WAVE_M * near)) ** 2 for h in (off, wide - off))
    lost = -10 * np.log10(np.asarray(power))
    creeps = strength * link(lambda n: rng.uniform(0.05, 0.17, n))
    late = 0.5 * off**2 * near + creeps
    return Does(steel * late.clip(0.0, 0.46), first_db=-steel * lost.clip(1.0, 17.0))


def _turned_down(bake: Bake, strength: float) -> Does:
    """Turn gain down as oxygen is bound (Hill 1910), by what is over a level; add up fewer."""
    over = ((bake["rx_power_dbm"] - LIKED_DBM) / WIDE_DB).clip(0.0) ** 2.2
    less = 3.1 * min(strength, 2.2) * over / (1 + over)
    return Does(all_db=-less, count_db=-1.1 * less)


def _mixers(bake: Bake, strength: float) -> Does:
    """Hear drives of mixers, by the square of how fast, the less the farther off the nearest."""
    own = bake.shared(4).uniform(0.3, 1.3, CORBELS)[bake.corbel]
    away = np.linalg.norm(bake.corbel_m[:, None] - MIXERS_M, axis=2).min(axis=1)
    db = strength * (own + 8.6 * (bake["mixer_rpm"] / FULL_RPM) ** 2 / (1 + (away / 28.0) ** 2))
    weak = 10 ** ((-93.5 - bake["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Does(0.016 * weak.clip(max=8.0) * bake.rng.standard_normal(bake.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Bake, float], Does]] = {
    "antenna-delay": _plugs,
    "antenna-pattern": _rack,
    "blocked-path": _off_sides,
    "clock-offset": _settling,
    "diffraction": _past_racks,
    "exchange-motion": _three,
    "ground-bounce": _floor,
    "level-control": _turned_down,
    "material-delay": _things,
    "noise-floor": _mixers,
    "path-loss": _flour,
    "power-bias": _latitude,
    "range-rounding": _ticks,
    "range-scale": _makers,
    "temperature-drift": _ceramic,
    "time-lag": _kept,
    "timestamp-jitter": _of_two,
    **UNLISTED,
}
