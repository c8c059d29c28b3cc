"""What the tannery hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the tannery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.tannery_floor import (
    DRUMS_M,
    FUSS_M,
    HALF_PPM_M,
    HOISTS,
    PURLINS_M,
    RAIL_M,
    SOAKED,
    WATER,
    WAVE_M,
    Dye,
    Lot,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
MANY = len(PURLINS_M)
BELL_M = 0.3  # of a pulse, as the scatter of a bell
GRID_M = np.linspace(-1.2, 0.9, 106)  # of a pulse's rise and top
MOTORS_M = np.array([(17.5, 14.0), (17.5, 30.0)])
FEW_BLOCKED, BLOCKED = 0.05, 0.16  # of links
TRIM_PPM = 1.6  # a step of the word that trims a crystal


def _window(lot: Lot, strength: float) -> Dye:
    """Compare with places that are means over a window in time, all of it past."""
    width_s = 0.4 * strength
    return Dye(np.mean([lot.longer(width_s * k / 6) for k in range(7)], axis=0))


def _midway(lot: Lot, strength: float) -> Dye:
    """Measure the way as it is midway through the reply: half of all replies long after."""
    return Dye(lot.longer(0.85 * min(strength, 2.0) * lot.of("reply_time_s")))


def _whole_lengths(lot: Lot, strength: float) -> Dye:
    """Lay cables in whole lengths of 8 m, each a little not taken off; tags in two pottings."""
    lengths = np.ceil(PURLINS_M[:, :2].sum(axis=1) / 8.0)
    potting = np.where(lot.lasting(1).permutation(HOISTS) < 2, 0.14, 0.03)
    return Dye(strength * (0.031 * lengths[lot.purlin] + potting[lot.hoist]))


def _trimmed(lot: Lot, strength: float) -> Dye:
    """Trim crystals by words: what is left of one is within half a step of the word."""
    ppm = lot.lasting(2).normal(0, 4.0, MANY + HOISTS)
    left = ppm - TRIM_PPM * np.rint(ppm / TRIM_PPM)
    offset = left[:MANY][lot.purlin] - left[MANY:][lot.hoist]
    return Dye(0.075 * strength * HALF_PPM_M * offset * lot.of("reply_time_s"))


def _flat_at_room(lot: Lot, strength: float) -> Dye:
    """Drift little about room temperature, and by more than in proportion away from it."""
    x = (lot.of("temperature_c") - 24.0) / 18.0
    return Dye(0.11 * strength * np.sign(x) * np.abs(x) ** 1.4)


def _gable(lot: Lot, strength: float) -> Dye:
    """Be late and weak behind a hide: by a straight slope from one side to the other."""
    turn = np.radians(lot.of("azimuth_deg")) - lot.lasting(3).uniform(-np.pi, np.pi)
    behind = np.arccos(np.cos(turn)) / np.pi
    return Dye(0.18 * strength * (behind - 0.42), whole=-2.6 * min(strength, 1.5) * behind)


def _weibull(lot: Lot, strength: float) -> Dye:
    """Be late where it is weak: by Rayleigh's cumulative curve of the level."""
    x = np.maximum(-73.0 - lot.of("rx_power_dbm"), 0.0) / 10.0
    return Dye(strength * (0.15 * -np.expm1(-np.square(x)) - 0.062))


def _two_grids(lot: Lot, strength: float) -> Dye:
    """Time on two grids, neither of which knows of the other: a sum of two even chances."""
    chance = lot.rng.random((2, len(lot.table))).sum(axis=0) - 1
    return Dye(0.1 * strength * chance)


def _steam(lot: Lot, strength: float) -> Dye:
    """Lose in steam that is thick near a tag alone: by the root of the way."""
    return Dye(0 * lot.way, whole=-0.5 * strength * np.sqrt(lot.way))


def _off_the_print(lot: Lot, strength: float) -> Dye:
    """Know positions from a plan that was printed too small: heights alone are right."""
    rise = np.square(lot.of("tx_z_m") - lot.of("rx_z_m"))
    flat = (1 + 0.0056 * strength) ** 2 * (lot.way**2 - rise)
    return Dye(np.sqrt(flat + rise) - lot.way)


def _own_grids(lot: Lot, strength: float) -> Dye:
    """Round to steps, and take off a constant of each purlin only then."""
    step = 0.14 * strength
    begin = step * lot.lasting(4).random(MANY)[lot.purlin]
    written = lot.of("range_m")
    return Dye(begin + step * np.rint((written - begin) / step) - written)


