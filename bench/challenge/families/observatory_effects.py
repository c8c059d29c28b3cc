"""What the observatory hides in ranges and levels: effects in forms of their own.

numpy alone; shared by the observatory's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.observatory_faults import UNLISTED
from bench.challenge.families.observatory_hall import (
    PER_PPM_M,
    SCONCES,
    SCONCES_M,
    TAGS,
    WAVE_M,
    Exposure,
    Toll,
)
from bench.challenge.families.observatory_plate import FINE, METRES, heights, moffat, vertex

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
UNSEEN = {False: 0.2, True: 0.075}  # of links, and where these are rare
POLE_S = 0.053  # of each of two lags that follow each other
TWO_POLES = ((3 - np.sqrt(3), (3 + np.sqrt(3)) / 6), (3 + np.sqrt(3), (3 - np.sqrt(3)) / 6))
"""Two ages, in lags, and their weights, by which a cubic is weighed as by two lags (Gauss)."""
MESSAGES = 4.3  # replies that an exchange lasts
CHEBYSHEV: Floats = 0.5 + 0.5 * np.array([-0.794654, -0.187592, 0.187592, 0.794654])
"""Four places of an exchange whose plain mean is that of a cubic over it."""
BLOCH_M, READ_K = 0.98, 291.0  # by which ferrites drift; at which these were calibrated
LOBE = 3.2  # how narrow beams of shade are
TURNS_DBM, BENDS_DB, KNEE = -78.5, 8.5, 3.0  # of biases: where none; how soon and how they end
MARKS_M = 0.16  # from mark to mark of dials
PAPER, PRESSED = 0.86, 0.78  # refraction of paper less 1 by g/cm3; of books, g/cm3
HOOPS_M: Floats = np.array([(15.0, 11.0, 9.3, 7.6), (15.0, 11.0, 7.4, 8.6)])
"""The dome's curb, and a gallery below it, of iron: middles, and how wide in half."""
DRIVE_M: Floats = np.array([15.0, 18.6, 9.1])  # of the dome
FULL_A, STEINMETZ = 58.0, 1.6  # of that; power by which iron hums
FLOOR, LAID_M = 5.6 - 0.35j, 0.0035  # permittivity of terrazzo; how even it is


def _two_lags(shot: Exposure, strength: float) -> Toll:
    """Compare with places that have come through two lags, one after the other."""
    ways = [by * shot.recedes_in(POLE_S * strength * age) for age, by in TWO_POLES]
    return Toll(np.sum(ways, axis=0))


def _chebyshev(shot: Exposure, strength: float) -> Toll:
    """Give the mean of the way over an exchange, by Chebyshev's rule of equal weights (1874)."""
    whole_s = MESSAGES * strength * shot["reply_time_s"]
    return Toll(np.mean([shot.recedes_in(whole_s * part) for part in CHEBYSHEV], axis=0))


def _adapters(shot: Exposure, strength: float) -> Toll:
    """Be late by so many adapters at sconces, and by how thick tags are cast."""
    drawn = shot.alike(1)
    adapters = drawn.hypergeometric(6, 6, 6, SCONCES)[shot.sconce]
    cast = drawn.gamma(2.2, 0.03, len(TAGS)).clip(max=0.2)[shot.tag]
    return Toll(strength * (0.024 * adapters + cast))


def _cut(shot: Exposure, strength: float) -> Toll:
    """Leave some of crystals' offset: of tags', by warmth as AT cuts have it, a line and a cube."""
    drawn = shot.alike(2)
    sconces = drawn.normal(0.0, 0.45, SCONCES).clip(-1.1, 1.1)[shot.sconce]
    begun, slope = drawn.uniform((-1.2, -0.7), (1.2, 0.7), (len(TAGS), 2))[shot.tag].T
    warm = (shot["temperature_c"] - 25.0) / 20.0
    ppm = 0.022 * strength * (begun + slope * warm + 0.35 * warm**3 - sconces)
    return Toll(PER_PPM_M * ppm * shot["reply_time_s"])


