"""What the pottery hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the pottery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.pottery_cone import (
    AHEAD,
    LIGHT_M_NS,
    SAMPLE_NS,
    slumped,
    thuds,
    weight,
)
from bench.challenge.families.pottery_faults import OF_THE_POTTERY
from bench.challenge.families.pottery_floor import (
    KILN_M,
    LIGHT_M_US,
    PURLINS,
    TAGS,
    WAVE_M,
    WORKS_M,
    Firing,
    Toll,
    lengths,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
SHUT = {False: 0.2, True: 0.08}  # of links, and where these are rare
BEHIND_S, MORE_S, FILLS_S = (
    0.06,
    0.07,
    2.5,
)  # of places: at first; more once a buffer is full; to 0.6
SLOTS = 7  # of an exchange; purlins have them by turns
STUBS_M, STUBS = (0.03, 0.2), (1.4, 2.2)  # of purlins' aerials; of a beta law
DISC_M, DISCS = 0.026, (4, 0.4)  # of tags' ceramic discs; how many are stacked (binomial)
SET_PPM, WARM_PPM, SET_C = 0.02, 0.018, 24.0  # of crystals; for each 10 K off where they were set
GROWS_M, GROWS_C = 0.042, 20.0  # late by an exponential of warmth
SIDE_M, TWICE_M, EDGE, HIDES_DB = 0.05, 0.021, 2.2, 3.8  # of patches; how sharp; weaker behind
TABLE_DBM = (-94.0, -89.0, -85.0, -81.5, -78.0, -75.0, -70.0)
TABLE_M = (0.082, 0.06, 0.034, 0.0, -0.03, -0.048, -0.062)
"""Of a maker's table of how ranges lean by levels, and what is between on straight lines."""
LAPLACE_M, FARTHEST = 0.026, 5.0  # of stamps; of the law's own unit, at most
RANKS_DB, RANKS, OWN = 0.85, 0.588, 0.28  # of racks at a metre; power of distance; e-folds of links
REELS, LOT, FAST = (
    3.0,
    4,
    0.0145,
)  # of a chi square; purlins of one lot; parts that are counted more
STEPS_M = (0.09, 0.12, 0.15)  # that lots of purlins write
EXCESS_M, EXCESS, SHORT_M, LONG_M = 1.1, 1.6, 0.5, 4.6  # of a Weibull law; bounds of what is late
TILES = 6.2 - 0.7j
GROUT_M, SLANT = (0.001, 0.009), (0.25, 1.0)  # how uneven floors are; radians of aerials off level
EDGES_M = (0.4, 1.05)  # of racks, to either side of straight ways
KNEE_DBM, EASES_DB, FEWER = -83.0, 5.0, 0.35
HUM_DB, HUM_KW, SPREAD = 5.2, 70.0, (0.6, 1.4)  # of noise, at most; to 0.6; of purlins


def _buffered(firing: Firing, strength: float) -> Toll:
    """Compare with places that are the later the longer a buffer has been filling."""
    full = -np.expm1(-firing.course["into_s"] / FILLS_S)
    return Toll(firing.draws_off(strength * (BEHIND_S + MORE_S * full)))


def _slots(firing: Firing, strength: float) -> Toll:
    """Go ways of the messages before and after a purlin's slot, in the mean."""
    reply_s, slot = strength * firing["reply_time_s"], 1 + firing.purlin % SLOTS
    return Toll(0.5 * (firing.draws_off(reply_s * slot) + firing.draws_off(reply_s * (slot + 1))))


def _stubs(firing: Firing, strength: float) -> Toll:
    """Be late by stubs of purlins' aerials (of a beta law) and by stacks of tags' discs."""
    drawn = firing.common(1)
    stubs = STUBS_M[0] + (STUBS_M[1] - STUBS_M[0]) * drawn.beta(*STUBS, PURLINS)
    discs = DISC_M * drawn.binomial(*DISCS, len(TAGS))
    return Toll(strength * (stubs[firing.purlin] + discs[firing.tag]))


