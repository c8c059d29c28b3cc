"""What the colliery hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the colliery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.colliery_faults import UNLISTED
from bench.challenge.families.colliery_geophone import METRES, TO_TOP, booms, first_paths, picked
from bench.challenge.families.colliery_pit import (
    PER_PPM_M,
    PROPS,
    SHIFT_S,
    TAGS,
    WAVE_M,
    Burden,
    Tally,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
CUT_OFF = {False: 0.2, True: 0.075}  # of links, and where these are rare
FRAME_S, SPLINE = 1 / 60, (1.0, 26.0, 66.0, 26.0, 1.0)  # frames, and how much each counts
MESSAGES = 1.75  # replies that an exchange lasts
BUCKLES_C, STIFF, BUCKLED_M = 22.0, 0.16, 0.079  # of a disc; parts of 12 degrees C; metres
RIM = 0.62  # of a helmet's radius that antennas are off its middle
EVEN_DBM, RINGS_DB, STEP_M = -84.5, 3.6, 0.031  # of a step whose band ends
SHRUNK, SHEET_M = 0.0085, 41.0  # of a plan's paper, and how long a sheet of it is
SLIDE = 0.0086  # of a range, from one mark of a slide rule to the next
NICHE_M = 0.7  # how deep it is round a pillar's corner
FLOOR = 6.1 - 1.1j  # permittivity of wet fireclay (ITU-R P.527)
UNEVEN_M = 0.016  # by which it scatters about its mean
LIKED_DBM, WIDE_DB = -88.0, 6.5  # about which gain is turned down
DRILLS_M: Floats = np.array([53.0, 11.0, 3.0])
MOST_BPM = 2900.0


def _spline(tally: Tally, strength: float) -> Burden:
    """Compare with places of old frames that count as in a spline of the fifth degree."""
    weights = np.array(SPLINE) / np.sum(SPLINE)
    ways = [by * tally.recedes_by(FRAME_S * strength * k) for k, by in enumerate(weights, 1)]
    return Burden(np.sum(ways, axis=0))


def takahasi(count: int, step: float) -> tuple[Floats, Floats]:
    """Return places between 0 and 1 and what each counts, by tanh and sinh (Takahasi, Mori 1974).

    `count` places on either side of the middle; what they count sums up to 1.
    """
    at = step * np.arange(-count, count + 1)
    inner = 0.5 * np.pi * np.sinh(at)
    counts = np.cosh(at) / np.cosh(inner) ** 2
    return 0.5 + 0.5 * np.tanh(inner), counts / counts.sum()


def _exchange(tally: Tally, strength: float) -> Burden:
    """Give the mean of the way over an exchange, by seven places that crowd doubly at its ends."""
    long_s = MESSAGES * strength * tally["reply_time_s"]
    ways = [by * tally.recedes_by(long_s * part) for part, by in zip(*takahasi(3, 0.62),
                                                                      strict=True)]  # fmt: skip
    return Burden(np.sum(ways, axis=0))


def _boxes(tally: Tally, strength: float) -> Burden:
    """Be late by boxes that props' cables come through, some by none; by how wet tags are sealed.

    Boxes are as many as chance has it of rare things; seals are mostly good, by a cube of chance.
    """
    drawn = tally.common(1)
    boxes = 0.055 * drawn.poisson(1.7, PROPS).clip(max=5)
    seals = 0.012 + 0.1 * drawn.random(len(TAGS)) ** 3
    return Burden(strength * (boxes[tally.prop] + seals[tally.tag]))


def _sawtooth(tally: Tally, strength: float) -> Burden:
    """Leave some of crystals' offset: tags' runs off by a line until a signal sets it right."""
    drawn = tally.common(2)
    props = drawn.uniform(-0.8, 0.8, PROPS)[tally.prop]
    first = (drawn.choice([-1.0, 1.0], len(TAGS)) * drawn.uniform(0.5, 1.4, len(TAGS)))[tally.tag]
    runs = drawn.uniform(-1.2, 1.2, len(TAGS))[tally.tag]
    signals = SHIFT_S / drawn.integers(2, 5, len(TAGS))[tally.tag]
    ppm = first + runs * np.mod(tally["time_s"] / signals, 1.0) - props
    return Burden(PER_PPM_M * 0.024 * strength * ppm * tally["reply_time_s"])


def buckled(warm: Floats) -> Floats:
    """Return how far a disc that is nearly buckled gives [n]: y^3 + STIFF y = warm (Cardano)."""
    third = STIFF / 3
    return np.asarray(2 * np.sqrt(third) * np.sinh(np.arcsinh(warm / (2 * third**1.5)) / 3))


def _disc(tally: Tally, strength: float) -> Burden:
    """Drift as a disc gives that is nearly buckled: much amid, and ever less off it."""
    warm = (tally["temperature_c"] - BUCKLES_C) / 12.0
    return Burden(BUCKLED_M * strength * buckled(warm))


def to_rim(at: Floats) -> Floats:
    """Return how far a circle's rim is from RIM off its middle, less its mean, [n] radii."""
    round_ = np.linspace(0.0, 2 * np.pi, 361)[:-1]
    far, every = (RIM * np.cos(a) + np.sqrt(1 - (RIM * np.sin(a)) ** 2) for a in (at, round_))
    return np.asarray(far - every.mean())


