"""What the roundhouse hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the roundhouse's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from math import erf

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.roundhouse_recorder import METRES, RISE, window
from bench.challenge.families.roundhouse_stalls import (
    ARSHIN_M,
    BETWEEN,
    CENTRE_M,
    CHAIR_M,
    DAY_S,
    FRONTS_M,
    PER_PPM_M,
    PIERS,
    PIERS_AT,
    PIERS_M,
    TABLE_M,
    TAGS,
    WALL_M,
    WAVE_M,
    WIDE_RAD,
    Shunt,
    Toll,
    placed,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
BEHIND_ENGINES = {False: 0.21, True: 0.07}  # of links, and where these are rare
FLOOR, UNEVEN_M = 5.24 - 0.55j, 0.004  # concrete at 6.5 GHz [ITU-R P.2040]; how uneven it is
ROUND_M: Floats = placed(np.full(73, WALL_M), np.linspace(0.0, np.pi, 73), np.full(73, 3.4))
RETURNED_BY: Floats = np.concatenate([ROUND_M, FRONTS_M])  # the round wall, and smokeboxes
DIPS_C: Floats = np.array([9.0, 16.0, 23.0, 30.0, 37.0])  # where crystals' activity may dip
LOBATTO = ((0.5, 1 / 12), (0.2236068, 5 / 12))  # places beside the middle, and their weights
CHARGERS_RAD: Floats = WIDE_RAD * np.array([2.5, 8.5])  # stalls where batteries are charged
ROOFS_M = 5.4  # from one engine's roof to the next
PLAY_RAD, SPLAYED, LAYER_M, BEHIND = 0.024, 0.0085, 0.17, 0.16


def _middle_frame(shunt: Shunt, strength: float) -> Toll:
    """Compare with places of a camera: the middle one of its last three frames, whenever it was."""
    late_s = shunt.rng.uniform(0.0, 0.025, shunt.size)
    frames = [shunt.lengthens_in(strength * (0.058 * k + late_s)) for k in (1, 2, 3)]
    return Toll(np.median(frames, axis=0))


def _lobatto(shunt: Shunt, strength: float) -> Toll:
    """Give the mean of the way over an exchange, by Lobatto's rule: both ends, and two between."""
    whole_s = 1.8 * strength * shunt["reply_time_s"]
    sides = ((0.5 + sense * off, by) for off, by in LOBATTO for sense in (-1, 1))
    return Toll(sum(by * shunt.lengthens_in(place * whole_s) for place, by in sides))


def _conduits(shunt: Shunt, strength: float) -> Toll:
    """Be late by some of conduits round the wall, and by joints in these; tags by their paint."""
    joints = shunt.shared(1).geometric(0.42, PIERS).clip(max=5)[shunt.pier]
    paint = shunt.shared(2).choice([0.02, 0.075, 0.13], len(TAGS))[shunt.tag]
    return Toll(strength * (0.022 * np.radians(PIERS_AT[shunt.pier, 1]) + 0.037 * joints + paint))


def _activity_dips(shunt: Shunt, strength: float) -> Toll:
    """Leave some of crystals' offset, and of what tags' are pulled by where activity dips."""
    own = shunt.shared(3).triangular(-1.3, 0.0, 1.3, PIERS + len(TAGS))
    dip_c = shunt.shared(4).choice(DIPS_C, len(TAGS))[shunt.tag]
    pulled = 0.8 / (1 + ((shunt["temperature_c"] - dip_c) / 3.5) ** 2)
    ppm = 0.0145 * strength * (own[PIERS + shunt.tag] - own[shunt.pier] + pulled)
    return Toll(PER_PPM_M * ppm * shunt["reply_time_s"])


def _three_halves(shunt: Shunt, strength: float) -> Toll:
    """Drift by warmth above freezing to the power of three halves."""
    warm = np.maximum(shunt["temperature_c"], 0.0)
    return Toll(strength * (0.00125 * warm**1.5 - 0.14))


def _wrapped_laplace(shunt: Shunt, strength: float) -> Toll:
    """Be late and weak past a handrail's stanchion: Laplace's peak of the direction, wrapped."""
    off = np.radians(shunt["azimuth_deg"]) - shunt.shared(5).uniform(0.0, 2 * np.pi)
    off = np.abs(np.angle(np.exp(1j * off)))
    shade = np.cosh((np.pi - off) / 0.75) / np.cosh(np.pi / 0.75)
    return Toll(strength * (0.19 * shade - 0.045), -3.8 * min(strength, 1.5) * shade)


