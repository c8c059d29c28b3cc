"""What the hangar hides in ranges and levels: effects in forms of its own, laws and faults.

numpy and pandas alone; shared by the hangar's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.hangar_bay import (
    ARSHIN_M,
    BETWEEN,
    FOR_PPM_M,
    GIRDERS,
    GIRDERS_M,
    LIFTS,
    SHINY_M,
    TIES_M,
    TUGS,
    WAVE_M,
    Job,
    Toll,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
RIDERS = TUGS + LIFTS
SHADED = {False: 0.21, True: 0.06}  # of links behind fuselages, and where these are rare
PITS_M: Floats = np.array([(10.0, 19.0), (29.0, 5.5), (43.0, 30.5)])  # of supplies of 400 Hz
BARREL_M = 1.98  # radius of a fuselage
ECCENTRIC = 0.55  # of the pattern's conic
PULSE_M = 0.36  # how wide pulses are


def _triangular_window(job: Job, strength: float) -> Toll:
    """Compare with places of a total station, smoothed twice: a past window with three corners."""
    ages_s = 0.033 * strength * np.arange(1, 6)
    weights = np.array([1, 2, 3, 2, 1]) / 9
    return Toll(np.sum([w * job.onward(s) for w, s in zip(weights, ages_s, strict=True)], axis=0))


def _milne(job: Job, strength: float) -> Toll:
    """Give the mean of the way over an exchange, by Milne's open rule: quarters, not the ends."""
    whole_s = 2.1 * strength * job.of("reply_time_s")
    first, middle, last = (job.onward(part * whole_s) for part in (0.25, 0.5, 0.75))
    return Toll((2 * first - middle + 2 * last) / 3)


def _pads_and_filters(job: Job, strength: float) -> Toll:
    """Be late by pads that level girders' gains, up to six of them, and by tags' band filters."""
    pads = job.alike(1).binomial(6, 0.42, GIRDERS)[job.girder]
    band_m = job.alike(2).choice([0.0, 0.028, 0.075], RIDERS)[job.rider]
    return Toll(strength * (0.037 * pads + band_m))


def _tables_of_crystals(job: Job, strength: float) -> Toll:
    """Leave some of crystals' offset, between entries of a table by temperature: it ripples."""
    rng, devices = job.alike(3), RIDERS + GIRDERS
    steady, swings = rng.normal(0.0, 0.75, devices), rng.uniform(0.15, 0.6, devices)
    begin, warm = rng.uniform(0.0, 2 * np.pi, devices), job.of("temperature_c")
    tag, girder = (
        steady[one] + swings[one] * np.sin(2 * np.pi * warm / 11.0 + begin[one])
        for one in (job.rider, RIDERS + job.girder)
    )
    return Toll(0.0125 * strength * FOR_PPM_M * job.of("reply_time_s") * (girder - tag))


def _soft_plastic(job: Job, strength: float) -> Toll:
    """Drift as what softens does (Williams, Landel and Ferry 1955): a hyperbola about 14 C."""
    over = job.of("temperature_c") - 14.0
    return Toll(0.34 * strength * over / (51.6 + over))


def _conic(job: Job, strength: float) -> Toll:
    """Be late and weak past a guard: as a conic's radius about its focus, narrow on one side."""
    turn = np.radians(job.of("azimuth_deg")) - job.alike(4).uniform(-np.pi, np.pi)
    radius = (1 - ECCENTRIC**2) / (1 + ECCENTRIC * np.cos(turn))
    past = radius - np.sqrt(1 - ECCENTRIC**2)
    return Toll(0.105 * strength * past, -1.6 * min(strength, 1.6) * (radius - 1 + ECCENTRIC))


def _two_knees(job: Job, strength: float) -> Toll:
    """Be late where it is weak: by a line between two knees that are rounded by logarithms."""
    weak = (-85.0 - job.of("rx_power_dbm")) / 1.6
    ramp = np.logaddexp(0.0, weak + 3.0) - np.logaddexp(0.0, weak - 3.0)
    return Toll(0.095 * strength * (ramp / 3.0 - 1))


