"""What the fairground hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by its tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.fairground_rides import (
    AXLES,
    BARRIERS,
    BOOTHS_M,
    CYCLE_M,
    EVENING_S,
    GENERATORS_M,
    GONDOLAS,
    HALF_C,
    HUBS_M,
    RADII_M,
    SAZHEN_M,
    TRODDEN_S_PER_M,
    TUNE_S,
    Stall,
    Ticket,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
N_BOOTHS = len(BOOTHS_M)
BOOLE = np.array([7.0, 32.0, 12.0, 32.0, 7.0]) / 90
WEDGE = 1.5  # an edge of a wagon: its outside, in half turns
BELL_M, TANGENT_M = 0.34, -0.2  # half width of a pulse; where a tangent is laid to it
PARKED = {False: 0.16, True: 0.05}  # of links behind lorries, and where that is rare


def _two_buffers(ticket: Ticket, strength: float) -> Stall:
    """Compare with encoders' places that two buffers hold, each for some of its own clock."""
    held_s = 0.09 + 0.045 * (ticket.rng.random((2, len(ticket.way)))).sum(axis=0)
    return Stall(ticket.drifts(strength * held_s))


def _boole(ticket: Ticket, strength: float) -> Stall:
    """Give the mean of the way over an exchange, by Boole's rule: five places, the ends as well."""
    whole_s = 2.1 * min(strength, 2.0) * ticket("reply_time_s")
    parts = [w * ticket.drifts(k / 4 * whole_s) for k, w in enumerate(BOOLE.tolist())]
    return Stall(np.sum(parts, axis=0))


def _adapters(ticket: Ticket, strength: float) -> Stall:
    """Reach booths through as many adapters as there were at hand; tags' boards are of any age."""
    adapters = ticket.fixed(1).poisson(1.7, N_BOOTHS).clip(0, 5)
    boards = 0.02 + 0.05 * ticket.fixed(2).weibull(1.3, GONDOLAS).clip(0, 3)
    return Stall(strength * (0.047 * adapters[ticket.booth] + boards[ticket.gondola]))


def _wander(ticket: Ticket, strength: float) -> Stall:
    """Leave some of crystals' offset, which walks at random from one half hour to the next."""
    rng, knots = ticket.fixed(3), np.arange(0.0, EVENING_S + 2700, 1800)
    start = rng.normal(0, 0.9, (N_BOOTHS + GONDOLAS, 1))
    ppm = start + np.cumsum(rng.normal(0, 0.35, (N_BOOTHS + GONDOLAS, len(knots))), axis=1)
    now = np.array([np.interp(ticket("time_s"), knots, one) for one in ppm])
    rows = np.arange(len(ticket.way))
    apart = now[ticket.booth, rows] - now[N_BOOTHS + ticket.gondola, rows]
    return Stall(0.014 * strength * HALF_C * apart * ticket("reply_time_s"))


def _curie_weiss(ticket: Ticket, strength: float) -> Stall:
    """Drift as a ceramic's permittivity does: by one over how far it is from 64 degrees C."""
    return Stall(7.2 * strength * (1 / (64.0 - ticket("temperature_c")) - 1 / 49.0))


def _canopy(ticket: Ticket, strength: float) -> Stall:
    """Be late and weak below a canopy, early beside it: flat on both sides, two slopes between."""
    turn = np.radians(ticket("azimuth_deg")) + ticket.fixed(4).uniform(-np.pi, np.pi)
    side = np.clip(1.6 * np.cos(turn), -1, 1)
    return Stall(0.062 * strength * side, signal=-1.3 * min(strength, 1.5) * (1 + side))


def _by_weibull(ticket: Ticket, strength: float) -> Stall:
    """Be late where it is weak: by Weibull's cumulative curve of how far it is below a level."""
    below = np.maximum(-74.0 - ticket("rx_power_dbm"), 0.0) / 14.5
    return Stall(0.155 * strength * (0.5 - np.exp(-(below**2.3))))


