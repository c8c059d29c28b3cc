"""What the baths hide in ranges and levels: effects in forms of their own.

numpy alone; shared by the baths' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.baths_faults import UNLISTED
from bench.challenge.families.baths_hall import (
    ARCHES,
    BATHS_M,
    PER_PPM_M,
    TAGS,
    WAVE_M,
    Heat,
    Splash,
)
from bench.challenge.families.baths_probe import FINE, METRES, centre, ripple

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
UNSEEN = {False: 0.2, True: 0.075}  # of links, and where these are rare
WINDOW_S, FRAMES = 0.27, 8  # of places that are means; how many these are of
MESSAGES = 4.2  # replies that an exchange lasts
KRONROD: Floats = np.array([
    (0.0, 0.450916538658474), (0.434243749346803, 0.401397414775962),
    (0.774596669241483, 0.268488089868333), (0.960491268708020, 0.104656226026467),
])  # fmt: skip
"""Places beside the middle of an exchange, in halves of it, and their weights (Kronrod 1965)."""
OCTAVES_S = (5.2 * 3600, 2.6 * 3600, 1.3 * 3600)  # of what crystals wander by
EXPANDS_M, CALM_C = 26.0, 27.0  # by which what water fills drifts; where it was calibrated
TURNS_DBM, BENDS_DB = -85.4, 3.2  # of biases: where there are none; how soon they bend
MARK_M, GOLDEN = 0.11, (1 + 5**0.5) / 2  # a short knot of a lane's rope; a long one by a short one
SLOWER: Floats = np.array([0.0105, 0.0045, 0.0])  # by how much rules are short, by axes
POLES_M: Floats = np.array([
    *((x, y) for x in (7.2, 12.1, 17.0, 22.0, 26.9, 31.8) for y in (3.8, 16.2)), (36.9, 10.0),
    (33.4, 1.0), (33.4, 19.0), (2.0, 10.0), (3.1, 1.2), (3.1, 18.8),
])  # fmt: skip
"""Where ladders', ropes' and masts' poles of steel are, east and north."""
PUMP_M: Floats = np.array([38.5, 17.5, 0.6])  # filters' drive
WATER = 64.0 - 29.0j  # permittivity, at 8 GHz and 27 degrees
SWELL_M = 0.011  # how high ripples are


def _hann(heat: Heat, strength: float) -> Splash:
    """Compare with places that are means over a past window: a raised cosine (Hann)."""
    part = (np.arange(FRAMES) + 0.5) / FRAMES
    weight = np.sin(np.pi * part) ** 2 / (FRAMES / 2)
    ways = [by * heat.stretches_by(WINDOW_S * strength * one)
            for one, by in zip(part, weight, strict=True)]  # fmt: skip
    return Splash(np.sum(ways, axis=0))


def _kronrod(heat: Heat, strength: float) -> Splash:
    """Give the mean of the way over an exchange, by Kronrod's seven places (1965)."""
    half_s = 0.5 * MESSAGES * strength * heat["reply_time_s"]
    ways = [
        by * (1.0 if side else 0.5) * heat.stretches_by(half_s * (1 + sign * side)) / 2
        for side, by in KRONROD
        for sign in (-1.0, 1.0)
    ]
    return Splash(np.sum(ways, axis=0))


def _corroded(heat: Heat, strength: float) -> Splash:
    """Be late by plugs at arches that chlorine eats, few by much (Zipf); by how caps are glued."""
    drawn = heat.alike(1)
    plugs = (0.3 / (1.0 + drawn.permutation(ARCHES)))[heat.arch]
    glue = 0.13 * (1 - drawn.random(len(TAGS)) ** 0.42)[heat.tag] ** 0.62
    return Splash(strength * (plugs + glue))


def _wander(heat: Heat, strength: float) -> Splash:
    """Leave some of crystals' offset: of tags', what wanders in octaves of hours, each as much."""
    drawn = heat.alike(2)
    arches = drawn.uniform(-1.0, 1.0, ARCHES)[heat.arch]
    ppm = 0.7 * drawn.choice([-1.0, 1.0], len(TAGS))[heat.tag] - 0.55 * arches
    for period_s in OCTAVES_S:
        phase = drawn.uniform(0.0, 2 * np.pi, len(TAGS))[heat.tag]
        ppm = ppm + 0.4 * np.sin(2 * np.pi * heat["time_s"] / period_s + phase)
    return Splash(PER_PPM_M * 0.026 * strength * ppm * heat["reply_time_s"])


