"""What the crag hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the crag's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.crag_wall import (
    BETWEEN,
    BOLTS,
    BOLTS_M,
    BRACCIO_M,
    HALL_M,
    HARNESSES,
    HIP_M,
    OF_PPM_M,
    PANEL_M,
    ROUTES,
    WAVE_M,
    Ascent,
    Slip,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
CUT_OFF = {False: 0.2, True: 0.06}  # of links behind volumes, and where these are rare
BREAK_M = 3.0  # beyond, ways are lossier
MAT_DB, SLAB = 1.6, 5.24  # what a mat takes on both ways through it; permittivity below
PULSE_M = 0.42  # how wide pulses are


def _two_frames(ascent: Ascent, strength: float) -> Slip:
    """Compare with places from cameras: the mean of two frames, one thrice as old as the other."""
    age_s = strength * ascent.common(1).uniform(0.1, 0.13, HARNESSES)[ascent.harness]
    return Slip((ascent.lengthens(age_s) + ascent.lengthens(3 * age_s)) / 2)


def _three_messages(ascent: Ascent, strength: float) -> Slip:
    """Give the mean of ways at three messages, the second of which counts twice."""
    wait_s = 1.7 * strength * ascent.of("reply_time_s")
    return Slip(0.5 * ascent.lengthens(wait_s) + 0.25 * ascent.lengthens(2 * wait_s))


def _pigtails(ascent: Ascent, strength: float) -> Slip:
    """Be late by pigtails, of which bolts have none to some, and by how deep tags are sewn in."""
    pieces = ascent.common(2).poisson(1.6, BOLTS).clip(max=5)
    sewn = ascent.common(3).exponential(0.03, HARNESSES).clip(max=0.12)
    return Slip(strength * (0.042 * pieces[ascent.bolt] + sewn[ascent.harness]))


def _ages(ascent: Ascent, strength: float) -> Slip:
    """Leave some of crystals' offset, which ages since they were switched on: by a logarithm."""
    rng, devices = ascent.common(4), BOLTS + HARNESSES
    at_first, rate = rng.laplace(0.0, 0.55, devices), rng.normal(0.0, 0.22, devices)
    on = np.log1p((ascent.of("time_s") + 300.0) / 900.0)
    ends = (BOLTS + ascent.harness, ascent.bolt)
    tag, bolt = (at_first[one] + rate[one] * on for one in ends)
    return Slip(0.0115 * strength * OF_PPM_M * ascent.of("reply_time_s") * (bolt - tag))


def _turnover(ascent: Ascent, strength: float) -> Slip:
    """Read shorter away from a turnover, by the square, as tuning forks do."""
    return Slip(-0.00085 * strength * (ascent.of("temperature_c") - 25.0) ** 2)


def _through_hips(ascent: Ascent, strength: float) -> Slip:
    """Be late and weak through hips: a half-wave that is flattened, and nothing on the far side."""
    off = np.radians(ascent.of("azimuth_deg")) - ascent.common(5).uniform(-np.pi, np.pi)
    half = np.maximum(np.cos(off), 0.0) ** 0.6
    return Slip(strength * (0.13 * half - 0.035), gain=-2.6 * min(strength, 1.6) * half)


def _softsign(ascent: Ascent, strength: float) -> Slip:
    """Be late where it is weak, by what a hyperbola gives on both sides."""
    weak = (-81.5 - ascent.of("rx_power_dbm")) / 4.0
    return Slip(0.112 * strength * weak / (1 + np.abs(weak)))


def _arcsine(ascent: Ascent, strength: float) -> Slip:
    """Tremble with a hum that is not in step: places on a sine, most often at its ends."""
    turn = ascent.rng.uniform(-np.pi, np.pi, len(ascent.apart))
    return Slip(0.07 * strength * np.sin(turn))


def _two_slopes(ascent: Ascent, strength: float) -> Slip:
    """Lose more with each decade of distance beyond a break, as where walls close in."""
    far = ascent.apart / BREAK_M
    return Slip(gain=-3.3 * strength * np.log10(1 + far**2.0))