def _bloch(shot: Exposure, strength: float) -> Toll:
    """Drift as ferrites are magnetised less with warmth: by a power of 3 / 2 (Bloch 1930)."""
    part = (shot["temperature_c"] + 273.15) / READ_K
    return Toll(BLOCH_M * strength * (part**1.5 - 1))


def _two_lobes(shot: Exposure, strength: float) -> Toll:
    """Be late and weak behind two struts, of which one is thinner: by bells round a circle."""
    at = np.radians(shot["azimuth_deg"]) - shot.alike(3).uniform(0.0, 2 * np.pi)
    shade = sum(
        by * np.exp(LOBE * (np.cos(at - where) - 1)) for by, where in ((1.0, 0.0), (0.6, 2.5))
    )
    mean = 1.6 * float(np.i0(LOBE)) * np.exp(-LOBE)
    return Toll(0.16 * strength * (shade - mean), first_db=-4.8 * min(strength, 1.5) * shade)


def _knee(shot: Exposure, strength: float) -> Toll:
    """Be early where it is loud and late where it is weak: by a line that bends at both ends."""
    weak = (TURNS_DBM - shot["rx_power_dbm"]) / BENDS_DB
    return Toll(0.104 * strength * weak * (1 + np.abs(weak) ** KNEE) ** (-1 / KNEE))


def _secant(shot: Exposure, strength: float) -> Toll:
    """Scatter by a law whose density is a hyperbolic secant: a bell with heavier ends."""
    even = shot.rng.uniform(0.003, 0.997, shot.rows)
    return Toll(0.046 * strength * np.log(np.tan(0.5 * np.pi * even)) * 2 / np.pi)


def _crowded(shot: Exposure, strength: float) -> Toll:
    """Lose among what stands about: by a line at first, later by a logarithm; links unlike."""
    amid = shot.per_link(lambda n: shot.rng.beta(3.0, 3.0, n)) + 0.5
    return Toll(all_db=-2.8 * strength * amid * np.arcsinh(shot.far / 7.0))


def _wheels(shot: Exposure, strength: float) -> Toll:
    """Count by sconces' wheels, all of which have too many teeth, and some have more."""
    slow = 0.0042 + 0.0042 * shot.alike(5).beta(0.8, 0.8, SCONCES)
    return Toll(strength * slow[shot.sconce] * shot.far)


def _dials(shot: Exposure, strength: float) -> Toll:
    """Write the nearest mark of a dial, whose marks begin elsewhere at each sconce."""
    step = MARKS_M * strength
    begin = step * shot.alike(6).random(SCONCES)[shot.sconce]
    told = shot["range_m"]
    return Toll(begin + step * np.rint((told - begin) / step) - told)


def chord_m(half_m: Floats, aside: Floats) -> Floats:
    """Return how long ways are within round columns, `aside` of whose halves they pass [n]."""
    return np.asarray(2 * half_m * np.sqrt((1 - aside**2).clip(0.0)))


def through_square_m(side_m: Floats, turned: Floats) -> Floats:
    """Return how long ways through square piers' middles are that are turned so, in m [n]."""
    return np.asarray(side_m / np.maximum(np.abs(np.cos(turned)), np.abs(np.sin(turned))))


