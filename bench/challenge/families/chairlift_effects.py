"""What the chairlift hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the chairlift's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.chairlift_rope import (
    KLAFTER_M,
    LEFT_IN,
    METRES_A_PPM,
    PYLONS_M,
    SHEAVE_M,
    TAGS,
    TREES_M,
    WAVE_M,
    Ill,
    Trip,
    ground,
    over_spans,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
PYLONS = len(PYLONS_M)
SHUT_OFF = {False: 0.18, True: 0.055}  # of links behind cabins, and where these are scarce
SNOW = 1.62  # permittivity of what lies on the ground
EDGE_M = 0.15  # how far pulses rise by a factor of e
STATION_M: Floats = np.array([-3.0, 0.0, 3.0])  # where the drive is


def _encoder(trip: Trip, strength: float) -> Ill:
    """Compare with a rope's encoder, which each pylon's net reads at another age."""
    age_s = trip.fixed(1).beta(4.0, 2.0, PYLONS)[trip.pylon]
    return {"metres": trip.comes_to(0.09 * strength * (0.3 + 0.5 * age_s))}


def _thirds(trip: Trip, strength: float) -> Ill:
    """Give the mean of ways amid three equal parts of an exchange."""
    whole_s = 2.1 * strength * trip.col("reply_time_s")
    return {"metres": sum((trip.comes_to(whole_s * k / 6) for k in (1, 3, 5)), 0 * trip.long) / 3}


def _arresters(trip: Trip, strength: float) -> Ill:
    """Be late by arresters, which some pylons have, by jumpers of cable and by tags' potting."""
    arrester = 0.075 * (trip.fixed(2).permutation(PYLONS) < 5)
    jumper = trip.fixed(3).gamma(2.0, 0.02, PYLONS).clip(max=0.11)
    potting = trip.fixed(4).triangular(0.0, 0.02, 0.1, len(TAGS))
    return {"metres": strength * ((arrester + jumper)[trip.pylon] + potting[trip.who])}


def _wanders(trip: Trip, strength: float) -> Ill:
    """Leave some of crystals' offset, each of which wanders to and fro in hours of its own."""
    rng, devices = trip.fixed(5), PYLONS + len(TAGS)
    middle, swing = rng.uniform(-1.1, 1.1, devices), rng.rayleigh(0.4, devices)
    period_s, turn = rng.uniform(4e3, 1.1e4, devices), rng.uniform(0, 2 * np.pi, devices)
    at = 2 * np.pi * trip.col("time_s")[:, None] / period_s + turn
    now, rows = middle + swing * np.sin(at), np.arange(len(trip.long))
    ppm = now[rows, trip.pylon] - now[rows, PYLONS + trip.who]
    return {"metres": 0.0125 * strength * METRES_A_PPM * ppm * trip.col("reply_time_s")}


def _in_the_cold(trip: Trip, strength: float) -> Ill:
    """Drift in the cold, and hardly when it thaws: there is a soft knee between."""
    cold = (-3.5 - trip.col("temperature_c")) / 1.6
    return {"metres": 0.024 * strength * np.logaddexp(0.0, cold)}


def _two_lobes(trip: Trip, strength: float) -> Ill:
    """Be late and weak past both poles of a chair, and on one side more: two waves and three."""
    off = np.deg2rad(trip.col("azimuth_deg")) + trip.fixed(6).uniform(0, 2 * np.pi)
    past = np.cos(2 * off) + 0.45 * np.cos(3 * off + 0.8)
    return {"metres": 0.068 * strength * past, "level": -1.3 * min(strength, 1.5) * (1.4 + past)}


def _clamped(trip: Trip, strength: float) -> Ill:
    """Be late where it is weak, between two levels, by a cubic: beyond both it is what it is."""
    part = np.clip((-77.0 - trip.col("rx_power_dbm")) / 15.0, 0.0, 1.0)
    return {"metres": 0.185 * strength * (part**2 * (3 - 2 * part) - 0.5)}


def _two_humps(trip: Trip, strength: float) -> Ill:
    """Tremble between two taps of a line, and a little about each."""
    tap = trip.rng.choice((-1.0, 1.0), len(trip.long))
    return {"metres": strength * (0.052 * tap + trip.rng.uniform(-0.028, 0.028, len(tap)))}


def _snowfall(trip: Trip, strength: float) -> Ill:
    """Lose in falling snow: less than in step with the way, as it falls in squalls."""
    return {"level": -0.27 * strength * trip.long**0.8}


def _uneven_scale(trip: Trip, strength: float) -> Ill:
    """Count too long, long ways more so: a ramp that is a little bent."""
    read = trip.col("range_m")
    return {"metres": 0.0023 * strength * read * (1 + read / 55.0)}


def _two_makes(trip: Trip, strength: float) -> Ill:
    """Round to whole steps, which are larger at pylons of one make."""
    step = strength * np.where(trip.pylon % 4 < 2, 0.14, 0.085)
    read = trip.col("range_m")
    return {"metres": step * np.rint(read / step) - read}


