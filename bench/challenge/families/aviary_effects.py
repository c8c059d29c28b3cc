"""What the aviary hides in ranges and levels: effects in forms of its own.

numpy alone; shared by the aviary's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.aviary_faults import UNLISTED
from bench.challenge.families.aviary_grounds import (
    DAY_S,
    DEEP_M,
    GROVE_M,
    NESTBOXES,
    NESTBOXES_M,
    PER_PPM_M,
    POND_M,
    TAGS,
    WAVE_M,
    WIDE_M,
    Change,
    Watch,
)
from bench.challenge.families.aviary_listener import METRES, UP, balanced, bell

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OUT_OF_SIGHT = {False: 0.21, True: 0.08}  # of links, and where these are rare
WEDDLE = np.array([1.0, 5.0, 1.0, 6.0, 1.0, 5.0, 1.0]) / 20  # of a whole, at its sixths
WATER, TURF, BLADES_M = 73.6 - 18.7j, 8.5 - 1.6j, 0.011  # at 4.5 GHz; how rough turf is
BARK, SAP, MOIST = 1.99, 74.0, 0.11  # permittivities of dry wood and of water; share of that
CROWN_DB, CROWN_DB_M = 13.0, 1.05  # what crowns take at most, and in their first metres
STEP_M = 0.118  # of ranges' codes
RETURNS_M: Floats = np.random.default_rng(2104).uniform(
    [2.0, 2.0, 0.3], [WIDE_M - 2.0, DEEP_M - 0.5, 6.0], (34, 3)
)
"""Boulders, trunks and stores that return what comes, in m."""


def _hunting_clock(watch: Watch, strength: float) -> Change:
    """Compare with places by a hub's clock, late, which hunts about the network's time."""
    turn = watch.shared(1).uniform(0.0, 2 * np.pi) + 2 * np.pi * watch.of("time_s") / 2900.0
    return Change(watch.goes_in(strength * (0.06 + 0.015 * np.sin(turn))))


def _weddle(watch: Watch, strength: float) -> Change:
    """Give a mean over an exchange of seven messages: by Weddle's rule (1854)."""
    whole_s = 0.95 * strength * watch.of("reply_time_s")
    goes = [by * watch.goes_in(k / 6 * whole_s) for k, by in enumerate(WEDDLE)]
    return Change(np.sum(goes, axis=0))


def _potted(watch: Watch, strength: float) -> Change:
    """Be late by resin: nestboxes, most of them, by little or by much; tags by how it was cast."""
    drawn = watch.shared(2)
    boxes = 0.29 * drawn.beta(0.75, 1.0, NESTBOXES)[watch.box]
    tags = 0.035 + 0.13 * drawn.beta(1.4, 3.2, len(TAGS))[watch.tag]
    return Change(strength * (boxes + tags))


def _left_over(watch: Watch, strength: float) -> Change:
    """Leave what crystals are off after carriers were compared: a little less by the evening."""
    drawn = watch.shared(3)
    boxes = drawn.laplace(0.0, 0.52, NESTBOXES).clip(-1.6, 1.6)[watch.box]
    tags = 0.75 * np.cos(np.pi * drawn.random(len(TAGS)))[watch.tag]
    ppm = 0.0148 * strength * (tags - boxes) * (1 - 0.2 * watch.of("time_s") / DAY_S)
    return Change(PER_PPM_M * ppm * watch.of("reply_time_s"))


def _sinh(watch: Watch, strength: float) -> Change:
    """Drift by what warms and cools two layers unlike: by a hyperbolic sine."""
    return Change(0.048 * strength * np.sinh((watch.of("temperature_c") - 17.0) / 9.5))


def _under_a_wing(watch: Watch, strength: float) -> Change:
    """Be late and weak under a wing: it shades one side, with edges as Butterworth's (1930)."""
    middle = 360.0 * watch.shared(4).random()
    off = np.abs((watch.of("azimuth_deg") - middle + 180.0) % 360.0 - 180.0)
    shade = 1 / (1 + (off / 62.0) ** 6)
    return Change(strength * (0.148 * shade - 0.052), first_db=-3.2 * min(strength, 1.5) * shade)


def _two_exponentials(watch: Watch, strength: float) -> Change:
    """Be late where it is weak, early where it is strong: by an exponential either side."""
    weak = (-85.5 - watch.of("rx_power_dbm")) / 5.5
    return Change(0.104 * strength * np.sign(weak) * -np.expm1(-np.abs(weak)))


