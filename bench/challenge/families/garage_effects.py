"""What the garage hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the garage's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.garage_cars import (
    AFTERNOON_S,
    ANCHORS_M,
    BETWEEN,
    GARAGE_M,
    OF_CAR,
    PHONES,
    PPM_M,
    STEP_M,
    UNITS_M,
    WAVE_M,
    Visit,
    Wrong,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
PAINT, SLAB, PAINT_M = 3.3, 5.6, 0.0028  # permittivities of a coat and of what it is on; its depth
PULSE_M, LATER_M, SHARE = 0.29, 0.6, 0.62  # a pulse's width; of a discriminator of constant share
IN_POCKETS = {False: 0.38, True: 0.1}  # of links out of sight, and where these are rare
STATES = np.array([0.078, 0.062, 0.05, 0.021, -0.004, -0.033, -0.041, -0.072])
"""What states of a gain cost in m, from that of weak signals on."""


def _fast_clock(visit: Visit, strength: float) -> Wrong:
    """Compare with places of a scanner whose clock runs away in the course of the afternoon."""
    off_s = 0.095 + 0.055 * visit["time_s"] / AFTERNOON_S
    return {"metres": visit.grown(strength * off_s)}


def _two_replies(visit: Visit, strength: float) -> Wrong:
    """Weigh two replies, of which the later comes after three times as long and counts less."""
    wait_s = 0.8 * min(strength, 2.0) * visit["reply_time_s"]
    return {"metres": 0.68 * visit.grown(wait_s) + 0.32 * visit.grown(3 * wait_s)}


def _harness(visit: Visit, strength: float) -> Wrong:
    """Be late by the harness from a car's unit, along its sides; phones are of two models."""
    wire_m = np.abs(ANCHORS_M - UNITS_M[OF_CAR]).sum(axis=1)
    model = np.where(visit.always(1).permutation(PHONES) < 3, 0.105, 0.025)
    late = (0.014 + 0.026 * wire_m)[visit.anchor] + model[visit.phone]
    return {"metres": strength * late}


def _sway_of_crystals(visit: Visit, strength: float) -> Wrong:
    """Leave some of crystals' offset, which goes to and fro within hours as pockets warm phones."""
    rng, devices = visit.always(2), len(ANCHORS_M) + PHONES
    steady, swing = rng.normal(0, 0.8, devices), rng.gamma(4.0, 0.2, devices)
    turns = visit["time_s"][:, None] / rng.uniform(1.5, 4.5, devices) / 3600 + rng.random(devices)
    now = steady + swing * np.sin(2 * np.pi * turns)
    rows = np.arange(len(now))
    apart = now[rows, len(ANCHORS_M) + visit.phone] - now[rows, visit.anchor]
    return {"metres": 0.011 * strength * PPM_M * apart * visit["reply_time_s"]}


def _turnover(visit: Visit, strength: float) -> Wrong:
    """Drift as a fork of quartz does: by the square of how far it is from 24 degrees C."""
    return {"metres": 0.105 * strength * ((visit["temperature_c"] - 24.0) / 26.0) ** 2}


def _held_by_an_edge(visit: Visit, strength: float) -> Wrong:
    """Be late past the hand that holds a phone: a first and a third wave about it; weak there."""
    turn = np.deg2rad(visit["azimuth_deg"]) + visit.always(3).uniform(-3.1, 3.1)
    past = np.cos(turn) + 0.55 * np.cos(3 * turn)
    return {
        "metres": 0.052 * strength * past,
        "whole": -0.75 * min(strength, 1.5) * (1.55 + past),
    }