def _snow_packed(trip: Trip, strength: float) -> Ill:
    """Go through fences and huts that are full of snow: logarithms mix by shares (Lichtenecker)."""
    late, lost = 0 * trip.long, 0 * trip.long
    for kind, (deep_m, dense, db) in LEFT_IN.items():
        full = trip.for_links(lambda n: trip.rng.beta(2.0, 1.2, n))
        whole = dense ** (0.55 + 0.45 * full) * SNOW ** (0.45 * (1 - full))
        late = late + trip.meets(kind) * deep_m * (np.sqrt(whole) - 1)
        lost = lost + trip.meets(kind) * db * (0.6 + 0.6 * full)
    metres = 1.2 * strength * np.minimum(late, 0.3)
    return {"metres": metres, "first": -min(strength, 1.6) * lost}


def by_trees(trip: Trip) -> Floats:
    """Return how much longer ways by the wood's edge are, in m [n]."""
    off = (trip.seat[:, 1] - TREES_M) * (trip.mast[:, 1] - TREES_M)
    return np.asarray(np.sqrt(trip.long**2 + 4 * off) - trip.long)


def _off_the_trees(trip: Trip, strength: float) -> Ill:
    """Hear, behind cabins, nothing but the first trunks of the wood's edge."""
    cabin = trip.some(SHUT_OFF[trip.scarce])
    past = by_trees(trip)
    detour = 0.35 + 3.4 * past / (past + 16.0)
    return {"metres": cabin * detour * (0.4 + 0.6 * strength**0.9), "level": -4.8 * cabin}


