"""What the swimming hall hides in ranges and levels: effects in forms of its own, laws, faults.

numpy and pandas alone; shared by the hall's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.pool_basin import (
    BEACONS_M,
    CARRIER_M,
    FOOT_M,
    HALF_LIGHT,
    HALL_M,
    SLABS,
    SWIMMERS,
    Change,
    Swims,
)

Floats = NDArray[np.float64]
WATER = 76.0 - 9.0j  # permittivity at the carrier


def _late_frames(swims: Swims, strength: float) -> Change:
    """Compare with the frame of a camera that was shown before: so late, and up to a frame."""
    age = strength * (0.1 + np.mod(7.31 * swims("time_s"), 0.08))
    return Change(swims.reach(age) - swims.far)


def _poll_and_answer(swims: Swims, strength: float) -> Change:
    """Measure half of the way at the poll, and half at the answer."""
    reply = min(strength, 2.0) * swims("reply_time_s")
    return Change((swims.reach(reply) - swims.far) / 2)


def _caps_and_cables(swims: Swims, strength: float) -> Change:
    """Cables of beacons by the metre; caps of two sizes."""
    rng = swims.kept(1)
    cable = 0.022 * rng.integers(0, 7, len(BEACONS_M)) + rng.uniform(0, 0.012, len(BEACONS_M))
    cap = rng.permutation([0.02, 0.02, 0.02, 0.13, 0.13])[:SWIMMERS]
    return Change(strength * (cable[swims.number("rx")] + cap[swims.number("tx")]))


def _carrier_read(swims: Swims, strength: float) -> Change:
    """Keep what a carrier's reading leaves of a crystal's offset: too little of it."""
    rng = swims.kept(2)
    ppm = rng.uniform(-3.0, 3.0, SWIMMERS)[swims.number("tx")]
    ppm = ppm - rng.normal(0, 1.4, len(BEACONS_M))[swims.number("rx")]
    return Change(0.022 * HALF_LIGHT * strength * ppm * swims("reply_time_s"))


def _bent_by_warmth(swims: Swims, strength: float) -> Change:
    return Change(0.12 * strength * np.tanh((swims("temperature_c") - 25.5) / 6))


def _heads(swims: Swims, strength: float) -> Change:
    """Be later and weaker behind a head: a cardioid, squared."""
    turned = np.radians(swims("azimuth_deg")) - swims.kept(3).uniform(-np.pi, np.pi)
    shade = np.square((1 - np.cos(turned)) / 2)
    return Change(0.21 * strength * (shade - 0.375), whole=-3.1 * min(strength, 1.6) * shade)


def _walks_with_level(swims: Swims, strength: float) -> Change:
    """Cross a threshold earlier the stronger the pulse is: between two bounds."""
    weak = 1 / (1 + np.exp((swims("rx_power_dbm") + 84) / 3.2))
    return Change(0.16 * strength * (weak - 0.45))


def _tick(swims: Swims, strength: float) -> Change:
    return Change(strength * swims.rng.triangular(-0.11, 0.0, 0.11, len(swims.table)))


def _two_slopes(swims: Swims, strength: float) -> Change:
    """Lose more from a corner on, where water lies in the first Fresnel zone."""
    corner = 4 * swims("tx_z_m") * swims("rx_z_m") / CARRIER_M / 9
    beyond = np.log10(1 + np.square(swims.far / np.maximum(corner, 3.0)))
    return Change(0 * beyond, whole=-4.6 * strength * beyond)


def _warm_crystal(swims: Swims, strength: float) -> Change:
    """Count with a clock that is slow, in proportion to all there is to count."""
    return Change(0.0052 * strength * swims("range_m"))


def _cut_off(swims: Swims, strength: float) -> Change:
    """Cut off what a coarse tick leaves."""
    step = 0.145 * strength
    return Change(-np.mod(swims("range_m"), step))


def _screens(swims: Swims, strength: float) -> Change:
    """Go through slabs by Snell's law, at the angle at which links meet upright ones."""
    late, lost = np.zeros((2, len(swims.table)))
    rise = np.square((swims("rx_z_m") - swims("tx_z_m")) / swims.far)
    for kind, (thick, index, db) in SLABS.items():
        there = swims.behind(kind) * swims.by_link(lambda n: swims.rng.uniform(0.7, 1.3, n))
        late += there * thick * (np.sqrt(index**2 - rise) - np.sqrt(1 - rise))
        lost += there * db
    return Change(1.25 * strength * late, edge=-min(strength, 1.5) * lost)


