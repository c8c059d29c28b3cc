"""What the printworks hides in ranges and levels: effects in forms of its own.

numpy alone; shared by the printworks' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable
from itertools import pairwise

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.printworks_console import METRES, RISE, risen, spline
from bench.challenge.families.printworks_faults import UNLISTED
from bench.challenge.families.printworks_hall import (
    BETWEEN,
    HALL_M,
    PER_PPM_M,
    PRESS_M,
    STANCHIONS,
    STANCHIONS_M,
    TAGS,
    TOWERS_M,
    WAVE_M,
    Change,
    Sheet,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
BEHIND_TOWERS = {False: 0.2, True: 0.07}  # of links, and where these are rare
BLOCKS, THICK_M, BELOW = 1.99 - 0.12j, 0.06, 5.24 - 0.6j  # end-grain wood, on concrete [P.2040]
FIBRES, SOLID = 3.4, 0.62  # permittivity of cellulose; share of paper that it is
CORE_M, FULL_M = 0.12, 0.44  # reels: radius of what is not paper, and of what is left of them
WEIGHTS = ((0.0, 0.25), (0.36, 0.5), (1.0, 0.25))  # messages' places in an exchange, and weights
WALKWAYS_M = 3.2  # above the floor, along flanks and walls
SIDES_M = (0.0, 3.1, 6.2, 9.3, *PRESS_M[2:], 18.9, 21.9, 24.9, HALL_M[1])  # walls, rows of reels
ACROSS = 0.22  # paper shrinks along its fibres by as much of what it shrinks across them


def _after_retries(sheet: Sheet, strength: float) -> Change:
    """Compare with places that a busy radio network brought: later, by twice, for each retry."""
    again = sheet.rng.geometric(0.8, sheet.size).clip(max=4) - 1
    own_s = sheet.shared(1).uniform(0.07, 0.105, len(TAGS))[sheet.tag]
    return Change(sheet.lengthens_in(strength * (own_s + 0.024 * (2.0**again - 1))))


def _unlike_waits(sheet: Sheet, strength: float) -> Change:
    """Give the way by three messages of which the second comes early: waits are not alike."""
    whole_s = 2.1 * strength * sheet["reply_time_s"]
    return Change(sum(by * sheet.lengthens_in(place * whole_s) for place, by in WEIGHTS))


def _serial_numbers(sheet: Sheet, strength: float) -> Change:
    """Be late by when consoles were made: by what went astray from one number to the next.

    Tags by how thick the rubber of grippers, and the shells of trucks, are.
    """
    drawn = sheet.shared(2)
    strays = np.cumsum(drawn.normal(0.015, 0.062, STANCHIONS))
    made = (strays - strays.min())[drawn.permutation(STANCHIONS)][sheet.reader]
    shells = 0.03 + drawn.gamma(1.6, 0.026, len(TAGS)).clip(max=0.14)[sheet.tag]
    return Change(strength * (0.8 * made.clip(max=0.36) + shells))


def _by_common_time(sheet: Sheet, strength: float) -> Change:
    """Leave, of crystals' offset, what is not common to all consoles that range a run."""
    drawn = sheet.shared(3)
    own = drawn.normal(0.0, 0.68, STANCHIONS).clip(-1.5, 1.5)[sheet.reader]
    sums = np.bincount(sheet.run, own) / np.bincount(sheet.run)
    tags = drawn.normal(0.0, 0.45, len(TAGS)).clip(-1.0, 1.0)[sheet.tag]
    ppm = 0.0155 * strength * (tags + 0.6 * sums[sheet.run] - own)
    return Change(PER_PPM_M * ppm * sheet["reply_time_s"])


def _vapour(sheet: Sheet, strength: float) -> Change:
    """Drift by what boards take up of moisture: by vapour's pressure when saturated (Magnus)."""
    warm_c = sheet["temperature_c"]
    hpa = 6.112 * np.exp(17.62 * warm_c / (243.12 + warm_c))
    return Change(0.0052 * strength * (hpa - 28.0).clip(max=52.0))


def _dipole(sheet: Sheet, strength: float) -> Change:
    """Be late and weak past both ends of a half-wave dipole, as its own pattern has it."""
    off = np.radians(sheet["azimuth_deg"]) - sheet.shared(4).uniform(0.0, np.pi)
    beside = np.abs(np.sin(off)).clip(1e-6)
    missing = 1 - np.abs(np.cos(0.5 * np.pi * np.cos(off)) / beside)
    return Change(strength * (0.155 * missing - 0.062), -3.0 * min(strength, 1.5) * missing)


def _richards(sheet: Sheet, strength: float) -> Change:
    """Be late where it is weak: by a logistic curve whose feet are unlike (Richards 1959)."""
    over = (sheet["rx_power_dbm"] + 79.5) / 2.7
    return Change(strength * (0.185 * (1 + 0.7 * np.exp(over.clip(-30, 30))) ** -0.62 - 0.128))


def _first_passage(sheet: Sheet, strength: float) -> Change:
    """Scatter as a ramp does that a loop's noise meets: by first passages (Schroedinger 1915)."""
    return Change(0.145 * strength * (sheet.rng.wald(1.0, 12.0, sheet.size) - 1.0))