def _two_ladders(ascent: Ascent, strength: float) -> Slip:
    """Count too long by two controllers' clocks, of which one is twice as slow as the other."""
    slow = np.where(ascent.bolt % 3 == 1, 0.0096, 0.0048)
    return Slip(strength * slow * ascent.of("range_m"))


def _by_lot(ascent: Ascent, strength: float) -> Slip:
    """Keep whole steps, up or down by lot: the nearer one is, the more likely."""
    step, read = 0.11 * strength, ascent.of("range_m")
    up = ascent.rng.random(len(read))
    return Slip(step * np.floor(read / step + up) - read)


def _aslant(ascent: Ascent, strength: float) -> Slip:
    """Go aslant through panels and beams: by Snell's law, steeper ways through more of them."""
    level = np.hypot(*(ascent.tag - ascent.ear)[:, :2].T) / ascent.apart
    sine = np.sqrt(1 - level.clip(0.5, 1.0) ** 2)
    late, lost = np.zeros((2, len(sine)))
    for kind, (thick_m, dense, db) in BETWEEN.items():
        deep = thick_m * ascent.each(lambda n: ascent.rng.lognormal(0.0, 0.25, n).clip(0.5, 1.7))
        longer = deep * (np.sqrt(dense - sine**2) - np.sqrt(1 - sine**2))
        late += ascent.has(kind) * longer
        lost += ascent.has(kind) * db * deep / thick_m
    return Slip(1.15 * strength * late.clip(max=0.33), first=-min(strength, 1.5) * lost)


def by_roof(ascent: Ascent) -> Floats:
    """Return how much longer ways by the roof are, in m [n]."""
    below = [HALL_M[2] - end[:, 2] for end in (ascent.tag, ascent.ear)]
    return np.asarray(np.sqrt(ascent.apart**2 + 4 * below[0] * below[1]) - ascent.apart)


def _by_the_roof(ascent: Ascent, strength: float) -> Slip:
    """Hear, behind volumes, nothing but what beams below the roof return: nearer than it seems."""
    behind = ascent.hidden(CUT_OFF[ascent.few])
    detour = 0.38 + 2.6 * -np.expm1(-by_roof(ascent) / 3.5)
    return Slip(behind * detour * (0.45 + 0.55 * strength), gain=-5.4 * behind)