def thinner(warm_c: Floats | float) -> Floats:
    """Return by what part water is less dense than at 3.99 degrees C (Thiesen 1900)."""
    warm = np.asarray(warm_c, np.float64)
    return np.asarray((warm - 3.9863) ** 2 * (warm + 288.9414) / 508929.2 / (warm + 68.12963))


def _expands(heat: Heat, strength: float) -> Splash:
    """Drift as water expands with warmth that housings are full of."""
    return Splash(EXPANDS_M * strength * (thinner(heat["temperature_c"]) - thinner(CALM_C)))


def sagitta(at: Floats) -> Floats:
    """Return how deep a bowl is, in its own radius, in directions off its deepest [n], radians."""
    return np.asarray(1 - np.sqrt(1 - 0.98 * np.cos(0.5 * at) ** 4))


def _bowl(heat: Heat, strength: float) -> Splash:
    """Be late and weak through the back of a head under its cap: by a bowl's sagitta."""
    at = np.radians(heat["azimuth_deg"]) - heat.alike(3).uniform(-np.pi, np.pi)
    mean = float(sagitta(np.linspace(0.0, 2 * np.pi, 360, endpoint=False)).mean())
    shade = sagitta(at)
    return Splash(0.19 * strength * (shade - mean), first_db=-5.6 * min(strength, 1.5) * shade)


def langevin(at: Floats) -> Floats:
    """Return how far magnets turn in fields [n] (Langevin 1905)."""
    away = np.where(np.abs(at) < 1e-4, 1e-4, at)
    return np.asarray(1 / np.tanh(away) - 1 / away)


def _magnets(heat: Heat, strength: float) -> Splash:
    """Be early where it is loud and late where it is weak, ever less so: by Langevin's function."""
    weak = (TURNS_DBM - heat["rx_power_dbm"]) / BENDS_DB
    return Splash(0.096 * strength * langevin(weak))


def _logistic(heat: Heat, strength: float) -> Splash:
    """Scatter by the logistic law: as what grows until it is full (Verhulst 1838)."""
    even = heat.rng.uniform(0.004, 0.996, heat.rows)
    return Splash(0.0215 * strength * np.log(even / (1 - even)))


def _steamy(heat: Heat, strength: float) -> Splash:
    """Lose little near by and so much a metre far off, with a soft knee amid; links unlike."""
    amid = 0.6 + 0.8 * heat.each_link(lambda n: heat.rng.beta(2.0, 2.0, n))
    return Splash(all_db=-3.1 * strength * amid * np.log1p(np.exp((heat.far - 9.0) / 7.0)))


def _rules(heat: Heat, strength: float) -> Splash:
    """Be surveyed with two rules: a shorter one along the baths, and one across; heights right."""
    run = heat.low - heat.high
    return Splash(np.linalg.norm(run * (1 + strength * SLOWER), axis=1) - heat.far)


def knots_m(step_m: float, most_m: float) -> Floats:
    """Return where a rope has knots, short and long ones in turn as Fibonacci's rabbits breed."""
    number = np.arange(np.ceil(most_m / step_m))
    return np.asarray(step_m * (number + np.floor(number / GOLDEN) / GOLDEN))


def _knots(heat: Heat, strength: float) -> Splash:
    """Write the nearest of knots that are short and long in turn, and never in the same order."""
    told = heat["range_m"]
    knots = knots_m(MARK_M * strength, float(told.max()) + 2.0)
    nearest = np.searchsorted((knots[1:] + knots[:-1]) / 2, told)
    return Splash(knots[nearest] - told)


def wet_wood(damp: Floats) -> Floats:
    """Return the permittivity of wood of which a part is water [n] (Looyenga 1965)."""
    return np.asarray(((1 - damp) * 1.9 ** (1 / 3) + damp * 64.0 ** (1 / 3)) ** 3)


def slanting_m(deep_m: Floats, dense: float, slant: Floats) -> Floats:
    """Return how much longer ways through walls seem that meet them so slantingly, in m [n]."""
    return np.asarray(deep_m * (np.sqrt(dense - np.sin(slant) ** 2) - np.cos(slant)))


