"""What the rink hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the rink's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.rink_ice import (
    BARRIERS,
    CARRIER_M,
    CHILLER_M,
    GRAVITY,
    HEAD_M,
    PERIOD_S,
    RACK_M,
    REPLY_M,
    RINK_M,
    SKATERS,
    TRUSSES_M,
    Cut,
    Sheet,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
ICE, SLAB, ICE_M = 3.17, 6.5, 0.035  # permittivities, and how thick the ice is
BELL_M, APART_M, FRACTION = 0.32, 0.6, 0.5  # a pulse, and the two copies that are compared
FEW_CROWDS = 0.05  # of links
FRESNEL_STEP = 0.004
FRESNEL = np.exp(-0.5j * np.pi * np.square(np.arange(3500) * FRESNEL_STEP))
FRESNEL_SUM = FRESNEL_STEP * (np.cumsum(FRESNEL) - 0.5 * (FRESNEL + 1))  # from 0, trapezia


def _between_frames(sheet: Sheet, strength: float) -> Cut:
    """Compare with places that a tracker draws straight between two frames, both of them old."""
    part = 0.25 + 0.5 * np.mod(sheet["time_s"], 0.04)[:, None] / 0.04
    drawn = (1 - part) * sheet.helmets() + part * sheet.helmets(0.22 * strength)
    return Cut(sheet.seen_at(drawn))


def _harmonic(sheet: Sheet, strength: float) -> Cut:
    """Give the harmonic mean of two ways, as a product over a sum of times does."""
    later = sheet.d + sheet.gone(1.3 * min(strength, 2.0) * sheet["reply_time_s"])
    return Cut(2 * sheet.d * later / (sheet.d + later) - sheet.d)


def _feeders(sheet: Sheet, strength: float) -> Cut:
    """Feed trusses along the boards from one rack, a little not taken off; tags of two shells."""
    along = np.abs(TRUSSES_M[:, :2] - RACK_M).sum(axis=1)
    shell = np.where(sheet.frozen(1).permutation(SKATERS) < 3, 0.02, 0.11)
    return Cut(strength * (0.0042 * along[sheet.number("rx")] + shell[sheet.number("tx")]))


def _crystals(sheet: Sheet, strength: float) -> Cut:
    """Miss, of crystals' offset, what helmets were off by when they were last compared."""
    rng = sheet.frozen(2)
    ppm = rng.logistic(0, 1.1, len(TRUSSES_M))[sheet.number("rx")]
    ppm = ppm - rng.uniform(-3.2, 3.2, SKATERS)[sheet.number("tx")]
    return Cut(0.013 * strength * REPLY_M * ppm * (sheet["reply_time_s"] + 0.0011))


def _rime(sheet: Sheet, strength: float) -> Cut:
    """Drift by a line, and by what moisture adds that freezes in connectors."""
    warm = sheet["temperature_c"]
    return Cut(strength * (0.07 / (1 + np.exp(warm / 0.9)) - 0.0042 * (warm - 4.0) - 0.012))


def _cage(sheet: Sheet, strength: float) -> Cut:
    """Be late through the long axis of a head: as an ellipse's radius has it."""
    turn = np.radians(sheet["azimuth_deg"]) - sheet.frozen(3).uniform(0, np.pi)
    radius = 1 / np.sqrt(1 - 0.66 * np.square(np.cos(turn))) - 1
    return Cut(0.18 * strength * (radius - 0.31), whole=-2.5 * min(strength, 1.5) * radius)


def _gompertz(sheet: Sheet, strength: float) -> Cut:
    """Be late where it is weak: by Gompertz's curve of the level, steeper at its foot."""
    grown = np.exp(-np.exp((sheet["rx_power_dbm"] + 88.0) / 4.0))
    return Cut(strength * (0.15 * grown - 0.055))


def _two_waits(sheet: Sheet, strength: float) -> Cut:
    """Wait for one clock and for another: the difference of two exponential waits."""
    waits = sheet.rng.standard_exponential((2, len(sheet.table)))
    return Cut(0.031 * strength * (waits[0] - waits[1]))


