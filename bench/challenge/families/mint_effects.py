"""What the mint hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the mint's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.mint_assay import (
    AHEAD,
    LIGHT_M_NS,
    SAMPLE_NS,
    assayed,
    coins,
    heights,
)
from bench.challenge.families.mint_court import (
    DAY_S,
    LIGHT_M_US,
    QUOINS,
    ROOM_M,
    TAGS,
    WAVE_M,
    Tally,
    Toll,
)
from bench.challenge.families.mint_faults import OF_THE_MINT

Floats = NDArray[np.float64]
Integers = NDArray[np.int64]
Complexes = NDArray[np.complex128]
CUT_OFF = {False: 0.21, True: 0.08}  # of links, and where these are rare
BUFFER_S = 0.125  # by which places come late, in the mean
NODES, WEIGHTS = np.polynomial.legendre.leggauss(3)
FEEDS_M, LOT_M, HOLDERS_M = 0.04, 0.045, 0.07  # late by quoins at least, by lots; by tags
OFF_PPM, AGES_PPM = 0.013, 0.02  # crystals off; by which these age in a day
EVEN_C, SPAN_C, WARM_M = 19.0, 8.0, 0.055  # of what no more drifts; to half; at most, twice so
LOBES_M, LOBES_DB = (0.05, 0.042), 3.4  # once and twice round; weaker at most
BIAS_M, EVEN_DBM, OVER_DB = 0.06, -88.0, 4.0  # at most; of none; until half
SPUR_M = 0.062  # of what swings stamps to and fro
EXPONENT, LINKS_DB, MOST_DB = 0.42, 1.4, 10.0  # more of distance; how links scatter; at most
SHORT = 0.0088  # parts that quoins' clocks count more
STEPS_M = (0.12, 0.15, 0.2)  # of three makes of tags
SOONEST_M, LONGEST_M = 0.6, 3.8  # of ways by walls, longer than straight ones
FLOOR, LOSSY = 7.07, 0.25  # permittivity of marble
RACK_M = (0.5, 1.15)  # by which edges of racks stand over straight ways
FROM_DBM, FLATTER, FEWER = -93.0, 0.3, 0.5  # of a knee; part that is lost over it; of symbols
FURNACE_M: Floats = np.array([6.0, 15.0, 1.2])
FULL_KW, ROARS_DB, NEAR_M = 30.0, 8.0, 10.0


def _buffered(tally: Tally, strength: float) -> Toll:
    """Compare with places that came through a buffer twice, by weights of a triangle."""
    late_s = BUFFER_S * strength
    return Toll(
        sum(w * tally.recedes(k * late_s) for k, w in ((0.5, 0.25), (1.0, 0.5), (1.5, 0.25)))
    )


def _exchanged(tally: Tally, strength: float) -> Toll:
    """Go ways of an exchange in the mean of all its time (Gauss 1814)."""
    long_s = 2.4 * strength * tally["reply_time_s"]
    parts = [w * tally.recedes((1 + k) * long_s) for k, w in zip(NODES, WEIGHTS, strict=True)]
    return Toll(0.5 * sum(parts))


def _feeds(tally: Tally, strength: float) -> Toll:
    """Be late by feeds of quoins, which come in lots, and by holders of tags."""
    drawn = tally.alike(1)
    feeds = FEEDS_M + LOT_M * drawn.poisson(1.4, QUOINS).clip(max=4)
    holders = HOLDERS_M * drawn.triangular(0.0, 0.6, 1.5, len(TAGS))
    return Toll(strength * (feeds[tally.quoin] + holders[tally.tag]))


def _ages(tally: Tally, strength: float) -> Toll:
    """Leave some of crystals' offsets, each of which ages at a rate of its own."""
    drawn = tally.alike(2)
    every = QUOINS + len(TAGS)
    off = OFF_PPM * drawn.normal(size=every).clip(-2.0, 2.0)
    rate = AGES_PPM * drawn.uniform(-1.0, 1.0, every)

    def ppm(one: Integers) -> Floats:
        return np.asarray(off[one] + rate[one] * (tally["time_s"] / DAY_S - 0.5))

    apart = ppm(tally.quoin) - ppm(QUOINS + tally.tag)
    return Toll(0.5 * LIGHT_M_US * strength * apart * tally["reply_time_s"])


def of_warmth(warm_c: Floats) -> Floats:
    """Return how far ovens of crystals drift by warmth in deg C, 1 at SPAN_C over EVEN_C [n]."""
    return np.asarray(4 / np.pi * np.arctan((warm_c - EVEN_C) / SPAN_C))


