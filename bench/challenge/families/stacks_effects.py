"""What the archive hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the archive's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.stacks_plan import (
    CARRIAGE_M,
    CARRIER_GHZ,
    CARTS,
    CORRIDOR_M,
    HALF_LIGHT,
    LIGHT,
    READERS_M,
    ROOM_M,
    SLABS,
    Entry,
    Files,
)

Floats = NDArray[np.float64]
CARRIER_M = LIGHT / CARRIER_GHZ
LINOLEUM = 3.3 - 0.3j  # permittivity of what lies on the floor
TURNS = np.linspace(0, 12, 6001)  # of a knife edge's parameter


def _filtered_truth(files: Files, strength: float) -> Entry:
    """Compare with a camera's track, which a filter draws from two frames, one of them old."""
    return Entry(0.65 * files.later(0.1 * strength) + 0.35 * files.later(0.32 * strength))


def _meanwhile(files: Files, strength: float) -> Entry:
    """Measure the mean of the way while messages come and go: Gauss's two places."""
    whole = 1.6 * min(strength, 2.0) * files["reply_time_s"]
    early, late = (files.later(whole * (1 + s / np.sqrt(3)) / 2) for s in (-1, 1))
    return Entry((early + late) / 2)


def _never_set(files: Files, strength: float) -> Entry:
    """Readers set in the works but for two; carts of which each has its own."""
    rng = files.bound(1)
    readers = 0.015 * rng.random(len(READERS_M)) + 0.13 * (rng.permutation(len(READERS_M)) < 2)
    carts = np.sort(rng.uniform(0.0, 0.12, CARTS))
    return Entry(strength * (readers[files.reader()] + carts[files.cart()]))


def _uneven_crystals(files: Files, strength: float) -> Entry:
    """Leave some of a crystal's offset in an answer: the part by which loads pull it."""
    rng = files.bound(2)
    ppm = rng.laplace(0, 1.2, CARTS)[files.cart()] + rng.logistic(0, 0.8, 7)[files.reader()]
    return Entry(HALF_LIGHT * 0.014 * strength * ppm * files["reply_time_s"])


def _leaks(files: Files, strength: float) -> Entry:
    """Drift as leakage does, which doubles with every so many degrees."""
    return Entry(0.09 * strength * (np.exp2((files["temperature_c"] - 20.0) / 9.0) - 1))


def _notch(files: Files, strength: float) -> Entry:
    """Be late and weak in one direction alone, where whoever pushes stands: von Mises' bell."""
    turn = np.radians(files["azimuth_deg"]) - files.bound(3).uniform(0, 2 * np.pi)
    bell = np.exp(2.2 * (np.cos(turn) - 1))
    return Entry(0.19 * strength * (bell - 0.2), whole=-3.3 * min(strength, 1.6) * bell)


def _comparator(files: Files, strength: float) -> Entry:
    """Compare later what is weak: by an arc's tangent of the level."""
    weak = np.arctan((-82.0 - files["rx_power_dbm"]) / 5.0)
    return Entry(strength * (0.058 * weak - 0.01))


def _by_reader(files: Files, strength: float) -> Entry:
    """Time with a noise that is some readers' more than others'."""
    size = files.bound(4).uniform(0.7, 1.3, len(READERS_M))[files.reader()]
    return Entry(0.04 * strength * size * files.rng.standard_normal(len(files)))


def _books(files: Files, strength: float) -> Entry:
    """Lose what books take, until what goes above them is all that is left."""
    return Entry(0 * files.far(), whole=8.5 * strength * np.expm1(-files.far() / 12.0))


def _slow_light(files: Files, strength: float) -> Entry:
    """Multiply by a speed of light with a mistyped digit, after a constant was taken away."""
    return Entry(0.0054 * strength * np.maximum(files["range_m"] - 0.3, 0.0))


def _middles(files: Files, strength: float) -> Entry:
    """Write down the middle of the step that a range is in."""
    step, written = 0.17 * strength, files["range_m"]
    return Entry((np.floor(written / step) + 0.5) * step - written)


def _shelves(files: Files, strength: float) -> Entry:
    """Go through slabs that stand across the length of the room."""
    across = np.abs(files["rx_x_m"] - files["tx_x_m"]) / files.far()
    sine = 1 - np.square(np.maximum(across, 0.55))
    late, lost = 0 * sine, 0 * sine
    for kind, (thick, permittivity, db) in SLABS.items():
        full = files.crosses(kind) * files.linkwise(lambda n: files.rng.normal(1.0, 0.15, n))
        late = late + full * thick * (np.sqrt(permittivity - sine) - np.sqrt(1 - sine))
        lost = lost + full * db
    return Entry(1.5 * strength * late, edge=-min(strength, 1.5) * lost)


