"""What the ferry hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the ferry's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.ferry_deck import (
    BETWEEN,
    CARRIER_GHZ,
    CARRIER_M,
    DECK_M,
    HALF_LIGHT,
    LANES_M,
    LIGHT,
    PILLARS_M,
    TAGS,
    YARD_M,
    Lading,
    Swell,
)

Floats = NDArray[np.float64]
TABLE_DBM = (-96.0, -90.0, -84.0, -79.0, -74.0, -69.0, -63.0)
TABLE_M = (0.086, 0.071, 0.043, 0.012, -0.047, -0.088, -0.108)


def _stamped_late(ship: Lading, strength: float) -> Swell:
    """Compare with places of a laser at the ramp, which queue for the ship's network."""
    queue = 0.13 + 0.02 * (1 + np.sin(0.9 * ship.col("time_s")))
    return Swell(ship.off(strength * queue))


def _three_messages(ship: Lading, strength: float) -> Swell:
    """Weigh distances at three messages, a reply time apart, as a double-sided exchange does."""
    reply = min(strength, 2.0) * ship.col("reply_time_s")
    return Swell((2 * ship.off(reply) + ship.off(2 * reply)) / 4)


def _feeders(ship: Lading, strength: float) -> Swell:
    """Feeders to the pillars as long as they came; tags behind screens with and without metal."""
    rng = ship.lasting(1)
    feeder = rng.gamma(2.0, 0.035, len(PILLARS_M))
    screen = 0.012 * np.arange(TAGS) + 0.09 * (rng.permutation(TAGS) % 3 == 0)
    return Swell(strength * (feeder[ship.pillar] + screen[ship.tag]))


def _beat(ship: Lading, strength: float) -> Swell:
    """Count replies with crystals that differ: what an estimate of both leaves of it."""
    rng = ship.lasting(2)
    ppm = (
        1.6 * rng.normal(size=len(PILLARS_M))[ship.pillar] - rng.uniform(-2.6, 2.6, TAGS)[ship.tag]
    )
    return Swell(HALF_LIGHT * 0.023 * strength * ppm * ship.col("reply_time_s"))


def _cubic(ship: Lading, strength: float) -> Swell:
    """Drift as crystals cut at an angle do: a line and a cube about room temperature."""
    warm = ship.col("temperature_c") - 22.0
    return Swell(strength * (0.0052 * warm + 1.6e-5 * warm**3))


def _roofs(ship: Lading, strength: float) -> Swell:
    """Be late over bonnet and boot, on one side more than on the other."""
    turn = np.radians(ship.col("azimuth_deg")) - ship.lasting(3).uniform(0, 2 * np.pi)
    lobes = np.cos(turn) + 0.45 * np.cos(2 * turn)
    return Swell(0.075 * strength * lobes, whole=-1.3 * min(strength, 1.6) * (1 + lobes))


def _calibrated(ship: Lading, strength: float) -> Swell:
    """Be biased as a table of calibration has it, straight between its entries."""
    return Swell(strength * np.interp(ship.col("rx_power_dbm"), TABLE_DBM, TABLE_M))


def _swept_clock(ship: Lading, strength: float) -> Swell:
    """Time with a clock that is swept to and fro, at any moment of its sweep."""
    return Swell(0.062 * strength * np.sin(2 * np.pi * ship.rng.random(len(ship.table))))


def _exhaust(ship: Lading, strength: float) -> Swell:
    """Lose more than in the open, and the more so the more decades away."""
    return Swell(0 * ship.range_m, whole=-2.4 * strength * np.log10(1 + ship.range_m) ** 2)


def _long_unit(ship: Lading, strength: float) -> Swell:
    return Swell(0.0047 * strength * (ship.range_m + 0.4))


def _next_step(ship: Lading, strength: float) -> Swell:
    """Write down the end of the step that a range is in."""
    step = 0.165 * strength
    return Swell(step * np.ceil(ship.col("range_m") / step) - ship.col("range_m"))


def _windows(ship: Lading, strength: float) -> Swell:
    """Go through slabs, at the angle at which a way meets what stands along the lanes."""
    late, lost = np.zeros((2, len(ship.table)))
    flat = np.abs(ship.col("rx_x_m") - ship.col("tx_x_m")) / ship.range_m
    sine = np.square(np.minimum(flat, 0.75))
    for kind, (thick, permittivity, db) in BETWEEN.items():
        panes = ship.hides(kind) * ship.each_link(lambda n: ship.rng.choice([0.8, 1.0, 1.25], n))
        late += panes * thick * (np.sqrt(permittivity - sine) - np.sqrt(1 - sine))
        lost += panes * db
    return Swell(1.7 * strength * late, edge=-min(strength, 1.5) * lost)