def snow_ray(trip: Trip, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the snow is in m, and its complex share, [n] each.

    Off a slope, so that heights are square to it; of snow that little returns from unless grazed.
    """
    upright = 1 / np.hypot(1.0, 0.3)
    seat, mast = (upright * (end[:, 2] - ground(end[:, 0])) for end in (trip.seat, trip.mast))
    way = np.sqrt(trip.long**2 + 4 * seat * mast)
    steep = (seat + mast) / way
    root = np.sqrt(SNOW - 1 + steep**2)
    uneven = np.exp(-((steep / 0.7) ** 2)) * trip.for_links(lambda n: trip.rng.uniform(0.8, 1.2, n))
    size = min(2.3 * strength**0.6, 3.4) * uneven * trip.long / way
    turn = np.exp(-2j * np.pi * ((way - trip.long) / WAVE_M))
    return way - trip.long, size * turn * (steep - root) / (steep + root)


def _sooner_if_louder(trip: Trip, strength: float) -> Ill:
    """Cross a threshold the sooner, the louder both ways are together, as an edge rises by e."""
    longer, share = snow_ray(trip, strength)
    both = np.abs(1 + share / (1 + (longer / 1.9) ** 2))
    both = np.clip(both, 0.3, 3.0)
    return {"metres": -EDGE_M * np.log(both), "level": 17.0 * np.log10(both)}


def edge_db(v: Floats) -> Floats:
    """Return what an edge takes in dB for v >= 0 [n]: right at its level, and far below it."""
    return np.asarray(10 * np.log10(4.0 + 5.5 * v + 2 * np.pi**2 * v**2))


def _past_sheaves(trip: Trip, strength: float) -> Ill:
    """Bend past a train of sheaves, which has two edges; and run along it."""
    sheaves = trip.meets("metal")
    near = trip.long * trip.for_links(lambda n: 0.1 + 0.4 * trip.rng.beta(1.2, 1.2, n))
    far = trip.long - near
    high = strength**0.5 * trip.for_links(lambda n: trip.rng.triangular(0.2, 0.3, 0.65, n))
    v = high * np.sqrt(2 * (near + far) / (WAVE_M * near * far))
    second = v * trip.for_links(lambda n: trip.rng.uniform(0.1, 0.4, n))
    lost = 0.5 * edge_db(v) + 0.25 * edge_db(second)
    runs = strength * trip.for_links(lambda n: trip.rng.uniform(0.04, 0.11, n))
    bent = (high**2 / 2 * (1 / near + 1 / far)).clip(max=0.32)
    return {"metres": sheaves * (bent + runs), "first": -sheaves * lost}


def _roots(trip: Trip, strength: float) -> Ill:
    """Turn gain down by a root of what is too much, and take the fewer symbols for it."""
    over = np.maximum(trip.col("rx_power_dbm") + 98.0, 0.0) ** 0.65
    return {"level": -0.34 * min(strength, 2.4) * over, "sums": -0.75 * strength * over}


def _the_drive(trip: Trip, strength: float) -> Ill:
    """Hear the drive's converter, when it brakes or pulls, the less the farther up the line."""
    away = np.sqrt(((trip.mast - STATION_M) ** 2).sum(axis=1))
    own = trip.fixed(7).uniform(0.7, 1.9, PYLONS)[trip.pylon]
    pulls = trip.rng.random(len(away)) ** 0.5
    noise = strength * (own + 3.6 * pulls / (1 + (away / 42.0) ** 2))
    weak = 10 ** ((-88.0 - trip.col("rx_power_dbm")) / 20) * np.sqrt(10 ** (noise / 10) - 1)
    return {"metres": 0.015 * weak * trip.rng.laplace(0.0, 0.71, len(away)), "noise": noise}


def _rime(trip: Trip, strength: float) -> Ill:
    """Come through rime, which is the denser the thicker it has grown."""
    return {"metres": 0.0125 * strength * trip.col("rime_mm") ** 1.4}


def _seats(trip: Trip, strength: float) -> Ill:
    """Come through snow on seats, of which no more than so much stays."""
    snow = trip.col("snow_kg")
    return {"metres": 0.19 * strength * snow / (snow + 7.5)}


def _wheel(trip: Trip, strength: float) -> Ill:
    """Ride up and down over wheels that are not round."""
    return {"metres": 0.055 * strength * np.cos(2 * np.pi * trip.col("rope_m") / SHEAVE_M + 2.1)}


def _guns(trip: Trip, strength: float) -> Ill:
    return {"metres": np.where(trip.col("gun_bar") >= 22.0, 0.113 * strength, 0.0)}


def _salt(trip: Trip, strength: float) -> Ill:
    return {"metres": 0.071 * strength * np.log(1 + trip.col("salt_g") / 1.1)}


def _fog(trip: Trip, strength: float) -> Ill:
    """Wet radomes by fog, the more the less far one sees."""
    return {"metres": 3.9 * strength / trip.col("sight_m")}


def _grease(trip: Trip, strength: float) -> Ill:
    """Read shorter, with joints that conduct the less the thicker grease is in them."""
    return {"metres": -0.0079 * strength * trip.col("grease_um")}


def _blown(trip: Trip, strength: float) -> Ill:
    """Hang aside, by the square of the wind across the line, where plans have chairs hang plumb."""
    aside = np.minimum(0.0056 * strength * trip.col("wind_mps") ** 2, 1.8) * trip.rides
    lift = 0.2 * aside**2
    return {"metres": trip.with_ends(np.stack([0 * aside, aside, lift], axis=1))}


def _lower(trip: Trip, strength: float) -> Ill:
    """Hang lower amid spans than plans have it, which are of a rope without load."""
    length, amid = over_spans(trip.seat[:, 0])
    sunk = 0.00095 * strength * length**2 * amid * trip.rides
    return {"metres": trip.with_ends(sunk[:, None] * [0.0, 0.0, -1.0])}


def _leads(trip: Trip, strength: float) -> Ill:
    """Send, from every other pylon, what is read and a part of how it differs from the last."""
    rows = trip.table.assign(copy=trip.table.groupby(["link", "time_s"]).cumcount())
    change = rows.groupby(["link", "copy"])["range_m"].diff().fillna(0.0).to_numpy(np.float64)
    return {"metres": 0.55 * strength * change * (trip.pylon % 2)}


def _stands_at(trip: Trip, pylons_m: Floats) -> Ill:
    """Return what ails rows whose pylons are elsewhere in truth [PYLONS, 3]."""
    metres = trip.with_ends(0 * trip.seat, (pylons_m - PYLONS_M)[trip.pylon])
    return {"metres": metres, "level": -19.4 * np.log10((trip.long + metres) / trip.long)}


def _creeps(trip: Trip, strength: float) -> Ill:
    moved = np.zeros((PYLONS, 3))
    moved[6] = 0.48 * strength * np.array([-6.0, 3.0, -2.0]) / 7
    return _stands_at(trip, PYLONS_M + moved)


def _plates(trip: Trip, _: float) -> Ill:
    number = np.arange(PYLONS)
    number[[3, 5]] = number[[5, 3]]
    return _stands_at(trip, PYLONS_M[number])


def _klafters(trip: Trip, _: float) -> Ill:
    """Show what one pylon reads in the measure that the line was surveyed in."""
    return {"metres": np.where(trip.pylon == 4, (1 / KLAFTER_M - 1) * trip.col("range_m"), 0.0)}


EFFECTS: dict[str, Callable[[Trip, float], Ill]] = {
    "path-loss": _snowfall,
    "level-control": _roots,
    "noise-floor": _the_drive,
    "power-bias": _clamped,
    "exchange-motion": _thirds,
    "time-lag": _encoder,
    "clock-offset": _wanders,
    "antenna-delay": _arresters,
    "temperature-drift": _in_the_cold,
    "timestamp-jitter": _two_humps,
    "antenna-pattern": _two_lobes,
    "range-scale": _uneven_scale,
    "range-rounding": _two_makes,
    "blocked-path": _off_the_trees,
    "material-delay": _snow_packed,
    "ground-bounce": _sooner_if_louder,
    "diffraction": _past_sheaves,
    "rime-on-radomes": _rime,
    "snow-on-seats": _seats,
    "wheel-out-of-round": _wheel,
    "snow-guns-on": _guns,
    "salt-on-hangers": _salt,
    "fog-thickens": _fog,
    "grease-stiffens": _grease,
    "chairs-blown-aside": _blown,
    "rope-hangs-lower": _lower,
    "lead-in-the-filter": _leads,
    "pylon-creeps-downhill": _creeps,
    "pylons-hung-with-wrong-plates": _plates,
    "klafters-from-one-pylon": _klafters,
}