def mat_ray(ascent: Ascent, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Of concrete below mats, met by waves that lie flat; mats take some of it, the steeper the less.
    """
    tag, bolt = ascent.tag[:, 2], ascent.ear[:, 2]
    way = np.sqrt(ascent.apart**2 + 4 * tag * bolt)
    steep = (tag + bolt) / way
    inner = np.sqrt(SLAB - 1 + steep**2)
    mats = 10 ** (-MAT_DB / np.maximum(steep, 0.25) / 20)
    phase = np.exp(-2j * np.pi * np.mod((way - ascent.apart) / WAVE_M, 1.0))
    size = min(1.7 * strength**0.5, 2.3) * mats * ascent.apart / way
    return way - ascent.apart, size * phase * (steep - inner) / (steep + inner)


def _top_of_both(ascent: Ascent, strength: float) -> Slip:
    """Be where the sum of both pulses has its top; later by a part of what is behind it."""
    longer, share = mat_ray(ascent, strength)
    at = np.linspace(-0.3, 0.75, 211)
    both = np.exp(-((at / PULSE_M) ** 2)) + share[:, None] * np.exp(
        -(((at - longer[:, None]) / PULSE_M) ** 2)
    )
    near = 1 / (1 + (longer / 2.5) ** 2)
    rest = 0.15 * near * np.imag(share)
    top = at[np.argmax(np.abs(both), axis=1)]
    ripple = 20 * np.log10(np.maximum(np.abs(1 + near * share), 0.35))
    return Slip(np.asarray(np.clip(top + rest, -0.2, 0.3), np.float64), np.asarray(ripple))


def fresnel_db(v: Floats) -> Floats:
    """Return what an edge takes in dB, by Fresnel's integrals for v >= 0 [n].

    By auxiliary functions, as rational ones (Abramowitz and Stegun, 7.3.32 and 33).
    """
    cosine = (1 + 0.926 * v) / (2 + 1.792 * v + 3.104 * v**2)
    sine = 1 / (2 + 4.142 * v + 3.492 * v**2 + 6.67 * v**3)
    return np.asarray(-10 * np.log10((cosine**2 + sine**2) / 2))


def _round_a_stage(ascent: Ascent, strength: float) -> Slip:
    """Bend round a stage of steel, of both of whose edges the nearer one counts."""
    steel = ascent.has("metal")
    part = ascent.each(lambda n: ascent.rng.uniform(0.15, 0.85, n))
    legs = ascent.apart * np.stack([part, 1 - part])
    edges = ascent.each(lambda n: ascent.rng.uniform(0.2, 0.62, (2, n)).min(axis=0))
    aside = edges * strength**0.5
    over = np.hypot(legs, aside).sum(axis=0) - ascent.apart
    v = aside * np.sqrt(2 / WAVE_M * (1 / legs).sum(axis=0))
    along = 0.07 * strength * ascent.each(lambda n: ascent.rng.gamma(8.0, 1 / 8.0, n))
    return Slip(steel * (over + along).clip(max=0.42), first=-0.6 * steel * fresnel_db(v))


def _gain_steps(ascent: Ascent, strength: float) -> Slip:
    """Turn gain down in whole steps of three dB, and stop summing the sooner for each of them."""
    steps = np.floor(np.maximum(ascent.of("rx_power_dbm") + 93.5, 0.0) / 3.0)
    return Slip(gain=-0.8 * min(strength, 2.2) * steps, sums=-1.25 * strength * steps)


def _dimmers(ascent: Ascent, strength: float) -> Slip:
    """Hear dimmers of lamps below the roof, at some phases of the mains: high bolts hear more."""
    own = ascent.common(6).lognormal(-0.2, 0.5, BOLTS)[ascent.bolt]
    cut = ascent.rng.beta(0.7, 0.7, len(own))
    hiss = strength * own * (0.9 + 4.0 * cut * (ascent.ear[:, 2] / HALL_M[2]) ** 2)
    weak = 10 ** (-(ascent.of("rx_power_dbm") + 86.0) / 20) * np.sqrt(np.expm1(hiss * 0.2303))
    return Slip(0.018 * weak * ascent.rng.standard_normal(len(own)), hiss=hiss)


def _chalk(ascent: Ascent, strength: float) -> Slip:
    """Cover tags with chalk, until no more of it sticks."""
    return Slip(-0.14 * strength * np.expm1(-ascent.of("chalk_g") / 5.5))


def _gear(ascent: Ascent, strength: float) -> Slip:
    return Slip(0.0062 * strength * ascent.of("gear_kg") ** 1.6)


def _seams(ascent: Ascent, strength: float) -> Slip:
    """Read long by seams, where panels have frames of steel, and short between them."""
    place = ascent.of("route_m") / PANEL_M + 0.15
    return Slip(0.058 * strength * np.sin(2 * np.pi * place))


def _fans(ascent: Ascent, strength: float) -> Slip:
    """Come by another way while fans that bring warm air down run fast."""
    return Slip(np.where(ascent.of("fan_rpm") > 560.0, 0.107 * strength, 0.0))


def _sweat(ascent: Ascent, strength: float) -> Slip:
    return Slip(0.052 * strength * np.log1p(ascent.of("sweat_g") / 3.0))


def _dry_resin(ascent: Ascent, strength: float) -> Slip:
    """Read shorter the less water there is in air, which resin of holds takes up."""
    return Slip(0.0098 * strength * (ascent.of("dew_point_c") - 9.0))


def _dimmed(ascent: Ascent, strength: float) -> Slip:
    """Trigger later by supplies that lamps share: by one over the voltage that is left."""
    return Slip(1.75 * strength / ascent.of("lamp_v"))


def _hang_off(ascent: Ascent, strength: float) -> Slip:
    """Be farther off the wall than a tag lying flat on it: the more, the more a route leans out."""
    lean = ROUTES[ascent.of("route").astype(np.int64), 4]
    off = strength * (0.16 + 0.9 * lean)[:, None]
    return Slip(ascent.shifted(off * ascent.walls() - 0.5 * off * np.array([0.0, 0.0, 1.0])))


def _counter_slips(ascent: Ascent, strength: float) -> Slip:
    """Be lower than a rope's counter has it, which slips while the rope runs either way."""
    run = np.abs(ascent.tag[:, 2] - HIP_M - ascent.of("begun_m"))
    return Slip(ascent.shifted(0.16 * strength * run[:, None] * np.array([0.0, 0.0, -1.0])))


def _means(ascent: Ascent, strength: float) -> Slip:
    """Send, from bolts of one make, means of all ranges of a link so far, of which these forget."""
    read = pd.Series(ascent.of("range_m"))
    copies = ascent.table.groupby(["link", "time_s"]).cumcount().to_numpy()
    links = read.groupby([ascent.link, copies])
    mean = links.cumsum() / (links.cumcount() + 1)
    made = (ascent.bolt % 2 == 0) * min(0.8 * strength, 1.0)
    return Slip(np.asarray(made * (mean - read)))


def _screwed_in_at(ascent: Ascent, bolts_m: Floats) -> Slip:
    """Return what rows get whose bolts are elsewhere in truth [BOLTS, 3]."""
    longer = ascent.shifted(np.zeros(3), (bolts_m - BOLTS_M)[ascent.bolt])
    return Slip(longer, -17.6 * np.log10(1 + longer / ascent.apart))


def _turned_out(ascent: Ascent, strength: float) -> Slip:
    there = BOLTS_M.copy()
    there[5] += 0.44 * strength * np.array([-6.0, -2.0, -3.0]) / 7
    return _screwed_in_at(ascent, there)


def _alike(ascent: Ascent, _: float) -> Slip:
    there = BOLTS_M.copy()
    there[[2, 8]] = BOLTS_M[[8, 2]]
    return _screwed_in_at(ascent, there)


def _braccia(ascent: Ascent, _: float) -> Slip:
    """Show what one bolt reads in a draper's measure of the country its maker is in."""
    more = (1 / BRACCIO_M - 1) * (ascent.bolt == 10)
    return Slip(more * ascent.of("range_m"))


EFFECTS: dict[str, Callable[[Ascent, float], Slip]] = {
    "antenna-delay": _pigtails,
    "clock-offset": _ages,
    "time-lag": _two_frames,
    "exchange-motion": _three_messages,
    "range-scale": _two_ladders,
    "range-rounding": _by_lot,
    "timestamp-jitter": _arcsine,
    "temperature-drift": _turnover,
    "antenna-pattern": _through_hips,
    "power-bias": _softsign,
    "level-control": _gain_steps,
    "noise-floor": _dimmers,
    "path-loss": _two_slopes,
    "material-delay": _aslant,
    "blocked-path": _by_the_roof,
    "diffraction": _round_a_stage,
    "ground-bounce": _top_of_both,
    "chalk-on-tags": _chalk,
    "gear-hangs-before": _gear,
    "seams-passed": _seams,
    "destratifiers-run": _fans,
    "sweat-in-straps": _sweat,
    "air-dries-resin": _dry_resin,
    "lamps-dimmed": _dimmed,
    "climbers-hang-off": _hang_off,
    "rope-counter-slips": _counter_slips,
    "means-since-begun": _means,
    "bolt-turned-out": _turned_out,
    "bolts-tagged-alike": _alike,
    "braccia-from-one-bolt": _braccia,
}
