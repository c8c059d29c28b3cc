"""What the bakery hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the bakery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.bakery_house import (
    BURN_S,
    CABINETS_M,
    ELL_M,
    HOODS_M,
    PARTS,
    PER_PPM_S,
    RACKS,
    SHELF_M,
    TILES,
    WAVE_M,
    Bake,
    Sheet,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
ALL = len(HOODS_M)
BELL_M, GATE_M = 0.3, 0.65  # scatter of a pulse; of the window that its energy is timed in
PILED = {False: 0.16, True: 0.05}  # of links behind sacks, usually and where that is rare


def _forgotten(sheet: Sheet, strength: float) -> Bake:
    """Compare with positions of a filter of first order, which forgets exponentially."""
    ages, weights = np.polynomial.laguerre.laggauss(6)
    slow_s = 0.17 * strength
    parts = [w * sheet.grown(slow_s * age) for age, w in zip(ages, weights, strict=True)]
    return Bake(np.sum(parts, axis=0))


def _three_messages(sheet: Sheet, strength: float) -> Bake:
    """Give the mean of the ways of a poll, a reply and what ends it, a reply's time apart."""
    later = 0.9 * min(strength, 2.0) * sheet.get("reply_time_s")
    return Bake((sheet.grown(later) + sheet.grown(2 * later)) / 3)


def _two_sides(sheet: Sheet, strength: float) -> Bake:
    """Be of hoods that were calibrated well or badly, and of racks that differ a little."""
    hoods = 0.03 + 0.14 * sheet.constant(1).beta(0.8, 0.8, ALL)
    racks = 0.02 + 0.045 * sheet.constant(2).exponential(1.0, RACKS).clip(0, 2.5)
    return Bake(strength * (hoods[sheet.hood] + racks[sheet.rack]))


def _by_its_cut(sheet: Sheet, strength: float) -> Bake:
    """Leave some of what crystals are off by, each a cubic of how warm it hangs (Bechmann 1956)."""
    rng = sheet.constant(3)
    warm = rng.uniform(-12.0, 36.0, ALL + RACKS)  # from the bend of the cubic, in K
    ppm = rng.normal(-0.12, 0.05, ALL + RACKS) * warm + 1.05e-4 * warm**3
    apart = ppm[sheet.hood] - ppm[ALL + sheet.rack]
    return Bake(0.018 * strength * PER_PPM_S * apart * sheet.get("reply_time_s"))


def _ever_faster(sheet: Sheet, strength: float) -> Bake:
    """Drift with heat as what leaks in a junction does: exponentially."""
    warm = sheet.get("temperature_c")
    return Bake(0.05 * strength * np.expm1((warm - 25.0) / 22.0))


def _uprights(sheet: Sheet, strength: float) -> Bake:
    """Be late and weak past the uprights of a rack, one on either side of its tag."""
    turn = np.radians(sheet.get("azimuth_deg")) - sheet.constant(4).uniform(0, np.pi)
    upright = np.abs(np.sin(turn)) ** 3
    return Bake(0.15 * strength * (upright - 0.42), whole=-2.4 * min(strength, 1.5) * upright)


def _walk(sheet: Sheet, strength: float) -> Bake:
    """Cross a fixed level the later the smaller a pulse is: by one over its size, softened."""
    smaller = np.minimum(10 ** (0.6 * (-82.0 - sheet.get("rx_power_dbm")) / 20), 2.6)
    return Bake(strength * 0.068 * (smaller - 0.92))


def _interrupts(sheet: Sheet, strength: float) -> Bake:
    """Wait for four interrupts, one after the other: sums of waits, without their mean."""
    return Bake(0.021 * strength * (sheet.rng.gamma(4.0, 1.0, sheet.rows) - 4.0))


def _flour_in_air(sheet: Sheet, strength: float) -> Bake:
    """Lose in air full of flour and steam: so many dB a metre (Beer)."""
    return Bake(0 * sheet.far, whole=-0.22 * strength * sheet.far)


def _small_grid(sheet: Sheet, strength: float) -> Bake:
    """Know positions by a grid of tiles that are larger than is thought, in all directions."""
    return Bake(0.0057 * strength * sheet.far)


def _middles(sheet: Sheet, strength: float) -> Bake:
    """Keep in which step a range is, and show the middle of the step."""
    step, written = 0.135 * strength, sheet.get("range_m")
    return Bake(step * (np.floor(written / step) + 0.5) - written)