def _by_the_tiles(swims: Swims, strength: float) -> Change:
    """Hear only what the best of the walls and the ceiling returns: the nearest image."""
    share = 0.055 if swims.seldom else 0.17
    struck = swims.by_link(lambda n: 1.0 * (swims.rng.random(n) < share))
    ends = swims.swum(), swims.hung()
    ways = [image_m(*ends, axis, wall) for axis, wall in WALLS]
    detour = np.clip(np.min(ways, axis=0) - swims.far, 0.25, 5.0)
    return Change(struck * detour * (0.3 + 0.7 * strength), whole=-5.0 * struck)


WALLS = ((0, 0.0), (0, HALL_M[0]), (1, 0.0), (1, HALL_M[1]), (2, HALL_M[2]))


def image_m(ends: Floats, others: Floats, axis: int, wall: float) -> Floats:
    """Return how long the way by a plane is in m [n]."""
    mirrored = ends.copy()
    mirrored[:, axis] = 2 * wall - mirrored[:, axis]
    return np.asarray(np.linalg.norm(mirrored - others, axis=1))


def water_ray(swims: Swims, strength: float) -> tuple[Floats, NDArray[np.complex128]]:
    """Return how much longer the way by the water is in m, and what it is next to the other [n].

    Fresnel's coefficient of water for an upright field, less for waves on it.
    """
    longer = image_m(swims.swum(), swims.hung(), 2, 0.0) - swims.far
    up = (swims("tx_z_m") + swims("rx_z_m")) / (swims.far + longer)
    root = np.sqrt(WATER - 1 + up**2)
    returned = (WATER * up - root) / (WATER * up + root)
    calm = np.exp(-np.square(4 * np.pi / CARRIER_M * 0.006 * up))
    size = min(0.75 * strength, 1.0) * calm * swims.far / (swims.far + longer)
    return longer, size * returned * np.exp(-2j * np.pi * longer / CARRIER_M)


def _water(swims: Swims, strength: float) -> Change:
    """Delay as a group that two rays make, as far as both are within one pulse."""
    longer, ray = water_ray(swims, strength)
    both = np.maximum(np.square(np.abs(1 + ray)), 0.12)
    pulls = (np.square(np.abs(ray)) + ray.real) / both
    metres = np.clip(longer * pulls * np.exp(-np.square(longer / 0.55)), -0.3, 0.5)
    return Change(metres, whole=10 * np.log10(both))


def _round_a_rail(swims: Swims, strength: float) -> Change:
    """Bend round one edge of steel: Fresnel's integral, by rational functions for f and g."""
    steel = swims.behind("metal")
    high = strength**0.5 * swims.by_link(lambda n: 0.35 + 0.5 * swims.rng.beta(2, 2, n))
    share = swims.by_link(lambda n: swims.rng.uniform(0.2, 0.8, n))
    legs = share * swims.far, (1 - share) * swims.far
    over = np.hypot(legs[0], high) + np.hypot(legs[1], high) - swims.far
    v = 2 * np.sqrt(over / CARRIER_M)
    f = (1 + 0.926 * v) / (2 + 1.792 * v + 3.104 * v**2)
    g = 1 / (2 + 4.142 * v + 3.492 * v**2 + 6.67 * v**3)
    lost = np.minimum(-10 * np.log10((f**2 + g**2) / 2), 17)
    return Change(steel * over, edge=-steel * lost * min(strength, 1.0) ** 0.5)


def _compressed(swims: Swims, strength: float) -> Change:
    """Take gain back softly above a level, and stop accumulating sooner."""
    over = np.log1p(np.exp((swims("rx_power_dbm") + 84) / 2.5)) * 2.5
    return Change(0 * over, whole=-0.32 * min(strength, 2.2) * over, count=-0.4 * strength * over)