def _through(shot: Exposure, strength: float) -> Toll:
    """Go through books by their density, round columns, panes of cases, and square piers."""
    drawn, link = shot.rng, shot.per_link
    deep = link(lambda n: drawn.gamma(6.0, 0.035, n).clip(0.05, 0.45))
    books = PAPER * link(lambda n: drawn.normal(PRESSED, 0.1, n).clip(0.4, 1.1))
    column = chord_m(link(lambda n: drawn.uniform(0.09, 0.15, n)), link(lambda n: drawn.random(n)))
    panes = 0.006 * link(lambda n: drawn.integers(2, 7, n))
    pier = through_square_m(link(lambda n: drawn.choice([0.12, 0.25], n)),
                            link(lambda n: drawn.uniform(0.0, np.pi, n)))  # fmt: skip
    things: dict[str, tuple[Floats, Floats]] = {
        "wood": (deep * books, 0.9 + 11.0 * deep),
        "marble": (column * (np.sqrt(7.074) - 1), 1.2 + 14.0 * column),
        "glass": (panes * (np.sqrt(6.31) - 1), 1.1 + 30.0 * panes),
        "brick": (pier * (np.sqrt(3.91) - 1), 1.0 + 16.0 * pier),
    }
    late = np.sum([shot.behind(what) * one[0] for what, one in things.items()], axis=0)
    lost = np.sum([shot.behind(what) * one[1] for what, one in things.items()], axis=0)
    return Toll(strength * late.clip(max=0.62), first_db=-min(strength, 1.5) * lost)


def by_hoops(shot: Exposure) -> Floats:
    """Return how much longer ways by hoops of iron are, wherever on these is soonest, in m [n]."""
    angle = np.linspace(0.0, 2 * np.pi, 72, endpoint=False)
    circle = np.column_stack([np.cos(angle), np.sin(angle), 0 * angle])
    rims = np.concatenate([one[:3] + one[3] * circle for one in HOOPS_M])
    legs = [np.linalg.norm(one[:, None] - rims, axis=2) for one in (shot.inner, shot.outer)]
    longer = legs[0] + legs[1] - shot.far[:, None]
    return np.asarray(np.where(longer > 0.46, longer, np.inf).min(axis=1))


def _off_hoops(shot: Exposure, strength: float) -> Toll:
    """Hear, out of sight, nothing but what the best placed hoop of iron returns."""
    hidden = shot.cut_off(UNSEEN[shot.rare])
    late = by_hoops(shot).clip(max=4.8) * (0.4 + 0.6 * strength)
    return Toll(hidden * late, -1.4 * hidden, -4.4 * hidden)


def even_enough(down: Floats, laid_m: Floats) -> Floats:
    """Return what a floor that is laid so unevenly returns still (Miller and others 1984) [n]."""
    spread = 2 * (2 * np.pi / WAVE_M * laid_m * down) ** 2
    return np.asarray(np.exp(-spread) * np.i0(spread))