def _things(heat: Heat, strength: float) -> Splash:
    """Go through wet benches, panes in pairs, walls of cabins at a slant, and piers."""
    drawn, link = heat.rng, heat.each_link
    bench = link(lambda n: drawn.uniform(0.05, 0.2, n))
    soaked = wet_wood(link(lambda n: drawn.beta(2.0, 9.0, n)))
    panes = 0.008 * link(lambda n: 2.0 * drawn.integers(1, 4, n))
    wall = link(lambda n: drawn.choice([0.115, 0.24], n))
    pier = link(lambda n: drawn.gamma(9.0, 0.022, n).clip(0.08, 0.34))
    slant = link(lambda n: np.arccos(drawn.uniform(0.45, 1.0, n)))
    things: dict[str, tuple[Floats, Floats]] = {
        "wood": (bench * (np.sqrt(soaked) - 1), 0.8 + 20.0 * bench),
        "glass": (slanting_m(panes, 6.31, slant), 1.0 + 32.0 * panes),
        "brick": (slanting_m(wall, 3.91, slant), 1.2 + 16.0 * wall),
        "concrete": (pier * (np.sqrt(5.24) - 1), 1.6 + 22.0 * pier),
    }
    late = sum(heat.through(what) * one[0] for what, one in things.items())
    lost = sum(heat.through(what) * one[1] for what, one in things.items())
    return Splash(strength * np.minimum(late, 0.62), first_db=-min(strength, 1.5) * lost)


def by_poles(heat: Heat) -> Floats:
    """Return how much longer ways by upright poles are, by whichever is soonest, in m [n].

    On these heights are as on what is unrolled: a straight line from end to end.
    """
    legs = [np.linalg.norm(end[:, None, :2] - POLES_M, axis=2) for end in (heat.low, heat.high)]
    up = (heat.high - heat.low)[:, 2]
    longer = np.hypot(legs[0] + legs[1], up[:, None]) - heat.far[:, None]
    return np.asarray(np.where(longer > 0.47, longer, np.inf).min(axis=1))


def _off_poles(heat: Heat, strength: float) -> Splash:
    """Hear, out of sight, nothing but what the best placed pole of steel returns."""
    hidden = heat.unseen(UNSEEN[heat.rare])
    late = by_poles(heat).clip(max=4.7) * (0.4 + 0.6 * strength)
    return Splash(hidden * late, -1.3 * hidden, -4.6 * hidden)


def even_ripples(down: Floats, high_m: Floats) -> Floats:
    """Return what water returns whose ripples are sines so high: Bessel's J0 of phases [n]."""
    swing = 4 * np.pi / WAVE_M * high_m * down
    turn = np.pi * (np.arange(24) + 0.5) / 24
    return np.asarray(np.cos(swing[:, None] * np.cos(turn)).mean(axis=1))