def _under_the_deckhead(ship: Lading, strength: float) -> Swell:
    """Hear, where lorries stand between, nothing but what the deck above returns."""
    share = 0.06 if ship.scarce else 0.18
    lorry = ship.each_link(lambda n: (ship.rng.random(n) < share) * 1.0)
    rise = 2 * DECK_M[2] - ship.col("tx_z_m") - ship.col("rx_z_m")
    down = ship.col("rx_z_m") - ship.col("tx_z_m")
    way = np.sqrt(np.maximum(np.square(ship.range_m) - down**2, 0) + rise**2)
    beams = ship.each_link(lambda n: ship.rng.uniform(0.15, 0.7, n))  # a way round by their webs
    detour = np.clip(way - ship.range_m + beams, 0.2, 4.0)
    return Swell(lorry * detour * (0.35 + 0.65 * strength), whole=-4.5 * lorry)


def plate_ray(ship: Lading, strength: float) -> tuple[Floats, Floats]:
    """Return how much longer the way by the steel plates is in m, and its share, [n] each.

    Steel returns an upright field unturned; bonnets leave some of it to some links.
    """
    drop = ship.col("tx_z_m") + ship.col("rx_z_m")
    across = np.square(ship.cars() - ship.posts())[:, :2].sum(axis=1)
    way = np.sqrt(across + drop**2)
    bare = ship.each_link(lambda n: ship.rng.beta(5.0, 2.0, n))
    return way - ship.range_m, min(0.95 * strength**0.5, 1.2) * bare * ship.range_m / way


def _plates(ship: Lading, strength: float) -> Swell:
    """Time the centre of two bell-shaped pulses, as far as they overlap."""
    longer, share = plate_ray(ship, strength)
    overlap = np.exp(-np.square(longer / 0.9))
    cross = share * overlap * np.cos(2 * np.pi * longer / CARRIER_M)
    energy = np.maximum(1 + share**2 + 2 * cross, 0.2)
    metres = np.clip(longer * (share**2 + cross) / energy * overlap, -0.3, 0.45)
    return Swell(metres, whole=overlap * 10 * np.log10(energy))


def _over_a_roof(ship: Lading, strength: float) -> Swell:
    """Bend over the roof of a van: Lee's pieces of the loss by a knife's edge."""
    van = ship.hides("metal")
    high = strength**0.5 * ship.each_link(lambda n: ship.rng.uniform(0.3, 0.75, n))
    near = ship.each_link(lambda n: ship.rng.triangular(0.1, 0.5, 0.9, n)) * ship.range_m
    rest = ship.range_m - near
    over = np.hypot(near, high) - near + np.hypot(rest, high) - rest
    v = high * np.sqrt(2 * ship.range_m / (CARRIER_M * near * rest))
    middle = np.sqrt(np.maximum(0.1184 - np.square(0.38 - 0.1 * v), 0))
    field = np.where(v < 1, 0.5 * np.exp(-0.95 * v), np.where(v < 2.4, 0.4 - middle, 0.225 / v))
    rail = 0.045 * strength * ship.each_link(lambda n: ship.rng.uniform(0.7, 1.3, n))
    return Swell(van * (over + rail), edge=van * np.maximum(20 * np.log10(field), -15))


def _attenuator(ship: Lading, strength: float) -> Swell:
    """Put in an attenuator, step by step, as it gets louder; each spares some symbols."""
    steps = np.clip(np.floor((ship.col("rx_power_dbm") + 89) / 5), 0, 3)
    return Swell(0 * steps, whole=-1.1 * min(strength, 2.2) * steps, count=-1.2 * strength * steps)