def _over_the_press(sheet: Sheet, strength: float) -> Change:
    """Lose by each metre of a way that is over the press, in mist; else by decades, squared."""
    load = sheet.by_link(lambda n: sheet.rng.uniform(0.6, 1.4, n))
    mist = 0.5 * load * sheet.amid_m + 2.6 * np.log10(sheet.far.clip(1.0)) ** 2
    return Change(all_db=-strength * mist)


def _shrunk_plan(sheet: Sheet, strength: float) -> Change:
    """Be on a plan whose paper shrank: across its fibres, and little along these; not upward."""
    apart = sheet.there - sheet.hung
    return Change(sheet.lengthens(0.0112 * strength * apart * [1.0, ACROSS, 0.0]))


def _logarithms(sheet: Sheet, strength: float) -> Change:
    """Keep logarithms of ranges in whole steps: each is farther by the same part."""
    step, read = 0.0115 * strength, sheet["range_m"].clip(0.05)
    return Change(np.exp(step * np.rint(np.log(read) / step)) - read)


def needles() -> float:
    """Return the permittivity of paper: of fibres like needles, any way round (Polder 1946)."""
    mixed = 1.0
    for _ in range(60):
        part = (FIBRES - 1) * (5 * mixed + FIBRES) / (3 * (mixed + FIBRES))
        mixed = 1 + SOLID * part
    return float(mixed)


PAPER = needles()


def _chords(sheet: Sheet, strength: float) -> Change:
    """Go through reels at chords, as these are met; through cladding and panes as they stand."""
    late, lost = np.zeros(sheet.size), np.zeros(sheet.size)
    met = sheet.by_link(lambda n: sheet.rng.uniform(0.0, 0.98, n))
    full_m = sheet.by_link(lambda n: sheet.rng.triangular(0.16, 0.24, FULL_M, n))
    chord = 2 * full_m * (np.sqrt(1 - met**2) - np.sqrt((CORE_M / full_m) ** 2 - met**2 + 0j).real)
    sheets = sheet.by_link(lambda n: sheet.rng.integers(1, 4, n))
    across = np.abs(sheet.there - sheet.hung)[:, 1] / sheet.far
    for kind, (thick_m, dense, db) in BETWEEN.items():
        there = sheet.through(kind)
        thick = chord * 1.1 if kind == "paper" else sheets * thick_m / across.clip(0.55)
        late += there * thick * (np.sqrt(PAPER if kind == "paper" else dense) - 1)
        lost += there * db * (0.4 + 0.6 * sheets / 2) * (0.5 + thick)
    return Change(strength * late, first_db=-min(strength, 1.5) * lost)


def _returned_m(sheet: Sheet, y_m: float, z_m: float) -> Floats:
    """Return how long ways are that an upright side and a level one return in turn, in m [n].

    Very long where one of them is between both ends.
    """
    ends = zip(sheet.there.T, sheet.hung.T, strict=True)
    over = [
        (one - plane) * (other - plane) < 0
        for (one, other), plane in zip(list(ends)[1:], (y_m, z_m), strict=True)
    ]
    image = sheet.there * [1.0, -1.0, -1.0] + np.array([0.0, 2 * y_m, 2 * z_m])
    return np.asarray(np.linalg.norm(image - sheet.hung, axis=1) + 99.0 * (over[0] | over[1]))


def _twice_returned(sheet: Sheet, strength: float) -> Change:
    """Hear, behind a tower, nothing but what an upright side and a level one return in turn.

    Of walls, flanks of the press and rows of reels, and of floor, walkways and roof, those that do
    so first.
    """
    there = sheet.behind(BEHIND_TOWERS[sheet.rare])
    ways = [_returned_m(sheet, y_m, z_m) for y_m in SIDES_M for z_m in (0.0, WALKWAYS_M, HALL_M[2])]
    detour = (np.min(ways, axis=0) - sheet.far).clip(0.45, 3.3)
    return Change(there * detour * (0.5 + 0.5 * strength), -2.0 * there, -3.6 * there)


def _layered(down: Floats, upright: bool) -> Complexes:
    """Return what blocks of wood on concrete return of a way that comes down so steeply [n].

    The upper face, and what goes to and fro between both. `upright`: how waves lie.
    """
    wood, stone = (np.sqrt(one - 1 + down**2) for one in (BLOCKS, BELOW))
    three = (down, wood / BLOCKS, stone / BELOW) if upright else (down, wood, stone)
    upper, lower = ((one - other) / (one + other) for one, other in pairwise(three))
    within = lower * np.exp(-4j * np.pi * THICK_M / WAVE_M * wood)
    return np.asarray((upper + within) / (1 + upper * within))