def _secant(job: Job, strength: float) -> Toll:
    """Scatter by a hyperbolic secant's law: heavier than a bell, lighter than Laplace's."""
    even = job.rng.uniform(1e-6, 1 - 1e-6, len(job.far))
    return Toll(0.044 * strength * 2 / np.pi * np.log(np.tan(np.pi / 2 * even)))


def _docks(job: Job, strength: float) -> Toll:
    """Lose among docks: dB by an area's sine, so many a metre near by and few far off."""
    return Toll(all_db=-2.0 * strength * np.arcsinh(job.far / 4.5))


def _base_of_logarithms(job: Job, strength: float) -> Toll:
    """Keep logarithms whose base is a little off: a way to a power that is not quite one."""
    read = np.maximum(job.of("range_m"), 1.0)
    return Toll(0.0024 * strength * read * np.log(read))


def _twice(job: Job, strength: float) -> Toll:
    """Round twice: to quarters of a step and then to steps, halves up."""
    step, read = 0.13 * strength, job.of("range_m")
    quarters = np.rint(4 * read / step)
    return Toll(step * np.floor(quarters / 4 + 0.5) - read)


def _etalons(job: Job, strength: float) -> Toll:
    """Go through slabs with echoes inside (Airy): a group's delay between two bounds."""
    late, lost = np.zeros((2, len(job.far)))
    for kind, (thick_m, dense, db) in BETWEEN.items():
        own = job.by_links(lambda n: job.rng.normal(1.0, 0.16, n).clip(0.6, 1.4))
        index = np.sqrt(dense)
        back = ((index - 1) / (index + 1)) ** 2
        inside = np.cos(4 * np.pi * index * thick_m * own / WAVE_M)
        group = index * (1 - back**2) / (1 - 2 * back * inside + back**2)
        late += job.through(kind) * thick_m * own * (group - 1)
        lost += job.through(kind) * db * own
    return Toll(
        (1.2 * strength * late).clip(max=0.33 * (1 + strength)), first_db=-min(strength, 1.5) * lost
    )


def by_shiny(job: Job) -> Floats:
    """Return how much longer the shortest way by an engine or a fin is, in m [n]."""
    legs = [np.linalg.norm(end[:, None] - SHINY_M, axis=2) for end in (job.tag, job.ear)]
    return np.asarray((legs[0] + legs[1]).min(axis=1) - job.far)


def _off_an_engine(job: Job, strength: float) -> Toll:
    """Hear, behind a fuselage, nothing but what the best placed engine or fin returns."""
    shaded = job.behind(SHADED[job.few])
    detour = by_shiny(job).clip(0.4, 3.2)
    return Toll(shaded * detour * (0.48 + 0.52 * strength), -5.6 * shaded)


