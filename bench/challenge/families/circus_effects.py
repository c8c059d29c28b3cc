"""What the circus hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the circus' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.circus_faults import UNLISTED
from bench.challenge.families.circus_lamp import FINE, ITSELF, METRES, REACH, crest, window
from bench.challenge.families.circus_lamp import LOBE as LOBE_SAMPLES
from bench.challenge.families.circus_tent import (
    DAY_S,
    PER_PPM_M,
    POLES,
    TAGS,
    WAVE_M,
    Act,
    Trick,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
CUT_OFF = {False: 0.2, True: 0.075}  # of links, and where these are rare
FRAME_S, PASCAL = 0.036, (1.0, 4.0, 6.0, 4.0, 1.0)  # frames of cameras, and how much each counts
MESSAGES = 3.6  # replies that an exchange lasts
EIGHTHS = (1.0, 3.0, 3.0, 1.0)  # of four places that are as far from each other (Newton)
WARMS_S = 2100.0  # until crystals have warmed by all but 1 / e since a show began
PIPE_M, TUNED_C = 2.1, 20.0  # by which what sounds drifts; where it was tuned
NEUTRAL_DBM, CRANK_DB = -85.2, 13.0  # of biases: where there are none; from end to end
MARK_M = 0.12  # what ranges are written to
TAPE_M, SAGS = 6.0, 0.0115  # a tape's length, and by how much one that sags is too short
CUPOLA_M, HOOP_M = (22.0, 18.0, 11.6), 4.6  # the middle of a hoop of steel, and how wide it is
DIMMERS_M: Floats = np.array([3.0, 33.5, 0.8])
SAND = 3.4 - 0.25j  # permittivity of a ring's sand, damp
ROUGH_M = 0.007  # how its heights scatter
STEP_DB, FROM_DB = 3.0, -95.0  # of an attenuator; from where on it is put in


def _pascal(act: Act, strength: float) -> Trick:
    """Compare with places that five frames give, old ones, which count as in Pascal's triangle."""
    weights = np.array(PASCAL) / np.sum(PASCAL)
    ways = [by * act.outgrows(FRAME_S * strength * k) for k, by in enumerate(weights)]
    return Trick(np.sum(ways, axis=0))


def _eighths(act: Act, strength: float) -> Trick:
    """Give the mean of the way over an exchange, by Newton's rule of three eighths (1711)."""
    long_s = MESSAGES * strength * act["reply_time_s"]
    ways = [by / 8 * act.outgrows(long_s * k / 3) for k, by in enumerate(EIGHTHS)]
    return Trick(np.sum(ways, axis=0))


def _sockets(act: Act, strength: float) -> Trick:
    """Be late by plugs of poles, mostly by little or by much (arcsine), and by tags' sewing."""
    drawn = act.fixed(1)
    plugs = 0.25 * np.sin(0.5 * np.pi * drawn.random(POLES)) ** 2
    sewn = drawn.triangular(0.0, 0.03, 0.16, len(TAGS))
    return Trick(strength * (plugs[act.pole] + sewn[act.tag]))


def _warming(act: Act, strength: float) -> Trick:
    """Leave some of crystals' offset: tags' dies away since a show began, poles' are as they are.

    The second show begins 7400 s before the day ends.
    """
    drawn = act.fixed(2)
    poles = drawn.triangular(-1.2, 0.0, 1.2, POLES)[act.pole]
    cold = (drawn.choice([-1.0, 1.0], len(TAGS)) * drawn.uniform(1.0, 2.6, len(TAGS)))[act.tag]
    kept = drawn.uniform(-0.7, 0.7, len(TAGS))[act.tag]
    since_s = np.where(act["time_s"] < DAY_S - 7400.0, act["time_s"], act["time_s"] - DAY_S + 7400)
    ppm = kept + cold * np.exp(-since_s / WARMS_S) - poles
    return Trick(PER_PPM_M * 0.034 * strength * ppm * act["reply_time_s"])


def hastens(warm_c: Floats | float) -> Floats:
    """Return by what part sound is faster than at TUNED_C: by a root of kelvins (Laplace 1816)."""
    return np.asarray(np.sqrt((np.asarray(warm_c) + 273.15) / (TUNED_C + 273.15)) - 1)


def _pitched(act: Act, strength: float) -> Trick:
    """Drift as sound hastens with warmth, of which filters are made."""
    return Trick(PIPE_M * strength * hastens(act["temperature_c"]))


def poisson(at: Floats, near: float) -> Floats:
    """Return Poisson's kernel on a circle [n], of mean 1: `near` 1 it is a spike (1823)."""
    return np.asarray((1 - near**2) / (1 - 2 * near * np.cos(at) + near**2))


def _shoulder(act: Act, strength: float) -> Trick:
    """Be late and weak behind a performer's shoulder, by Poisson's kernel."""
    at = np.radians(act["azimuth_deg"]) - act.fixed(3).uniform(-np.pi, np.pi)
    shade = poisson(at, 0.52)
    return Trick(0.06 * strength * (shade - 1), first_db=-1.5 * min(strength, 1.5) * shade)