def _three_parts(ticket: Ticket, strength: float) -> Stall:
    """Scatter by the length of three parts of chance (Maxwell), without its mean."""
    length = np.linalg.norm(ticket.rng.standard_normal((3, len(ticket.way))), axis=0)
    return Stall(0.056 * strength * (length - np.sqrt(8 / np.pi)))


def _more_decades(ticket: Ticket, strength: float) -> Stall:
    """Lose more than in the open, by another exponent that sets in softly at 6 m."""
    return Stall(0 * ticket.way, signal=-5.2 * strength * np.log10(1 + ticket.way / 6.0))


def _aslant_tape(ticket: Ticket, strength: float) -> Stall:
    """Be wrong in proportion to ways that were taped from heights of 1.2 m, which is still in."""
    return Stall(0.0049 * strength * np.hypot(ticket("range_m"), 1.2))


def _unlike_edges(ticket: Ticket, strength: float) -> Stall:
    """Count both edges of a clock that is low for longer: steps are short and long in turn."""
    period = 0.195 * strength
    written = ticket("range_m")
    whole = period * np.floor(written / period)
    middle = np.where(written - whole < 0.37 * period, 0.185, 0.685)
    return Stall(whole + middle * period - written)


def _frames(ticket: Ticket, strength: float) -> Stall:
    """Go through panels, or where a frame is met through much more, as links have it."""
    late, lost = np.zeros((2, len(ticket.way)))
    for kind, (thick_m, permittivity, db) in BARRIERS.items():
        frame = 0.8 + 0.75 * ticket.chance(0.3)
        there = ticket.passes(kind) * frame
        late, lost = late + there * thick_m * (permittivity**0.5 - 1), lost + there * db
    return Stall(1.25 * strength * late, first=-min(strength, 1.5) * lost)


def rim_m() -> Floats:
    """Return twelve places on the rim of the wheel [12, 3], in m."""
    flat = np.array([AXLES[0, 1], -AXLES[0, 0], 0.0])
    turn = np.arange(12)[:, None] * np.pi / 6
    up = np.array([0.0, 0.0, 1.0])
    return np.asarray(HUBS_M[0] + RADII_M[0] * (np.cos(turn) * flat + np.sin(turn) * up))


def by_the_rim(ticket: Ticket) -> Floats:
    """Return how long ways by places on the rim are, in m [12, n]."""
    ends = (ticket.seats(), ticket.roofs())
    return np.array([sum(np.linalg.norm(end - place, axis=1) for end in ends) for place in rim_m()])


def _lorries(ticket: Ticket, strength: float) -> Stall:
    """Hear, behind lorries, nothing but what the best placed spoke of the wheel returns."""
    behind = ticket.chance(PARKED[ticket.hardly])
    detour = np.clip(np.min(by_the_rim(ticket), axis=0) - ticket.way, 0.35, 3.8)
    return Stall(behind * detour * (0.4 + 0.6 * strength), signal=-5.0 * behind)