def _error_function(shunt: Shunt, strength: float) -> Toll:
    """Be late where it is weak: by the error function of the level."""
    over = (shunt["rx_power_dbm"] + 85.0) / 5.5
    return Toll(-0.092 * strength * np.array([erf(one) for one in over]))


def _middle_of_three(shunt: Shunt, strength: float) -> Toll:
    """Scatter as the middle one of three stamps does, each anywhere within a tick."""
    stamps = shunt.rng.uniform(-0.085, 0.085, (3, shunt.size))
    return Toll(strength * np.median(stamps, axis=0))


def _past_stalls(shunt: Shunt, strength: float) -> Toll:
    """Lose more with each decade of distance, and for each stall that is crossed; by links."""
    load = shunt.per_link(lambda n: shunt.rng.beta(2.0, 2.0, n))
    return Toll(whole_db=-strength * (2.6 * np.log10(shunt.far) + 0.55 * shunt.crossed + load))


def _delay_lines(shunt: Shunt, strength: float) -> Toll:
    """Count by delay lines, which are long, and stretch a little in the course of a day."""
    slow = 0.0055 + 0.0012 * shunt["time_s"] / DAY_S
    return Toll(strength * slow * shunt["range_m"])


def _squares(shunt: Shunt, strength: float) -> Toll:
    """Keep squares of ranges in whole steps: far ranges are finer than near ones."""
    step, read = 2.8 * strength, shunt["range_m"]
    return Toll(np.sqrt(step * np.rint(read**2 / step).clip(min=0.0)) - read)


def _layers(shunt: Shunt, strength: float) -> Toll:
    """Go through what is layered, along its layers (Wiener 1912): permittivities are averaged.

    Doors and panes stand round the middle, piers' flanks along rays from it.
    """
    late, lost = np.zeros(shunt.size), np.zeros(shunt.size)
    for kind, (thick_m, solid, dense, db) in BETWEEN.items():
        straight = shunt.along(outward=kind != "brick").clip(0.45, 1.0)
        layers = shunt.per_link(lambda n: shunt.rng.integers(2, 6, n)) / 3.5 * shunt.through(kind)
        mixed = solid * dense + (1 - solid)
        late += layers * thick_m * (np.sqrt(mixed - 1 + straight**2) - straight)
        lost += layers * db / np.sqrt(straight)
    return Toll(0.95 * strength * late, first_db=-min(strength, 1.5) * lost)


def _best_return(shunt: Shunt, strength: float) -> Toll:
    """Hear, behind an engine, nothing but what of round wall and smokeboxes returns first."""
    there = shunt.unseen(BEHIND_ENGINES[shunt.rare])
    legs = [np.linalg.norm(end[:, None] - RETURNED_BY, axis=2) for end in (shunt.there, shunt.hung)]
    detour = ((legs[0] + legs[1]).min(axis=1) - shunt.far).clip(0.4, 3.6)
    return Toll(there * detour * (0.45 + 0.55 * strength), -2.2 * there, -3.5 * there)


