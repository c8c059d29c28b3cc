"""What the saw mill hides in ranges and levels: effects in forms of its own.

numpy alone; shared by the saw mill's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from math import erf

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.sawmill_decoder import METRES, RISE, hump, inclined
from bench.challenge.families.sawmill_faults import UNLISTED
from bench.challenge.families.sawmill_yard import (
    BRACES,
    BRACES_M,
    BREAKS,
    HALL_M,
    KILNS_M,
    PER_PPM_M,
    SHIFT_S,
    TAGS,
    WAVE_M,
    Change,
    Stint,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OUT_OF_SIGHT = {False: 0.2, True: 0.075}  # of links, and where these are rare
CARRIED_ON = 0.35  # of the speed that places had when they were new
CURTIS = np.array([1.0, 8.0, 12.0, 8.0, 1.0]) / 30
"""Weights of parts of an exchange, from its begin to its end, by Clenshaw and Curtis (1960)."""
CELLS_M: Floats = np.array([0.1, 0.14, 0.19])  # of ranges' codes, again and again
INDEX, WATER = 0.83, 2.35  # of refraction, over 1, for each g/cm3 of dry wood, and of its water
MUD, CHIPS, ROUGH_M = 24.0 - 5.5j, 2.7 - 0.3j, 0.016  # at 3.5 GHz; how rough ground is
SAW_M = (43.5, 20.2)  # where the gang saw is
CUT_S, CUTS = 61.0, 0.45  # from one log to the next, and for which part of it the saw cuts
PLATES = (
    (0, HALL_M[0], HALL_M[2:4], HALL_M[4]),
    (0, HALL_M[1], HALL_M[2:4], HALL_M[4]),
    (1, HALL_M[2], HALL_M[:2], HALL_M[4]),
    (1, HALL_M[3], HALL_M[:2], HALL_M[4]),
    (0, KILNS_M[0], KILNS_M[1:3], KILNS_M[3]),
    (1, 13.0, (5.0, 24.0), 3.8),
    (1, 29.0, (5.0, 24.0), 3.8),
    (0, 43.0, (11.0, 31.0), 2.4),
    (1, 5.2, (33.0, 66.0), 3.1),
    (1, 37.4, (33.0, 66.0), 3.1),
)
"""What is upright and returns waves: axis and place of its plane, from where to where, height.

Sides of the hall and fronts of kilns, which are of steel; piles and stacks.
"""


def _carried_on(stint: Stint, strength: float) -> Change:
    """Compare with old places that a tracker carries on, but by a part of their speed alone."""
    late_s = 0.15 * strength
    return Change(stint.grown(late_s) - CARRIED_ON * stint.longer(-stint.carried(-late_s)))


def _clenshaw(stint: Stint, strength: float) -> Change:
    """Give the mean of the way over an exchange, by places that crowd at both of its ends."""
    whole_s = 2.0 * strength * stint.column("reply_time_s")
    places = 0.5 - 0.5 * np.cos(np.pi * np.arange(5) / 4)
    return Change(
        sum(by * stint.grown(at * whole_s) for by, at in zip(CURTIS, places, strict=True))
    )


def _ladder(stint: Stint, strength: float) -> Change:
    """Be late by how often connectors were crimped: braces by steps all alike; tags by makes."""
    drawn = stint.shared(2)
    braces = 0.0245 * drawn.permutation(BRACES)[stint.brace]
    tags = np.array([0.03, 0.075, 0.135])[drawn.integers(3, size=len(TAGS))][stint.tag]
    return Change(strength * (braces + tags))


def _retrace(stint: Stint, strength: float) -> Change:
    """Leave some of crystals' offset, which comes back as another after each break (retrace)."""
    drawn, after = stint.shared(3), np.searchsorted(BREAKS, stint.column("time_s") / SHIFT_S)
    ends = []
    for count, of in ((BRACES, stint.brace), (len(TAGS), stint.tag)):
        own = drawn.uniform(-1.0, 1.0, count) + drawn.normal(0.0, 0.3, (len(BREAKS) + 1, count))
        ends.append(own[after, of])
    return Change(
        PER_PPM_M * 0.0142 * strength * (ends[1] - ends[0]) * stint.column("reply_time_s")
    )


def _radiated(stint: Stint, strength: float) -> Change:
    """Drift by what lids radiate, which are black: by the fourth power of kelvins (Stefan)."""
    kelvins = stint.column("temperature_c") + 273.15
    return Change(0.31 * strength * ((kelvins / 288.15) ** 4 - 1))


def _slit(stint: Stint, strength: float) -> Change:
    """Be late and weak behind a plate, as what it is as wide as would bend it (Fraunhofer)."""
    middle = stint.shared(4).uniform(0.0, 2 * np.pi)
    off = np.sin(0.5 * (np.radians(stint.column("azimuth_deg")) - middle))
    shade = np.sinc(1.55 * off) ** 2
    return Change(strength * (0.166 * shade - 0.058), first_db=-4.3 * min(strength, 1.5) * shade)


