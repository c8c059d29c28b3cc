"""What the velodrome hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the velodrome's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.velodrome_camera import METRES, bulges, seen
from bench.challenge.families.velodrome_faults import MOST_RPM, UNLISTED
from bench.challenge.families.velodrome_track import (
    EVENING_S,
    PER_PPM_M,
    POSTS,
    TAGS,
    WAVE_M,
    Handicap,
    Race,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
CUT_OFF = {False: 0.2, True: 0.075}  # of links, and where these are rare
FRAME_S, FIBONACCI = 0.0032, (5.0, 3.0, 2.0, 1.0, 1.0)  # frames, and how much each counts
MESSAGES = 0.65  # replies that an exchange lasts
THERMISTOR_K, TUNED_C, DIVIDES_M = 3950.0, 21.0, 0.46
NEUTRAL_DBM, DIODE_DB, DIODE_M = -86.0, 6.5, 0.115
EGG = 1.12  # of Cassini's oval
ROOT_M = 0.0134  # of roots of metres that ranges are written to
INDEX, THINS_M = 0.0098, 9.0  # by which part ways are too long at the floor; what thins it
RAILS_M: Floats = np.array(
    [(5.3, 3.9), (48.7, 3.9), (16.5, 12.1), (37.5, 12.1), (20.5, 1.1), (33.5, 1.1)]
)
"""Where rails of steel run along the hall: across and up, in m."""
PIT_M: Floats = np.array([33.0, 25.0, 0.7])
FLOOR = 5.24 - 0.24j  # permittivity of the infield's concrete (ITU-R P.2040)
UNEVEN_M = 0.018  # between the lowest and the highest of it
LIKED_DBM, WIDE_DB = -99.0, 32.0  # from which levels gain is turned down, and until when


def _frames(race: Race, strength: float) -> Handicap:
    """Compare with places of old frames, of which each counts as two before it (Fibonacci)."""
    weights = np.array(FIBONACCI) / np.sum(FIBONACCI)
    ways = [by * race.widens(FRAME_S * strength * k) for k, by in enumerate(weights, 1)]
    return Handicap(np.sum(ways, axis=0))


def fejer(count: int) -> tuple[Floats, Floats]:
    """Return places between 0 and 1 and what each counts, which sum up to 1 (Fejer 1933)."""
    angle = np.pi * (np.arange(count) + 0.5) / count
    k = np.arange(1, count // 2 + 1)[:, None]
    counts = 1 - 2 * np.sum(np.cos(2 * k * angle) / (4 * k**2 - 1), axis=0)
    return 0.5 - 0.5 * np.cos(angle), counts / count


def _exchange(race: Race, strength: float) -> Handicap:
    """Give the mean of the way over an exchange, by Fejer's rule of five places."""
    long_s = MESSAGES * strength * race["reply_time_s"]
    ways = [by * race.widens(long_s * part) for part, by in zip(*fejer(5), strict=True)]
    return Handicap(np.sum(ways, axis=0))


def _splices(race: Race, strength: float) -> Handicap:
    """Be late by splices of posts' cables, as one over what chance leaves; by tags' tape."""
    drawn = race.same(1)
    part = drawn.random(POSTS)
    spliced = 0.075 * part / (1 - 0.72 * part)
    taped = 0.012 * drawn.integers(0, 9, len(TAGS))
    return Handicap(strength * (spliced[race.post] + taped[race.tag]))


def _ageing(race: Race, strength: float) -> Handicap:
    """Leave some of crystals' offset: tags' goes by the root of how long the evening is old."""
    drawn = race.same(2)
    posts = drawn.normal(0.0, 0.55, POSTS).clip(-1.2, 1.2)[race.post]
    first = (drawn.choice([-1.0, 1.0], len(TAGS)) * drawn.uniform(0.7, 1.9, len(TAGS)))[race.tag]
    aged = drawn.uniform(-1.1, 1.1, len(TAGS))[race.tag]
    ppm = first + aged * np.sqrt(race["time_s"].clip(0.0) / EVENING_S) - posts
    return Handicap(PER_PPM_M * 0.036 * strength * ppm * race["reply_time_s"])


def divided(warm_c: Floats) -> Floats:
    """Return by what part a thermistor's divider is off its middle [n]: by a logistic of 1 / K."""
    off = THERMISTOR_K * (1 / (TUNED_C + 273.15) - 1 / (warm_c + 273.15))
    return np.asarray(1 / (1 + np.exp(-off)) - 0.5)


def _thermistor(race: Race, strength: float) -> Handicap:
    """Drift as a thermistor in a divider has it."""
    return Handicap(DIVIDES_M * strength * divided(race["temperature_c"]))


def oval(at: Floats) -> Floats:
    """Return how far Cassini's oval is from its middle, less its mean, [n] (1680)."""
    round_ = np.linspace(0.0, 2 * np.pi, 361)[:-1]
    far, every = (
        np.sqrt(np.cos(2 * a) + np.sqrt(EGG**4 - np.sin(2 * a) ** 2)) for a in (at, round_)
    )
    return np.asarray(far - every.mean())


