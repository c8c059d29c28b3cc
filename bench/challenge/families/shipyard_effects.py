"""What the shipyard hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the shipyard's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.shipyard_faults import UNLISTED
from bench.challenge.families.shipyard_lookout import AHEAD, METRES, combers, first_paths, heights
from bench.challenge.families.shipyard_slip import (
    DERRICKS,
    DOCK_M,
    PPM_MS_M,
    TAGS,
    TANK_M,
    TANKS_M,
    WAVE_M,
    Berth,
    Toll,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
OUT_OF_SIGHT = {False: 0.2, True: 0.075}  # of links, and where these are rare
OLDEST_S = 0.158  # of places that are told
ROOT = 6**0.5
RADAU = (((4 - ROOT) / 10, (16 - ROOT) / 36), ((4 + ROOT) / 10, (16 + ROOT) / 36), (1.0, 1 / 9))
"""Places of an exchange, the last one of which is its end, and what each counts (Radau 1880)."""
LASTS = 2.2  # replies that an exchange does
CABLE_M, POTTING_M = 0.95, 0.046  # of a reel that is cut up, in late metres; of tags
TURNS_S = 5.3 * 3600
MAGNUS, DRY_C, DEW_M = (6.112, 17.62, 243.12), 17.0, 0.0029  # hPa, 1, C; no drift; m each hPa
APART, DIPOLES_M, DIPOLES_DB = 0.27, 0.088, 5.6  # waves from dipole to dipole; late; weak
EVEN_DBM, LOG_DB, LOG_M = -87.0, 3.6, 0.031  # of bias: where it is none, how wide, how much
SCATTERS_M = 0.0365
MOST_DB, RIGGED_M = (
    7.2,
    27.0,
)  # that rigging takes at last; by which e times less of that is to come
SHORT_M, BASES_M = 0.0125, (1.4, 3.6)  # of bases that clocks were set on; how long these were
COMBS_M = (0.165, 0.272)  # from mark to mark of either scale
ASIDE_M, SOONEST_M = 4.0, 0.6  # of balls off ways; longer
DECK, LAID_M = 9.4 - 1.1j, 0.017  # permittivity of wet timber; how far planks lie up or down
LIKED_DBM, WIDE_DB = -95.5, 4.6  # over which gain is turned down
WELDS_M: Floats = np.array([33.0, 14.0, 3.0])
FULL_A = 420.0


def _old(berth: Berth, strength: float) -> Toll:
    """Compare with places whose ages are by a beta's law, of one and of four."""
    at, by = np.polynomial.legendre.leggauss(9)
    age = 0.5 * (at + 1)
    counts = by * age * (1 - age) ** 3
    ways = [berth.hauls_off(OLDEST_S * strength * one) for one in age.tolist()]
    return Toll(counts @ np.stack(ways) / counts.sum())


def _exchange(berth: Berth, strength: float) -> Toll:
    """Give the mean of the way over an exchange, by Radau's three places."""
    long_s = LASTS * strength * berth["reply_time_s"]
    return Toll(sum((by * berth.hauls_off(at * long_s) for at, by in RADAU), np.zeros(berth.rows)))


def broken(rng: np.random.Generator, parts: int) -> Floats:
    """Return lengths of parts of a stick of 1 that is broken anywhere [parts]."""
    return np.diff(np.sort(rng.random(parts - 1)), prepend=0.0, append=1.0)


def _cables(berth: Berth, strength: float) -> Toll:
    """Be late by cables that were cut off one reel anywhere; tags by how deep they are potted."""
    drawn = berth.alike(1)
    cables = CABLE_M * broken(drawn, DERRICKS)
    potted = POTTING_M * np.hypot(*drawn.standard_normal((2, len(TAGS)))).clip(0.0, 3.0)
    return Toll(strength * (cables[berth.derrick] + potted[berth.tag]))


def _turning(berth: Berth, strength: float) -> Toll:
    """Leave some of crystals' offset: tags' goes up and down by a cosine of hours."""
    drawn = berth.alike(2)
    derricks = 0.5 * np.arcsin(drawn.uniform(-1.0, 1.0, DERRICKS))
    rest, sways = drawn.uniform(-0.6, 0.6, len(TAGS)), drawn.uniform(0.4, 1.1, len(TAGS))
    phase = drawn.uniform(0.0, 2 * np.pi, len(TAGS))[berth.tag]
    turn = np.cos(2 * np.pi * berth["time_s"] / TURNS_S + phase)
    ppm = 0.025 * strength * (rest[berth.tag] + sways[berth.tag] * turn - derricks[berth.derrick])
    return Toll(PPM_MS_M * ppm * (1e3 * berth["reply_time_s"]))