def _aslant(sheet: Sheet, strength: float) -> Bake:
    """Go through slabs aslant, refracted: d (sqrt(e - sin^2) - cos) more, and d / cos lost."""
    aslant = sheet.of_links(lambda n: np.radians(62.0) * sheet.rng.random(n))
    late, lost = np.zeros(sheet.rows), np.zeros(sheet.rows)
    for kind, (thick_m, permittivity, db) in PARTS.items():
        there = sheet.behind(kind)
        inside = np.sqrt(permittivity - np.sin(aslant) ** 2)
        late += there * thick_m * (inside - np.cos(aslant))
        lost += there * db * np.sqrt(permittivity) / inside
    return Bake(1.35 * strength * late, front=-min(strength, 1.5) * lost)


def _off_oven_fronts(sheet: Sheet, strength: float) -> Bake:
    """Hear, behind stacked sacks, nothing but what fronts of ovens reflect: an image in them."""
    share = PILED[sheet.few]
    sacks = sheet.of_links(lambda n: (sheet.rng.random(n) < share) * 1.0)
    way = np.sqrt(sheet.far**2 + 4 * sheet.tags()[:, 0] * sheet.hooks()[:, 0])
    detour = np.clip(way - sheet.far, 0.32, 3.9)
    return Bake(sacks * detour * (0.4 + 0.6 * strength), whole=-5.0 * sacks)


