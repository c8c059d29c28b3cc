"""What the belfry's close hides in ranges and levels: effects in forms of its own, laws, faults.

numpy alone; shared by its tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.belfry_close import (
    GARGOYLES_M,
    LENGTH_M,
    LIGHT_HALF,
    MASONS,
    QUARTER_S,
    SCREENS,
    TOISE_M,
    WATER,
    Toll,
    Watch,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
MOUTHS = len(GARGOYLES_M)
EDGE_M, WIDE_M = 0.26, 0.5  # in which an edge grows by e; half width of a pulse
BEHIND, SELDOM_BEHIND = 0.17, 0.05  # of links
BIAS_DBM = (-101.0, -95.0, -91.0, -87.0, -83.0, -79.0, -74.0, -68.0)
BIAS_M = (0.086, 0.079, 0.061, 0.03, -0.012, -0.034, -0.046, -0.05)


def _asked_in_turn(watch: Watch, strength: float) -> Toll:
    """Compare with places of when a round was called, before gargoyles ask one after another."""
    late_s = 0.115 + 0.012 * watch.gargoyle.astype(np.float64)
    return Toll(watch.opened(strength * late_s))


def _product_by_sum(watch: Watch, strength: float) -> Toll:
    """Give products of both ways by sums, as asymmetric exchanges do: a harmonic mean."""
    later = watch.opened(1.6 * min(strength, 2.0) * watch["reply_time_s"])
    return Toll(watch.away * later / (2 * watch.away + later))


def _down_the_tower(watch: Watch, strength: float) -> Toll:
    """Be late by some of a cable down to the ground; tags by what coats them, few by much."""
    coats = 0.02 + 0.13 * watch.stays(1).power(0.5, MASONS)
    down = 0.0068 * GARGOYLES_M[:, 2] + 0.012
    return Toll(strength * (down[watch.gargoyle] + coats[watch.mason]))


def _two_lots(watch: Watch, strength: float) -> Toll:
    """Be of one lot of crystals or another, which were cut a little fast and a little slow."""
    rng = watch.stays(2)
    ppm = np.where(rng.random(MOUTHS + MASONS) < 0.5, 1.15, -1.0) + rng.laplace(
        0, 0.35, MOUTHS + MASONS
    )
    apart = ppm[watch.gargoyle] - ppm[MOUTHS + watch.mason]
    return Toll(0.022 * strength * LIGHT_HALF * apart * watch["reply_time_s"])


def _turns_over(watch: Watch, strength: float) -> Toll:
    """Be least late at a temperature that a quartz filter was cut for: by the square beside it."""
    beside = watch["temperature_c"] - 13.0
    return Toll(strength * (0.00034 * beside**2 - 0.03))


def _behind_a_back(watch: Watch, strength: float) -> Toll:
    """Be late and weak behind a mason's back, and by hardly anything elsewhere: a cardioid's cube.

    Without its mean, 5/16.
    """
    turn = np.radians(watch["azimuth_deg"]) + watch.stays(3).uniform(0, 2 * np.pi)
    back = ((1 - np.cos(turn)) / 2) ** 3
    return Toll(0.155 * strength * (back - 0.3125), all=-2.8 * min(strength, 1.5) * back)


def _published(watch: Watch, strength: float) -> Toll:
    """Be late by a table of levels as makers of chips publish it, straight between knots."""
    return Toll(strength * np.interp(watch["rx_power_dbm"], BIAS_DBM, BIAS_M))


def _spur(watch: Watch, strength: float) -> Toll:
    """Sway with a spur of the synthesiser, whose phase no range knows: an arcsine's scatter."""
    return Toll(0.062 * strength * np.sin(2 * np.pi * watch.rng.random(len(watch))))


def _steeper(watch: Watch, strength: float) -> Toll:
    """Lose by a larger exponent than in the open, from a metre on."""
    return Toll(0 * watch.away, all=-2.6 * strength * np.log10(np.maximum(watch.away, 1.0)))


def _short_second(watch: Watch, strength: float) -> Toll:
    """Count with a second that is too short, and with it all that is written."""
    return Toll((1 / (1 - 0.0054 * strength) - 1) * watch["range_m"])


def _short_floats(watch: Watch, strength: float) -> Toll:
    """Write short floating numbers, whose step doubles whenever ranges do."""
    written = watch["range_m"]
    step = 0.0092 * strength * 2 ** np.floor(np.log2(np.maximum(written, 1.0)))
    return Toll(step * np.rint(written / step) - written)