def saturated_hpa(warm: Floats | float) -> Floats:
    """Return how much vapour air can hold by degrees C, in hPa [n] (Magnus 1844)."""
    at_0, by, off = MAGNUS
    return np.asarray(at_0 * np.exp(by * warm / (off + np.asarray(warm))))


def _vapour(berth: Berth, strength: float) -> Toll:
    """Drift with the vapour that saturated air has in lacquer."""
    return Toll(DEW_M * strength * (saturated_hpa(berth["temperature_c"]) - saturated_hpa(DRY_C)))


def of_dipoles(turn: Floats) -> Floats:
    """Return what power three dipoles in a row give, next to their most, by radians off it [n]."""
    phase = 2 * np.pi * APART * (1 - np.cos(turn))
    return np.asarray(((1 + 2 * np.cos(phase)) / 3) ** 2)


def _dipoles(berth: Berth, strength: float) -> Toll:
    """Be late and weak where a tag's three dipoles give less; no later in the mean."""
    aims = berth.alike(3).uniform(-np.pi, np.pi)
    lack = 1 - of_dipoles(np.radians(berth["azimuth_deg"]) - aims)
    mean = 1 - of_dipoles(np.linspace(0.0, 2 * np.pi, 361)[1:]).mean()
    weak = -DIPOLES_DB * min(strength, 1.5) * lack
    return Toll(DIPOLES_M * strength * (lack - mean), first_db=weak)


def _logarithmic(berth: Berth, strength: float) -> Toll:
    """Be early where it is loud and late where it is weak, by an amplifier of both signs' logs."""
    return Toll(LOG_M * strength * np.arcsinh((EVEN_DBM - berth["rx_power_dbm"]) / LOG_DB))


def semicircle(rng: np.random.Generator, rows: int) -> Floats:
    """Return what scatters by 1 as Wigner's half circle (1955), from -2 to 2 [rows]."""
    out, turn = np.sqrt(rng.random(rows)), rng.uniform(0.0, 2 * np.pi, rows)
    return np.asarray(2 * out * np.cos(turn))


def _jitter(berth: Berth, strength: float) -> Toll:
    """Scatter by a half circle."""
    return Toll(SCATTERS_M * strength * semicircle(berth.rng, berth.rows))


def _rigging(berth: Berth, strength: float) -> Toll:
    """Lose in rigging, which takes no more than so much, since waves come round it as well."""
    thick = berth.each(lambda n: np.sqrt(berth.rng.uniform(0.3, 2.0, n)))
    return Toll(dim_db=MOST_DB * strength * thick * np.expm1(-berth.far / RIGGED_M))


def _bases(berth: Berth, strength: float) -> Toll:
    """Count by clocks that were set on bases, all too short by as much: short ones are the worst.

    A part that is wrong is one over how long a base was.
    """
    bases = berth.alike(5).uniform(*BASES_M, DERRICKS)
    return Toll(strength * berth.far * (SHORT_M / bases)[berth.derrick])


def at_either(ranges: Floats, combs: tuple[float, float]) -> Floats:
    """Return the nearest mark of either of two scales that begin alike, in m [n]."""
    one, other = (comb * np.rint(ranges / comb) for comb in combs)
    return np.where(np.abs(one - ranges) <= np.abs(other - ranges), one, other)


def _combs(berth: Berth, strength: float) -> Toll:
    ranges = berth["range_m"]
    return Toll(at_either(ranges, (COMBS_M[0] * strength, COMBS_M[1] * strength)) - ranges)


def of_both(one: float, other: float, part: Floats) -> Floats:
    """Return the permittivity of two things, of which the other has a part [n] (Bruggeman 1935)."""
    half = 0.25 * ((2 - 3 * part) * one + (3 * part - 1) * other)
    return np.asarray(half + np.sqrt(half**2 + 0.5 * one * other))


def _things(berth: Berth, strength: float) -> Toll:
    """Go through wet planks of staging, mats for the tanks, moulds of ribs, and panes."""
    rng, each = berth.rng, berth.each
    planks = each(lambda n: 0.042 * rng.integers(1, 4, n))
    wet = np.sqrt(of_both(1.9, 76.0, each(lambda n: rng.uniform(0.02, 0.15, n)))) - 1
    mats = each(lambda n: rng.triangular(0.1, 0.2, 0.5, n))
    moulds = each(lambda n: 0.018 * rng.integers(2, 9, n))
    panes = each(lambda n: 0.011 * rng.integers(1, 6, n))
    things: dict[str, tuple[Floats, Floats]] = {
        "wood": (planks * wet, 0.7 + 21.0 * planks),
        "foam": (mats * (np.sqrt(1.31) - 1), 0.5 + 3.1 * mats),
        "plywood": (moulds * (np.sqrt(2.71) - 1), 0.6 + 17.0 * moulds),
        "glass": (panes * (np.sqrt(6.31) - 1), 0.8 + 33.0 * panes),
    }
    late, lost = np.sum([np.stack(both) * berth.behind(what) for what, both in things.items()], 0)
    return Toll(1.45 * strength * late, first_db=-min(strength, 1.5) * lost)