def _helmet(tally: Tally, strength: float) -> Burden:
    """Be late and weak by how far it is to a helmet's rim from an antenna off its middle."""
    shade = to_rim(np.radians(tally["azimuth_deg"]) - tally.common(3).uniform(-np.pi, np.pi))
    return Burden(0.09 * strength * shade, first_db=-1.5 * min(strength, 1.5) * (shade + RIM))


def sine_integral(of: Floats) -> Floats:
    """Return the integral of sin(t) / t from 0 to `of` [n], by 24 of Gauss's places."""
    at, by = np.polynomial.legendre.leggauss(24)
    return np.asarray(
        0.5 * of * (by * np.sinc(0.5 * of[..., None] * (at + 1) / np.pi)).sum(axis=-1)
    )


def _ringing_step(tally: Tally, strength: float) -> Burden:
    """Be early where it is loud and late where it is weak, as a step whose band ends (Gibbs)."""
    weak = (EVEN_DBM - tally["rx_power_dbm"]) / RINGS_DB
    return Burden(STEP_M * strength * sine_integral(weak.clip(-12.0, 12.0)))


def raised(even: Floats) -> Floats:
    """Return where a raised cosine's law has so much below it [n], from -1 to 1."""
    at = np.linspace(-1.0, 1.0, 2001)
    return np.asarray(np.interp(even, 0.5 * (1 + at + np.sin(np.pi * at) / np.pi), at))


def _loop(tally: Tally, strength: float) -> Burden:
    """Scatter by the law of a raised cosine, as phases of a loop that slips no cycle do."""
    return Burden(0.094 * strength * raised(tally.rng.random(tally.rows)))


def _crosscuts(tally: Tally, strength: float) -> Burden:
    """Lose among pillars: more across galleries than along these, by what both make; links unlike.

    By the root of both squares.
    """
    thick = tally.by_link(lambda n: tally.rng.gamma(9.0, 1 / 9.0, n)).clip(0.4, 1.8)
    along, across = np.abs(tally.sends - tally.stands)[:, :2].T
    return Burden(all_db=-3.4 * strength * thick * np.hypot(along / 21.0, across / 12.0).clip(0, 3))


def shrunk(begin: Floats, end: Floats) -> Floats:
    """Return the mean part between two places along a plan by which its sheets have shrunk [n].

    Amid each sheet they shrank most, at seams nothing: by a sine's square.
    """
    turn = 2 * np.pi / SHEET_M
    off, middle = 0.5 * (end - begin) * turn, 0.5 * (end + begin) * turn
    return np.asarray(SHRUNK * (1 - np.cos(middle) * np.sinc(off / np.pi)))


def _plan(tally: Tally, strength: float) -> Burden:
    """Be surveyed from a plan whose paper shrank, in sheets: the less the nearer to seams."""
    return Burden(strength * tally.far * shrunk(tally.sends[:, 0], tally.stands[:, 0]))