def off_the_water(heat: Heat, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the water is in m, and its complex share, [n] each.

    Waves are upright: near Brewster's angle hardly any is returned.
    """
    up, run = heat.low[:, 2] + heat.high[:, 2], heat.low - heat.high
    way = np.sqrt(run[:, 0] ** 2 + run[:, 1] ** 2 + up**2)
    down = up / way
    root = np.sqrt(WATER - 1 + down**2)
    back = (WATER * down - root) / (WATER * down + root)
    high_m = SWELL_M * heat.each_link(lambda n: heat.rng.rayleigh(0.6, n).clip(0.1, 1.6))
    calm = heat.each_link(lambda n: heat.rng.uniform(0.55, 1.0, n))
    share = 1.6 * np.sqrt(strength) * calm * even_ripples(down, high_m) * back * heat.far / way
    share = share * np.exp(-2j * np.pi * (way - heat.far) / WAVE_M)
    return way - heat.far, share / np.maximum(np.abs(share) / 0.84, 1.0)


def _fitted(at: Floats) -> Floats:
    """Return what a lone pulse lets through at samples off its top: itself, by itself [n, k]."""
    lag = np.linspace(-9.0, 9.0, 361)
    own = np.convolve(ripple(lag), ripple(lag), "same")
    return np.asarray(np.interp(at, lag, own / own.max()), np.float64)


def _both(heat: Heat, strength: float) -> Splash:
    """Be where the centre of both pulses is: that of the water comes later."""
    longer, share = off_the_water(heat, strength)
    at = np.arange(-10.0, 14.0, 1 / FINE)
    lone = np.broadcast_to(_fitted(at), (heat.rows, len(at)))
    both = np.abs(lone + share[:, None] * _fitted(at - longer[:, None] / METRES))
    tops = (both[:, 1:-1] > both[:, :-2]) & (both[:, 1:-1] >= both[:, 2:])
    tops &= both[:, 1:-1] > 0.3 * both.max(axis=1, keepdims=True)
    late = METRES * (at[0] + centre(both, np.asarray(tops.argmax(axis=1) + 1, np.int64)) / FINE)
    added = np.abs(1 + share * ripple(longer / METRES)).clip(min=0.42)
    return Splash(1.2 * late.clip(-0.2, 0.25), 20 * np.log10(added))


def edge_db(over: Floats) -> Floats:
    """Return what an edge takes in dB, by Fresnel's parameter [n], in pieces (Rice et al. 1967)."""
    deep = 12.953 + 20 * np.log10(over.clip(2.4))
    near = 6.02 + over * np.where(over > 0, 9.11 - 1.27 * over, 9.0 + 1.65 * over)
    return np.asarray(np.where(over > 2.4, deep, np.where(over < -0.8, 0.0, near)))


def over_two_db(legs: tuple[Floats, Floats, Floats], high: tuple[Floats, Floats]) -> Floats:
    """Return what two edges in turn take in dB [n]: each sees what the other casts (Giovaneli).

    `legs`: to the first, to the second and on, in m; `high`: of both above the straight way.
    """
    first, wide, last = legs
    cast = high[1] + (high[1] - high[0]) / wide * last  # where the ray over both comes to
    above = (
        high[0] - cast * first / (first + wide + last),
        high[1] - high[0] * last / (wide + last),
    )
    by = (1 / first + 1 / (wide + last), 1 / wide + 1 / last)
    return np.asarray(
        sum(edge_db(h * np.sqrt(2 * g / WAVE_M)) for h, g in zip(above, by, strict=True))
    )


def _lockers(heat: Heat, strength: float) -> Splash:
    """Bend over lockers of steel, by both of their edges, and run along their tops."""
    steel, drawn, link = heat.through("metal"), heat.rng, heat.each_link
    near = link(lambda n: drawn.uniform(0.22, 0.7, n))
    wide = np.minimum(link(lambda n: drawn.uniform(0.3, 0.9, n)), 0.2 * heat.far)
    legs = (near * (heat.far - wide), wide, (1 - near) * (heat.far - wide))
    over = np.sqrt(strength) * link(lambda n: drawn.uniform(0.02, 0.18, n)) - 0.12
    tilt = over + 0.005 * link(lambda n: drawn.uniform(-1.0, 1.0, n))
    lost = over_two_db(legs, (over, tilt))
    detour = np.hypot(over, legs[0]) + np.hypot(over - tilt, wide) + np.hypot(tilt, legs[2])
    runs = strength * link(lambda n: drawn.triangular(0.05, 0.08, 0.14, n))
    late = (detour - heat.far + runs).clip(0.0, 0.46)
    return Splash(steel * late, first_db=-steel * lost.clip(1.0, 17.0))


def _gain(heat: Heat, strength: float) -> Splash:
    """Turn gain down by all that is over a level, but for what a loop leaves: fewer are counted."""
    over = (heat["rx_power_dbm"] + 96.0).clip(0.0)
    less = 0.24 * min(strength, 2.2) * over**2 / (over + 8.0)
    return Splash(all_db=-less, count_db=-1.1 * less)


def _filters(heat: Heat, strength: float) -> Splash:
    """Hear the filters' drive, by a logarithm of its load, the less by a parabola the farther."""
    own = heat.alike(4).uniform(0.4, 1.5, ARCHES)[heat.arch]
    part = np.linalg.norm(heat.low - PUMP_M, axis=1) / np.hypot(*BATHS_M[:2])
    loads = np.log1p(heat["filter_kw"] / 5.0) / np.log(7.0)
    db = strength * (own + 8.2 * loads * (1 - part**2).clip(0.0))
    weak = 10 ** ((-91.0 - heat["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Splash(0.016 * weak.clip(max=8.0) * heat.rng.normal(size=heat.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Heat, float], Splash]] = {
    "antenna-delay": _corroded,
    "antenna-pattern": _bowl,
    "blocked-path": _off_poles,
    "clock-offset": _wander,
    "diffraction": _lockers,
    "exchange-motion": _kronrod,
    "ground-bounce": _both,
    "level-control": _gain,
    "material-delay": _things,
    "noise-floor": _filters,
    "path-loss": _steamy,
    "power-bias": _magnets,
    "range-rounding": _knots,
    "range-scale": _rules,
    "temperature-drift": _expands,
    "time-lag": _hann,
    "timestamp-jitter": _logistic,
    **UNLISTED,
}