def _back(race: Race, strength: float) -> Handicap:
    """Be late and weak before and behind a bent rider, by Cassini's oval."""
    shade = oval(np.radians(race["azimuth_deg"]) - race.same(3).uniform(-np.pi, np.pi))
    return Handicap(0.105 * strength * shade, first_db=-1.6 * min(strength, 1.5) * (shade + 0.5))


def lambert(of: Floats) -> Floats:
    """Return w [n] of which w + ln w is `of`: Lambert's function of an exponential (1758)."""
    w = np.where(of > 1.0, np.maximum(of, 1.0), np.exp(np.minimum(of, 1.0)) / 2.0)
    for _ in range(12):
        w = w * (1 + of - np.log(w)) / (1 + w)
    return np.asarray(w)


def _diode(race: Race, strength: float) -> Handicap:
    """Be late where it is weak, as a diode with a resistor has it: by Lambert's function."""
    weak = (NEUTRAL_DBM - race["rx_power_dbm"]) / DIODE_DB
    return Handicap(DIODE_M * strength * (lambert(weak) - lambert(np.zeros(1))))


def _middle_of_three(race: Race, strength: float) -> Handicap:
    """Scatter by the middle one of three even chances: a parabola (Epanechnikov 1969)."""
    three = np.sort(race.rng.uniform(-1.0, 1.0, (3, race.rows)), axis=0)
    return Handicap(0.088 * strength * three[1])


def _crowd(race: Race, strength: float) -> Handicap:
    """Lose in the air of a full house: by the three halves of how far it is; links unlike."""
    full = race.per_link(lambda n: race.rng.beta(2.0, 2.0, n)) + 0.5
    return Handicap(all_db=-3.0 * strength * full * (race.far / 24.0).clip(max=2.2) ** 1.5)


def _index(race: Race, strength: float) -> Handicap:
    """Be surveyed by light without what air holds it up by, which is thinner the higher it is."""
    up = 0.5 * (race.rider[:, 2] + race.hears[:, 2])
    return Handicap(strength * INDEX * race.far * np.exp(-up / THINS_M))


def _roots(race: Race, strength: float) -> Handicap:
    """Write roots of ranges in whole steps."""
    step = ROOT_M * strength
    ranges = race["range_m"]
    return Handicap((step * np.rint(np.sqrt(ranges.clip(0.0)) / step)) ** 2 - ranges)


def along_grain(along: float, across: float, turned: Floats) -> Floats:
    """Return the refractive index of wood to whose grain waves are turned so [n], in radians.

    Of its permittivities along and across grain; by the ellipsoid of indices (Fresnel 1821).
    """
    return np.asarray(1 / np.sqrt(np.cos(turned) ** 2 / across + np.sin(turned) ** 2 / along))


def _things(race: Race, strength: float) -> Handicap:
    """Go through hoardings, screens, boards on edge and panes."""
    drawn, link = race.rng, race.per_link
    turned = link(lambda n: 0.5 * np.pi * drawn.random(n))
    plies = link(lambda n: 0.012 * drawn.integers(3, 13, n))
    screens = link(lambda n: drawn.uniform(0.03, 0.16, n))
    boards = link(lambda n: 0.04 * drawn.integers(1, 7, n))
    panes = link(lambda n: 0.008 * drawn.integers(1, 5, n))
    things: dict[str, tuple[Floats, Floats]] = {
        "plywood": (plies * (np.sqrt(2.71) - 1), 0.9 + 18.0 * plies),
        "plastic": (screens * (np.sqrt(2.55) - 1), 0.7 + 20.0 * screens),
        "wood": (boards * (along_grain(2.4, 1.8, turned) - 1), 1.0 + 13.0 * boards),
        "glass": (panes * (np.sqrt(6.31) - 1), 1.1 + 38.0 * panes),
    }
    late, lost = (sum(race.through(w) * both[k] for w, both in things.items()) for k in (0, 1))
    return Handicap(
        1.5 * strength * np.asarray(late), first_db=-min(strength, 1.5) * np.asarray(lost)
    )


def by_rails(race: Race) -> Floats:
    """Return how much longer ways by straight rails are, in m [n], unrolled about these.

    By the soonest of all, that is later than half a metre.
    """
    beside = [
        np.linalg.norm(end[:, None, 1:] - RAILS_M, axis=2) for end in (race.rider, race.hears)
    ]
    along = (race.rider - race.hears)[:, [0]]
    more = np.hypot(beside[0] + beside[1], along) - race.far[:, None]
    return np.asarray(np.where(more > 0.5, more, np.inf).min(axis=1))


def _off_rails(race: Race, strength: float) -> Handicap:
    """Hear, out of sight, nothing but what rails of steel return."""
    cut = race.hidden(CUT_OFF[race.rare])
    late = np.minimum(by_rails(race), 4.4) * (0.45 + 0.55 * strength)
    return Handicap(cut * late, -1.1 * cut, -4.9 * cut)