def _states_of_gain(visit: Visit, strength: float) -> Wrong:
    """Cost something else in each state of an amplifier, of which every 4 dB has one."""
    state = np.clip((visit["rx_power_dbm"] + 92.0) // 4.0, 0, len(STATES) - 1).astype(np.intp)
    return {"metres": strength * STATES[state]}


def _latest_of_many(visit: Visit, strength: float) -> Wrong:
    """Scatter as the largest of many does (Gumbel), about its mean."""
    drawn = visit.rng.gumbel(-0.5772156649, 1.0, len(visit.off))
    return {"metres": 0.028 * strength * np.minimum(drawn, 6.0)}


def _by_the_root(visit: Visit, strength: float) -> Wrong:
    """Lose dB by the root of the way: the longer it is, the more is already lost."""
    return {"whole": -1.15 * strength * np.sqrt(visit.off)}


def _inches(visit: Visit, strength: float) -> Wrong:
    """Be on a plan whose inches were taken for 25 mm: along the floor alone, heights were taped."""
    apart = visit.senders() - visit.phones()
    level_m, rise_m = np.hypot(apart[:, 0], apart[:, 1]), apart[:, 2]
    return {"metres": np.hypot((1 + 0.016 * strength) * level_m, rise_m) - visit.off}


def _own_zero(visit: Visit, strength: float) -> Wrong:
    """Be cut to steps, before each model of phone adds what it was calibrated by."""
    step, zero = 0.055 * strength, visit.always(4).uniform(0.0, 1.0, PHONES)[visit.phone]
    written = visit["range_m"]
    return {"metres": step * (np.floor(written / step - zero) + zero + 0.5) - written}


def _dulled(visit: Visit, strength: float) -> Wrong:
    """Go through what takes more of high pitches (a constant Q), so that edges come later too."""
    late, lost = np.zeros(len(visit.off)), np.zeros(len(visit.off))
    for kind, (thick_m, permittivity, db) in BETWEEN.items():
        there, own = visit.past(kind), visit.each_link(visit.rng.uniform, 0.8, 1.2)
        late += there * (thick_m * (np.sqrt(permittivity) - 1) + 0.006 * db * own)
        lost += there * db * own
    return {"metres": 1.15 * strength * late, "edge": -min(strength, 1.5) * lost}


def image_ways(visit: Visit) -> list[tuple[Floats, Floats]]:
    """Return ways by four walls and the ceiling in m, and how squarely these are met, [n] each."""
    ends, out = (visit.senders(), visit.phones()), []
    for axis, plane in ((0, 0.0), (0, GARAGE_M[0]), (1, 0.0), (1, GARAGE_M[1]), (2, GARAGE_M[2])):
        to = [np.abs(end[:, axis] - plane) for end in ends]
        way = np.sqrt(visit.off**2 + 4 * to[0] * to[1])
        out.append((way, (to[0] + to[1]) / way))
    return out


def _in_a_pocket(visit: Visit, strength: float) -> Wrong:
    """Hear, from a pocket behind, nothing but what the best placed wall or the ceiling returns."""
    pocket = visit.unseen(IN_POCKETS[visit.seldom])
    nearest = np.min([way for way, _ in image_ways(visit)], axis=0)
    detour = np.clip(nearest - visit.off, 0.34, 3.6)
    return {"metres": pocket * detour * (0.48 + 0.52 * strength), "whole": -5.4 * pocket}


def floor_ray(visit: Visit, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Of a coat on concrete: what both its sides return (Airy), of waves that lie flat.
    """
    low, high = visit.senders()[:, 2], visit.phones()[:, 2]
    way = np.sqrt(visit.off**2 + 4 * low * high)
    steep = (low + high) / way
    coat, slab = (np.sqrt(dense - 1 + steep**2) for dense in (PAINT, SLAB))
    upper, lower = (steep - coat) / (steep + coat), (coat - slab) / (coat + slab)
    depth = visit.each_link(visit.rng.uniform, 0.6, 1.4) * PAINT_M
    there_and_back = np.exp(-4j * np.pi * depth * coat / WAVE_M)
    returned = (upper + lower * there_and_back) / (1 + upper * lower * there_and_back)
    turn = np.exp(-2j * np.pi * (way - visit.off) / WAVE_M)
    return way - visit.off, min(1.1 * strength**0.5, 1.5) * returned * visit.off / way * turn


def _bell(place: Floats) -> Floats:
    """Return a pulse of height 1 at places in m."""
    return np.asarray(1 / np.cosh(np.clip(place / PULSE_M * 1.3, -40, 40)))


def _floor(visit: Visit, strength: float) -> Wrong:
    """Move where a pulse outgrows a share of what it was before, of two pulses together."""
    longer, share = floor_ray(visit, strength)
    place = np.linspace(-0.9, 0.9, 121)
    alone = _when(place, _bell(place)[None], _bell(place - LATER_M)[None])
    both, later = (
        np.abs(_bell(place - d) + share[:, None] * _bell(place - d - longer[:, None]))
        for d in (0.0, LATER_M)
    )
    near = np.exp(-np.square(longer / PULSE_M) / 2)
    power = np.abs(1 + share * near) ** 2
    moved = np.clip(_when(place, both, later) - alone, -0.28, 0.28)
    return {"metres": moved, "whole": 10 * np.log10(np.maximum(power, 0.24))}


def _when(place: Floats, size: Floats, later: Floats) -> Floats:
    """Return the first place [n] of some [k] at which what came later outgrows a share of all."""
    over = later - SHARE * size
    late = np.clip(np.argmax((over >= 0) & (size > 0.25), axis=1), 1, len(place) - 1)
    rows = np.arange(len(over))
    below, above = over[rows, late - 1], over[rows, late]
    part = np.clip(-below / np.maximum(above - below, 1e-9), 0.0, 1.0)
    return np.asarray(place[late - 1] + part * (place[1] - place[0]))


def _creeping(visit: Visit, strength: float) -> Wrong:
    """Creep round a roof: by how long its skin is followed, more on a tighter bend.

    Upright waves on a cylinder (Keller and Levy 1959): the first root of Airy's slope, 1.019.
    """
    body = visit.past("metal")
    bend_m = visit.each_link(visit.rng.uniform, 0.35, 0.95)
    angle = strength**0.5 * visit.each_link(visit.rng.uniform, 0.12, 0.37)
    along = bend_m * angle
    nepers = 1.019 * 0.866 / bend_m * (np.pi * bend_m / WAVE_M) ** (1 / 3) * along
    chord = 2 * bend_m * np.sin(angle / 2)
    tangents = bend_m * angle**2 / 4
    kept = 0.045 * strength * visit.each_link(visit.rng.triangular, 0.5, 1.0, 1.5)
    return {
        "metres": body * (along - chord + tangents + kept),
        "edge": -body * np.clip(8.686 * nepers, 0.5, 10.5),
    }


def _softly(visit: Visit, strength: float) -> Wrong:
    """Turn gain down above a level, softly, and add up fewer symbols with it."""
    over = 3.5 * np.log1p(np.exp((visit["rx_power_dbm"] + 85.0) / 3.5))
    return {
        "whole": -0.21 * min(strength, 2.2) * over,
        "count": -0.42 * strength * np.minimum(over, 22.0),
    }


def _chargers(visit: Visit, strength: float) -> Wrong:
    """Hear phones' own chargers and screens, some phones much more, and a charging post near by."""
    own = visit.always(5).gamma(2.2, 0.75, PHONES)[visit.phone]
    post = np.exp(-np.hypot(*(visit.phones()[:, :2] - np.array([14.6, 4.9])).T) / 4.0)
    hiss = strength * (0.5 + own + 2.2 * post)
    weak = 10 ** (-(visit["rx_power_dbm"] + 88) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return {"metres": 0.017 * weak * visit.rng.normal(0, 1, len(weak)), "hiss": hiss}


def _rain(visit: Visit, strength: float) -> Wrong:
    return {"metres": 0.13 * strength * np.tanh(visit["rain_g"] / 19.0)}


def _hotspot(visit: Visit, strength: float) -> Wrong:
    return {"metres": 0.16 * strength * (visit["wifi_percent"] / 100.0) ** 2.1}


def _arms(visit: Visit, strength: float) -> Wrong:
    return {"metres": 0.049 * strength * np.cos(2 * np.pi * visit["walked_m"] / STEP_M + 0.7)}


def _doors(visit: Visit, strength: float) -> Wrong:
    """Hear anchors past a door that is open: by its frame, a little later."""
    return {"metres": np.where(visit["door_deg"] >= 34.0, 0.108 * strength, 0.0)}


def _sun(visit: Visit, strength: float) -> Wrong:
    return {"metres": 0.036 * strength * np.log1p(visit["lux"] / 28.0)}


def _hands(visit: Visit, strength: float) -> Wrong:
    return {"metres": 0.0029 * strength * visit["hand_cm2"]}


def _charge(visit: Visit, strength: float) -> Wrong:
    """Sag as a cell's resistance grows that runs out: by one over its charge."""
    return {"metres": 1.5 * strength / visit["charge_percent"]}


def _steps(visit: Visit, strength: float) -> Wrong:
    """Have walked farther than places say that were counted from steps, some people more."""
    long = 0.05 * strength * visit.always(6).uniform(0.6, 1.4, PHONES)
    every = np.stack([visit.phones(0.0, 1.0 + one) for one in long.tolist()])
    return {"metres": visit.grown_to(every[visit.phone, np.arange(len(visit.off))])}


def _rise_slowly(visit: Visit, strength: float) -> Wrong:
    """Let ranges fall at once, and rise no faster than by some m a second: so doors stay open."""
    written, time_s = visit["range_m"], visit["time_s"]
    out, rate = written.copy(), 0.24 / strength
    last: dict[tuple[int, int], int] = {}
    seen: dict[tuple[int, float], int] = {}
    for row, link in enumerate(visit.of_link.tolist()):
        copy = seen.get((link, time_s[row]), 0)  # of the rows: each goes on by itself
        seen[link, time_s[row]] = copy + 1
        before = last.get((link, copy))
        if before is not None:
            most = out[before] + rate * (time_s[row] - time_s[before]) + 0.03
            out[row] = min(out[row], most)
        last[link, copy] = row
    return {"metres": out - written}


def _elsewhere(visit: Visit, anchors_m: Floats) -> Wrong:
    """Return what goes wrong at rows whose anchors have their antennas at [9, 3] in truth."""
    truly = np.sqrt(((anchors_m[visit.anchor] - visit.phones()) ** 2).sum(axis=1))
    return {"metres": truly - visit.off, "whole": -18.8 * np.log10(truly / visit.off)}


def _unclipped(visit: Visit, strength: float) -> Wrong:
    hangs = ANCHORS_M + 0.43 * strength * (np.arange(9) == 7)[:, None] * [3 / 7, 2 / 7, -6 / 7]
    return _elsewhere(visit, hangs)


def _flashed(visit: Visit, _: float) -> Wrong:
    return _elsewhere(visit, ANCHORS_M[[0, 1, 8, 3, 4, 5, 6, 7, 2]])


def _quarters(visit: Visit, _: float) -> Wrong:
    """Show, at one anchor, counts of a quarter of a metre, as doors ask for."""
    return {"metres": np.where(visit.anchor == 4, 3.0 * visit["range_m"], 0.0)}


EFFECTS: dict[str, Callable[[Visit, float], Wrong]] = {
    "time-lag": _fast_clock,
    "exchange-motion": _two_replies,
    "antenna-delay": _harness,
    "clock-offset": _sway_of_crystals,
    "temperature-drift": _turnover,
    "antenna-pattern": _held_by_an_edge,
    "power-bias": _states_of_gain,
    "timestamp-jitter": _latest_of_many,
    "path-loss": _by_the_root,
    "range-scale": _inches,
    "range-rounding": _own_zero,
    "material-delay": _dulled,
    "blocked-path": _in_a_pocket,
    "ground-bounce": _floor,
    "diffraction": _creeping,
    "level-control": _softly,
    "noise-floor": _chargers,
    "rain-on-paint": _rain,
    "hotspot-shares-the-air": _hotspot,
    "arms-swing": _arms,
    "doors-opened": _doors,
    "sun-on-dashboards": _sun,
    "hands-cover": _hands,
    "charge-runs-out": _charge,
    "steps-counted-short": _steps,
    "ranges-rise-slowly": _rise_slowly,
    "anchor-clip-broken": _unclipped,
    "anchors-flashed-wrongly": _flashed,
    "quarters-from-one-anchor": _quarters,
}