def _warms(tally: Tally, strength: float) -> Toll:
    return Toll(WARM_M * strength * of_warmth(tally["temperature_c"]))


def _lobes(tally: Tally, strength: float) -> Toll:
    """Be late and weak once round and twice, by where tags face."""
    facing = np.radians(tally["azimuth_deg"])
    once, twice = np.cos(facing - 0.6), np.cos(2 * facing + 0.9)
    weak = (0.5 - 0.35 * once + 0.15 * twice).clip(0.0)
    return Toll(strength * (LOBES_M[1] * twice - LOBES_M[0] * once), -LOBES_DB * strength * weak)


def _bias(tally: Tally, strength: float) -> Toll:
    """Be early where it is loud, late where it is weak, ever less more so."""
    over = (EVEN_DBM - tally["rx_power_dbm"]) / OVER_DB
    return Toll(BIAS_M * strength * over / np.sqrt(1 + over**2))


def _spur(tally: Tally, strength: float) -> Toll:
    """Tell stamps that a spur swings to and fro, at any phase (of an arcsine's law)."""
    return Toll(SPUR_M * strength * np.sin(tally.rng.uniform(-np.pi, np.pi, tally.rows)))


def _farther(tally: Tally, strength: float) -> Toll:
    """Lose by a greater power of distance, links more or less so."""
    more = tally.links(lambda n: LINKS_DB * tally.rng.triangular(-1.0, 0.0, 1.0, n))
    lost = 10 * EXPONENT * np.log10(tally.far) + more
    return Toll(level_db=-strength * lost.clip(0.0, MOST_DB))


def _short(tally: Tally, strength: float) -> Toll:
    """Count parts too many, by the clock of the quoin."""
    own = tally.alike(3).uniform(0.7, 1.3, QUOINS)
    return Toll(SHORT * strength * own[tally.quoin] * tally.far)


def _steps(tally: Tally, strength: float) -> Toll:
    """Tell ranges by whole steps of a tag's make."""
    step, told = strength * np.array(STEPS_M)[tally.tag % 3], tally["range_m"]
    return Toll(step * np.rint(told / step) - told)


def slab(slow: float, thick_m: Floats, sine: Floats) -> Floats:
    """Return how much longer ways are through slabs of a permittivity, met so aslant, in m [n]."""
    return np.asarray(thick_m * (np.sqrt(slow - sine**2) - np.sqrt(1 - sine**2)))


def _through(tally: Tally, strength: float) -> Toll:
    """Go through strongrooms, counters, crates, cases, and both walls of the court."""
    rng, links = tally.rng, tally.links
    sine = links(lambda n: rng.beta(1.5, 2.0, n))
    each = {
        "concrete": (5.24, links(lambda n: rng.uniform(0.12, 0.3, n)), 22.0),
        "marble": (7.074, links(lambda n: rng.uniform(0.02, 0.05, n)), 25.0),
        "chipboard": (2.58, 0.019 * links(lambda n: 1.0 + rng.poisson(4.0, n).clip(max=9)), 20.0),
        "glass": (6.31, 0.006 * links(lambda n: 2.0 + rng.binomial(5, 0.4, n)), 30.0),
        "brick": (3.91, 2 * links(lambda n: rng.choice([0.06, 0.12, 0.18], n)), 13.0),
    }
    late, lost = np.zeros(tally.rows), np.zeros(tally.rows)
    for what, (slow, thick_m, db) in each.items():
        there = tally.meets(what)
        late += there * slab(slow, thick_m, sine)
        lost += there * (0.4 + db * thick_m)
    return Toll(strength * late.clip(max=0.58), first_db=-min(strength, 1.4) * lost.clip(max=9.5))


def by_walls(tally: Tally) -> Floats:
    """Return how much longer ways by one of four outer walls are, in m [n]."""
    wall = tally.links(lambda n: tally.rng.integers(0, 4, n)).astype(np.int64)
    image, axis = tally.quoin_m.copy(), wall % 2
    rows = np.arange(tally.rows)
    image[rows, axis] = 2 * np.array(ROOM_M)[axis] * (wall > 1) - image[rows, axis]
    longer = np.linalg.norm(image - tally.tag_m, axis=1) - tally.far
    return np.asarray(longer.clip(SOONEST_M, LONGEST_M))


def _by_walls(tally: Tally, strength: float) -> Toll:
    """Hear, out of sight, nothing but what outer walls return."""
    cut = tally.cut_off(CUT_OFF[tally.rare])
    return Toll(cut * by_walls(tally) * strength**0.4, -0.9 * cut, -5.8 * cut)