def off_a_ball(one: Floats, other: Floats, ball: Floats) -> tuple[Floats, Floats]:
    """Return places [n, 3] and a ball's middle: both legs of the way that it returns, in m [2, n].

    It is met where both legs make one angle with it (Alhazen): again and again one takes the
    direction that halves these, as seen from where one was.
    """
    out = np.stack([one, other]) - ball
    normal = (out / np.linalg.norm(out, axis=2, keepdims=True)).sum(axis=0)
    for _ in range(60):
        normal = normal / np.linalg.norm(normal, axis=1, keepdims=True).clip(1e-9)
        legs = out - TANK_M * normal
        normal = normal + (legs / np.linalg.norm(legs, axis=2, keepdims=True)).sum(axis=0)
    first, second = np.linalg.norm(legs, axis=2)
    return first, second


def aside_m(berth: Berth, ball: Floats) -> Floats:
    """Return how far a ball's middle is off straight ways, in m [n]."""
    run = berth.top_m - berth.tag_m
    part = ((ball - berth.tag_m) * run).sum(axis=1) / (run**2).sum(axis=1)
    near = berth.tag_m + part.clip(0.0, 1.0)[:, None] * run
    return np.asarray(np.linalg.norm(near - ball, axis=1))


def off_tanks(berth: Berth) -> Floats:
    """Return how much longer the soonest way off a tank or the roof is, in m [n].

    Nothing comes off a tank that is less than ASIDE_M beside the straight way: it is in the way.
    """
    over = 2 * DOCK_M[2] - berth.tag_m[:, 2] - berth.top_m[:, 2]
    soonest = np.hypot(np.hypot(*(berth.top_m - berth.tag_m)[:, :2].T), over)
    for ball in TANKS_M:
        way = np.sum(off_a_ball(berth.tag_m, berth.top_m, ball), axis=0)
        soonest = np.where(aside_m(berth, ball) > ASIDE_M, np.minimum(soonest, way), soonest)
    return np.asarray(soonest - berth.far)


def _off_tanks(berth: Berth, strength: float) -> Toll:
    """Hear, out of sight, nothing but what a tank returns, or the roof."""
    cut = berth.cut_off(OUT_OF_SIGHT[berth.rare])
    late = off_tanks(berth).clip(SOONEST_M, 6.0) * (0.5 + 0.5 * strength)
    return Toll(cut * late, -1.5 * cut, -4.5 * cut)


def planks(sine: Floats) -> Complexes:
    """Return what wet planks return of level waves that are so steep [n] (Fresnel).

    These lie up and down evenly, so that phases spread over a box: by a sinc.
    """
    root = np.sqrt(DECK - 1 + sine**2)
    return np.asarray((sine - root) / (sine + root) * np.sinc(4 * LAID_M * sine / WAVE_M))