def tile_ray(sheet: Sheet, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the tiles is in m, and its complex share, [n] each.

    Fresnel's coefficients of both polarisations, which a tag that hangs aslant mixes.
    """
    rise = sheet.tags()[:, 2] + sheet.hooks()[:, 2]
    way = np.sqrt(sheet.far**2 + 4 * sheet.tags()[:, 2] * sheet.hooks()[:, 2])
    steep = rise / way
    root = np.sqrt(TILES - 1 + steep**2)
    flat, upright = ((k * steep - root) / (k * steep + root) for k in (1.0, TILES))
    mixed = sheet.of_links(lambda n: sheet.rng.uniform(0.55, 0.95, n))
    share = min(1.1 * strength**0.5, 1.5) * (mixed * flat + (1 - mixed) * upright) * sheet.far / way
    return way - sheet.far, share * np.exp(-2j * np.pi * (way - sheet.far) / WAVE_M)


def _tiles(sheet: Sheet, strength: float) -> Bake:
    """Move by where the energy of both pulses is on average, in a window about the first."""
    longer, share = tile_ray(sheet, strength)
    overlap = np.exp(-np.square(longer / BELL_M) / 4)
    inside = np.exp(-np.square(longer / GATE_M))
    late = inside * np.abs(share) ** 2
    whole = np.maximum(1 + late + 2 * share.real * overlap, 0.25)
    mean = longer * (late + share.real * overlap) / whole
    return Bake(np.clip(mean, -0.35, 0.35), whole=10 * np.log10(whole))


def _past_steel(sheet: Sheet, strength: float) -> Bake:
    """Bend past a mixer of steel: Lee's pieces (1985) for the loss past an edge."""
    steel = sheet.behind("metal")
    deep = strength**0.5 * sheet.of_links(lambda n: sheet.rng.uniform(0.06, 0.4, n))
    part = sheet.of_links(lambda n: sheet.rng.uniform(0.2, 0.8, n))
    both = 1 / (part * sheet.far) + 1 / ((1 - part) * sheet.far)
    v = deep * np.sqrt(2 * both / WAVE_M)
    bent = 0.4 - np.sqrt(np.maximum(0.1184 - (0.38 - 0.1 * v) ** 2, 0.0))
    gain = np.where(v < 1, 0.5 * np.exp(-0.95 * v), np.where(v < 2.4, bent, 0.225 / v.clip(0.1)))
    clings = 0.055 * strength * sheet.of_links(lambda n: sheet.rng.uniform(0.75, 1.3, n))
    db = np.minimum(-20 * np.log10(np.maximum(gain, 1e-3)), 12.5)
    return Bake(steel * (0.5 * deep**2 * both + clings), front=-steel * db)


def _pads(sheet: Sheet, strength: float) -> Bake:
    """Switch pads before the amplifier, one for each 5 dB over a level, and add fewer symbols."""
    over = np.floor((sheet.get("rx_power_dbm") + 97.0) / 5.0)
    pads = np.minimum(np.maximum(over, 0.0), 4.0)
    return Bake(0 * pads, whole=-1.3 * min(strength, 2.2) * pads, count=-1.8 * strength * pads)


def _igniters(sheet: Sheet, strength: float) -> Bake:
    """Hear igniters of ovens, whose power spreads: by one over squares of how far they are."""
    square = np.square(HOODS_M[:, None, :2] - CABINETS_M).sum(axis=2)
    power = (1.7 / (1 + square / 36.0)).sum(axis=1) * sheet.constant(5).uniform(0.7, 1.3, ALL)
    hiss = 10 * np.log10(1.1 + power)[sheet.hood] * strength
    weak = 10 ** (-(sheet.get("rx_power_dbm") + 91) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Bake(0.018 * weak * sheet.rng.standard_normal(sheet.rows), hiss=hiss)


def _flour(sheet: Sheet, strength: float) -> Bake:
    return Bake(-0.24 * strength * np.expm1(-sheet.get("flour_g") / 34.0))


def _steams(sheet: Sheet, strength: float) -> Bake:
    return Bake(0.21 * strength * (sheet.get("steam_percent") / 95.0) ** 2.2)


def _burners(sheet: Sheet, strength: float) -> Bake:
    return Bake(0.073 * strength * np.sin(2 * np.pi * sheet.get("time_s") / BURN_S + 1.1))


def _shutter(sheet: Sheet, strength: float) -> Bake:
    return Bake(np.where(sheet.get("shutter_percent") > 56.0, 0.124 * strength, 0.0))


def _fat(sheet: Sheet, strength: float) -> Bake:
    return Bake(0.07 * strength * np.log1p(sheet.get("fat_ml") / 3.2))


def _dough(sheet: Sheet, strength: float) -> Bake:
    return Bake(0.0068 * strength * sheet.get("dough_cm"))


def _belts(sheet: Sheet, strength: float) -> Bake:
    """Slip, as belts of fans do, by as much as their tension divides: tags cool less."""
    return Bake(22.0 * strength / sheet.get("belt_n"))


def _shelves(sheet: Sheet, strength: float) -> Bake:
    """Hang tags, on some racks, a shelf above or below that which the list has."""
    shelf = sheet.constant(6).permutation([-1.0, -1.0, 0.0, 0.0, 1.0, 1.0, -1.0])[sheet.rack]
    up = SHELF_M * strength * shelf[:, None] * np.array([0.0, 0.0, 1.0])
    return Bake(sheet.grown_from(sheet.tags() + up))


def _smoothed(sheet: Sheet, strength: float) -> Bake:
    """Send, at five hoods, what was sent before and a part of what is new."""
    slow = sheet.constant(7).permutation(ALL)[:5]
    part = np.where(np.isin(sheet.hood, slow), 1 / (1 + strength), 1.0)
    sent = sheet.in_turn(lambda row, new, before: before + float(part[row]) * (new - before))
    return Bake(sent - sheet.get("range_m"))


def _hung(sheet: Sheet, hoods_m: Floats) -> Bake:
    """Return what becomes of rows whose hoods have their antennas at [8, 3] in truth."""
    truly = np.linalg.norm(sheet.tags() - hoods_m[sheet.hood], axis=1)
    return Bake(truly - sheet.far, whole=-17.6 * np.log10(truly / sheet.far))


def _knocked(sheet: Sheet, strength: float) -> Bake:
    places = HOODS_M.copy()
    places[6] += 0.525 * strength * np.array([6.0, 6.0, 7.0]) / 11
    return _hung(sheet, places)


def _miswritten(sheet: Sheet, _: float) -> Bake:
    return _hung(sheet, HOODS_M[[0, 4, 2, 3, 1, 5, 6, 7]])


def _ells(sheet: Sheet, _: float) -> Bake:
    """Show ells, at one hood, as the bakery's oldest reader does."""
    return Bake(np.where(sheet.hood == 3, 1 / ELL_M - 1, 0.0) * sheet.get("range_m"))


EFFECTS: dict[str, Callable[[Sheet, float], Bake]] = {
    "time-lag": _forgotten,
    "exchange-motion": _three_messages,
    "antenna-delay": _two_sides,
    "clock-offset": _by_its_cut,
    "temperature-drift": _ever_faster,
    "antenna-pattern": _uprights,
    "power-bias": _walk,
    "timestamp-jitter": _interrupts,
    "path-loss": _flour_in_air,
    "range-scale": _small_grid,
    "range-rounding": _middles,
    "material-delay": _aslant,
    "blocked-path": _off_oven_fronts,
    "ground-bounce": _tiles,
    "diffraction": _past_steel,
    "level-control": _pads,
    "noise-floor": _igniters,
    "flour-settles": _flour,
    "prover-steams": _steams,
    "burners-cycle": _burners,
    "shutter-rolled-up": _shutter,
    "fat-on-hoods": _fat,
    "dough-rises": _dough,
    "fan-belts-slip": _belts,
    "tag-a-shelf-away": _shelves,
    "ranges-smoothed-slowly": _smoothed,
    "hood-knocked": _knocked,
    "hoods-miswritten": _miswritten,
    "ells-from-one-hood": _ells,
}