def _frechet(stint: Stint, strength: float) -> Change:
    """Be late where it is weak: by Fréchet's curve (1927) of how far it is below a level."""
    below = (-58.0 - stint.column("rx_power_dbm")).clip(1.0)
    return Change(strength * (0.196 * np.exp(-((22.0 / below) ** 3.2)) - 0.1))


def _subbotin(stint: Stint, strength: float) -> Change:
    """Scatter by a bell that has a fourth power in it (Subbotin 1923): flat, and soon nothing."""
    size = stint.rng.gamma(0.25, 1.0, stint.n) ** 0.25
    usual = np.sqrt(0.3379891)  # of its square: gamma(3/4) / gamma(1/4)
    return Change(0.051 * strength * size / usual * stint.rng.choice([-1.0, 1.0], stint.n))


def _low_ways(stint: Stint, strength: float) -> Change:
    """Lose more by decades, and the lower a way runs the more: by links, as stacks stand."""
    low = np.minimum(stint.there[:, 2], stint.fixed[:, 2])
    stands = stint.by_link(lambda n: stint.rng.triangular(0.5, 0.9, 1.6, n))
    more = (1.8 + 6.0 * np.exp(-low / 1.7)) * stands
    return Change(all_db=-strength * more * np.log10(stint.far.clip(1.0)))


def _wheel(stint: Stint, strength: float) -> Change:
    """Be surveyed by a wheel whose tyre is softer at some stints than at others."""
    soft = stint.by_stint(lambda n: np.exp(stint.rng.normal(0.0, 0.13, n)))
    return Change(0.0098 * strength * soft * stint.far)


def _in_cells(stint: Stint, strength: float) -> Change:
    """Write the middles of cells, narrow, middling and wide in turn, that ranges are in."""
    cells, read = CELLS_M * strength, stint.column("range_m")
    whole, rest = np.divmod(read, cells.sum())
    edges = np.cumsum(cells)
    which = np.searchsorted(edges, rest, side="right").clip(max=len(cells) - 1)
    return Change(whole * cells.sum() + edges[which] - 0.5 * cells[which] - read)


def _gladstone(stint: Stint, strength: float) -> Change:
    """Go through timber by its density and its water's: indices add up (Gladstone, Dale 1863).

    Through partitions, walls of kilns and panes as they stand.
    """
    drawn = stint.rng
    deep = stint.by_link(lambda n: drawn.gamma(5.0, 0.042, n).clip(0.06, 0.42))
    dense = stint.by_link(lambda n: drawn.uniform(0.36, 0.62, n))
    moist = dense * stint.by_link(lambda n: drawn.beta(1.6, 2.6, n)) * 0.75
    late: dict[str, Floats] = {
        "wood": deep * (INDEX * dense + WATER * moist),
        "chipboard": stint.by_link(lambda n: drawn.uniform(0.06, 0.15, n)) * (2.58**0.5 - 1),
        "brick": stint.by_link(lambda n: drawn.choice([0.115, 0.24], n)) * (3.91**0.5 - 1),
        "glass": stint.by_link(lambda n: drawn.uniform(0.012, 0.035, n)) * (6.31**0.5 - 1),
    }
    lost: dict[str, Floats | float] = {
        "wood": 9.0 * deep * (1 + 3 * moist) + 1.2,
        "chipboard": 2.1,
        "brick": 4.2,
        "glass": 1.7,
    }
    metres = np.sum([stint.has(what) * one for what, one in late.items()], axis=0)
    db = np.sum([stint.has(what) * one for what, one in lost.items()], axis=0)
    return Change(strength * metres, first_db=-min(strength, 1.5) * db)


def _off_plates(stint: Stint, strength: float) -> Change:
    """Hear, out of sight, nothing but what the best placed of walls and piles returns.

    These end somewhere: what would be returned beyond an edge comes by the edge.
    """
    hidden = stint.out_of_sight(OUT_OF_SIGHT[stint.rare])
    ways = []
    for axis, plane_m, (begin_m, end_m), high_m in PLATES:
        off = [np.abs(end[:, axis] - plane_m) + 1e-6 for end in (stint.there, stint.fixed)]
        part = (off[0] / (off[0] + off[1]))[:, None]
        met = stint.there + part * (stint.fixed - stint.there)
        met[:, axis] = plane_m
        met[:, 1 - axis] = met[:, 1 - axis].clip(begin_m, end_m)
        met[:, 2] = met[:, 2].clip(0.0, high_m)
        ways.append(sum(np.linalg.norm(end - met, axis=1) for end in (stint.there, stint.fixed)))
    detours = np.array(ways) - stint.far
    best = np.where(detours > 0.46, detours, np.inf).min(axis=0).clip(max=3.3)
    return Change(hidden * best * (0.45 + 0.55 * strength), -1.7 * hidden, -3.8 * hidden)