def off_the_floor(sheet: Sheet, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Antennas are slanted, so that waves lie both ways; what stands about takes some, by links.
    """
    way = np.linalg.norm(sheet.there * [1.0, 1.0, -1.0] - sheet.hung, axis=1)
    down, longer = (sheet.there[:, 2] + sheet.hung[:, 2]) / way, way - sheet.far
    back = 0.5 * (_layered(down, True) + _layered(down, False))
    free = sheet.by_link(lambda n: sheet.rng.triangular(0.3, 0.8, 1.0, n))
    size = (1.7 * np.sqrt(strength) * free * sheet.far / way).clip(max=2.2)
    share = size * back * np.exp(-2j * np.pi * longer / WAVE_M)
    return longer, share * np.minimum(1.0, 0.9 / np.abs(share).clip(1e-9))


def _both_rise(sheet: Sheet, strength: float) -> Change:
    """Be where discriminators have the rise of both pulses: that of the floor comes later."""
    longer, share = off_the_floor(sheet, strength)
    at = np.arange(-6.0, 4.0, 1 / 24)
    both = np.abs(spline(at) + share[:, None] * spline(at - longer[:, None] / METRES))
    falls = (np.diff(both, axis=1) < 0) & (both[:, 1:] > 0.25)
    place = at[0] + risen(both, falls.argmax(axis=1), at[1] - at[0])
    added = np.abs(1 + share * spline(longer / METRES)).clip(min=0.45)
    return Change((1.2 * METRES * (place + RISE)).clip(-0.26, 0.3), 20 * np.log10(added))


def edge_db(over: Floats) -> Floats:
    """Return what one edge takes in dB, by Fresnel's parameter > -0.7 [n] (ITU-R P.526)."""
    return np.asarray(6.9 + 20 * np.log10(np.sqrt((over - 0.1) ** 2 + 1) + over - 0.1))


def _two_towers(sheet: Sheet, strength: float) -> Change:
    """Bend over two towers, each as if the other's edge were an end (Epstein and Peterson 1953)."""
    steel = sheet.through("metal")
    cuts = np.sort(
        [sheet.by_link(lambda n: sheet.rng.uniform(0.15, 0.85, n)) for _ in "ab"], axis=0
    )
    high = [
        np.sqrt(strength) * sheet.by_link(lambda n: sheet.rng.uniform(0.05, 0.42, n)) for _ in "ab"
    ]
    first, amid, last = (
        sheet.far * cuts[0],
        sheet.far * (cuts[1] - cuts[0]),
        sheet.far * (1 - cuts[1]),
    )
    amid = amid.clip(0.4)
    raised = high[0] - high[1] * first / (first + amid), high[1] - high[0] * last / (last + amid)
    legs = (first + 0.2, amid), (amid, last + 0.2)
    over = (
        up * np.sqrt(2 / WAVE_M * (1 / one + 1 / other))
        for up, (one, other) in zip(raised, legs, strict=True)
    )
    lost = np.sum([edge_db(one.clip(-0.7)) for one in over], axis=0)
    bent = np.hypot(first, high[0]) + np.hypot(amid, high[0] - high[1]) + np.hypot(last, high[1])
    more = strength * sheet.by_link(lambda n: sheet.rng.gamma(4.0, 0.02, n).clip(0.03, 0.17))
    late = (bent - (first + amid + last) + more).clip(0.0, 0.45)
    return Change(steel * late, first_db=-steel * lost.clip(max=13.5))


def _varactors(sheet: Sheet, strength: float) -> Change:
    """Turn gain down by varactors: by an arc's tangent of the level; count the fewer symbols."""
    over = np.maximum(sheet["rx_power_dbm"] + 90.0, 0.0)
    less = 4.4 * min(strength, 2.2) * np.arctan(over / 14.0)
    return Change(all_db=-less, count_db=-1.2 * less)


def _static_bars(sheet: Sheet, strength: float) -> Change:
    """Hear bars that take static off webs: ever more the drier it is, and the nearer towers are."""
    own = sheet.shared(5).gamma(6.0, 0.14, STANCHIONS)[sheet.reader]
    hung = STANCHIONS_M[:, :2]
    near = [1 / (1 + (np.hypot(*(hung - [x_m, 14.1]).T) / 5.5) ** 3) for x_m in TOWERS_M]
    dry = np.exp(-(sheet["humidity_pct"] - 30.0) / 13.0).clip(max=1.4)
    db = strength * (own + 4.6 * dry * np.sum(near, axis=0)[sheet.reader])
    weak = 10 ** ((-83.0 - sheet["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Change(0.015 * weak * sheet.rng.normal(size=sheet.size), noise_db=db)


EFFECTS: dict[str, Callable[[Sheet, float], Change]] = {
    "antenna-delay": _serial_numbers,
    "antenna-pattern": _dipole,
    "blocked-path": _twice_returned,
    "clock-offset": _by_common_time,
    "diffraction": _two_towers,
    "exchange-motion": _unlike_waits,
    "ground-bounce": _both_rise,
    "level-control": _varactors,
    "material-delay": _chords,
    "noise-floor": _static_bars,
    "path-loss": _over_the_press,
    "power-bias": _richards,
    "range-rounding": _logarithms,
    "range-scale": _shrunk_plan,
    "temperature-drift": _vapour,
    "time-lag": _after_retries,
    "timestamp-jitter": _first_passage,
    **UNLISTED,
}