def _skewed(watch: Watch, strength: float) -> Change:
    """Scatter more to late than to early: a bell that is skewed (Azzalini 1985), about its mean."""
    skew = 6.0 / np.sqrt(37.0)
    one, other = watch.rng.normal(size=(2, watch.rows))
    bent = skew * np.abs(one) + np.sqrt(1 - skew**2) * other
    return Change(
        0.046 * strength * (bent - skew * np.sqrt(2 / np.pi)) / np.sqrt(1 - 2 * skew**2 / np.pi)
    )


def _amid_crowns(watch: Watch, strength: float) -> Change:
    """Lose amid crowns much at first, then ever less (ITU-R P.833), and ever more by decades."""
    dense = watch.by_link(lambda n: watch.rng.uniform(0.6, 1.3, n))
    crowns = CROWN_DB * -np.expm1(-CROWN_DB_M * dense * watch.amid_m / CROWN_DB)
    decades = np.log10(watch.far.clip(1.0))
    return Change(all_db=-strength * (0.3 * crowns + 2.3 * decades**1.6))


def _slack_line(watch: Watch, strength: float) -> Change:
    """Be surveyed with a line that is short, and that sags by the cube of what it spans."""
    return Change(strength * (0.0041 * watch.far + 3.6e-6 * watch.far**3))


def _missing_codes(watch: Watch, strength: float) -> Change:
    """Write ranges in whole steps, of which every fourth is never written: the nearer beside it."""
    step = STEP_M * strength
    fine = watch.of("range_m") / step
    code = np.rint(fine)
    beside = code + np.where(fine >= code, 1.0, -1.0)
    return Change(step * (np.where(np.mod(code, 4) == 2, beside, code) - fine))


def _greenery(watch: Watch, strength: float) -> Change:
    """Go through crowns as far as these reach, through trunks whose roots of permittivities mix.

    Through piers of rock and panes as they stand.
    """
    drawn = watch.rng
    wide = watch.by_link(lambda n: drawn.triangular(0.09, 0.14, 0.22, n))
    sap = watch.by_link(lambda n: drawn.uniform(0.6, 1.4, n)) * MOIST
    bark = (1 - sap) * np.sqrt(BARK) + sap * np.sqrt(SAP)
    panes = watch.by_link(lambda n: drawn.integers(1, 4, n))
    leafy = watch.by_link(lambda n: drawn.uniform(0.004, 0.0085, n)) * watch.amid_m.clip(1.0)
    through = {
        "foliage": (leafy, 0.28 * watch.amid_m.clip(1.0)),
        "wood": (wide * (bark - 1), 30.0 * wide),
        "brick": (1.25 * wide * (np.sqrt(3.91) - 1), 18.0 * wide),
        "glass": (0.011 * panes * (np.sqrt(6.31) - 1), 1.1 * panes),
    }
    late = sum(watch.through(kind) * metres for kind, (metres, _) in through.items())
    lost = sum(watch.through(kind) * db for kind, (_, db) in through.items())
    return Change(strength * late, first_db=-min(strength, 1.5) * lost)


def _other_ways(watch: Watch, strength: float) -> Change:
    """Hear, out of sight, nothing but what boulders, trunks and stores return: the soonest."""
    hidden = watch.behind(OUT_OF_SIGHT[watch.rare])
    legs = [
        np.sqrt(((end[:, None] - RETURNS_M) ** 2).sum(axis=2)) for end in (watch.there, watch.hung)
    ]
    detours = legs[0] + legs[1] - watch.far[:, None]
    soonest = np.where(detours > 0.42, detours, np.inf).min(axis=1).clip(max=3.4)
    return Change(hidden * soonest * (0.4 + 0.6 * strength), -1.8 * hidden, -3.9 * hidden)