def off_the_deck(berth: Berth, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the planks is in m, and its complex share, [n] each."""
    up = berth.tag_m[:, 2] + berth.top_m[:, 2]
    way = np.sqrt(berth.far**2 + 4 * berth.tag_m[:, 2] * berth.top_m[:, 2])
    clear = berth.each(lambda n: berth.rng.triangular(0.25, 0.75, 1.0, n))
    share = 0.78 * np.sqrt(strength) * clear * berth.far / way * planks(up / way)
    share = share * np.exp(2j * np.pi / WAVE_M * (berth.far - way))
    return way - berth.far, share * np.minimum(1.0, 0.77 / np.abs(share).clip(1e-9))


def crest_of_two(longer_m: Floats, share: Complexes) -> tuple[Floats, Floats]:
    """Return by how much first paths are later in m, and as what share of one, [n] each.

    As lookouts have it of two pulses, the second of which is so much later and such a share.
    """
    top = np.full(longer_m.shape, 88.4)
    both = combers(top) + share[:, None] * combers(top + longer_m / METRES)
    at = first_paths(both, np.full(longer_m.shape, 1e-6))
    return METRES * (at - top + AHEAD), heights(both, at)


def _deck(berth: Berth, strength: float) -> Toll:
    """Be where both pulses' crest is: that of the planks comes later."""
    late, height = crest_of_two(*off_the_deck(berth, strength))
    return Toll(late.clip(-0.2, 0.24), 20 * np.log10(height.clip(0.4)))


PATH, BY = np.polynomial.legendre.leggauss(48)


def left_past(v: Floats) -> Complexes:
    """Return what is left past an edge by Fresnel's parameter, which is > 0 in its shadow [n].

    The integral goes down its steepest way, on which nothing turns.
    """
    along = 2.0 * (PATH + 1)
    fall = -0.5 * np.pi * along**2 - np.pi * np.exp(0.25j * np.pi) * np.abs(v)[:, None] * along
    whole = np.sqrt(2.0) * np.exp(fall) @ BY * np.exp(-0.5j * np.pi * v**2)
    return np.asarray(np.where(v < 0, 1 - whole, whole), np.complex128)


def past_two_db(v: Floats, then: Floats) -> Floats:
    """Return what two edges take in dB, the main one and the other seen off it (Deygout 1966)."""
    return np.asarray(-20 * np.log10(np.abs(left_past(v)) * np.abs(left_past(then)).clip(max=1.0)))


def over_ribs(berth: Berth, high: Floats, lower: Floats, at: Floats, long: Floats) -> Floats:
    """Return what a stack of ribs takes in dB [n], by its edges' heights and places in m."""
    rest, root = berth.far - at, np.sqrt(2 / WAVE_M)
    v = high * root * np.sqrt(1 / at + 1 / rest)
    below = lower - high * (rest - long) / rest
    return past_two_db(v, below * root * np.sqrt(1 / long + 1 / (rest - long)))


def _ribs(berth: Berth, strength: float) -> Toll:
    """Bend over a stack of ribs of steel, by its higher edge and then its lower; creep between."""
    steel, rng, each = berth.behind("metal"), berth.rng, berth.each
    at = berth.far * each(lambda n: rng.uniform(0.2, 0.6, n))
    long = np.minimum(each(lambda n: rng.uniform(0.5, 1.9, n)), 0.25 * berth.far)
    high = np.sqrt(strength) * each(lambda n: 0.05 + 0.3 * rng.beta(1.5, 1.5, n))
    lower = high * each(lambda n: rng.uniform(0.4, 1.0, n))
    rise = 0.5 * (high**2 / at + lower**2 / (berth.far - at - long) + (high - lower) ** 2 / long)
    late = rise + strength * each(lambda n: rng.uniform(0.05, 0.17, n))
    lost = over_ribs(berth, high, lower, at, long)
    return Toll(steel * late.clip(0.0, 0.46), first_db=-steel * lost.clip(1.0, 17.0))


def _turned_down(berth: Berth, strength: float) -> Toll:
    """Turn gain down, as two calls have come by then (Erlang 1909), by what is over a level."""
    over = ((berth["rx_power_dbm"] - LIKED_DBM) / WIDE_DB).clip(0.0)
    less = 3.4 * min(strength, 2.2) * (1 - (1 + over) * np.exp(-over))
    return Toll(dim_db=-less, tally_db=-1.1 * less)


def _welds(berth: Berth, strength: float) -> Toll:
    """Hear welding, by the root of its current; as it goes along plates, e times less by metres."""
    own = berth.alike(4).uniform(0.3, 1.3, DERRICKS)[berth.derrick]
    away = np.linalg.norm(berth.top_m - WELDS_M, axis=1)
    db = strength * (own + 7.4 * np.sqrt(berth["weld_a"] / FULL_A) * np.exp(-away / 48.0))
    weak = 10 ** ((-92.5 - berth["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    stray = berth.rng.standard_normal(berth.rows)
    return Toll(0.0165 * stray * np.minimum(weak, 8.0), hiss_db=db)


EFFECTS: dict[str, Callable[[Berth, float], Toll]] = {
    "antenna-delay": _cables,
    "antenna-pattern": _dipoles,
    "blocked-path": _off_tanks,
    "clock-offset": _turning,
    "diffraction": _ribs,
    "exchange-motion": _exchange,
    "ground-bounce": _deck,
    "level-control": _turned_down,
    "material-delay": _things,
    "noise-floor": _welds,
    "path-loss": _rigging,
    "power-bias": _logarithmic,
    "range-rounding": _combs,
    "range-scale": _bases,
    "temperature-drift": _vapour,
    "time-lag": _old,
    "timestamp-jitter": _jitter,
    **UNLISTED,
}
