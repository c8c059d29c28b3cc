"""What the saltworks hide in ranges and levels: effects in forms of their own.

numpy alone; shared by the works' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.saltworks_faults import UNLISTED
from bench.challenge.families.saltworks_gauge import (
    FINE,
    METRES,
    OF_TOP,
    hump,
    summit,
    teager,
    unsurpassed,
)
from bench.challenge.families.saltworks_pans import (
    PER_PPM_M,
    TAGS,
    VANES,
    VANES_M,
    WAVE_M,
    Haul,
    Levy,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
UNSEEN = {False: 0.2, True: 0.075}  # of links, and where these are rare
WINDOW_S, PARTS = 0.21, 6  # past, that places are means over; in which these are summed
DURAND: Floats = np.array([0.4, 1.1, 1.0, 1.1, 0.4]) / 4
"""Weights of five places of an exchange, from its beginning to its end."""
EXCHANGE = 3.4  # replies that an exchange lasts
LEARNS_S, NEVER = 0.9, 0.45  # of a loop: until e times less; what it never learns
GAP_M_K, DEBYE_K, READ_K = 0.0115, 636.0, 290.0  # of silicon's gap; at which it was calibrated
POST_DEG = 62.0  # on either side of a post's middle until its edge
LOUDEST_DBM, SPAN_DB = -65.0, 31.0  # between which and how far below it biases turn over
LAMBDA = -0.11  # of Tukey's law: ends are heavier than a bell's
VERNIER_M = (0.13, 0.21)  # steps of both scales
TRIMMED, STEEPER = 0.0042, 1.09  # by how much the first vane's divider is slow; the next, more
HAZE_M = 3.2  # of height until haze is e times thinner
HEAPS_M: Floats = np.array([
    (11.0, 22.9, 2.0, 2.8), (32.5, 23.1, 2.3, 3.1), (53.4, 22.8, 1.9, 2.6), (24.0, -4.6, 4.4, 6.0),
    (56.0, -5.0, 4.1, 5.4), (9.0, 50.6, 4.6, 6.2), (49.0, 50.2, 3.9, 5.2),
    (6.0, 8.0, 0.9, 1.2), (20.0, 6.0, 1.0, 1.3), (27.0, 15.0, 0.8, 1.1), (39.0, 8.5, 1.1, 1.4),
    (57.0, 14.0, 0.9, 1.2), (6.5, 36.0, 1.0, 1.3), (22.0, 38.0, 0.9, 1.2), (28.0, 31.0, 1.1, 1.4),
    (41.0, 34.0, 0.8, 1.1), (58.0, 37.0, 1.0, 1.3),
])  # fmt: skip
"""Where heaps are, how wide in half and how high, in m: old ones on dykes, new ones in beds."""
MILLS_M: Floats = np.array([(70.0, 30.0), (-5.0, 38.0)])
CUT_IN_MS, RATED_MS = 3.0, 13.0  # of mills
BRINE, SALT = 44.0 - 56.0j, 5.6 - 0.03j  # permittivities at 4 GHz
PADE = (1.0553, 1.8075, 2.3441)  # of what is left past edges, fitted here
ROUND: Floats = np.cos(np.linspace(0.0, np.pi, 24, endpoint=False) + np.pi / 48)


def _welch(haul: Haul, strength: float) -> Levy:
    """Compare with places that are means over a window in the past, a parabola (Welch 1967)."""
    part = (np.arange(PARTS) + 0.5) / PARTS
    ways = [haul.farther_after(strength * WINDOW_S * one) for one in part]
    return {"m": np.average(ways, axis=0, weights=part * (1 - part))}


def _durand(haul: Haul, strength: float) -> Levy:
    """Give the mean of the way over an exchange, by Durand's rule (1894)."""
    whole_s = EXCHANGE * strength * haul.of("reply_time_s")
    ways = [haul.farther_after(whole_s * k / 4) for k in range(5)]
    return {"m": np.tensordot(DURAND, np.stack(ways), 1)}


def _soaked(haul: Haul, strength: float) -> Levy:
    """Be late by brine that seeps into cables, by the root of seasons; by how tags were potted."""
    drawn = haul.same(1)
    seasons, potted = drawn.integers(0, 16, VANES), drawn.beta(1.2, 2.0, len(TAGS))
    return {"m": strength * (0.022 * np.sqrt(seasons)[haul.vane] + 0.16 * potted[haul.tag])}