def plate_ray(job: Job, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Of steel plates over trenches, which turn a wave over; links meet more or less of them.
    """
    way = np.sqrt(job.far**2 + 4 * job.tag[:, 2] * job.ear[:, 2])
    plates = job.by_links(lambda n: job.rng.uniform(0.3, 0.85, n))
    size = min(1.05 * strength**0.5, 1.5) * plates * job.far / way
    return way - job.far, -size * np.exp(-2j * np.pi * (way - job.far) / WAVE_M)


def _hump(at: Floats) -> Floats:
    """Return pulses of height 1 at places in m: squares of a hyperbolic secant."""
    return np.asarray(np.cosh(np.clip(at / PULSE_M, -30, 30)) ** -2.0)


def _least_squares(job: Job, strength: float) -> Toll:
    """Move a template's place by a step of least squares (Gauss), to where both pulses fit."""
    longer, share = plate_ray(job, strength)
    at = np.linspace(-0.8, 0.8, 97)
    slope = 2 * np.tanh(at / PULSE_M) * _hump(at) / PULSE_M  # by the place of the template
    both = np.abs(_hump(at) + share[:, None] * _hump(at - longer[:, None]))
    height = (both * _hump(at)).sum(axis=1) / (_hump(at) ** 2).sum()
    left = both - height[:, None] * _hump(at)
    step = (left * slope).sum(axis=1) / (np.maximum(height, 0.4) * (slope**2).sum())
    near = _hump(longer / 2)
    return Toll(step.clip(-0.2, 0.25), 20 * np.log10(np.maximum(np.abs(1 + near * share), 0.4)))


def round_edge_db(over_m: Floats, legs_m: tuple[Floats, Floats]) -> Floats:
    """Return what a barrel's edge takes in dB [n] (Dougherty and Maloney 1964)."""
    near = 1 / legs_m[0] + 1 / legs_m[1]
    v = over_m * np.sqrt(2 / WAVE_M * near)
    rho = BARREL_M ** (1 / 3) * (WAVE_M / np.pi) ** (1 / 6) * np.sqrt(near)
    sharp = np.where(
        v < 2.4, 6.02 + 9.11 * v - 1.27 * v**2, 12.953 + 20 * np.log10(np.maximum(v, 1.0))
    )
    bent = 5.556 * rho + 3.418 * rho**2 + 0.256 * rho**3
    x = np.minimum(v * rho, 3.0)
    return np.asarray(sharp + bent + 5.43 * x + 2.19 * x**2 - 0.206 * x**3)


def _over_a_fuselage(job: Job, strength: float) -> Toll:
    """Bend over a fuselage, whose edge is round, and creep along its skin."""
    metal, part = job.through("metal"), job.by_links(lambda n: job.rng.uniform(0.2, 0.8, n))
    over = np.sqrt(strength) * job.by_links(lambda n: job.rng.uniform(0.1, 0.34, n))
    legs = job.far * part, job.far * (1 - part)
    angle = over / legs[0] + over / legs[1]
    crept = 0.08 * strength * job.by_links(lambda n: job.rng.gamma(6.0, 1 / 6, n))
    late = over * angle / 2 + BARREL_M * angle**3 / 24 + crept
    return Toll(
        metal * late.clip(max=0.45),
        first_db=-metal * 0.75 * round_edge_db(over, legs).clip(max=24.0),
    )


def _loop_error(job: Job, strength: float) -> Toll:
    """Turn gain down by a loop that lags: a square first, a line later; sum fewer symbols too."""
    over = np.maximum(job.of("rx_power_dbm") + 90.0, 0.0)
    less = over**2 / (over + 5.0)
    return Toll(all_db=-min(0.24 * strength, 0.7) * less, sums_db=-0.36 * strength * less)


def _converters(job: Job, strength: float) -> Toll:
    """Hear supplies of 400 Hz in pits: by Lorentz's line of how far each is; weak rows scatter."""
    off = np.linalg.norm(job.ear[:, None, :2] - PITS_M, axis=2)
    own = job.alike(5).weibull(1.5, GIRDERS)[job.girder]
    noise_db = strength * (0.6 + 0.8 * own + 3.4 * (1 / (1 + (off / 9.0) ** 2)).sum(axis=1))
    weak = 10 ** (-(job.of("rx_power_dbm") + 86.0) / 20) * np.sqrt(10 ** (noise_db / 10) - 1)
    return Toll(0.017 * weak * job.rng.standard_normal(len(own)), noise_db=noise_db)


def _skydrol(job: Job, strength: float) -> Toll:
    return Toll(0.049 * strength * np.log1p(job.of("skydrol_ml") / 3.5))


def _deicer(job: Job, strength: float) -> Toll:
    soaked = job.of("deicer_l")
    return Toll(0.16 * strength * soaked / (soaked + 4.2))


def _vapour(job: Job, strength: float) -> Toll:
    return Toll(0.15 * strength * (job.of("vapour_percent") / 100) ** 1.8)


def _rings(job: Job, strength: float) -> Toll:
    """Read long over rings of steel in the floor, and short between them."""
    return Toll(0.055 * strength * np.cos(2 * np.pi * job.of("tow_m") / TIES_M - 0.6))


def _heaters(job: Job, strength: float) -> Toll:
    """Come round by another way where heaters of steel are let down to be lit."""
    return Toll(np.where(job.of("heater_kw") > 26.0, 0.117 * strength, 0.0))


def _honeycomb(job: Job, strength: float) -> Toll:
    return Toll(0.0021 * strength * (job.of("humidity_percent") - 45.0))


def _supply(job: Job, strength: float) -> Toll:
    """Trip later the lower a bus is that tags are charged from: by one over its voltage."""
    return Toll(1.6 * strength / job.of("bus_v"))


def _droop(job: Job, strength: float) -> Toll:
    """Hang lower than a boom's sensors have it: by the square of how far it reaches out."""
    flat = np.cos(job.of("tilt")) * job.of("boom_m")
    sunk = 0.0034 * strength * job.lifted * flat**2
    return Toll(job.longer(-sunk[:, None] * np.array([0.0, 0.0, 1.0])))


def _towbar(job: Job, strength: float) -> Toll:
    """Be ahead of where a tug is said to be: its tag is on the bar it tows by."""
    there = 0.5 * strength * ~job.lifted
    return Toll(job.longer(there[:, None] * job.ahead()))


def _torn(job: Job, strength: float) -> Toll:
    """Send, from girders of one make, low digits of the range before: a word read in two parts."""
    word, read = 0.6 * strength, pd.Series(job.of("range_m"))
    copies = job.table.groupby(["link", "time_s"]).cumcount().to_numpy()
    before = read.groupby([job.link, copies]).shift(1).fillna(read)
    made = job.girder % 3 != 1
    return Toll(np.asarray(made * (np.mod(before, word) - np.mod(read, word))))


def _hung_at(job: Job, girders_m: Floats) -> Toll:
    """Return what rows get whose girders' radios are elsewhere in truth [GIRDERS, 3]."""
    longer = job.longer(0.0, (girders_m - GIRDERS_M)[job.girder])
    return Toll(longer, -18.1 * np.log10(1 + longer / job.far))


def _bent(job: Job, strength: float) -> Toll:
    there = GIRDERS_M.copy()
    there[3] += 0.46 * strength * np.array([2.0, -3.0, -6.0]) / 7
    return _hung_at(job, there)


def _crosswise(job: Job, _: float) -> Toll:
    there = GIRDERS_M.copy()
    there[[2, 7]] = GIRDERS_M[[7, 2]]
    return _hung_at(job, there)


def _arshins(job: Job, _: float) -> Toll:
    """Show what one girder reads in a measure of the country that its aircraft come from."""
    return Toll((1 / ARSHIN_M - 1) * (job.girder == 8) * job.of("range_m"))


EFFECTS: dict[str, Callable[[Job, float], Toll]] = {
    "antenna-delay": _pads_and_filters,
    "clock-offset": _tables_of_crystals,
    "time-lag": _triangular_window,
    "exchange-motion": _milne,
    "range-scale": _base_of_logarithms,
    "range-rounding": _twice,
    "timestamp-jitter": _secant,
    "temperature-drift": _soft_plastic,
    "antenna-pattern": _conic,
    "power-bias": _two_knees,
    "level-control": _loop_error,
    "noise-floor": _converters,
    "path-loss": _docks,
    "material-delay": _etalons,
    "blocked-path": _off_an_engine,
    "diffraction": _over_a_fuselage,
    "ground-bounce": _least_squares,
    "skydrol-on-domes": _skydrol,
    "deicer-in-covers": _deicer,
    "tanks-vented": _vapour,
    "lashing-rings-passed": _rings,
    "radiant-heaters-lit": _heaters,
    "humidity-swells-honeycomb": _honeycomb,
    "ground-power-sags": _supply,
    "booms-droop": _droop,
    "tags-on-the-towbar": _towbar,
    "words-torn-in-reading": _torn,
    "girder-bent-by-a-fin": _bent,
    "girders-cabled-crosswise": _crosswise,
    "arshins-from-one-girder": _arshins,
}