def floor_ray(shunt: Shunt, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Antennas lie across their ways; the floor is of concrete, uneven (Boithias 1987). What lies on
    it takes some, by links.
    """
    way = np.linalg.norm(shunt.there * [1.0, 1.0, -1.0] - shunt.hung, axis=1)
    down = (shunt.there[:, 2] + shunt.hung[:, 2]) / way
    inside = np.sqrt(FLOOR - 1 + down**2)
    rough = 0.5 * (4 * np.pi * UNEVEN_M * down / WAVE_M) ** 2
    even = (3.2 * rough - 2 + np.sqrt((3.2 * rough) ** 2 - 7 * rough + 9)) ** -0.5
    free = shunt.per_link(lambda n: shunt.rng.beta(6.0, 2.0, n))
    size = (1.5 * strength**0.5 * even * free * shunt.far / way).clip(max=1.3)
    longer = way - shunt.far
    turned = np.exp(-2j * np.pi * longer / WAVE_M)
    return longer, size * (down - inside) / (down + inside) * turned


def _mean_rise(shunt: Shunt, strength: float) -> Toll:
    """Be where both pulses rise on average, each step by its square: the floor's comes later."""
    longer, share = floor_ray(shunt, strength)
    at = np.linspace(-4.0, 3.0, 106)
    both = np.abs(window(at) + share[:, None] * window(at - longer[:, None] / METRES))
    steps = np.diff(both, axis=1)
    before = np.cumsum((steps < 0) & (both[:, 1:] > 0.3), axis=1) == 0
    weight = np.where(before, np.maximum(steps, 0.0), 0.0) ** 2 + 1e-12
    place = (weight * (at[1:] - (at[1] - at[0]) / 2)).sum(axis=1) / weight.sum(axis=1)
    added = np.abs(1 + share * np.exp(-((longer / 0.75) ** 2))).clip(min=0.4)
    return Toll((1.4 * METRES * (place + RISE)).clip(-0.24, 0.32), 20 * np.log10(added))


def roofs_db(glance_rad: Floats) -> Floats:
    """Return what many roofs one behind the other take in dB [n] (Walfisch and Bertoni 1988)."""
    field = 2.35 * (glance_rad * np.sqrt(ROOFS_M / WAVE_M)) ** 0.9
    return np.asarray(-20 * np.log10(field.clip(max=1.0)))


def _over_roofs(shunt: Shunt, strength: float) -> Toll:
    """Bend over the roofs of engines side by side, the lower of which the way would go through."""
    steel = shunt.through("metal")
    part = shunt.per_link(lambda n: shunt.rng.triangular(0.2, 0.5, 0.8, n))
    high = np.sqrt(strength) * shunt.per_link(lambda n: shunt.rng.uniform(0.12, 0.42, n))
    legs = shunt.far * part, shunt.far * (1 - part)
    bent = np.hypot(legs[0], high) + np.hypot(legs[1], high) - shunt.far
    cabs = strength * shunt.per_link(lambda n: shunt.rng.uniform(0.04, 0.11, n))
    glance = 0.034 * shunt.per_link(lambda n: shunt.rng.beta(2.0, 2.0, n)) / np.sqrt(strength)
    lost = 1.5 + roofs_db(glance.clip(0.004)).clip(max=17.0)
    return Toll(steel * (bent + cabs).clip(max=0.46), first_db=-steel * lost)


def _diodes(shunt: Shunt, strength: float) -> Toll:
    """Turn gain down by diodes, which go no further than they can; sum the fewer symbols."""
    over = np.maximum(shunt["rx_power_dbm"] + 92.0, 0.0)
    less = 7.0 * min(strength, 2.2) * (1 - np.exp(-over / 22.0))
    return Toll(whole_db=-less, sums_db=-1.15 * less)


def _chargers(shunt: Shunt, strength: float) -> Toll:
    """Hear chargers of batteries, at shunts while they are on: the more the nearer round."""
    apart = np.radians(PIERS_AT[shunt.pier, 1])[:, None] - CHARGERS_RAD
    near = np.exp(-np.abs(np.angle(np.exp(1j * apart))) / 0.8).sum(axis=1)
    own = shunt.shared(6).uniform(0.5, 1.1, PIERS)[shunt.pier]
    on = shunt.per_shunt(lambda n: 0.3 + 0.7 * (shunt.rng.random(n) < 0.6))
    db = strength * (own + 3.6 * on * near)
    weak = 10 ** (-(shunt["rx_power_dbm"] + 85.0) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Toll(0.016 * weak * shunt.rng.normal(size=shunt.size), hiss_db=db)


def _steam(shunt: Shunt, strength: float) -> Toll:
    """Come through wet steam: ever less for each kilogram more that leaks."""
    leaks = shunt["steam_kgh"]
    return Toll(0.2 * strength * leaks / (leaks + 12.0))


def _bunker(shunt: Shunt, strength: float) -> Toll:
    """Come past a bunker of coal, the longer the fuller it is."""
    return Toll(0.021 * strength * shunt["coal_t"])


def _pit_water(shunt: Shunt, strength: float) -> Toll:
    """Be late by what stands in the pit: by a power of how deep it is."""
    return Toll(0.19 * strength * (shunt["pit_cm"] / 60.0) ** 1.75)


def _chairs(shunt: Shunt, strength: float) -> Toll:
    """Read long at chairs of rails, and short between them."""
    return Toll(0.056 * strength * np.sin(2 * np.pi * shunt["chairs_m"] / CHAIR_M - 0.4))


def _louvres(shunt: Shunt, strength: float) -> Toll:
    """Come by another way as soon as louvres of the roof are open far enough."""
    return Toll(np.where(shunt["louvre_pct"] > 55.0, 0.106 * strength, 0.0))


def _welder(shunt: Shunt, strength: float) -> Toll:
    """Be late beside a welder's arc, by one over how far it is."""
    return Toll(0.35 * strength / shunt["welder_m"])


def _oil(shunt: Shunt, strength: float) -> Toll:
    """Come through oil on covers, whose film grows by a logarithm."""
    return Toll(0.064 * strength * np.log1p(shunt["oil_ml"] / 2.5))


def _round(shunt: Shunt, out_m: Floats | float, rad: Floats) -> Toll:
    """Return what becomes of rows whose tags are further round the middle by an angle [n]."""
    angle = np.angle((shunt.there[:, :2] - CENTRE_M) @ np.array([1.0, 1.0j]))
    shift = placed(out_m * np.ones(shunt.size), angle + rad, np.zeros(shunt.size))
    shift = shift - placed(out_m * np.ones(shunt.size), angle, np.zeros(shunt.size))
    return Toll(shunt.lengthens(shift))


def _play(shunt: Shunt, strength: float) -> Toll:
    """Be behind what the motor of a turntable says, by the play of its gear, either way round."""
    sense = np.sign(shunt.course["go_rad"]) * shunt.rides("end")
    return _round(shunt, TABLE_M, -PLAY_RAD * strength * sense)


def _splayed(shunt: Shunt, strength: float) -> Toll:
    """Be on roads that are farther apart than a plan has them, from the middle one on."""
    off = shunt.course["from_rad"] - 0.5 * np.pi
    out_m = np.hypot(*(shunt.there[:, :2] - CENTRE_M).T)
    return _round(shunt, out_m, SPLAYED * strength * off * shunt.rides("engine"))


def _second_layer(shunt: Shunt, strength: float) -> Toll:
    """Hang lower than a drum's turns say, where its rope's second layer is paid out."""
    second = np.maximum(6.2 - shunt.there[:, 2], 0.0) * shunt.rides("hoist")
    return Toll(shunt.lengthens(-LAYER_M * strength * second[:, None] * [0.0, 0.0, 1.0]))


def _fall_behind(shunt: Shunt, strength: float) -> Toll:
    """Be of ever later moments than is written: stamps lose time from a shunt's begin on."""
    into_s = shunt.course["into_s"]
    begun_s = np.full(shunt.shunt.max() + 1, np.inf)
    np.minimum.at(begun_s, shunt.shunt, into_s)
    return Toll(shunt.lengthens_in(BEHIND * strength * (into_s - begun_s[shunt.shunt])))


def _elsewhere(shunt: Shunt, piers_m: Floats) -> Toll:
    """Return what becomes of rows whose readers are elsewhere in truth [PIERS, 3]."""
    more = shunt.lengthens(0.0, (piers_m - PIERS_M)[shunt.pier])
    return Toll(more, -17.2 * np.log10(1 + more / shunt.far) - 0.05 * more)


def _struck(shunt: Shunt, strength: float) -> Toll:
    moved = 0.46 * strength * np.array([3.0, -6.0, -2.0]) / 7
    return _elsewhere(shunt, PIERS_M + (np.arange(PIERS) == 6)[:, None] * moved)


def _crosswise(shunt: Shunt, _: float) -> Toll:
    order = np.arange(PIERS)
    order[[2, 9]] = 9, 2
    return _elsewhere(shunt, PIERS_M[order])


def _arshins(shunt: Shunt, _: float) -> Toll:
    """Write, at one pier, Russian arshins, as the engines' own drawings have them."""
    return Toll((shunt.pier == 3) * (1 / ARSHIN_M - 1) * shunt["range_m"])


EFFECTS: dict[str, Callable[[Shunt, float], Toll]] = {
    "antenna-delay": _conduits,
    "antenna-pattern": _wrapped_laplace,
    "blocked-path": _best_return,
    "clock-offset": _activity_dips,
    "diffraction": _over_roofs,
    "exchange-motion": _lobatto,
    "ground-bounce": _mean_rise,
    "level-control": _diodes,
    "material-delay": _layers,
    "noise-floor": _chargers,
    "path-loss": _past_stalls,
    "power-bias": _error_function,
    "range-rounding": _squares,
    "range-scale": _delay_lines,
    "temperature-drift": _three_halves,
    "time-lag": _middle_frame,
    "timestamp-jitter": _middle_of_three,
    "steam-leaks": _steam,
    "bunker-filled": _bunker,
    "pit-takes-water": _pit_water,
    "rail-chairs-passed": _chairs,
    "louvres-opened": _louvres,
    "welder-near": _welder,
    "oil-creeps-on-covers": _oil,
    "table-gear-has-play": _play,
    "roads-splayed-wider": _splayed,
    "second-layer-on-the-drum": _second_layer,
    "stamps-fall-behind": _fall_behind,
    "pier-struck-by-a-tender": _struck,
    "piers-named-crosswise": _crosswise,
    "arshins-from-one-pier": _arshins,
}