def _learned(haul: Haul, strength: float) -> Levy:
    """Leave some of crystals' offset, the less the longer a loop has heard a link's messages."""
    drawn = haul.same(2)
    vanes, tags = drawn.normal(0.0, 0.45, VANES).clip(-1, 1), drawn.choice([-1.1, 0.4, 1.3], 13)
    left = NEVER + (1 - NEVER) * np.exp(-haul.since_s / LEARNS_S)
    ppm = 0.024 * strength * left * (tags[haul.tag] - vanes[haul.vane])
    return {"m": PER_PPM_M * ppm * haul.of("reply_time_s")}


def gap_k(celsius: Floats | float) -> Floats:
    """Return by how much a semiconductor's gap has closed, in K of its law (Varshni 1967)."""
    kelvin = np.asarray(celsius, np.float64) + 273.15
    return np.asarray(kelvin**2 / (kelvin + DEBYE_K))


def _gap(haul: Haul, strength: float) -> Levy:
    """Drift as diodes do whose gap closes with warmth."""
    closed = gap_k(haul.of("temperature_c")) - gap_k(READ_K - 273.15)
    return {"m": GAP_M_K * strength * closed}


def _post(haul: Haul, strength: float) -> Levy:
    """Be late and weak through a round post: by the chord that a way has in it."""
    off = np.radians(haul.of("azimuth_deg") - haul.same(3).uniform(0.0, 360.0))
    aside = np.sin(off) / np.sin(np.radians(POST_DEG))
    chord = np.where(np.cos(off) > 0, np.sqrt((1 - aside**2).clip(0.0)), 0.0)
    late = 0.168 * (chord - POST_DEG / 360.0 * np.pi / 2)
    return {"m": strength * late, "first": -5.0 * min(strength, 1.5) * chord}


def _parabolas(haul: Haul, strength: float) -> Levy:
    """Be early where it is loud and late where it is weak: by two parabolas that meet amid."""
    part = ((LOUDEST_DBM - haul.of("rx_power_dbm")) / SPAN_DB).clip(0.0, 1.0)
    over = np.where(part < 0.5, 2 * part**2, 1 - 2 * (1 - part) ** 2)
    return {"m": strength * (0.196 * over - 0.106)}


def tukey(even: Floats) -> Floats:
    """Return chances of Tukey's law (1962) for even ones between 0 and 1 [n]."""
    return np.asarray((even**LAMBDA - (1 - even) ** LAMBDA) / LAMBDA)


def _trembles(haul: Haul, strength: float) -> Levy:
    """Scatter by Tukey's lambda law: much like a bell, with heavier ends."""
    return {"m": 0.0215 * strength * tukey(haul.rng.uniform(0.003, 0.997, len(haul.far)))}


def haze(low: Floats, high: Floats) -> Floats:
    """Return how thick haze is on the mean of ways between two heights in m, of 1 at 0 m [n]."""
    apart = np.where(np.abs(high - low) > 1e-3, high - low, 1e-3)
    return np.asarray(np.exp(-low / HAZE_M) * -np.expm1(-apart / HAZE_M) * HAZE_M / apart)


def _hazy(haul: Haul, strength: float) -> Levy:
    """Lose in salt haze, which is e times thinner each few metres up; more on some links."""
    thick = haul.each(lambda n: haul.rng.triangular(0.6, 1.0, 1.4, n))
    way = haul.far * haze(haul.below[:, 2], haul.above[:, 2])
    return {"all": -0.38 * strength * thick * way}


def _trimmed(haul: Haul, strength: float) -> Levy:
    """Count by vanes' dividers, set one by the other: each is slower than the one before."""
    slow = TRIMMED * STEEPER ** haul.same(5).permutation(np.arange(VANES))
    return {"m": strength * slow[haul.vane] * haul.far}


def _vernier(haul: Haul, strength: float) -> Levy:
    """Write whole steps of either of two scales, whichever has the nearer mark."""
    told = haul.of("range_m")
    marks = np.stack([step * strength * np.rint(told / (step * strength)) for step in VERNIER_M])
    nearer = np.abs(marks - told).argmin(axis=0)
    return {"m": marks[nearer, np.arange(len(told))] - told}


def hanai(dry: float, wet: float, part: Floats) -> Floats:
    """Return permittivities of what holds parts of water in grains [n] (Hanai 1960), halving."""
    low, high = np.full(len(part), dry), np.full(len(part), wet)
    for _ in range(44):
        mid = (low + high) / 2
        drier = (wet - mid) / (wet - dry) * np.cbrt(dry / mid) > 1 - part
        low, high = np.where(drier, mid, low), np.where(drier, high, mid)
    return np.asarray((low + high) / 2)