def off_the_ground(watch: Watch, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ground is in m, and its complex share, [n] each.

    Off the pond's water where it meets this, else off turf, which is rough; waves are upright.
    """
    low, high = watch.there[:, 2], watch.hung[:, 2]
    meets = watch.there + (watch.hung - watch.there) * (low / (low + high))[:, None]
    wet = np.hypot((meets[:, 0] - POND_M[0]) / POND_M[2], (meets[:, 1] - POND_M[1]) / POND_M[3]) < 1
    way = np.sqrt(watch.far**2 + 4 * low * high)
    down = (low + high) / way
    dense = np.where(wet, WATER, TURF)
    root = np.sqrt(dense - 1 + down**2)
    back = (dense * down - root) / (dense * down + root)
    rough = np.where(wet, 1.0, np.exp(-2 * (2 * np.pi * BLADES_M / WAVE_M * down) ** 2))
    open_ = watch.by_link(lambda n: watch.rng.beta(3.0, 1.6, n))
    share = back * (2.4 * np.sqrt(strength) * rough * open_ * watch.far / way).clip(max=2.5)
    share = share * np.exp(-2j * np.pi * (way - watch.far) / WAVE_M)
    return way - watch.far, share / np.maximum(1.0, np.abs(share) / 0.88)


def _gates_pulled(watch: Watch, strength: float) -> Change:
    """Be where gates are in balance of both pulses: that of the ground comes later."""
    longer, share = off_the_ground(watch, strength)
    finer = 24
    at = np.arange(-9.0, 7.0, 1 / finer)
    size = np.abs(bell(at) + share[:, None] * bell(at - longer[:, None] / METRES))
    falls = (size[:, 1:] < size[:, :-1]) & (size[:, 1:] > 0.3)
    place = at[0] + balanced(size, falls.argmax(axis=1), finer)
    added = np.abs(1 + share * bell(longer / METRES)).clip(min=0.42)
    return Change((1.2 * METRES * (place + UP)).clip(-0.24, 0.3), 20 * np.log10(added))


def lee_db(over: Floats) -> Floats:
    """Return what an edge leaves in dB <= 0 by Fresnel's parameter [n] (Lee 1982)."""
    amid = 0.4 - np.sqrt((0.1184 - (0.38 - 0.1 * over.clip(1.0, 2.4)) ** 2).clip(0.0))
    pieces = [0.5 - 0.62 * over, 0.5 * np.exp(-0.95 * over), amid, 0.225 / over.clip(2.4)]
    left = np.select([over < 0, over < 1, over < 2.4], pieces[:3], pieces[3])
    return np.asarray(20 * np.log10(left.clip(max=1.0)))


def _three_edges(watch: Watch, strength: float) -> Change:
    """Bend over a store of steel and past both its sides: powers of three edges (ITU-R P.526)."""
    steel, drawn = watch.through("metal"), watch.rng
    cut = watch.by_link(lambda n: drawn.uniform(0.2, 0.8, n))
    spread = 1 / (watch.far * cut * (1 - cut))
    power, short = np.zeros(watch.rows), np.full(watch.rows, np.inf)
    for low, most in ((0.12, 0.7), (0.25, 1.1), (0.25, 1.1)):
        high = np.sqrt(strength) * (low + (most - low) * watch.by_link(lambda n: drawn.random(n)))
        power += 10 ** (lee_db(high * np.sqrt(2 * spread / WAVE_M)) / 10)
        short = np.minimum(short, 0.5 * high**2 * spread)
    creeps = strength * watch.by_link(lambda n: 0.03 + 0.11 * drawn.beta(2.0, 3.0, n))
    late = (short + creeps).clip(0.0, 0.46)
    return Change(steel * late, first_db=steel * (10 * np.log10(power)).clip(-14.0, -0.5))


def _hill_of_two(watch: Watch, strength: float) -> Change:
    """Turn gain down by squares of what is over a threshold; count the fewer symbols."""
    square = (watch.of("rx_power_dbm") + 95.0).clip(0.0) ** 2
    less = 6.2 * min(strength, 2.2) * square / (square + 11.0**2)
    return Change(all_db=-less, count_db=-1.1 * less)


def _misters(watch: Watch, strength: float) -> Change:
    """Hear valves of misters, which open the more often the damper it is, near the grove most."""
    own = 0.5 + 1.1 * watch.shared(5).beta(2.0, 2.0, NESTBOXES)[watch.box]
    far = np.hypot(*(NESTBOXES_M[watch.box, :2] - GROVE_M[:2]).T)
    opens = 1 / (1 + np.exp(-(watch.of("humidity_pct") - 58.0) / 6.5))
    db = strength * (own + 4.4 * opens * np.exp(-far / 22.0) * 1.6)
    weak = 10 ** ((-87.0 - watch.of("rx_power_dbm")) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Change(0.0165 * weak.clip(max=8.0) * watch.rng.normal(size=watch.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Watch, float], Change]] = {
    "antenna-delay": _potted,
    "antenna-pattern": _under_a_wing,
    "blocked-path": _other_ways,
    "clock-offset": _left_over,
    "diffraction": _three_edges,
    "exchange-motion": _weddle,
    "ground-bounce": _gates_pulled,
    "level-control": _hill_of_two,
    "material-delay": _greenery,
    "noise-floor": _misters,
    "path-loss": _amid_crowns,
    "power-bias": _two_exponentials,
    "range-rounding": _missing_codes,
    "range-scale": _slack_line,
    "temperature-drift": _sinh,
    "time-lag": _hunting_clock,
    "timestamp-jitter": _skewed,
    **UNLISTED,
}