def _mist(sheet: Sheet, strength: float) -> Cut:
    """Lose in mist above the ice by a power of the way between a line and a square."""
    return Cut(0 * sheet.d, whole=-0.055 * strength * sheet.d**1.35)


def _oblique(sheet: Sheet, strength: float) -> Cut:
    """Multiply with what is right for a way that has a bend of 1.8 m beside it."""
    return Cut(0.0053 * strength * np.hypot(sheet["range_m"], 1.8))


def _carried(sheet: Sheet, strength: float) -> Cut:
    """Round to steps, and carry what is rounded off into the next row."""
    step, carry = 0.15 * strength, 0.0
    written = sheet["range_m"]
    out = np.empty_like(written)
    for row, one in enumerate(written):
        out[row] = step * np.rint((one + carry) / step)
        carry += one - out[row]
    return Cut(out - written)


def _barriers(sheet: Sheet, strength: float) -> Cut:
    """Go straight through what stands upright, the longer the more aslant."""
    flat = np.abs(sheet["tx_y_m"] - sheet["rx_y_m"]) / sheet.d
    longer = 1 / np.maximum(flat, 0.65)
    late, lost = 0 * flat, 0 * flat
    for kind, (thick_m, permittivity, db) in BARRIERS.items():
        some = sheet.behind(kind) * sheet.by_link(lambda n: sheet.rng.lognormal(0, 0.16, n))
        late, lost = late + some * thick_m * (permittivity**0.5 - 1) * longer, lost + some * db
    return Cut(1.5 * strength * late, edge=-lost * min(strength, 1.5))


def _off_the_boards(sheet: Sheet, strength: float) -> Cut:
    """Hear, behind a crowd at the bench, nothing but what the nearest board returns."""
    share = FEW_CROWDS if sheet.few else 0.16
    crowd = sheet.by_link(lambda n: 1.0 * (sheet.rng.random(n) < share))
    at, ends = sheet.helmets(), sheet.ends()
    ways = []
    for axis, plane in ((0, 0.0), (0, RINK_M[0]), (1, 0.0), (1, RINK_M[1])):
        image = np.array(at)
        image[:, axis] = 2 * plane - image[:, axis]
        ways.append(np.linalg.norm(image - ends, axis=1))
    detour = np.clip(np.min(ways, axis=0) - sheet.d, 0.28, 4.4)
    return Cut(crowd * detour * (0.4 + 0.6 * strength), whole=-5.0 * crowd)