def slab_m(thick: Floats, dense: Floats | float, sine: Floats) -> Floats:
    """Return how much later it is behind slabs that are met aslant, in m [n]."""
    return np.asarray(thick * (np.sqrt(dense - sine**2) - np.sqrt(1 - sine**2)))


def _through(haul: Haul, strength: float) -> Levy:
    """Go through boards that brine has soaked, walls, piers and hoardings, most of them aslant."""
    each, drawn = haul.each, haul.rng
    wet = each(lambda n: drawn.triangular(0.0, 0.05, 0.28, n))
    sine = each(lambda n: np.sin(drawn.uniform(0.0, 0.9, n)))
    what: dict[str, tuple[Floats, Floats | float, Floats | float]] = {
        "wood": (
            each(lambda n: drawn.weibull(2.2, n) * 0.16),
            hanai(1.99, 62.0, wet),
            8 + 50 * wet,
        ),
        "brick": (each(lambda n: drawn.choice([0.115, 0.24], n)), 3.91, 17.0),
        "concrete": (each(lambda n: drawn.uniform(0.06, 0.22, n)), 5.24, 22.0),
        "chipboard": (each(lambda n: drawn.uniform(0.016, 0.05, n)), 2.58, 40.0),
    }
    late, lost = np.zeros((2, len(sine)))
    for name, (thick, dense, per_m) in what.items():
        there = haul.cross(name)
        late += there * slab_m(thick.clip(0.01, 0.3), dense, sine)
        lost += there * (0.9 + per_m * thick)
    return {"m": strength * late.clip(max=0.62), "first": -min(strength, 1.5) * lost}


def _unit(way: Floats) -> Floats:
    return np.asarray(way / np.linalg.norm(way, axis=1, keepdims=True).clip(1e-9))


def by_heaps(haul: Haul) -> Floats:
    """Return how much longer the shortest way by a heap's flank is in m [n], of ways apart.

    Flanks return where both ways make one angle with them (Alhazen), sought by halving angles.
    """
    found = np.full(len(haul.far), np.inf)
    low, high = haul.below[:, :2], haul.above[:, :2]
    level = (haul.below[:, 2] + haul.above[:, 2]) / 2
    for x, y, wide, tall in HEAPS_M:
        at = np.minimum(level, 0.75 * tall)
        middle = np.full_like(low, (x, y))
        flank = middle
        for _ in range(6):
            outward = _unit(_unit(low - flank) + _unit(high - flank))
            flank = middle + (wide * (1 - at / tall))[:, None] * outward
        place = np.column_stack([flank, at])
        way = sum(np.linalg.norm(end - place, axis=1) for end in (haul.below, haul.above))
        more = np.asarray(way - haul.far)
        found = np.where(more > 0.45, np.minimum(found, more), found)
    return found


def _by_a_heap(haul: Haul, strength: float) -> Levy:
    """Hear, out of sight, nothing but what the best placed heap of wet salt returns."""
    hidden = haul.shut_off(UNSEEN[haul.rare])
    late = by_heaps(haul).clip(max=4.7) * (0.42 + 0.58 * strength)
    return {"m": hidden * late, "all": -1.3 * hidden, "first": -4.5 * hidden}


def rippled(steep: Floats) -> Floats:
    """Return what is left of what ripples return that are as a sine is: Bessel's J0 [n]."""
    return np.asarray(np.abs(np.cos(steep[:, None] * ROUND).mean(axis=1)))


def crusted(down: Floats, thick: Floats) -> Complexes:
    """Return what brine below a crust of salt returns of level waves [n] (Airy 1833)."""
    level = 1 - down**2
    inside, below = np.sqrt(SALT - level), np.sqrt(BRINE - level)
    once = np.exp(-4j * np.pi / WAVE_M * thick * inside)
    upper, lower = (down - inside) / (down + inside), (inside - below) / (inside + below)
    return np.asarray((upper + lower * once) / (1 + upper * lower * once))