def _slide_rule(tally: Tally, strength: float) -> Burden:
    """Write ranges by a slide rule's marks, which are a part of what they stand for apart."""
    step, ranges = SLIDE * strength, tally["range_m"].clip(0.05)
    return Burden(np.exp(step * np.rint(np.log(ranges) / step)) - tally["range_m"])


def relaxed(water: Floats, dry: float) -> Floats:
    """Return the index of what holds water in pores [n]: by Cole's and Cole's law (1941)."""
    late = (1j * 4.4928 / 8.0) ** (1 - 0.28)  # bound water relaxes at 8 GHz, broadly
    return np.asarray(np.sqrt(dry + 46.0 * water / (1 + late)).real)


def _things(tally: Tally, strength: float) -> Burden:
    """Go through packs of stone, chocks that are mostly air, wet stoppings, curtains in folds."""
    drawn, link = tally.rng, tally.by_link
    water = link(lambda n: drawn.beta(1.6, 14.0, n))
    packs = link(lambda n: drawn.uniform(0.03, 0.11, n))
    chocks = link(lambda n: 0.13 * drawn.integers(1, 4, n)) * link(lambda n: drawn.uniform(
        0.3, 0.7, n))  # fmt: skip
    bricks = link(lambda n: 0.05 * drawn.integers(1, 4, n))
    folds = link(lambda n: 0.018 * drawn.integers(2, 9, n))
    things: dict[str, tuple[Floats, Floats]] = {
        "marble": (packs * (np.sqrt(7.074) - 1), 1.0 + 24.0 * packs),
        "wood": (chocks * (relaxed(0.7 * water, 1.9) - 1), 0.9 + 11.0 * chocks),
        "brick": (bricks * (relaxed(0.5 * water, 3.8) - 1), 1.1 + 16.0 * bricks),
        "plastic": (folds * (np.sqrt(2.4) - 1), 0.6 + 17.0 * folds),
    }
    late, lost = (sum(tally.behind(w) * both[k] for w, both in things.items()) for k in (0, 1))
    return Burden(
        1.25 * strength * np.asarray(late), first_db=-min(strength, 1.5) * np.asarray(lost)
    )


def round_corners(tally: Tally) -> Floats:
    """Return how much longer ways by galleries that cross squarely are, in m [n].

    So far along and so far across, and into a niche and out of it.
    """
    apart = np.abs(tally.sends - tally.stands)
    return np.asarray(np.hypot(apart[:, 0] + apart[:, 1] + 2 * NICHE_M, apart[:, 2]) - tally.far)


def _corners(tally: Tally, strength: float) -> Burden:
    """Hear, out of sight, nothing but what comes round a pillar's corner by galleries."""
    cut = tally.cut_off(CUT_OFF[tally.rare])
    late = np.minimum(round_corners(tally), 4.1) * (0.5 + 0.5 * strength)
    return Burden(cut * late, -1.2 * cut, -4.7 * cut)