def upright_waves(sine: Floats, slow: complex) -> Complexes:
    """Return what a floor so dense returns of upright waves so steep [n] (Fresnel)."""
    root = np.sqrt(slow - 1 + sine**2 + 0j)
    return np.asarray((slow * sine - root) / (slow * sine + root))


def off_marble(tally: Tally, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each."""
    high = tally.tag_m[:, 2] + tally.quoin_m[:, 2]
    level = tally.far**2 - (tally.quoin_m[:, 2] - tally.tag_m[:, 2]) ** 2
    way = np.sqrt(level + high**2)
    bare = tally.links(lambda n: tally.rng.uniform(0.45, 0.95, n))
    size = np.sqrt(strength) * 1.9 * bare * tally.far / way
    share = size * upright_waves(high / way, FLOOR - 1j * LOSSY)
    share *= np.minimum(1.0, 0.76 / np.abs(share).clip(1e-9))
    return way - tally.far, share * np.exp(-2j * np.pi * (way - tally.far) / WAVE_M)


def told_of_two(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As assays have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(len(longer_m), 88.6)
    each_m = LIGHT_M_NS * SAMPLE_NS
    both = coins(top) + share[:, None] * coins(top + longer_m / each_m)
    at = assayed(both)
    return each_m * (at - top + AHEAD), heights(both, at, np.full(len(top), 1e-7))


def _floor(tally: Tally, strength: float) -> Toll:
    """Be where an assay has both pulses: that of the floor comes later."""
    late, high = told_of_two(*off_marble(tally, strength))
    return Toll(late.clip(-0.24, 0.24), first_db=20 * np.log10(high.clip(0.4, 2.2)))


def over_edges(far: Floats, part: Floats, high: Floats) -> tuple[Floats, Floats]:
    """Return how much longer ways over edges are in m, and what these take in dB, [n] each.

    Edges stand so high over straight ways, a part of these from one end (Lee 1985).
    """
    one, other = part * far, (1 - part) * far
    longer = np.hypot(one, high) + np.hypot(other, high) - far
    bend = high * np.sqrt(2 * far / (WAVE_M * one * other))
    near = 6 + 7 * bend.clip(0.0, 1.0)
    return longer, np.where(bend > 1.0, 13.0 + 20 * np.log10(bend.clip(1.0)), near)


def _racks(tally: Tally, strength: float) -> Toll:
    """Bend over the edges of racks of gold."""
    rng, gold = tally.rng, tally.meets("metal")
    high = np.sqrt(strength) * tally.links(lambda n: rng.uniform(*RACK_M, n))
    part = tally.links(lambda n: rng.uniform(0.25, 0.75, n))
    longer, lost = over_edges(tally.far, part, np.minimum(high, 0.3 * tally.far))
    return Toll(gold * longer.clip(0.0, 0.46), first_db=-gold * lost.clip(1.0, 10.0))


def _flatter(tally: Tally, strength: float) -> Toll:
    """Tell levels over a knee by less than they rise, and sum fewer symbols there."""
    over = (tally["rx_power_dbm"] - FROM_DBM).clip(0.0, 18.0)
    less = min(FLATTER * strength, 0.75) * over
    return Toll(level_db=-less, count_db=-FEWER * min(strength, 2.0) * (over - 6.0).clip(0.0))


def _furnace(tally: Tally, strength: float) -> Toll:
    """Hear an arc furnace, tags near it the more; all are a little noisier anyway."""
    own = tally.alike(4).uniform(0.1, 0.9, len(TAGS))[tally.tag]
    away = np.linalg.norm(tally.tag_m - FURNACE_M, axis=1)
    roars = ROARS_DB * (tally["furnace_kw"] / FULL_KW) / (1 + (away / NEAR_M) ** 2)
    db = strength * (own + roars)
    weak = 10 ** ((-91.0 - tally["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    late = 0.013 * tally.rng.standard_normal(tally.rows).clip(-3.5, 3.5) * weak.clip(max=6.0)
    return Toll(late, noise_db=db)


EFFECTS: dict[str, Callable[[Tally, float], Toll]] = {
    "antenna-delay": _feeds,
    "antenna-pattern": _lobes,
    "blocked-path": _by_walls,
    "clock-offset": _ages,
    "diffraction": _racks,
    "exchange-motion": _exchanged,
    "ground-bounce": _floor,
    "level-control": _flatter,
    "material-delay": _through,
    "noise-floor": _furnace,
    "path-loss": _farther,
    "power-bias": _bias,
    "range-rounding": _steps,
    "range-scale": _short,
    "temperature-drift": _warms,
    "time-lag": _buffered,
    "timestamp-jitter": _spur,
    **OF_THE_MINT,
}