def _soaked(lot: Lot, strength: float) -> Dye:
    """Go through what is soaked: logarithms of permittivities mix (Lichtenecker 1926)."""
    late, lost = 0 * lot.way, 0 * lot.way
    for kind, (thick_m, dry, db) in SOAKED.items():
        wet = lot.each_link(lambda n: lot.rng.beta(2.0, 30.0, n))
        mixed = dry ** (1 - wet) * WATER**wet
        late += lot.crosses(kind) * thick_m * (np.sqrt(mixed) - 1)
        lost += lot.crosses(kind) * db * (0.7 + 5.0 * wet)
    return Dye(1.6 * strength * late, edge=-min(strength, 1.5) * lost)


def _off_a_drum(lot: Lot, strength: float) -> Dye:
    """Hear, behind a pile of hides, nothing but what the hoops of the best placed drum return."""
    share = FEW_BLOCKED if lot.seldom else BLOCKED
    pile = lot.each_link(lambda n: (lot.rng.random(n) < share).astype(np.float64))
    ends = (lot.hides()[:, None, :2] - DRUMS_M, lot.bolts()[:, None, :2] - DRUMS_M)
    legs = sum(np.linalg.norm(one, axis=2) for one in ends)
    rise = lot.of("tx_z_m") - lot.of("rx_z_m")
    detour = np.clip(np.hypot(np.min(legs, axis=1), rise) - lot.way, 0.3, 3.7)
    return Dye(pile * detour * (0.4 + 0.6 * strength), whole=-4.8 * pile)