def _warmed(firing: Firing, strength: float) -> Toll:
    """Leave some of crystals' offsets, each of which goes with warmth at a slope of its own."""
    drawn = firing.common(2)
    ends = [drawn.triangular(-2.0, 0.0, 2.0, (2, n)) for n in (PURLINS, len(TAGS))]
    off, slope = ends[1][:, firing.tag] - ends[0][:, firing.purlin]
    ppm = SET_PPM * off + WARM_PPM * slope * (firing["temperature_c"] - SET_C) / 10
    return Toll(0.5 * LIGHT_M_US * strength * ppm * firing["reply_time_s"])


def _grows(firing: Firing, strength: float) -> Toll:
    """Be late by an exponential of warmth, as what leaks in parts doubles."""
    return Toll(GROWS_M * strength * np.expm1((firing["temperature_c"] - 22.0) / GROWS_C))


def _patches(firing: Firing, strength: float) -> Toll:
    """Be late on one side and soon on the other, all alike but at edges, and twice round a little.

    Weak behind, by the square of how far behind.
    """
    facing = np.radians(firing["azimuth_deg"])
    late = SIDE_M * np.tanh(EDGE * np.sin(facing + 0.5)) + TWICE_M * np.cos(2 * facing)
    return Toll(strength * late, -HIDES_DB * strength * (-np.cos(facing)).clip(0.0) ** 2)


def _leans(firing: Firing, strength: float) -> Toll:
    """Be early where it is loud, late where it is weak, by a table of its maker's."""
    return Toll(strength * np.interp(firing["rx_power_dbm"], TABLE_DBM, TABLE_M))


def _stamps(firing: Firing, strength: float) -> Toll:
    """Stamp by as much too soon or late as chance has it (Laplace 1774)."""
    chance = firing.rng.laplace(0.0, 1.0, firing.rows).clip(-FARTHEST, FARTHEST)
    return Toll(LAPLACE_M * strength * chance)


def _ranks(firing: Firing, strength: float) -> Toll:
    """Lose amid racks as waves do amid leaves: by a power of the way (Weissberger 1982)."""
    own = firing.each_link(lambda n: np.exp(OWN * firing.rng.triangular(-2.0, 0.0, 2.0, n)))
    return Toll(level_db=-RANKS_DB * strength * own * firing.far**RANKS)