def off_the_floor(shot: Exposure, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    What is level is returned as (1 - x) / (1 + x), which is exp(-2 artanh x).
    """
    up = shot.inner[:, 2] + shot.outer[:, 2]
    way = np.hypot(up, np.linalg.norm((shot.outer - shot.inner)[:, :2], axis=1))
    down = up / way
    back = -np.exp(-2 * np.arctanh(down / np.sqrt(FLOOR - 1 + down**2)))
    laid = shot.per_link(lambda n: shot.rng.gamma(4.0, LAID_M / 4, n))
    open_ = shot.per_link(lambda n: shot.rng.beta(4.0, 1.2, n))
    share = 1.5 * np.sqrt(strength) * open_ * even_enough(down, laid) * back * shot.far / way
    share = share * np.exp(-2j * np.pi * (way - shot.far) / WAVE_M)
    return way - shot.far, share / np.maximum(np.abs(share) / 0.84, 1.0)


def _both_fit(shot: Exposure, strength: float) -> Toll:
    """Be where a pulse fits both first: that of the floor comes later."""
    longer, share = off_the_floor(shot, strength)
    at = np.arange(-10.0, 10.0, 1 / FINE)
    both = np.abs(moffat(at) + share[:, None] * moffat(at - longer[:, None] / METRES))
    fits = heights(both)
    tops = (fits[:, 1:-1] > fits[:, :-2]) & (fits[:, 1:-1] >= fits[:, 2:])
    tops &= fits[:, 1:-1] > 0.3 * fits.max(axis=1, keepdims=True)
    late = METRES * (at[0] + vertex(fits, tops.argmax(axis=1) + 1) / FINE)
    added = np.abs(1 + share * moffat(longer / METRES)).clip(min=0.42)
    return Toll(1.3 * late.clip(-0.2, 0.24), 20 * np.log10(added))


def cornu(at: Floats) -> Complexes:
    """Return Fresnel's C + iS from 0 to places of any sign [n], within 0.002 (Heald 1985)."""
    out = np.abs(at)
    f = (1 + 0.926 * out) / (2 + 1.792 * out + 3.104 * out**2)
    g = 1 / (2 + 4.142 * out + 3.492 * out**2 + 6.670 * out**3)
    left = (g + 1j * f) * np.exp(0.5j * np.pi * out**2)
    return np.asarray(np.sign(at) * ((1 + 1j) / 2 - left))


def past_a_stand(low: Floats, high: Floats) -> Floats:
    """Return what a stand from `low` to `high`, in Fresnel's parameter, takes in dB [n].

    What passes on both sides is all but what would pass where it stands (Babinet).
    """
    left = np.abs(1 - (cornu(high) - cornu(low)) / (1 + 1j))
    return np.asarray(-20 * np.log10(left.clip(min=1e-3)))


def _past_iron(shot: Exposure, strength: float) -> Toll:
    """Bend past both sides of an iron stand, and run along its flanges."""
    iron, drawn, link = shot.behind("metal"), shot.rng, shot.per_link
    half = np.sqrt(strength) * link(lambda n: drawn.uniform(0.18, 0.42, n))
    aside = half * link(lambda n: drawn.uniform(-0.6, 0.6, n))
    legs = [shot.far * one for one in (lambda cut: (cut, 1 - cut))(
        link(lambda n: drawn.uniform(0.25, 0.75, n)))]  # fmt: skip
    over = np.sqrt(2 * shot.far / (WAVE_M * legs[0] * legs[1]))
    lost = past_a_stand((aside - half) * over, (aside + half) * over)
    side = half - np.abs(aside)
    detour = np.hypot(side, legs[0]) + np.hypot(side, legs[1]) - shot.far
    runs = strength * link(lambda n: drawn.uniform(0.05, 0.13, n))
    return Toll(iron * (detour + runs).clip(0.0, 0.46), first_db=-iron * lost.clip(1.0, 17.0))


def _root(shot: Exposure, strength: float) -> Toll:
    """Turn gain down past a level by a hyperbola; count the fewer symbols."""
    over = shot["rx_power_dbm"] + 84.0
    less = 0.16 * min(strength, 2.2) * (over + np.hypot(over, 6.0))
    return Toll(all_db=-less, count_db=-1.15 * less)


def _drive(shot: Exposure, strength: float) -> Toll:
    """Hear the dome's drive, the more the nearer: as iron hums, by a power of what it draws."""
    own = shot.alike(4).uniform(0.4, 1.5, SCONCES)[shot.sconce]
    apart = np.linalg.norm(SCONCES_M - DRIVE_M, axis=1)[shot.sconce]
    hums = (shot["dome_a"] / FULL_A) ** STEINMETZ
    db = strength * (own + 8.8 / (1 + (apart / 13.0) ** 2) * hums)
    weak = 10 ** ((-86.0 - shot["rx_power_dbm"]) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Toll(0.016 * weak.clip(max=8.0) * shot.rng.normal(size=shot.rows), noise_db=db)


EFFECTS: dict[str, Callable[[Exposure, float], Toll]] = {
    "antenna-delay": _adapters,
    "antenna-pattern": _two_lobes,
    "blocked-path": _off_hoops,
    "clock-offset": _cut,
    "diffraction": _past_iron,
    "exchange-motion": _chebyshev,
    "ground-bounce": _both_fit,
    "level-control": _root,
    "material-delay": _through,
    "noise-floor": _drive,
    "path-loss": _crowded,
    "power-bias": _knee,
    "range-rounding": _dials,
    "range-scale": _wheels,
    "temperature-drift": _bloch,
    "time-lag": _two_lags,
    "timestamp-jitter": _secant,
    **UNLISTED,
}