def crank(at: Floats) -> Floats:
    """Return how far a crank has come, of -1 to 1, halfway at 0 and at rest from 1 on [n]."""
    return np.asarray(np.sin(0.5 * np.pi * at.clip(-1.0, 1.0)))


def _cranked(act: Act, strength: float) -> Trick:
    """Be early where it is loud and late where it is weak, and no more at a crank's dead ends."""
    weak = (NEUTRAL_DBM - act["rx_power_dbm"]) / CRANK_DB
    return Trick(0.1 * strength * crank(weak))


def _three_chances(act: Act, strength: float) -> Trick:
    """Scatter by the sum of three even chances (Irwin 1927)."""
    return Trick(0.078 * strength * act.rng.uniform(-0.5, 0.5, (3, act.rows)).sum(axis=0))


def _sawdust(act: Act, strength: float) -> Trick:
    """Lose by a square near by and by a line far off, by an arctangent; links unlike."""
    dusty = 0.6 + 0.8 * act.by_link(lambda n: act.rng.random(n))
    part = act.far / 11.0
    return Trick(all_db=-2.6 * strength * dusty * part * np.arctan(part))


def _tapes(act: Act, strength: float) -> Trick:
    """Be surveyed by tapes that sag: whole ones all alike, the last by a cube of its length."""
    whole, rest = np.divmod(act.far, TAPE_M)
    return Trick(strength * SAGS * TAPE_M * (whole + (rest / TAPE_M) ** 3))


def _either(act: Act, strength: float) -> Trick:
    """Write the next mark below or above, whichever a die has, the nearer one the more often.

    On average that leaves ranges as they are (Forsythe 1950).
    """
    step = MARK_M * strength
    marks = act["range_m"] / step
    return Trick(step * np.floor(marks + act.rng.random(act.rows)) - act["range_m"])


def pressed(heavy: Floats, share: float) -> Floats:
    """Return the permittivity of what is so heavy in g/cm3 [n] (Clausius, Mossotti)."""
    return np.asarray((1 + 2 * share * heavy) / (1 - share * heavy))


def _things(act: Act, strength: float) -> Trick:
    """Go through tiers of seats, flats of scenery, panes and the ring's fence."""
    drawn, link = act.rng, act.by_link
    seats = link(lambda n: 0.024 * drawn.integers(2, 11, n))
    flats = link(lambda n: drawn.uniform(0.04, 0.22, n))
    panes = 0.006 * link(lambda n: drawn.integers(1, 6, n))
    fence = link(lambda n: drawn.triangular(0.08, 0.15, 0.34, n))
    heavy = link(lambda n: drawn.uniform(0.55, 0.8, n))
    things: dict[str, tuple[Floats, Floats]] = {
        "wood": (seats * (np.sqrt(pressed(heavy - 0.1, 0.45)) - 1), 0.9 + 17.0 * seats),
        "plywood": (flats * (np.sqrt(pressed(heavy, 0.55)) - 1), 0.8 + 22.0 * flats),
        "glass": (panes * (np.sqrt(6.31) - 1), 1.0 + 40.0 * panes),
        "chipboard": (fence * (np.sqrt(pressed(heavy, 0.53)) - 1), 1.1 + 15.0 * fence),
    }
    late, lost = (sum(act.meets(w) * both[k] for w, both in things.items()) for k in (0, 1))
    return Trick(strength * np.minimum(late, 0.6), first_db=-min(strength, 1.5) * np.asarray(lost))


def by_the_hoop(act: Act) -> Floats:
    """Return how much longer ways by a hoop of steel in the cupola are, in m [n].

    By the soonest of a hundred and twenty places of it, that is later than half a metre.
    """
    turn = 2 * np.pi * np.arange(120) / 120
    hoop = np.array(CUPOLA_M) + HOOP_M * np.stack(
        [np.cos(turn), np.sin(turn), np.zeros(120)], axis=1
    )
    legs = [np.linalg.norm(end[:, None] - hoop, axis=2) for end in (act.there, act.post)]
    more = legs[0] + legs[1] - act.far[:, None]
    return np.asarray(np.where(more > 0.5, more, np.inf).min(axis=1))


def _off_the_hoop(act: Act, strength: float) -> Trick:
    """Hear, out of sight, nothing but what a hoop of steel returns."""
    hidden = act.cut_off(CUT_OFF[act.rare])
    late = np.minimum(by_the_hoop(act), 4.6) * (0.4 + 0.6 * strength)
    return Trick(hidden * late, -1.2 * hidden, -4.8 * hidden)