def _wet_stone(watch: Watch, strength: float) -> Toll:
    """Go through what is wet: refractive indices mix by volumes (Birchak and others 1974)."""
    late, lost = np.zeros(len(watch)), np.zeros(len(watch))
    for kind, (thick_m, dry, db) in SCREENS.items():
        wet = watch.linked(lambda n: watch.rng.triangular(0.0, 0.02, 0.09, n))
        index = (1 - wet) * dry**0.5 + wet * WATER**0.5
        there = watch.screened(kind)
        late, lost = late + there * thick_m * (index - 1), lost + there * db * (0.8 + 6.0 * wet)
    return Toll(1.3 * strength * late, first=-min(strength, 1.5) * lost)


def _by_a_yew(watch: Watch, strength: float) -> Toll:
    """Hear, behind the tower, nothing but what a yew beside it scatters: a corner of a triangle."""
    share = SELDOM_BEHIND if watch.seldom else BEHIND
    there = watch.linked(lambda n: np.where(watch.rng.random(n) < share, 1.0, 0.0))
    part = watch.linked(lambda n: watch.rng.uniform(0.2, 0.8, n))
    aside = watch.linked(lambda n: watch.rng.uniform(2.4, 5.6, n))
    legs = np.hypot(part * watch.away, aside) + np.hypot((1 - part) * watch.away, aside)
    detour = np.clip(legs - watch.away, 0.3, 4.0)
    return Toll(there * detour * (0.42 + 0.58 * strength), all=-5.4 * there)