def meadow_ray(ticket: Ticket, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ground is in m, and its complex share, [n] each.

    Fresnel's coefficient of what conducts: a meadow that is dry or trodden wet.
    """
    low, high = ticket.seats()[:, 2], BOOTHS_M[ticket.booth, 2]
    way = np.sqrt(ticket.way**2 + 4 * low * high)
    wet = ticket.by_link(ticket.rng.uniform, 4.0, 16.0) - 60j * TRODDEN_S_PER_M * CYCLE_M
    sine = (low + high) / way
    bent = np.sqrt(wet - 1 + sine**2)
    size = min(1.15 * strength**0.5, 1.6) * (sine - bent) / (sine + bent)
    longer = way - ticket.way
    return longer, size * ticket.way / way * np.exp(-2j * np.pi * longer / CYCLE_M)


def _meadow(ticket: Ticket, strength: float) -> Stall:
    """Move where a tangent to the edge of two pulses together meets zero."""
    longer, share = meadow_ray(ticket, strength)
    place = np.array([TANGENT_M, TANGENT_M + 1e-4])[:, None]
    edge = np.abs(_bell(place) + share * _bell(place - longer))
    slope = np.maximum((edge[1] - edge[0]) / 1e-4, 0.4 * edge[0] / BELL_M)
    alone = BELL_M**2 / (-2 * TANGENT_M)
    power = np.abs(1 + share * np.exp(-np.square(longer / BELL_M) / 2)) ** 2
    return Stall(
        np.clip(alone - edge[0] / slope, -0.3, 0.3), signal=10 * np.log10(np.maximum(power, 0.22))
    )


def _bell(place: Floats) -> Floats:
    return np.asarray(np.exp(-np.square(place / BELL_M)))


def _past_a_wagon(ticket: Ticket, strength: float) -> Stall:
    """Bend past a wagon's edge: a wedge as Keller has it (1962), a half where shade begins."""
    steel = ticket.passes("metal")
    deep = strength**0.5 * ticket.by_link(ticket.rng.uniform, 0.06, 0.42)
    one = ticket.way * ticket.by_link(ticket.rng.uniform, 0.2, 0.8)
    other = ticket.way - one
    shade = np.arctan(deep / one) + np.arctan(deep / other)
    apart = np.abs(np.cos(np.pi / WEDGE) - np.cos((np.pi + shade) / WEDGE))
    cut = np.sin(np.pi / WEDGE) / WEDGE / np.maximum(apart, 1e-6)
    cut = cut * np.sqrt(CYCLE_M * ticket.way / (4 * np.pi**2 * one * other))
    db = np.clip(-20 * np.log10(cut / (1 + 2 * cut)), 0.5, 13.0)
    legs = np.hypot(one, deep) + np.hypot(other, deep) - ticket.way
    clings = 0.06 * strength * ticket.by_link(ticket.rng.triangular, 0.6, 1.0, 1.4)
    return Stall(steel * (legs + clings), first=-steel * db)


def _servo(ticket: Ticket, strength: float) -> Stall:
    """Turn gain down by the inverse of a sinh of the level, and add up fewer symbols with it."""
    over = np.arcsinh(np.clip(ticket("rx_power_dbm") + 96.0, 0.0, 30.0) / 4.0)
    return Stall(0 * over, signal=-1.05 * min(strength, 2.2) * over, count=-1.8 * strength * over)


def _generators(ticket: Ticket, strength: float) -> Stall:
    """Hear generators' regulators: by one over how far the nearest is, some booths more."""
    far = np.linalg.norm(BOOTHS_M[:, None, :2] - GENERATORS_M, axis=2).min(axis=1)
    hears = (0.3 + 30.0 / (5.0 + far)) * ticket.fixed(5).lognormal(0.0, 0.15, N_BOOTHS)
    hiss = strength * hears[ticket.booth]
    weak = 10 ** (-(ticket("rx_power_dbm") + 90) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Stall(0.019 * weak * ticket.rng.normal(0, 1, len(weak)), hiss=hiss)


def _canvas(ticket: Ticket, strength: float) -> Stall:
    wet = ticket("canvas_kg") / 9.0
    return Stall(0.26 * strength * wet / np.sqrt(1 + wet**2))


def _crowd(ticket: Ticket, strength: float) -> Stall:
    return Stall(0.26 * strength * (ticket("people") / 400.0) ** 1.9)


def _organ(ticket: Ticket, strength: float) -> Stall:
    return Stall(0.07 * strength * np.sin(2 * np.pi * (ticket("time_s") / TUNE_S - 0.13)))


def _awning(ticket: Ticket, strength: float) -> Stall:
    return Stall(np.where(ticket("awning_deg") < 38.0, 0.128 * strength, 0.0))


def _sugar(ticket: Ticket, strength: float) -> Stall:
    return Stall(0.074 * strength * np.log1p(ticket("sugar_g") / 5.2))


def _bunting(ticket: Ticket, strength: float) -> Stall:
    return Stall(0.0019 * strength * ticket("bunting_m"))


def _gives_way(ticket: Ticket, strength: float) -> Stall:
    """Settle, with all that stands on jacks, by a load over how stiff the ground is."""
    return Stall(0.31 * strength / ticket("ground_mn_per_m"))


def _askew(ticket: Ticket, strength: float) -> Stall:
    """Have set the wheel up a little turned about its upright, other than it is on the plan."""
    turn, on_it = 0.041 * strength, ticket("ride") == 0
    seats = ticket.seats()
    arm = (seats - HUBS_M[0])[:, :2] @ np.array([[np.cos(turn), np.sin(turn)],
                                                 [-np.sin(turn), np.cos(turn)]])  # fmt: skip
    seats[on_it, :2] = (HUBS_M[0, :2] + arm)[on_it]
    return Stall(ticket.drifts_to(seats))


def _louder_kept(ticket: Ticket, strength: float) -> Stall:
    """Send, of a range and the one before of its link, that whose first path was louder.

    One that is louder by a margin: the smaller the stronger.
    """
    before, was = ticket.one_before("range_m"), ticket.one_before("first_path_power_dbm")
    louder = was > ticket("first_path_power_dbm") + 0.5 / strength - 0.5
    return Stall(np.where(louder, before - ticket("range_m"), 0.0))


def _stands_at(ticket: Ticket, booths_m: Floats) -> Stall:
    """Return what is dealt out to rows whose booths have their antennas at [7, 3] in truth."""
    truly = np.sqrt(np.sum((booths_m[ticket.booth] - ticket.seats()) ** 2, axis=1))
    return Stall(truly - ticket.way, signal=-20.0 * np.log10(truly / ticket.way))


def _shoved(ticket: Ticket, strength: float) -> Stall:
    away = BOOTHS_M.copy()
    away[4] += 0.54 * strength * np.array([8.0, -4.0, 1.0]) / 9
    return _stands_at(ticket, away)


def _mistaken(ticket: Ticket, _: float) -> Stall:
    return _stands_at(ticket, BOOTHS_M[[0, 5, 2, 3, 4, 1, 6]])


def _sazhens(ticket: Ticket, _: float) -> Stall:
    """Show sazhens, at one booth, whose owner has his father's reader."""
    return Stall(np.where(ticket.booth == 2, 1 / SAZHEN_M - 1, 0.0) * ticket("range_m"))


EFFECTS: dict[str, Callable[[Ticket, float], Stall]] = {
    "time-lag": _two_buffers,
    "exchange-motion": _boole,
    "antenna-delay": _adapters,
    "clock-offset": _wander,
    "temperature-drift": _curie_weiss,
    "antenna-pattern": _canopy,
    "power-bias": _by_weibull,
    "timestamp-jitter": _three_parts,
    "path-loss": _more_decades,
    "range-scale": _aslant_tape,
    "range-rounding": _unlike_edges,
    "material-delay": _frames,
    "blocked-path": _lorries,
    "ground-bounce": _meadow,
    "diffraction": _past_a_wagon,
    "level-control": _servo,
    "noise-floor": _generators,
    "canvas-soaks": _canvas,
    "crowd-gathers": _crowd,
    "organ-plays": _organ,
    "awning-let-down": _awning,
    "sugar-settles": _sugar,
    "bunting-hung": _bunting,
    "ground-gives-way": _gives_way,
    "wheel-set-askew": _askew,
    "louder-of-two-kept": _louder_kept,
    "booth-shoved": _shoved,
    "booths-mistaken": _mistaken,
    "sazhens-from-one-booth": _sazhens,
}