def off_the_sand(act: Act, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the sand is in m, and its complex share, [n] each.

    Waves lie flat (Fresnel); heights scatter by an exponential to both sides, whose phases leave
    one over one and half their square.
    """
    up, flat = act.there[:, 2] + act.post[:, 2], (act.there - act.post)[:, :2]
    way = np.sqrt((flat**2).sum(axis=1) + up**2)
    sine = up / way
    root = np.sqrt(SAND - 1 + sine**2)
    back = (sine - root) / (sine + root)
    rough = ROUGH_M * act.by_link(lambda n: act.rng.uniform(0.5, 1.5, n))
    left = 1 / (1 + 0.5 * (4 * np.pi / WAVE_M * rough * sine) ** 2)
    raked = act.by_link(lambda n: act.rng.uniform(0.5, 1.0, n))
    share = 2.1 * np.sqrt(strength) * raked * left * back * act.far / way
    share = share * np.exp(-2j * np.pi * (way - act.far) / WAVE_M)
    return way - act.far, share / np.maximum(np.abs(share) / 0.82, 1.0)


def _both(act: Act, strength: float) -> Trick:
    """Be where what fits both pulses has its first top: that of the sand comes later."""
    longer, share = off_the_sand(act, strength)
    at = np.arange(-REACH, REACH + 1)
    later = at - FINE * longer[:, None] / METRES
    both = np.abs(ITSELF + share[:, None] * np.interp(later, at, ITSELF, 0.0, 0.0))
    tops = (both[:, 1:-1] >= both[:, :-2]) & (both[:, 1:-1] > both[:, 2:])
    tops &= both[:, 1:-1] > 0.35 * both.max(axis=1, keepdims=True)
    late = METRES / FINE * (crest(both, tops.argmax(axis=1) + 1) - REACH)
    added = np.abs(1 + share * window(longer / METRES / LOBE_SAMPLES))
    return Trick(1.15 * late.clip(-0.22, 0.26), 20 * np.log10(added.clip(0.4)))


def rounded_db(over: Floats, girth_m: Floats, legs: tuple[Floats, Floats]) -> Floats:
    """Return what a round top takes in dB [n]: an edge, and more the rounder (ITU-R P.526).

    `over`: m above the straight way; `girth_m`: the radius of what is round; `legs`: to both ends.
    """
    near = 1 / legs[0] + 1 / legs[1]
    v = over * np.sqrt(2 / WAVE_M * near)
    edge = 6.9 + 20 * np.log10(np.hypot(v - 0.1, 1.0) + v - 0.1)
    m = girth_m * near / (np.pi * girth_m / WAVE_M) ** (1 / 3)
    n = over * (np.pi * girth_m / WAVE_M) ** (2 / 3) / girth_m
    round_ = 7.2 * m**0.5 - (2 - 12.5 * n) * m + 3.6 * m**1.5 - 0.8 * m**2
    return np.asarray(np.maximum(edge, 0.0) + np.maximum(round_, 0.0))


def _wagons(act: Act, strength: float) -> Trick:
    """Bend over wagons' round roofs of steel, and creep along these."""
    steel, drawn, link = act.meets("metal"), act.rng, act.by_link
    part = link(lambda n: drawn.beta(2.0, 2.0, n)).clip(0.12, 0.88)
    legs = (part * act.far, (1 - part) * act.far)
    over = np.sqrt(strength) * link(lambda n: drawn.uniform(0.03, 0.2, n)) - 0.08
    girth = link(lambda n: drawn.uniform(0.3, 0.9, n))
    lost = rounded_db(over, girth, legs)
    longer = np.hypot(over, legs[0]) + np.hypot(over, legs[1]) - act.far
    creeps = strength * link(lambda n: drawn.uniform(0.04, 0.13, n))
    late = (longer + creeps).clip(0.0, 0.46)
    return Trick(steel * late, first_db=-steel * lost.clip(1.0, 17.0))


def _attenuator(act: Act, strength: float) -> Trick:
    """Put in an attenuator by whole steps, as levels are over what a lamp likes: fewer count."""
    steps = np.floor((act["rx_power_dbm"] - FROM_DB) / STEP_DB).clip(0.0, 8.0)
    less = 0.62 * min(strength, 2.2) * steps
    return Trick(all_db=-less, count_db=-1.05 * less)


def _dimmers(act: Act, strength: float) -> Trick:
    """Hear dimmers, most when they are half open, the less by Cauchy's curve the farther."""
    own = act.fixed(4).uniform(0.4, 1.6, POLES)[act.pole]
    away = np.linalg.norm(act.post - DIMMERS_M, axis=1)
    chop = np.sin(np.pi * act["dim_pct"] / 100.0) ** 2
    db = strength * (own + 8.8 * chop / (1 + (away / 21.0) ** 2))
    weak = 10 ** ((-92.0 - act["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Trick(0.016 * weak.clip(max=8.0) * act.rng.normal(size=act.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Act, float], Trick]] = {
    "antenna-delay": _sockets,
    "antenna-pattern": _shoulder,
    "blocked-path": _off_the_hoop,
    "clock-offset": _warming,
    "diffraction": _wagons,
    "exchange-motion": _eighths,
    "ground-bounce": _both,
    "level-control": _attenuator,
    "material-delay": _things,
    "noise-floor": _dimmers,
    "path-loss": _sawdust,
    "power-bias": _cranked,
    "range-rounding": _either,
    "range-scale": _tapes,
    "temperature-drift": _pitched,
    "time-lag": _pascal,
    "timestamp-jitter": _three_chances,
    **UNLISTED,
}