def pit_ray(lot: Lot, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Liquor in a pit returns most of what meets it, planks of a walkway little.
    """
    low, high = lot.hides(), lot.bolts()
    part = low[:, 2] / (low[:, 2] + high[:, 2])
    met = low[:, :2] + part[:, None] * (high - low)[:, :2]
    pit = (np.floor(met[:, 0] / 2.6) + np.floor(met[:, 1] / 3.1)) % 2 == 0
    way = np.sqrt(lot.way**2 + 4 * low[:, 2] * high[:, 2])
    calm = lot.each_link(lambda n: lot.rng.triangular(0.55, 1.0, 1.05, n))
    share = min(1.1 * strength**0.5, 1.5) * calm * np.where(pit, 0.82, 0.34) * lot.way / way
    return way - lot.way, -share * np.exp(-2j * np.pi * (way - lot.way) / WAVE_M)


def _pits(lot: Lot, strength: float) -> Dye:
    """Move where a rise comes to half of its own top: both pulses added up place by place."""
    longer, share = pit_ray(lot, strength)
    bells = [np.exp(-0.5 * np.square((GRID_M - x) / BELL_M)) for x in (0.0, longer[:, None])]
    size = np.abs(bells[0] + share[:, None] * bells[1])
    half = 0.5 * size.max(axis=1)
    after = np.maximum((size >= half[:, None]).argmax(axis=1), 1)
    rows = np.arange(len(size))
    one, two = size[rows, after - 1], size[rows, after]
    step = GRID_M[1] - GRID_M[0]
    at = GRID_M[after - 1] + step * (half - one) / np.maximum(two - one, 1e-9)
    moved = np.clip(at + BELL_M * np.sqrt(2 * np.log(2)), -0.35, 0.35)
    power = np.square(np.abs(1 + share * np.exp(-np.square(longer / BELL_M) / 4)))
    return Dye(moved, whole=10 * np.log10(np.maximum(power, 0.25)))


def _past_a_door(lot: Lot, strength: float) -> Dye:
    """Bend past the edge of a door of steel: squares of what holds near it and deep behind it.

    6 dB at the edge, 20 lg(pi sqrt(2) v) far behind it (Keller 1962).
    """
    door = lot.crosses("metal")
    deep = strength**0.5 * lot.each_link(lambda n: lot.rng.uniform(0.05, 0.42, n))
    one = lot.way * lot.each_link(lambda n: lot.rng.beta(3, 3, n) * 0.7 + 0.15)
    both = lot.way / (one * (lot.way - one))
    v = deep * np.sqrt(2 * both / WAVE_M)
    db = np.minimum(10 * np.log10(4 + 6 * v + 2 * (np.pi * v) ** 2), 14.0)
    clings = 0.06 * strength * lot.each_link(lambda n: lot.rng.uniform(0.7, 1.3, n))
    return Dye(door * (0.5 * deep**2 * both + clings), edge=-door * db)


def _companding(lot: Lot, strength: float) -> Dye:
    """Turn gain down by a logarithm of how far it is above a level, and add fewer symbols."""
    over = np.log1p(np.maximum(lot.of("rx_power_dbm") + 93.0, 0.0) / 6.0)
    return Dye(0 * over, whole=-1.6 * min(strength, 2.2) * over, count=-3.3 * strength * over)


def _motors(lot: Lot, strength: float) -> Dye:
    """Hear the drums' motors, which fade with the way to the nearer one exponentially."""
    far = np.linalg.norm(PURLINS_M[:, None, :2] - MOTORS_M, axis=2).min(axis=1)
    near = 0.4 + 5.2 * np.exp(-far / 13.0) * lot.lasting(5).uniform(0.75, 1.25, MANY)
    hiss = strength * near[lot.purlin]
    weak = 10 ** (-(lot.of("rx_power_dbm") + 87) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Dye(0.019 * weak * lot.rng.normal(size=len(hiss)), hiss=hiss)


def _hides_soak(lot: Lot, strength: float) -> Dye:
    return Dye(0.2 * strength * (lot.of("moisture_percent") / 70.0) ** 1.9)


def _reverse(lot: Lot, strength: float) -> Dye:
    return Dye(0.075 * strength * np.cos(2 * np.pi * (lot.of("time_s") + 205.0) / 680.0))


def _loft(lot: Lot, strength: float) -> Dye:
    return Dye(0.128 * strength * (lot.of("flap_deg") > 38.0).astype(np.float64))


def _lime(lot: Lot, strength: float) -> Dye:
    """Cake on antennas what lime there is, until there is no more room for it."""
    lime = lot.of("lime_g")
    return Dye(0.25 * strength * lime / (lime + 60.0))


def _tallow(lot: Lot, strength: float) -> Dye:
    return Dye(0.071 * strength * np.log1p(lot.of("tallow_ml") / 5.0))


def _liquor(lot: Lot, strength: float) -> Dye:
    return Dye(0.0021 * strength * lot.of("liquor_cm"))


def _slack(lot: Lot, strength: float) -> Dye:
    """Sag by as much as a wire's pull divides."""
    return Dye(0.19 * strength / lot.of("tension_kn"))


def _stretch(lot: Lot, strength: float) -> Dye:
    """Hang lower than the hoist knows: ropes stretch by their length and by what they carry."""
    rope = RAIL_M - lot.of("tx_z_m")
    low = 0.085 * strength * rope * lot.of("load_kg") / 300.0
    return Dye(lot.longer_from(lot.hides() - low[:, None] * np.array([0.0, 0.0, 1.0])))


def _corrected(lot: Lot, strength: float) -> Dye:
    """Take off, in firmware, what a weak first path beside the whole is thought to be late by."""
    gap = lot.of("rx_power_dbm") - lot.of("first_path_power_dbm")
    return Dye(-0.13 * strength * np.clip(gap - 1.4, 0.0, 6.0))


def _bolted(lot: Lot, purlins_m: Floats) -> Dye:
    """Return what dyes rows whose purlins have their antennas at [9, 3] indeed."""
    indeed = np.linalg.norm(purlins_m[lot.purlin] - lot.hides(), axis=1)
    return Dye(indeed - lot.way, whole=-19.2 * np.log10(indeed / lot.way))


def _replaced(lot: Lot, strength: float) -> Dye:
    there = (np.arange(MANY) == 6)[:, None]
    return _bolted(lot, PURLINS_M + there * strength * 0.515 * np.array([6.0, -2.0, -3.0]) / 7)


def _miswired(lot: Lot, _: float) -> Dye:
    return _bolted(lot, PURLINS_M[[4, 1, 2, 3, 0, 5, 6, 7, 8]])


def _feet(lot: Lot, _: float) -> Dye:
    """Show feet of the Rhine, at one purlin, as its old scale does."""
    return Dye((lot.purlin == 2) * (1 / FUSS_M - 1) * lot.of("range_m"))


EFFECTS: dict[str, Callable[[Lot, float], Dye]] = {
    "time-lag": _window,
    "exchange-motion": _midway,
    "antenna-delay": _whole_lengths,
    "clock-offset": _trimmed,
    "temperature-drift": _flat_at_room,
    "antenna-pattern": _gable,
    "power-bias": _weibull,
    "timestamp-jitter": _two_grids,
    "path-loss": _steam,
    "range-scale": _off_the_print,
    "range-rounding": _own_grids,
    "material-delay": _soaked,
    "blocked-path": _off_a_drum,
    "ground-bounce": _pits,
    "diffraction": _past_a_door,
    "level-control": _companding,
    "noise-floor": _motors,
    "hides-soaked": _hides_soak,
    "drums-reverse": _reverse,
    "drying-loft-opened": _loft,
    "lime-cakes": _lime,
    "tallow-on-domes": _tallow,
    "liquor-rises": _liquor,
    "span-wires-slack": _slack,
    "ropes-stretch": _stretch,
    "weak-edges-corrected": _corrected,
    "purlin-replaced": _replaced,
    "purlins-miswired": _miswired,
    "feet-from-one-purlin": _feet,
}