def _drives(ship: Lading, strength: float) -> Swell:
    """Hear the drives of ventilators, at some pillars more: weak rows scatter with it."""
    near = ship.lasting(4).lognormal(0.2, 0.6, len(PILLARS_M))[ship.pillar]
    hiss = strength * np.minimum(0.4 + 1.2 * near, 6.0)
    weak = 10 ** (-(ship.col("rx_power_dbm") + 86) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Swell(0.022 * weak * ship.rng.standard_normal(len(near)), hiss=hiss)


def _tyres(ship: Lading, strength: float) -> Swell:
    return Swell(0.0022 * strength * ship.col("cars_aboard"))


def _ballast(ship: Lading, strength: float) -> Swell:
    return Swell(0.085 * strength * np.sin(2 * np.pi * ship.col("time_s") / 1130 - 0.7))


def _ramp(ship: Lading, strength: float) -> Swell:
    return Swell(np.where(ship.col("ramp_deg") < -4.0, 0.14 * strength, 0.0))


def _tarpaulin(ship: Lading, strength: float) -> Swell:
    wet = ship.col("wet_minutes")
    return Swell(0.23 * strength * wet / (wet + 14.0))


def _spray(ship: Lading, strength: float) -> Swell:
    return Swell(0.00083 * strength * ship.col("wind_m_per_s") ** 2)


def _shore(ship: Lading, strength: float) -> Swell:
    return Swell(4.4 * strength / ship.col("supply_v"))


def _heels(ship: Lading, strength: float) -> Swell:
    """Roll with the ship: cars lean on their springs, the pillars do not; so far up, so far off."""
    heel = np.sin(2 * np.pi * ship.col("time_s") / 13.7) + 0.5 * np.sin(ship.col("time_s") / 41.0)
    lean = np.zeros((len(ship.table), 3))
    lean[:, 1] = 0.085 * strength * heel * ship.col("tx_z_m")
    truly = np.linalg.norm(ship.cars() + lean - ship.posts(), axis=1)
    return Swell(truly - ship.range_m)


def _averaged(ship: Lading, strength: float) -> Swell:
    """Send, from half of the tags, the mean of a range and the one before of the same link."""
    written = ship.col("range_m")
    share = 0.5 * min(strength, 1.6) * np.isin(ship.tag, ship.lasting(5).permutation(TAGS)[:3])
    links = ship.table.groupby("link", sort=False)
    before = links["range_m"].shift(1).to_numpy(np.float64)
    later = links["time_s"].diff().to_numpy(np.float64) > 0  # else another run of it begins
    return Swell(np.where(later, share * (before - written), 0.0))


def _out_of_line(ship: Lading, strength: float) -> Swell:
    """Take two lanes to be where paint was before they were painted anew."""
    lane = np.abs(ship.col("tx_y_m")[:, None] - LANES_M).argmin(axis=1)
    moved = ship.cars() + np.array([0.0, 0.42 * strength, 0.0])
    truly = np.linalg.norm(moved - ship.posts(), axis=1)
    return Swell(np.where(np.isin(lane, (2, 3)), truly - ship.range_m, 0.0))


def _stands(ship: Lading, pillars: Floats) -> Swell:
    """Return what comes over rows where pillars truly stand at [8, 3]."""
    truly = np.linalg.norm(ship.cars() - pillars[ship.pillar], axis=1)
    return Swell(truly - ship.range_m, whole=-15 * np.log10(truly / ship.range_m))


def _struck(ship: Lading, strength: float) -> Swell:
    pushed = PILLARS_M.copy()
    pushed[5] += strength * np.array([0.36, -0.28, 0.2])
    return _stands(ship, pushed)


def _confused(ship: Lading, _: float) -> Swell:
    return _stands(ship, PILLARS_M[[0, 4, 2, 3, 1, 5, 6, 7]])


def _yards(ship: Lading, _: float) -> Swell:
    return Swell(np.where(ship.pillar == 2, (1 / YARD_M - 1) * ship.col("range_m"), 0.0))


def turned(longer_m: Floats) -> NDArray[np.complex128]:
    """Return the phase of a way so much longer [n]."""
    return np.asarray(np.exp(-2j * np.pi * CARRIER_GHZ * longer_m / LIGHT))


EFFECTS: dict[str, Callable[[Lading, float], Swell]] = {
    "time-lag": _stamped_late,
    "exchange-motion": _three_messages,
    "antenna-delay": _feeders,
    "clock-offset": _beat,
    "temperature-drift": _cubic,
    "antenna-pattern": _roofs,
    "power-bias": _calibrated,
    "timestamp-jitter": _swept_clock,
    "path-loss": _exhaust,
    "range-scale": _long_unit,
    "range-rounding": _next_step,
    "material-delay": _windows,
    "blocked-path": _under_the_deckhead,
    "ground-bounce": _plates,
    "diffraction": _over_a_roof,
    "level-control": _attenuator,
    "noise-floor": _drives,
    "tyres-insulate": _tyres,
    "ballast-pumped": _ballast,
    "ramp-let-down": _ramp,
    "soaked-tarpaulin": _tarpaulin,
    "spray-on-lenses": _spray,
    "shore-power": _shore,
    "deck-heels": _heels,
    "two-ranges-averaged": _averaged,
    "lane-out-of-line": _out_of_line,
    "pillar-struck": _struck,
    "pillars-confused": _confused,
    "yards-from-one-pillar": _yards,
}