def turf_ray(watch: Watch, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the turf is in m, and its complex share, [n] each.

    All of it at grazing, and exponentially less the steeper it is met; long grass takes some.
    """
    low, high = watch.tags()[:, 2], watch.mouths()[:, 2]
    way = np.sqrt(watch.away**2 + 4 * low * high)
    grass = watch.linked(lambda n: watch.rng.uniform(0.7, 1.0, n))
    share = min(1.15 * strength**0.5, 1.5) * grass * np.exp(-1.1 * (low + high) / way)
    share = share * watch.away / way
    return way - watch.away, -share * np.exp(-2j * np.pi * (way - watch.away) / LENGTH_M)


def _turf(watch: Watch, strength: float) -> Toll:
    """Cross a level sooner or later than without: both edges grow exponentially until then."""
    longer, share = turf_ray(watch, strength)
    edge = np.abs(1 + share * np.exp(-longer / EDGE_M))
    moved = -EDGE_M * np.log(np.clip(edge, 0.3, 2.0))
    power = np.abs(1 + share * np.maximum(1 - longer / (2 * WIDE_M), 0.0)) ** 2
    return Toll(np.clip(moved, -0.3, 0.3), all=10 * np.log10(np.maximum(power, 0.22)))


def _round_railings(watch: Watch, strength: float) -> Toll:
    """Bend over iron railings: Delisle's polynomials (1985), and creep along what is round."""
    iron = watch.screened("metal")
    deep = strength**0.5 * watch.linked(lambda n: watch.rng.uniform(0.08, 0.45, n))
    one = watch.away * watch.linked(lambda n: watch.rng.uniform(0.18, 0.82, n))
    other = watch.away - one
    v = deep * np.sqrt(2 * watch.away / (LENGTH_M * one * other))
    near = 6.02 + 9.11 * v - 1.27 * v**2
    db = np.where(v < 2.4, near, 12.95 + 20 * np.log10(np.maximum(v, 0.1)))
    legs = np.hypot(one, deep) + np.hypot(other, deep) - watch.away
    creeps = 0.06 * strength * watch.linked(lambda n: watch.rng.uniform(0.7, 1.3, n))
    return Toll(iron * (legs + creeps), first=-iron * np.clip(db, 0.5, 14.0))


def _half_decibels(watch: Watch, strength: float) -> Toll:
    """Turn gain down by a part of each dB over a level, and add up fewer symbols as well."""
    over = np.clip(watch["rx_power_dbm"] + 98.0, 0.0, 24.0)
    return Toll(0 * over, all=-0.19 * min(strength, 2.2) * over, count=-0.31 * strength * over)


def _town(watch: Watch, strength: float) -> Toll:
    """Hear the town over the wall: more of it the higher, as a logarithm."""
    over = np.log1p(GARGOYLES_M[:, 2] / 3.0) * watch.stays(4).uniform(0.8, 1.2, MOUTHS)
    hiss = strength * (0.4 + 1.7 * over[watch.gargoyle])
    weak = 10 ** (-(watch["rx_power_dbm"] + 92) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Toll(0.019 * weak * watch.rng.normal(size=len(watch)), hiss=hiss)


def _lichen(watch: Watch, strength: float) -> Toll:
    return Toll(0.25 * strength * np.arctan(watch["lichen_mm"] / 1.2) / (0.5 * np.pi))


def _dew(watch: Watch, strength: float) -> Toll:
    return Toll(0.27 * strength * (watch["dew_um"] / 80.0) ** 2)


def _quarters(watch: Watch, strength: float) -> Toll:
    return Toll(0.071 * strength * np.cos(2 * np.pi * watch["time_s"] / QUARTER_S - 0.8))


def _louvres(watch: Watch, strength: float) -> Toll:
    return Toll(np.where(watch["louvre_deg"] >= 41.0, 0.136 * strength, 0.0))


def _moss(watch: Watch, strength: float) -> Toll:
    return Toll(0.076 * strength * np.log1p(watch["moss_mm"] / 2.6))


def _nests(watch: Watch, strength: float) -> Toll:
    return Toll(0.00033 * strength * watch["twigs_g"])


def _brackets(watch: Watch, strength: float) -> Toll:
    """Sag by as much as the pull of a stay divides."""
    return Toll(0.2 * strength / watch["pull_kn"])


def _barometer(watch: Watch, strength: float) -> Toll:
    """Take heights from a barometer: air pressure falls while a day lasts, so tags seem to rise.

    Each tag's was set by its wearer at another time of the day.
    """
    hours = (watch["time_s"] - watch.stays(5).uniform(0, 34200, MASONS)[watch.mason]) / 3600
    truly = watch.tags() - (0.036 * strength * hours)[:, None] * np.array([0.0, 0.0, 1.0])
    return Toll(watch.opened_from(truly))


def _leaps_cut(watch: Watch, strength: float) -> Toll:
    """Let no range be farther from the one before than a little: what leaps is cut."""
    most_m, ranges = 0.27 / strength**0.5, watch["range_m"]
    sent = ranges.copy()
    for row, before in enumerate(watch.after_another().tolist()):
        if before >= 0:
            sent[row] = np.clip(ranges[row], sent[before] - most_m, sent[before] + most_m)
    return Toll(sent - ranges)


def _fixed(watch: Watch, gargoyles_m: Floats) -> Toll:
    """Return what is added to rows whose gargoyles have their antennas at [8, 3] in truth."""
    truly = np.linalg.norm(gargoyles_m[watch.gargoyle] - watch.tags(), axis=1)
    return Toll(truly - watch.away, all=20.0 * np.log10(watch.away / truly))


def _broken_off(watch: Watch, strength: float) -> Toll:
    lower = np.zeros((MOUTHS, 3))
    lower[5] = 0.535 * strength * np.array([-6.0, 7.0, -6.0]) / 11
    return _fixed(watch, GARGOYLES_M + lower)


def _misread(watch: Watch, _: float) -> Toll:
    return _fixed(watch, GARGOYLES_M[[0, 6, 2, 3, 4, 5, 1, 7]])


def _toises(watch: Watch, _: float) -> Toll:
    """Show toises, at one gargoyle, as the old plans do."""
    factor = np.where(watch.gargoyle == 2, 1 / TOISE_M, 1.0)
    return Toll((factor - 1) * watch["range_m"])


EFFECTS: dict[str, Callable[[Watch, float], Toll]] = {
    "time-lag": _asked_in_turn,
    "exchange-motion": _product_by_sum,
    "antenna-delay": _down_the_tower,
    "clock-offset": _two_lots,
    "temperature-drift": _turns_over,
    "antenna-pattern": _behind_a_back,
    "power-bias": _published,
    "timestamp-jitter": _spur,
    "path-loss": _steeper,
    "range-scale": _short_second,
    "range-rounding": _short_floats,
    "material-delay": _wet_stone,
    "blocked-path": _by_a_yew,
    "ground-bounce": _turf,
    "diffraction": _round_railings,
    "level-control": _half_decibels,
    "noise-floor": _town,
    "lichen-on-radomes": _lichen,
    "dew-gathers": _dew,
    "quarters-struck": _quarters,
    "louvres-shut": _louvres,
    "moss-grows": _moss,
    "nests-grow": _nests,
    "brackets-sag": _brackets,
    "barometer-drifts": _barometer,
    "leaps-cut": _leaps_cut,
    "gargoyle-broken-off": _broken_off,
    "gargoyles-misread": _misread,
    "toises-from-one-gargoyle": _toises,
}