def ice_ray(sheet: Sheet, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the ice is in m, and its complex share, [n] each.

    A film on a slab (Airy's sum; Born and Wolf 1999, 1.6.4), across the plane of incidence.
    """
    mirrored = sheet.helmets() * [1, 1, -1] - sheet.ends()
    way = np.linalg.norm(mirrored, axis=1)
    steep = np.abs(mirrored[:, 2]) / way
    inside, below = (np.sqrt(one - 1 + steep**2) for one in (ICE, SLAB))
    upper, lower = (steep - inside) / (steep + inside), (inside - below) / (inside + below)
    turn = np.exp(-4j * np.pi * ICE_M * inside / CARRIER_M)
    film = (upper + lower * turn) / (1 + upper * lower * turn)
    scratched = sheet.by_link(lambda n: sheet.rng.beta(5.0, 1.2, n))
    share = min(1.1 * strength**0.5, 1.5) * scratched * film * sheet.d / way
    return way - sheet.d, share * np.exp(-2j * np.pi * (way - sheet.d) / CARRIER_M)


def _ice(sheet: Sheet, strength: float) -> Cut:
    """Move where a pulse equals a part of itself before: by one of Newton's steps."""
    longer, share = ice_ray(sheet, strength)
    begin = (APART_M**2 + 2 * BELL_M**2 * np.log(FRACTION)) / (2 * APART_M)

    def bell(x: Floats | float) -> Floats:
        return np.asarray(np.exp(-0.5 * np.square(np.asarray(x) / BELL_M)))

    def balance(t: float, part: Complexes | float) -> Floats:
        now, before = (np.abs(bell(x) + part * bell(x - longer)) for x in (t, t - APART_M))
        return np.asarray(FRACTION * now - before)

    slope = (balance(begin + 0.01, 0.0) - balance(begin - 0.01, 0.0)) / 0.02
    power = np.square(np.abs(1 + share * np.exp(-np.square(longer / BELL_M) / 4)))
    moved = np.clip(-balance(begin, share) / slope, -0.3, 0.3)
    return Cut(moved, whole=10 * np.log10(np.maximum(power, 0.2)))


def _strip(sheet: Sheet, strength: float) -> Cut:
    """Bend round both sides of a board of steel: Kirchhoff's strip, Fresnel's integral summed."""
    steel = sheet.behind("metal")
    sides = [strength**0.5 * sheet.by_link(lambda n: sheet.rng.uniform(0.1, 0.38, n))
             for _ in range(2)]  # fmt: skip
    one = sheet.d * sheet.by_link(lambda n: sheet.rng.triangular(0.12, 0.5, 0.88, n))
    two = sheet.d - one
    v = [side * np.sqrt(2 * sheet.d / (CARRIER_M * one * two)) for side in sides]
    cells = [np.minimum(x / FRESNEL_STEP, len(FRESNEL) - 1).astype(np.intp) for x in v]
    left = np.abs(1 - (0.5 + 0.5j) * sum(FRESNEL_SUM[cell] for cell in cells))
    near = np.minimum(*sides)
    over = np.hypot(one, near) + np.hypot(two, near) - sheet.d
    pulled = 0.06 * strength * sheet.by_link(lambda n: sheet.rng.uniform(0.7, 1.3, n))
    db = np.clip(-20 * np.log10(np.maximum(left, 1e-3)), 0.5, 13.0)
    return Cut(steel * (over + pulled), edge=-steel * db)


def _sigmoid(sheet: Sheet, strength: float) -> Cut:
    """Go over to a quieter amplifier about a level: by a logistic curve, and fewer symbols."""
    part = 1 / (1 + np.exp(-(sheet["rx_power_dbm"] + 86.0) / 3.0))
    return Cut(0 * part, whole=-3.1 * min(strength, 2.2) * part, count=-4.2 * strength * part)


def _chiller(sheet: Sheet, strength: float) -> Cut:
    """Hear the chiller's drive, the less by the square the farther from it a truss is."""
    far = np.square(TRUSSES_M[:, :2] - CHILLER_M).sum(axis=1)
    near = 5.6 / (1 + far / 24.0**2) * sheet.frozen(4).triangular(0.7, 1.0, 1.3, len(far))
    hiss = strength * near[sheet.number("rx")]
    weak = 10 ** (-(sheet["rx_power_dbm"] + 88) / 20) * np.sqrt(10 ** (hiss / 10) - 1)
    return Cut(0.019 * weak * sheet.rng.standard_normal(len(hiss)), hiss=hiss)


def _fogged(sheet: Sheet, strength: float) -> Cut:
    return Cut(0.21 * strength * (sheet["breath_percent"] / 100) ** 2.2)


def _drier(sheet: Sheet, strength: float) -> Cut:
    return Cut(0.076 * strength * np.cos(2 * np.pi * sheet["time_s"] / PERIOD_S + 0.7))


def _brine(sheet: Sheet, strength: float) -> Cut:
    return Cut(np.where(sheet["brine_percent"] > 60.0, 0.125 * strength, 0.0))


def _spectators(sheet: Sheet, strength: float) -> Cut:
    return Cut(0.23 * strength * -np.expm1(-sheet["spectators"] / 240.0))


def _on_trusses(sheet: Sheet, strength: float) -> Cut:
    return Cut(0.081 * strength * np.log1p(sheet["rime_mm"] / 0.8))


def _floodlights(sheet: Sheet, strength: float) -> Cut:
    return Cut(0.055 * strength * sheet["lux_klx"])


def _cells(sheet: Sheet, strength: float) -> Cut:
    """Rise later the higher a cell's resistance is, which charge that is left divides."""
    return Cut(6.4 * strength / sheet["cell_mah"])


def _lean(sheet: Sheet, strength: float) -> Cut:
    """Lean into curves, as a balance of weight and speed has it: tags are inward and lower."""
    arc, heading, speed = (sheet[one] for one in ("arc_m", "heading_rad", "speed_m_per_s"))
    angle = np.arctan(strength * np.square(speed) / (GRAVITY * arc))
    aside = HEAD_M * np.sin(angle)
    off = [-aside * np.sin(heading), aside * np.cos(heading), HEAD_M * (np.cos(angle) - 1)]
    return Cut(sheet.seen_at(sheet.helmets() + np.stack(off, axis=1)))


def _coasts(sheet: Sheet, strength: float) -> Cut:
    """Send, at trusses of one make, what follows from the two ranges before, in half of rows."""
    written = sheet["range_m"]
    rows = sheet.table.groupby("link", sort=False)
    one, two = (rows["range_m"].shift(k).to_numpy(np.float64) for k in (1, 2))
    onward = (rows["time_s"].diff().to_numpy(np.float64) > 0) & (
        rows["time_s"].diff(2).to_numpy(np.float64) > 0
    )  # else another run of it begins
    make = np.isin(sheet.number("rx"), sheet.frozen(5).permutation(len(TRUSSES_M))[:4])
    struck = make & onward & (sheet.rng.random(len(written)) < 0.55)
    return Cut(np.where(struck, min(strength, 1.0) * (2 * one - two - written), 0.0))


def _hangs(sheet: Sheet, trusses_m: Floats) -> Cut:
    """Return what is cut into rows whose trusses truly are at [7, 3]."""
    truly = np.linalg.norm(sheet.helmets() - trusses_m[sheet.number("rx")], axis=1)
    return Cut(truly - sheet.d, whole=-19.7 * np.log10(truly / sheet.d))


def _rehung(sheet: Sheet, strength: float) -> Cut:
    off = np.outer(np.arange(7) == 5, strength * 0.49 * np.array([2, 6, -3]) / 7)
    return _hangs(sheet, TRUSSES_M + off)


def _swapped(sheet: Sheet, _: float) -> Cut:
    return _hangs(sheet, TRUSSES_M[[3, 1, 2, 0, 4, 5, 6]])


def _counter(sheet: Sheet, _: float) -> Cut:
    """Take, at one truss, a clock of 512 MHz for one of 499.2 MHz."""
    return Cut((499.2 / 512 - 1) * sheet["range_m"] * (sheet.number("rx") == 2))


EFFECTS: dict[str, Callable[[Sheet, float], Cut]] = {
    "time-lag": _between_frames,
    "exchange-motion": _harmonic,
    "antenna-delay": _feeders,
    "clock-offset": _crystals,
    "temperature-drift": _rime,
    "antenna-pattern": _cage,
    "power-bias": _gompertz,
    "timestamp-jitter": _two_waits,
    "path-loss": _mist,
    "range-scale": _oblique,
    "range-rounding": _carried,
    "material-delay": _barriers,
    "blocked-path": _off_the_boards,
    "ground-bounce": _ice,
    "diffraction": _strip,
    "level-control": _sigmoid,
    "noise-floor": _chiller,
    "visor-fogs": _fogged,
    "drier-cycles": _drier,
    "second-brine-pump": _brine,
    "spectators-rise": _spectators,
    "rime-on-trusses": _on_trusses,
    "floodlights-burn": _floodlights,
    "cell-sags-in-cold": _cells,
    "blades-lean": _lean,
    "coasts-on-speed": _coasts,
    "truss-rehung": _rehung,
    "trusses-swapped": _swapped,
    "counter-of-another-clock": _counter,
}