def _by_the_corridor(files: Files, strength: float) -> Entry:
    """Hear, where shelves are shut, only what goes by the corridor and turns there once."""
    shut = files.linkwise(lambda n: 1.0 * (files.rng.random(n) < (0.055 if files.seldom else 0.17)))
    here, there = files.walkers(), files.hung()
    corner = np.stack([here[:, 0], 0 * here[:, 0] + CORRIDOR_M, here[:, 2]], axis=1)
    legs = np.linalg.norm(here - corner, axis=1) + np.linalg.norm(there - corner, axis=1)
    detour = np.clip(legs - files.far(), 0.35, 3.6)
    return Entry(shut * detour * (0.4 + 0.6 * strength), whole=-6.0 * shut)


def floor_ray(files: Files, strength: float) -> tuple[Floats, NDArray[np.complex128]]:
    """Return how much longer the way by the floor is in m, and what it brings, [n] each.

    Fresnel's coefficient of linoleum for a field that lies, with the turn of that way.
    """
    mirrored = files.walkers() * [1, 1, -1] - files.hung()
    way = np.sqrt(np.square(mirrored).sum(axis=1))
    sine = np.abs(mirrored[:, 2]) / way
    root = np.sqrt(LINOLEUM - 1 + sine**2)
    back = (sine - root) / (sine + root)
    seen = files.linkwise(lambda n: files.rng.uniform(0.7, 1.0, n))
    size = min(0.9 * strength**0.5, 1.2) * seen * files.far() / way
    longer = way - files.far()
    return longer, size * back * np.exp(-2j * np.pi * longer / CARRIER_M)


def _floor(files: Files, strength: float) -> Entry:
    """Cross a level sooner with a steeper edge: what the floor adds while it is crossed."""
    longer, ray = floor_ray(files, strength)
    both = np.maximum(np.abs(1 + ray * np.exp(-np.square(longer / 0.95))), 0.35)
    return Entry(-0.17 * np.log(both), whole=20 * np.log10(both))


def fresnel_db(v: Floats) -> Floats:
    """Return what a knife's edge takes at parameters 0 to 12 in dB [n]: Fresnel's integrals."""
    wave = np.exp(-0.5j * np.pi * TURNS**2)
    steps = (wave[1:] + wave[:-1]) / 2 * np.diff(TURNS)
    rest = (0.5 - 0.5j) - np.concatenate([[0], np.cumsum(steps)])
    return np.asarray(-20 * np.log10(np.interp(v, TURNS, np.abs(rest) / np.sqrt(2))))


def _two_ends(files: Files, strength: float) -> Entry:
    """Bend round both ends of a steel cabinet, one after the other."""
    steel, far = files.crosses("metal"), files.far()
    high = strength**0.5 * files.linkwise(lambda n: files.rng.uniform(0.16, 0.42, n))
    begin = files.linkwise(lambda n: files.rng.uniform(0.15, 0.45, n)) * far
    wide = np.minimum(0.9, 0.3 * far)
    rest = np.maximum(far - begin - wide, 0.3)
    over = np.hypot(begin, high) - begin + np.hypot(rest, high) - rest
    lost = sum(
        fresnel_db(high * np.sqrt(2 * (leg + wide) / (CARRIER_M * leg * wide)) / 2)
        for leg in (begin, rest)
    )
    gap = 0.05 * strength * files.linkwise(lambda n: files.rng.uniform(0.8, 1.2, n))
    return Entry(steel * (over + gap), edge=-steel * np.minimum(0.6 * lost, 13.0))


def _squeezed(files: Files, strength: float) -> Entry:
    """Turn gain down by the square of how much there is too much, and add fewer symbols."""
    over = np.clip((files["rx_power_dbm"] + 91) / 10, 0, 2.2)
    return Entry(0 * over, whole=-0.9 * min(strength, 2.0) * over**2, count=-0.9 * strength * over)


def _dimmers(files: Files, strength: float) -> Entry:
    """Hear dimmers, which are along the long wall: those near it more, by the cube root."""
    near = np.cbrt(3.0 / (1.0 + READERS_M[:, 1]))[files.reader()]
    dimmed = files.bound(5).uniform(0.7, 1.3, CARTS)[files.cart()]
    hiss = 3.1 * strength * near * dimmed
    weak = 10 ** (-(files["rx_power_dbm"] + 87) / 20) * np.sqrt(np.expm1(0.2302585 * hiss))
    return Entry(0.02 * weak * files.rng.normal(size=len(files)), hiss=hiss)