def off_the_floor(tally: Tally, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Waves lie level (Fresnel); the floor's heights are a bell's (Rayleigh's roughness).
    """
    up = tally.sends[:, 2] + tally.stands[:, 2]
    flat = ((tally.sends - tally.stands)[:, :2] ** 2).sum(axis=1)
    way = np.sqrt(flat + up**2)
    sine = up / way
    root = np.sqrt(FLOOR - 1 + sine**2)
    uneven = UNEVEN_M * tally.by_link(lambda n: tally.rng.uniform(0.3, 1.3, n))
    left = np.exp(-2 * (2 * np.pi * uneven * sine / WAVE_M) ** 2)
    bare = tally.by_link(lambda n: tally.rng.beta(5.0, 2.5, n))
    share = 1.25 * np.sqrt(strength) * bare * left * (sine - root) / (sine + root) * tally.far / way
    share = share * np.exp(-2j * np.pi * (way - tally.far) / WAVE_M)
    return way - tally.far, share / np.maximum(np.abs(share) / 0.78, 1.0)


def of_both(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As geophones have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(len(longer_m), 90.3)
    one = booms(top).astype(np.complex128)
    both = one + share[:, None] * booms(top + longer_m / METRES)
    quiet = np.full(len(top), 1e-6)
    at, alone = (first_paths(wave, quiet) for wave in (both, one))
    return METRES * (at - alone), np.abs(picked(both, at + TO_TOP) / picked(one, alone + TO_TOP))


def _both(tally: Tally, strength: float) -> Burden:
    """Be where a step is that has as much below it as both pulses' rise has."""
    late, height = of_both(*off_the_floor(tally, strength))
    return Burden(late.clip(-0.2, 0.24), 20 * np.log10(height.clip(0.4)))


def through_gap(low: Floats, high: Floats) -> Floats:
    """Return the size of what a gap leaves between two of Fresnel's parameters [n].

    By 60 places of Gauss's in between.
    """
    at, by = np.polynomial.legendre.leggauss(60)
    v = 0.5 * (low + high)[:, None] + 0.5 * (high - low)[:, None] * at
    whole = 0.5 * (high - low) * (by * np.exp(0.5j * np.pi * v**2)).sum(axis=1)
    return np.asarray(np.abs(whole) / np.sqrt(2))


def _gaps(tally: Tally, strength: float) -> Burden:
    """Come by a gap between a train of tubs and the roof above it, of which each is off the way."""
    steel, drawn, link = tally.behind("metal"), tally.rng, tally.by_link
    part = link(lambda n: drawn.uniform(0.25, 0.75, n))
    near = 1 / (part * tally.far) + 1 / ((1 - part) * tally.far)
    above = link(lambda n: drawn.uniform(0.1, 0.5, n)) * np.sqrt(strength)
    wide = link(lambda n: drawn.uniform(0.5, 2.2, n))
    low, high = (one * np.sqrt(2 / WAVE_M * near) for one in (above, above + wide))
    lost = -20 * np.log10(through_gap(low, high).clip(1e-3))
    late = 0.5 * above**2 * near + strength * link(lambda n: drawn.uniform(0.06, 0.17, n))
    return Burden(steel * late.clip(0.0, 0.46), first_db=-steel * lost.clip(1.0, 17.0))


def grown(of: Floats) -> Floats:
    """Return what goes from 0 to 1, soon at first and slowly at last (Gompertz 1825) [n]."""
    return np.asarray(np.exp(-np.exp(-of.clip(-5.0))))


def _grown(tally: Tally, strength: float) -> Burden:
    """Turn gain down as levels are over what is liked, by Gompertz's curve; count the fewer."""
    less = 3.6 * min(strength, 2.2) * grown((tally["rx_power_dbm"] - LIKED_DBM) / WIDE_DB)
    return Burden(all_db=-less, count_db=-1.15 * less)


def _drills(tally: Tally, strength: float) -> Burden:
    """Hear motors of drills: by the square of how fast they strike, the less the farther off."""
    own = tally.common(4).uniform(0.3, 1.4, PROPS)[tally.prop]
    away = np.linalg.norm(tally.stands - DRILLS_M, axis=1)
    blows = (tally["drill_bpm"] / MOST_BPM) ** 2
    db = strength * (own + 10.0 * blows * np.exp(-away / 55.0))
    weak = 10 ** ((-91.0 - tally["rx_power_dbm"]) / 20) * np.sqrt(np.expm1(db * np.log(10) / 10))
    return Burden(0.015 * weak.clip(max=8.0) * tally.rng.normal(size=tally.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Tally, float], Burden]] = {
    "antenna-delay": _boxes,
    "antenna-pattern": _helmet,
    "blocked-path": _corners,
    "clock-offset": _sawtooth,
    "diffraction": _gaps,
    "exchange-motion": _exchange,
    "ground-bounce": _both,
    "level-control": _grown,
    "material-delay": _things,
    "noise-floor": _drills,
    "path-loss": _crosscuts,
    "power-bias": _ringing_step,
    "range-rounding": _slide_rule,
    "range-scale": _plan,
    "temperature-drift": _disc,
    "time-lag": _spline,
    "timestamp-jitter": _loop,
    **UNLISTED,
}