def _lots(firing: Firing, strength: float) -> Toll:
    """Count parts too many, by clocks that came in lots (of a chi square)."""
    drawn = firing.common(3).chisquare(REELS, -(-PURLINS // LOT)).clip(0.6, 7.0) / REELS
    return Toll(FAST * 0.5 * strength * drawn[firing.purlin // LOT] * firing.far)


def _steps(firing: Firing, strength: float) -> Toll:
    """Write the step before or after, by chance, the likelier the nearer it is (dither)."""
    wide, told = strength * np.array(STEPS_M)[firing.purlin % 3], firing["range_m"]
    return Toll(wide * np.floor(told / wide + firing.rng.random(firing.rows)) - told)


def slabbed(thick_m: Floats, slow: Floats, sine: Floats) -> Floats:
    """Return how much later waves are behind slabs, met at angles of such sines, in m (Snell)."""
    return np.asarray(thick_m * (np.sqrt(slow - sine**2) - np.sqrt(1 - sine**2)))


def damped(dry: float, moist: Floats) -> Floats:
    """Return permittivities of what holds a part of water (Lichtenecker 1926)."""
    return np.asarray(dry ** (1 - moist) * 79.0**moist)


def _slabs(firing: Firing, strength: float) -> Toll:
    """Go through slabs that are more or less damp."""
    rng, each_link = firing.rng, firing.each_link
    sine = each_link(lambda n: np.sin(rng.uniform(0.0, 0.9, n)))
    kinds = {
        "brick": (3.6, each_link(lambda n: rng.uniform(0.14, 0.28, n)), 0.06, 20),
        "concrete": (5.4, each_link(lambda n: rng.uniform(0.1, 0.2, n)), 0.03, 22),
        "wood": (2.0, each_link(lambda n: rng.uniform(0.08, 0.16, n)), 0.09, 22),
        "plasterboard": (2.6, each_link(lambda n: rng.choice([0.05, 0.09], n)), 0.12, 24),
        "chipboard": (2.4, each_link(lambda n: rng.uniform(0.03, 0.06, n)), 0.06, 28),
        "glass": (6.3, each_link(lambda n: rng.choice([0.016, 0.025], n)), 0.0, 50),
    }
    late, lost = np.zeros(firing.rows), np.zeros(firing.rows)
    for what, (dry, thick_m, most, db) in kinds.items():
        moist, met = most * each_link(rng.random), firing.through(what)
        late += met * slabbed(thick_m, damped(dry, moist), sine)
        lost += met * (0.8 + thick_m * (db + 100.0 * moist) / np.sqrt(1 - sine**2))
    return Toll(strength * late.clip(max=0.33), first_db=-min(strength, 1.4) * lost.clip(max=9.0))


def by_the_kiln(firing: Firing) -> Floats:
    """Return how much longer the shortest ways off the kiln's flank are, in m [n].

    At points of its outside that both ends see, at heights amid; of others the shorter roof's way.
    """
    angle = np.linspace(0.0, 2 * np.pi, 72, endpoint=False)
    out = np.stack([np.cos(angle), np.sin(angle)], axis=1)
    high, best = 0.5 * (firing.tag_m[:, 2] + firing.purlin_m[:, 2]), []
    for one in out:
        at = np.column_stack([np.tile(np.array(KILN_M[:2]) + KILN_M[2] * one, (firing.rows, 1)),
                              high])  # fmt: skip
        ways = [firing.tag_m - at, firing.purlin_m - at]
        seen = np.all([way[:, :2] @ one > 0 for way in ways], axis=0)
        best.append(np.where(seen, lengths(ways[0]) + lengths(ways[1]), np.inf))
    roof = lengths(firing.purlin_m * [1.0, 1.0, -1.0] + [0.0, 0.0, 2 * WORKS_M[2]] - firing.tag_m)
    return np.asarray(np.minimum(np.min(best, axis=0), roof) - firing.far)


def _flank(firing: Firing, strength: float) -> Toll:
    """Hear, out of sight, nothing but what the kiln's flank or the roof returns."""
    shut = firing.shut_off(SHUT[firing.rare])
    more = EXCESS_M * firing.each_link(lambda n: firing.rng.weibull(EXCESS, n))
    late = (by_the_kiln(firing) + more).clip(SHORT_M, LONG_M)
    return Toll(shut * late * strength**0.4, -1.0 * shut, -6.0 * shut)


def returned(slow: complex, sine: Floats, slant: Floats) -> Complexes:
    """Return what a floor returns of waves so steep, of aerials so far off level [n] (Fresnel)."""
    under = np.sqrt(slow - (1 - sine**2) + 0j)
    level = (sine - under) / (sine + under)
    upright = (slow * sine - under) / (slow * sine + under)
    return np.asarray(level + np.sin(slant) ** 2 * (upright - level))


def off_the_tiles(firing: Firing, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    What is uneven returns less, by a bell of how uneven it looks (Rayleigh; Ament 1953).
    """
    rise = firing.tag_m[:, 2] + firing.purlin_m[:, 2]
    way = np.sqrt(firing.far**2 + 4 * firing.tag_m[:, 2] * firing.purlin_m[:, 2])
    grout = firing.each_link(lambda n: firing.rng.uniform(*GROUT_M, n))
    slant = firing.each_link(lambda n: firing.rng.uniform(*SLANT, n))
    kept = np.exp(-8 * (np.pi * grout * rise / way / WAVE_M) ** 2)
    share = 2.0 * np.sqrt(strength) * kept * firing.far / way * returned(TILES, rise / way, slant)
    share = share / np.maximum(1.0, np.abs(share) / 0.78)
    return way - firing.far, share * np.exp(-2j * np.pi * (way - firing.far) / WAVE_M)


def told_of_both(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As cones have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(np.shape(longer_m), 90.4)
    each = LIGHT_M_NS * SAMPLE_NS
    both = thuds(top) + share[:, None] * thuds(top + longer_m / each)
    told = slumped(both)
    return each * (told + AHEAD - top), weight(both, told, np.full(len(top), 1e-6))


def _ground(firing: Firing, strength: float) -> Toll:
    """Be where a cone has both pulses: that of the floor comes later."""
    late, high = told_of_both(*off_the_tiles(firing, strength))
    return Toll(late.clip(-0.24, 0.24), first_db=20 * np.log10(high.clip(0.4, 2.2)))


def edge_db(bend: Floats) -> Floats:
    """Return what an edge takes in dB by Fresnel's parameter [n] (Lee 1985)."""
    gains = np.select(
        [bend <= -0.8, bend <= 0, bend <= 1, bend <= 2.4],
        [np.ones_like(bend), 0.5 - 0.62 * bend, 0.5 * np.exp(-0.95 * bend),
         0.4 - np.sqrt(np.maximum(0.1184 - (0.38 - 0.1 * bend) ** 2, 0.0))],
        0.225 / np.maximum(bend, 2.4),
    )  # fmt: skip
    return np.asarray(-20 * np.log10(gains))


def round_racks(far: Floats, part: Floats, sides: Floats) -> tuple[Floats, Floats]:
    """Return how much longer the shorter way round a rack is in m, and its loss in dB, [n] each.

    `sides` [2, n]: how far its edges are from the straight way; what comes by both adds in power.
    """
    one, other = part * far, (1 - part) * far
    longer = np.hypot(one, sides) + np.hypot(other, sides) - far
    lost = edge_db(sides * np.sqrt(2 * far / (WAVE_M * one * other)))
    return longer.min(axis=0), -10 * np.log10((10 ** (-lost / 10)).sum(axis=0))


def _racks(firing: Firing, strength: float) -> Toll:
    """Bend round both sides of racks of trays."""
    rng, racked = firing.rng, firing.through("metal")
    sides = np.stack([firing.each_link(lambda n: rng.uniform(*EDGES_M, n)) for _ in range(2)])
    part = firing.each_link(lambda n: rng.triangular(0.15, 0.5, 0.85, n))
    wide = np.minimum(np.sqrt(strength) * sides, 0.3 * firing.far)
    longer, lost = round_racks(firing.far, part, wide)
    return Toll(racked * longer.clip(0.0, 0.45), first_db=-racked * lost.clip(1.0, 9.5))


def _eases(firing: Firing, strength: float) -> Toll:
    """Tell levels over a knee by a root of these, and sum fewer symbols there."""
    over = (firing["rx_power_dbm"] - KNEE_DBM).clip(0.0, 24.0)
    less = over - EASES_DB * (np.sqrt(1 + 2 * over / EASES_DB) - 1)
    return Toll(level_db=-min(strength, 1.5) * less, count_db=-FEWER * min(strength, 2.0) * less)


def _elements(firing: Firing, strength: float) -> Toll:
    """Hear thyristors of kilns: noise rises in dB by their kW, ever less; by purlins more or so."""
    own = firing.common(4).uniform(*SPREAD, PURLINS)[firing.purlin]
    db = -HUM_DB * strength * own * np.expm1(-firing["kiln_kw"] / HUM_KW)
    weak = 10 ** ((-82.0 - firing["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    chance = firing.rng.triangular(-2.45, 0.0, 2.45, firing.rows)
    return Toll(0.0065 * chance * weak.clip(max=5.0), noise_db=db)


EFFECTS: dict[str, Callable[[Firing, float], Toll]] = {
    "antenna-delay": _stubs,
    "antenna-pattern": _patches,
    "blocked-path": _flank,
    "clock-offset": _warmed,
    "diffraction": _racks,
    "exchange-motion": _slots,
    "ground-bounce": _ground,
    "level-control": _eases,
    "material-delay": _slabs,
    "noise-floor": _elements,
    "path-loss": _ranks,
    "power-bias": _leans,
    "range-rounding": _steps,
    "range-scale": _lots,
    "temperature-drift": _grows,
    "time-lag": _buffered,
    "timestamp-jitter": _stamps,
    **OF_THE_POTTERY,
}