def _swells(files: Files, strength: float) -> Entry:
    return Entry(2.5e-5 * strength * files["humidity_percent"] ** 2.1)


def _boxes(files: Files, strength: float) -> Entry:
    return Entry(0.24 * strength * files["boxes"] / (files["boxes"] + 21.0))


def _air(files: Files, strength: float) -> Entry:
    return Entry(0.085 * strength * np.cos(2 * np.pi * files["time_s"] / 790 + 0.4))


def _lights(files: Files, strength: float) -> Entry:
    return Entry(np.where(files["lux"] > 230.0, 0.13 * strength, 0.0))


def _dust(files: Files, strength: float) -> Entry:
    return Entry(0.066 * strength * np.log1p(files["days_undusted"] / 2.5))


def _rails(files: Files, strength: float) -> Entry:
    return Entry(0.0072 * strength * files["tonnes"])


def _at(files: Files, readers: Floats) -> Entry:
    """Return what is entered where readers truly are at [7, 3]."""
    truly = np.linalg.norm(files.walkers() - readers[files.reader()], axis=1)
    return Entry(truly - files.far(), whole=19 * np.log10(files.far() / truly))


def _sags(files: Files, strength: float) -> Entry:
    """Hang from a ceiling that sags toward its middle by decimetres."""
    sag = np.sin(np.pi * READERS_M[:, 0] / ROOM_M[0]) * (READERS_M[:, 2] > 2.4)
    return _at(files, READERS_M - 0.6 * strength * sag[:, None] * [0, 0, 1])


def _moved(files: Files, strength: float) -> Entry:
    """Cross, in the second half of the day, carriages that somebody moved where an aisle was."""
    rng = files.bound(6)
    middle, since = rng.uniform(9, 18), rng.uniform(0.35, 0.65) * 8 * 3600
    ends = files["tx_x_m"] - middle, files["rx_x_m"] - middle
    through = (ends[0] * ends[1] < 0) & (files["time_s"] > since)
    thick = CARRIAGE_M * np.hypot(1, (files["tx_y_m"] - files["rx_y_m"]) / files.far())
    lost = np.where(through, -2.2 * min(strength, 2.0), 0.0)
    return Entry(0.26 * strength * through * thick, whole=lost)


def _steps(files: Files, strength: float) -> Entry:
    """Range with readers two of which had their clocks set anew, each at its own moment."""
    rng = files.bound(7)
    struck = rng.permutation(len(READERS_M))[:2]
    size = np.zeros(len(READERS_M))
    size[struck] = strength * np.array([0.31, -0.24])
    moment = rng.uniform(0.25, 0.75, len(READERS_M)) * 8 * 3600
    return Entry(np.where(files["time_s"] > moment[files.reader()], size[files.reader()], 0.0))


def _slid(files: Files, strength: float) -> Entry:
    there = READERS_M.copy()
    there[3] += strength * np.array([-0.26, -0.21, -0.406])
    return _at(files, there)


def _interchanged(files: Files, _: float) -> Entry:
    return _at(files, READERS_M[[4, 1, 2, 3, 0, 5, 6]])


def _half_metres(files: Files, _: float) -> Entry:
    return Entry(np.where(files.reader() == 1, files["range_m"], 0.0))


EFFECTS: dict[str, Callable[[Files, float], Entry]] = {
    "time-lag": _filtered_truth,
    "exchange-motion": _meanwhile,
    "antenna-delay": _never_set,
    "clock-offset": _uneven_crystals,
    "temperature-drift": _leaks,
    "antenna-pattern": _notch,
    "power-bias": _comparator,
    "timestamp-jitter": _by_reader,
    "path-loss": _books,
    "range-scale": _slow_light,
    "range-rounding": _middles,
    "material-delay": _shelves,
    "blocked-path": _by_the_corridor,
    "ground-bounce": _floor,
    "diffraction": _two_ends,
    "level-control": _squeezed,
    "noise-floor": _dimmers,
    "paper-swells": _swells,
    "boxes-returned": _boxes,
    "air-handler": _air,
    "reading-lights": _lights,
    "dust-settles": _dust,
    "rails-laden": _rails,
    "ceiling-sags": _sags,
    "carriage-moved": _moved,
    "clocks-step": _steps,
    "reader-slid-down": _slid,
    "readers-interchanged": _interchanged,
    "half-metres-from-one-reader": _half_metres,
}