def off_the_ground(stint: Stint, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ground is in m, and its complex share, [n] each.

    Waves lie level. Ground is of mud and of chips, by links as much of each; it is rough as seas
    are (Miller, Brown and Vegh 1984).
    """
    up = stint.there[:, 2] + stint.fixed[:, 2]
    flat = np.hypot(*(stint.there - stint.fixed)[:, :2].T)
    way = np.hypot(flat, up)
    down, longer = up / way, way - stint.far
    roots = [np.sqrt(dense - 1 + down**2) for dense in (MUD, CHIPS)]
    back = [(down - root) / (down + root) for root in roots]
    wet = stint.by_link(lambda n: stint.rng.beta(1.2, 1.2, n))
    spread = 2 * (2 * np.pi * ROUGH_M / WAVE_M * down) ** 2
    size = 1.7 * np.sqrt(strength) * np.exp(-spread) * np.i0(spread) * stint.far / way
    free = stint.by_link(lambda n: stint.rng.uniform(0.35, 1.0, n))
    share = size * free * (wet * back[0] + (1 - wet) * back[1])
    share = share * np.exp(-2j * np.pi * longer / WAVE_M)
    return longer, share * np.minimum(1.0, 0.87 / np.abs(share).clip(1e-9))


def _both_inclined(stint: Stint, strength: float) -> Change:
    """Be where a line through the rise of both pulses is: that of the ground comes later."""
    longer, share = off_the_ground(stint, strength)
    finer = 20
    at = np.arange(-8.0, 6.0, 1 / finer)
    size = np.abs(hump(at) + share[:, None] * hump(at - longer[:, None] / METRES))
    falls = (size[:, 1:] < size[:, :-1]) & (size[:, :-1] > 0.28)
    place = at[0] + inclined(size, falls.argmax(axis=1), 1 / finer)
    added = np.abs(1 + share * hump(longer / METRES)).clip(min=0.43)
    return Change((1.15 * METRES * (place + RISE)).clip(-0.25, 0.3), 20 * np.log10(added))


def screen_db(turned: Floats, spread: Floats) -> Floats:
    """Return what an edge of something black lets by in dB <= -6 [n] (Felsen).

    By angles that it turns waves by, in rad > 0, and (d1 + d2) / (d1 d2) in 1/m.
    """
    sizes = (1 / turned - 1 / (2 * np.pi + turned)) * np.sqrt(WAVE_M * spread) / (2 * np.pi)
    return np.asarray(20 * np.log10(np.abs(sizes).clip(1e-6, 0.5)))


def _over_a_car(stint: Stint, strength: float) -> Change:
    """Bend over a kiln's car of stacked boards, which are black, and creep along its top."""
    steel = stint.has("metal")
    cut = stint.by_link(lambda n: stint.rng.uniform(0.2, 0.8, n))
    high = np.sqrt(strength) * stint.by_link(lambda n: stint.rng.triangular(0.1, 0.4, 1.0, n))
    legs = [stint.far * part for part in (cut, 1 - cut)]
    turned = sum(np.arctan2(high, leg) for leg in legs)
    bent = sum(np.hypot(high, leg) for leg in legs) - stint.far
    creeps = strength * stint.by_link(lambda n: stint.rng.uniform(0.03, 0.13, n))
    lets_by = screen_db(turned, 1 / legs[0] + 1 / legs[1]).clip(min=-12.5)
    return Change(steel * (bent + creeps).clip(0.0, 0.45), first_db=steel * lets_by)


def _by_a_bells_sum(stint: Stint, strength: float) -> Change:
    """Turn gain down by the error function of what is over a level; count the fewer symbols."""
    over = (stint.column("rx_power_dbm") + 91.0).clip(0.0) / 16.5
    less = 5.6 * min(strength, 2.2) * np.array([erf(one) for one in over])
    return Change(all_db=-less, count_db=-1.15 * less)


def _gang_saw(stint: Stint, strength: float) -> Change:
    """Hear the gang saw's drive while it cuts, near it most; and converters all the time."""
    drawn = stint.shared(5)
    own = drawn.uniform(0.45, 1.35, BRACES)[stint.brace]
    part = np.mod(stint.column("time_s") / CUT_S + drawn.random(), 1.0)
    near = np.exp(-((np.hypot(*(BRACES_M[:, :2] - SAW_M).T) / 17.0) ** 1.6))[stint.brace]
    db = strength * (own + 7.2 * near * (part < CUTS))
    weak = 10 ** ((-84.0 - stint.column("rx_power_dbm")) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Change(0.0155 * weak.clip(max=8.0) * stint.rng.normal(size=stint.n), noise_db=db)


EFFECTS: dict[str, Callable[[Stint, float], Change]] = {
    "antenna-delay": _ladder,
    "antenna-pattern": _slit,
    "blocked-path": _off_plates,
    "clock-offset": _retrace,
    "diffraction": _over_a_car,
    "exchange-motion": _clenshaw,
    "ground-bounce": _both_inclined,
    "level-control": _by_a_bells_sum,
    "material-delay": _gladstone,
    "noise-floor": _gang_saw,
    "path-loss": _low_ways,
    "power-bias": _frechet,
    "range-rounding": _in_cells,
    "range-scale": _wheel,
    "temperature-drift": _radiated,
    "time-lag": _carried_on,
    "timestamp-jitter": _subbotin,
    **UNLISTED,
}