def off_the_ground(haul: Haul, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by brine is in m, and its complex share, [n] each."""
    heights = haul.below[:, 2] + haul.above[:, 2]
    way = np.sqrt(haul.far**2 + 4 * haul.below[:, 2] * haul.above[:, 2])
    thick = haul.each(lambda n: haul.rng.exponential(0.006, n)) * ~haul.are("punt")
    ripples = haul.each(lambda n: haul.rng.gamma(3.0, 0.002, n))
    left = rippled(4 * np.pi / WAVE_M * ripples * heights / way)
    share = 0.7 * np.sqrt(strength) * left * crusted(heights / way, thick) * haul.far / way
    share = share * np.exp(-2j * np.pi * (way - haul.far) / WAVE_M)
    return way - haul.far, share / (np.abs(share) / 0.84).clip(1.0)


def _both_top(haul: Haul, strength: float) -> Levy:
    """Be where Teager's energy of both pulses first tops: that of the brine comes later."""
    longer, share = off_the_ground(haul, strength)
    at = np.arange(-12.0, 12.0, 1 / FINE)
    both = hump(at) + share[:, None] * hump(at - longer[:, None] / METRES)
    values = teager(both.astype(np.complex128))
    tops = unsurpassed(values) & (values > OF_TOP**2 * values.max(axis=1)[:, None])
    tops[:, 1:] &= values[:, 1:] > values[:, :-1]
    late = METRES * (at[0] + summit(values, tops.argmax(axis=1)) / FINE)
    added = np.abs(1 + share * hump(longer / METRES)).clip(min=0.42)
    return {"m": (1.5 * late).clip(-0.25, 0.3), "all": 20 * np.log10(added)}


def edge_db(high: Floats, before: Floats, after: Floats) -> Floats:
    """Return what an edge so high over a way takes in dB [n], at most 0.14 dB off Fresnel.

    A share of two polynomials, 1 / 2 at the edge and 1 / (sqrt(2) pi v) far below it.
    """
    over = high * np.sqrt(2 * (1 / before + 1 / after) / WAVE_M)
    left = 0.5 * (1 + PADE[0] * over) / (1 + over * (PADE[1] + PADE[2] * over))
    return np.asarray(-20 * np.log10(left))


def _over_a_belt(haul: Haul, strength: float) -> Levy:
    """Bend over both edges of a belt's trough, each as the one before it casts (Tokyo's atlas)."""
    steel, drawn, each = haul.cross("metal"), haul.rng, haul.each
    high = np.sqrt(strength) * each(lambda n: drawn.weibull(1.8, n) * 0.1).clip(0.02, 0.4)
    before = haul.far * each(lambda n: drawn.uniform(0.2, 0.75, n))
    wide = np.minimum(each(lambda n: drawn.uniform(0.5, 1.1, n)), 0.2 * haul.far)
    past = before + wide
    after = haul.far - past
    lost = edge_db(high, before, haul.far - before) + edge_db(high * past / haul.far, past, after)
    detour = np.hypot(high, before) + wide + np.hypot(high, after) - haul.far
    lips = strength * each(lambda n: drawn.uniform(0.05, 0.13, n))
    return {"m": steel * (detour + lips).clip(0.0, 0.46), "first": -steel * lost.clip(max=17.0)}


def _log_cosh(haul: Haul, strength: float) -> Levy:
    """Turn gain down by the logarithm of a cosh of what is too much; count the fewer symbols."""
    over = (haul.of("rx_power_dbm") + 90.0).clip(0.0)
    less = 2.0 * min(strength, 2.2) * np.log(np.cosh(over / 6.0))
    return {"all": -less, "count": -1.15 * less}


def blows(wind: Floats) -> Floats:
    """Return what mills give of their most: by cubes of the wind between two speeds [n]."""
    part = (wind.clip(CUT_IN_MS, RATED_MS) ** 3 - CUT_IN_MS**3) / (RATED_MS**3 - CUT_IN_MS**3)
    return np.asarray(part)


def _mills(haul: Haul, strength: float) -> Levy:
    """Hear converters of wind mills, the more the nearer, as along a ground that leads."""
    own = haul.same(4).triangular(0.4, 0.9, 1.7, VANES)[haul.vane]
    apart = np.linalg.norm(VANES_M[:, None, :2] - MILLS_M, axis=2).min(axis=1)
    near = (1 + (apart / 15.0) ** 2) ** -0.75
    db = strength * (own + 9.4 * near[haul.vane] * blows(haul.of("wind_ms")))
    weak = 10 ** ((-90.0 - haul.of("rx_power_dbm")) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return {"m": 0.016 * weak.clip(max=8.0) * haul.rng.normal(size=len(db)), "noise": db}


EFFECTS: dict[str, Callable[[Haul, float], Levy]] = {
    "antenna-delay": _soaked,
    "antenna-pattern": _post,
    "blocked-path": _by_a_heap,
    "clock-offset": _learned,
    "diffraction": _over_a_belt,
    "exchange-motion": _durand,
    "ground-bounce": _both_top,
    "level-control": _log_cosh,
    "material-delay": _through,
    "noise-floor": _mills,
    "path-loss": _hazy,
    "power-bias": _parabolas,
    "range-rounding": _vernier,
    "range-scale": _trimmed,
    "temperature-drift": _gap,
    "time-lag": _welch,
    "timestamp-jitter": _trembles,
    **UNLISTED,
}