def off_the_floor(race: Race, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the infield is in m, and its complex share, [n] each.

    Waves stand upright (Fresnel); the floor's heights are even chances, whose phases leave a sinc.
    """
    up = race.rider[:, 2] + race.hears[:, 2]
    flat = ((race.rider - race.hears)[:, :2] ** 2).sum(axis=1)
    way = np.sqrt(flat + up**2)
    sine = up / way
    root = np.sqrt(FLOOR - 1 + sine**2)
    back = (FLOOR * sine - root) / (FLOOR * sine + root)
    uneven = UNEVEN_M * race.per_link(lambda n: race.rng.uniform(0.4, 1.5, n))
    left = np.sinc(2 * uneven * sine / WAVE_M)
    swept = race.per_link(lambda n: race.rng.uniform(0.45, 1.0, n))
    share = 2.3 * np.sqrt(strength) * swept * left * back * race.far / way
    share = share * np.exp(-2j * np.pi * (way - race.far) / WAVE_M)
    return way - race.far, share / np.maximum(np.abs(share) / 0.78, 1.0)


def through_slit(late: Floats) -> Floats:
    """Return how much of pulses so many samples later a slit lets through [n], of 1 at 0."""
    tops = np.arange(0.0, 8.0, 0.05)
    waves = bulges(90.0 + tops).astype(np.complex128)
    through = np.abs(seen(waves, np.full(len(tops), 90.0), 0.0))
    return np.asarray(np.interp(late, tops, through / through[0], right=0.0))


def _both(race: Race, strength: float) -> Handicap:
    """Be where phases of both pulses turn evenly: that of the floor comes later."""
    longer, share = off_the_floor(race, strength)
    share = share * through_slit(longer / METRES)
    late = longer * np.real(share / (1 + share))
    return Handicap(late.clip(-0.2, 0.24), 20 * np.log10(np.abs(1 + share).clip(0.4)))


def beyond(v: Floats) -> Complexes:
    """Return the share of waves that is left behind an edge, by Fresnel's parameter of any sign.

    By rational auxiliary functions, within 0.002 (Hastings 1955).
    """
    x = np.abs(v)
    f = (1 + 0.926 * x) / (2 + 1.792 * x + 3.104 * x**2)
    g = 1 / (2 + 4.142 * x + 3.492 * x**2 + 6.67 * x**3)
    share = (g + 1j * f) * np.exp(0.5j * np.pi * x**2) * (1 - 1j) / 2
    return np.where(v >= 0, share, 1 - share)


def _vans(race: Race, strength: float) -> Handicap:
    """Bend over a van of steel and round one side of it: both ways add up as they come."""
    steel, drawn, link = race.through("metal"), race.rng, race.per_link
    part = link(lambda n: drawn.uniform(0.2, 0.8, n))
    near = 1 / (part * race.far) + 1 / ((1 - part) * race.far)
    off = [link(lambda n: drawn.uniform(0.12, 0.7, n)) * np.sqrt(strength) for _ in (0, 1)]
    top, side = (beyond(one * np.sqrt(2 / WAVE_M * near)) for one in off)
    lost = -20 * np.log10(np.abs(top + side).clip(1e-3))
    soon = np.minimum(*off)
    creeps = strength * link(lambda n: drawn.uniform(0.05, 0.16, n))
    late = (0.5 * soon**2 * near + creeps).clip(0.0, 0.46)
    return Handicap(steel * late, first_db=-steel * lost.clip(1.0, 17.0))


def eased(part: Floats) -> Floats:
    """Return what goes from 0 to 1 and is level at both ends: a cubic [n]."""
    part = part.clip(0.0, 1.0)
    return part**2 * (3 - 2 * part)


def _eased(race: Race, strength: float) -> Handicap:
    """Turn gain down, softly at first and at last, as levels are over what is liked."""
    over = eased((race["rx_power_dbm"] - LIKED_DBM) / WIDE_DB)
    less = 4.6 * min(strength, 2.2) * over
    return Handicap(all_db=-less, count_db=-1.1 * less)


def _ignitions(race: Race, strength: float) -> Handicap:
    """Hear ignitions of dernies that warm up: by three halves of how fast; less the farther."""
    own = race.same(4).uniform(0.4, 1.5, POSTS)[race.post]
    away = np.linalg.norm(race.hears - PIT_M, axis=1)
    db = strength * (own + 9.5 * (race["derny_rpm"] / MOST_RPM) ** 1.5 / (1 + away / 30.0))
    weak = 10 ** ((-93.0 - race["rx_power_dbm"]) / 20) * np.sqrt(np.expm1(db * np.log(10) / 10))
    return Handicap(0.017 * weak.clip(max=8.0) * race.rng.normal(size=race.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Race, float], Handicap]] = {
    "antenna-delay": _splices,
    "antenna-pattern": _back,
    "blocked-path": _off_rails,
    "clock-offset": _ageing,
    "diffraction": _vans,
    "exchange-motion": _exchange,
    "ground-bounce": _both,
    "level-control": _eased,
    "material-delay": _things,
    "noise-floor": _ignitions,
    "path-loss": _crowd,
    "power-bias": _diode,
    "range-rounding": _roots,
    "range-scale": _index,
    "temperature-drift": _thermistor,
    "time-lag": _frames,
    "timestamp-jitter": _middle_of_three,
    **UNLISTED,
}