def _lamps(swims: Swims, strength: float) -> Change:
    """Ballasts of lamps near some beacons hiss, and blink: weak rows scatter more."""
    near = swims.kept(4).gamma(2.5, 0.5, len(BEACONS_M))[swims.number("rx")]
    hiss = strength * (0.5 + near * swims.rng.choice([0.6, 1.4], len(near)))
    weak = 10 ** (-(swims("rx_power_dbm") + 88) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Change(0.021 * weak * swims.rng.normal(size=len(near)), hiss=hiss)


def _fills(swims: Swims, strength: float) -> Change:
    return Change(-0.21 * strength * np.expm1(-swims("minutes_in_water") / 6.5))


def _splashes(swims: Swims, strength: float) -> Change:
    return Change(0.0024 * strength * swims("kicks_per_min"))


def _waves(swims: Swims, strength: float) -> Change:
    return Change(0.09 * strength * np.sin(2 * np.pi * swims("time_s") / 610 + 2.2))


def _pump(swims: Swims, strength: float) -> Change:
    return Change(np.asarray(0.14 * strength * (swims("pump_rpm") > 1050), np.float64))


def _salt(swims: Swims, strength: float) -> Change:
    return Change(0.0041 * strength * np.square(swims("salt_g_per_l")))


def _bathers(swims: Swims, strength: float) -> Change:
    return Change(0.062 * strength * np.log(1 + swims("bathers") / 2))


def _lower_water(swims: Swims, strength: float) -> Change:
    """Let water out: all who swim are lower than the plan has them."""
    lower = swims.swum() - [0.0, 0.0, 0.75 * strength]
    truly = np.linalg.norm(lower - swims.hung(), axis=1)
    return Change(truly - swims.far, whole=20 * np.log10(swims.far / truly))


def _smoothed(swims: Swims, strength: float) -> Change:
    """Write down what a filter keeps of a link's ranges, which starts at the first."""
    keeps = 0.4 * strength / (strength + 0.8)
    written = swims("range_m").copy()
    for rows in swims.table.groupby("link", sort=False).indices.values():
        for before, now in pairwise(rows):
            written[now] += keeps * (written[before] - written[now])
    return Change(written - swims("range_m"))


def _crossed(swims: Swims, strength: float) -> Change:
    """Take, for now and then a row of a beacon, what belongs to the row before it."""
    taken = swims.rng.random(len(swims.table)) < min(0.05 * strength, 0.4)
    shift = np.where(taken, np.roll(swims.far, 1) - swims.far, 0.0)
    return Change(np.clip(shift, -9, 9))


def _truly(swims: Swims, beacons: Floats) -> Change:
    """Return what changes where beacons truly are at [9, 3]."""
    far = swims.reach(0.0, beacons[swims.number("rx")])
    return Change(far - swims.far, whole=20 * np.log10(swims.far / far))


def _loose_pole(swims: Swims, strength: float) -> Change:
    moved = BEACONS_M.copy()
    moved[3] += strength * np.array([-0.3, 0.4, 0.0725])
    return _truly(swims, moved)


def _mixed_up(swims: Swims, _: float) -> Change:
    return _truly(swims, BEACONS_M[[0, 1, 4, 3, 2, 5, 6, 7, 8]])


def _feet(swims: Swims, _: float) -> Change:
    return Change((swims.number("rx") == 1) * (1 / FOOT_M - 1) * swims("range_m"))


EFFECTS: dict[str, Callable[[Swims, float], Change]] = {
    "time-lag": _late_frames,
    "exchange-motion": _poll_and_answer,
    "antenna-delay": _caps_and_cables,
    "clock-offset": _carrier_read,
    "temperature-drift": _bent_by_warmth,
    "antenna-pattern": _heads,
    "power-bias": _walks_with_level,
    "timestamp-jitter": _tick,
    "path-loss": _two_slopes,
    "range-scale": _warm_crystal,
    "range-rounding": _cut_off,
    "material-delay": _screens,
    "blocked-path": _by_the_tiles,
    "ground-bounce": _water,
    "diffraction": _round_a_rail,
    "level-control": _compressed,
    "noise-floor": _lamps,
    "cap-fills": _fills,
    "splashing": _splashes,
    "wave-machine": _waves,
    "pump-starts": _pump,
    "salted-water": _salt,
    "bathers-around": _bathers,
    "water-let-out": _lower_water,
    "laps-smoothed": _smoothed,
    "crossed-wires": _crossed,
    "beacon-on-loose-pole": _loose_pole,
    "beacons-mixed-up": _mixed_up,
    "feet-from-one-beacon": _feet,
}
