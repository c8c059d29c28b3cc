"""What the atrium hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the atrium's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.atrium_well import (
    BALCONIES,
    BALCONIES_M,
    BETWEEN,
    COURT_M,
    LID_M,
    NAMES,
    OF_PPM_M,
    RAIL_M,
    ROOF_M,
    STOREY_M,
    STOREYS,
    TOISE_M,
    WAVE_M,
    Ride,
    Upset,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
SCREENED = {False: 0.19, True: 0.055}  # of links behind counterweights, and where these are seldom
MARBLE = 7.074  # permittivity of the court's floor
EDGE_M = 0.36  # how wide pulses are
SCREEN_M: Floats = np.array([12.0, 0.2, 5.0])  # where a wall of lamps shows pictures
LAG = ((0.5858, 0.8536), (3.4142, 0.1464))
"""Parts of a time constant and their weights, which stand for an exponential (Laguerre)."""


def _sluggish(ride: Ride, strength: float) -> Upset:
    """Compare with what a controller smooths by an exponential, longer for some cars."""
    tau_s = strength * ride.shared(1).triangular(0.07, 0.1, 0.14, len(NAMES))[ride.who]
    return Upset(sum((weight * ride.grows_by(part * tau_s) for part, weight in LAG), 0 * tau_s))


def _simpson(ride: Ride, strength: float) -> Upset:
    """Give a mean of ways over an exchange: the middle counts as much as four of its ends."""
    whole_s = 2.0 * strength * ride.read("reply_time_s")
    return Upset((4 * ride.grows_by(whole_s / 2) + ride.grows_by(whole_s)) / 6)


def _two_batches(ride: Ride, strength: float) -> Upset:
    """Be late by units that differ, and by tags that come from two batches."""
    unit = ride.shared(2).lognormal(np.log(0.045), 0.55, BALCONIES).clip(max=0.17)
    batch = np.where(ride.shared(3).random(len(NAMES)) < 0.4, 0.095, 0.012)
    return Upset(strength * (unit[ride.balcony] + batch[ride.who]))


def _cut_at_an_angle(ride: Ride, strength: float) -> Upset:
    """Leave some of crystals' offset: tags' follow a cubic of how warm it is, units' stay."""
    unit, tag = (ride.shared(k).normal(0.0, 0.75, n) for k, n in ((4, BALCONIES), (5, len(NAMES))))
    warm = (ride.read("temperature_c") - 23.0) / 8.0
    ppm = unit[ride.balcony] - tag[ride.who] - 0.8 * warm + 0.45 * warm**3
    return Upset(0.0125 * strength * OF_PPM_M * ppm * ride.read("reply_time_s"))


def _tanh(ride: Ride, strength: float) -> Upset:
    """Drift when it is warm, and the other way when cool; no more at either end."""
    return Upset(0.062 * strength * np.tanh((ride.read("temperature_c") - 22.0) / 4.5))


def _back_plane(ride: Ride, strength: float) -> Upset:
    """Be late and weak behind a plate below the antenna: cubes of a half angle's sine."""
    off = np.radians(ride.read("azimuth_deg")) - ride.shared(6).uniform(-np.pi, np.pi)
    behind = np.abs(np.sin(off / 2)) ** 3
    return Upset(strength * (0.155 * behind - 0.05), whole=-2.4 * min(strength, 1.6) * behind)


def _algebraic(ride: Ride, strength: float) -> Upset:
    """Be late where it is weak: by a root's sigmoid."""
    weak = (-83.5 - ride.read("rx_power_dbm")) / 3.8
    return Upset(0.103 * strength * weak / np.sqrt(1 + weak**2))


def _two_stamps(ride: Ride, strength: float) -> Upset:
    """Tremble by what is left of two stamps, each anywhere within a tick."""
    stamps = ride.rng.random((2, ride.size))
    return Upset(0.115 * strength * (stamps[0] - stamps[1]))


def _court_closes_in(ride: Ride, strength: float) -> Upset:
    """Lose the more the farther it is across the court: as one and a bit of a distance."""
    return Upset(whole=-1.7 * strength * np.log1p((ride.apart / 4.0) ** 1.25))


def _own_metres(ride: Ride, strength: float) -> Upset:
    """Count too long, each tag by its own clock."""
    part = strength * ride.shared(7).triangular(0.003, 0.0055, 0.009, len(NAMES))[ride.who]
    return Upset(part * ride.read("range_m"))


def _quarters_past(ride: Ride, strength: float) -> Upset:
    """Keep whole steps and a quarter, whichever is nearest."""
    step, read = 0.125 * strength, ride.read("range_m")
    return Upset(step * (np.rint(read / step - 0.25) + 0.25) - read)


def _panes(ride: Ride, strength: float) -> Upset:
    """Go through panes and partitions that stand upright: the more aslant, the more of them."""
    aslant = (ride.tag[:, 2] - ride.ear[:, 2]) ** 2 / ride.apart**2
    late, lost = np.zeros((2, ride.size))
    for kind, (thick_m, dense, db) in BETWEEN.items():
        deep = ride.by_link(lambda n: ride.rng.gamma(14.0, 1 / 14.0, n).clip(0.5, 1.7))
        late += ride.through(kind) * deep * thick_m * (np.sqrt(dense) - 1) * (1 + 0.4 * aslant)
        lost += ride.through(kind) * deep * db
    return Upset(1.3 * strength * late.clip(max=0.34), first=-min(strength, 1.5) * lost)


def by_glass_roof(ride: Ride) -> Floats:
    """Return how much longer ways by the roof are, in m [n]."""
    image = ride.ear * [1, 1, -1] + [0.0, 0.0, 2 * COURT_M[2]]
    return np.asarray(np.linalg.norm(ride.tag - image, axis=1) - ride.apart)


def _counterweights(ride: Ride, strength: float) -> Upset:
    """Hear, behind counterweights, nothing but what trusses below the roof return."""
    behind, longer = ride.chosen(SCREENED[ride.seldom]), by_glass_roof(ride)
    detour = 0.36 + 2.5 * longer / np.hypot(longer, 5.0)
    return Upset(behind * detour * (0.5 + 0.5 * strength), whole=-5.0 * behind)


def marble_ray(ride: Ride, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the court's floor is in m, and its complex share, [n] each.

    Marble, met by waves that lie flat; rugs and seats leave of it what a link has of bare floor.
    """
    image = np.linalg.norm(ride.tag - ride.ear * [1, 1, -1], axis=1)
    steep = (ride.tag[:, 2] + ride.ear[:, 2]) / image
    within = np.sqrt(MARBLE - 1 + steep**2)
    bare = ride.by_link(lambda n: ride.rng.beta(5.0, 1.3, n))
    size = min(1.25 * strength**0.5, 1.9) * bare * ride.apart / image
    phase = np.exp(-1j * (2 * np.pi / WAVE_M) * (image - ride.apart))
    return image - ride.apart, size * phase * (steep - within) / (steep + within)


def _half_of_both(ride: Ride, strength: float) -> Upset:
    """Be where the sum of both pulses first has half of its height, next to where one has."""
    longer, share = marble_ray(ride, strength)
    at = np.linspace(-0.8, 0.9, 341)
    both = np.abs(_bell(at) + share[:, None] * _bell(at - longer[:, None]))
    begin = (both >= both.max(axis=1)[:, None] / 2).argmax(axis=1)
    alone = at[(_bell(at) >= 0.5).argmax()]
    blurred = 0.13 * share.real * np.exp(-longer / 2.2)  # of what antennas spread
    near = np.exp(-longer / 2.5)
    level = 20 * np.log10(np.maximum(np.abs(1 + near * share), 0.35))
    return Upset((at[begin] - alone + blurred).clip(-0.25, 0.35), whole=level)


def _bell(at_m: Floats) -> Floats:
    return np.asarray(1 / np.cosh(at_m / EDGE_M) ** 2)


def round_edge_db(v: Floats) -> Floats:
    """Return what an edge takes in dB for v >= 0 [n]: by a hyperbola's logarithm."""
    return np.asarray(6.2 + 8.686 * np.arcsinh(v))


def _round_frames(ride: Ride, strength: float) -> Upset:
    """Bend round a frame of steel on the way, and creep along what of it is rounded."""
    steel = ride.through("metal")
    part = ride.by_link(lambda n: ride.rng.beta(2.0, 2.0, n).clip(0.12, 0.88))
    aside = strength**0.5 * ride.by_link(lambda n: ride.rng.uniform(0.15, 0.48, n))
    near, far = part * ride.apart, (1 - part) * ride.apart
    v = aside * np.sqrt(2 * ride.apart / (WAVE_M * near * far))
    bent = np.hypot(near, aside) + np.hypot(far, aside) - ride.apart
    creeps = strength * ride.by_link(lambda n: ride.rng.triangular(0.04, 0.07, 0.1, n))
    return Upset(steel * (bent + creeps).clip(max=0.42), first=-0.6 * steel * round_edge_db(v))


def _soft_limits(ride: Ride, strength: float) -> Upset:
    """Press levels together where they are high, softly, and add up the fewer symbols."""
    over = np.logaddexp(0.0, (ride.read("rx_power_dbm") + 92.0) / 2.4)
    return Upset(whole=-0.55 * min(strength, 2.2) * over, symbols=-1.05 * strength * over)


def _wall_of_lamps(ride: Ride, strength: float) -> Upset:
    """Hear what drives a wall of lamps, near it and while its pictures are bright."""
    far = np.linalg.norm(ride.ear - SCREEN_M, axis=1)
    own = ride.shared(8).uniform(0.5, 1.3, BALCONIES)[ride.balcony]
    noise = strength * (own + 4.6 * ride.rng.beta(2.0, 1.5, ride.size) * np.exp(-far / 11.0))
    weak = 10 ** (-(ride.read("rx_power_dbm") + 86.0) / 20) * np.sqrt(10 ** (noise / 10) - 1)
    return Upset(0.017 * weak * ride.rng.standard_normal(ride.size), noise=noise)


def _wax(ride: Ride, strength: float) -> Upset:
    """Come through wax, which is polished off where it is thick."""
    wax = ride.read("wax_um")
    return Upset(0.165 * strength * wax / (wax + 9.0))


def _laden(ride: Ride, strength: float) -> Upset:
    return Upset(0.165 * strength * (ride.read("load_kg") / 630.0) ** 1.7)


def _joints(ride: Ride, strength: float) -> Upset:
    """Read long by plates that join guide rails, and short between them."""
    return Upset(-0.057 * strength * np.cos(2 * np.pi * ride.read("shaft_m") / RAIL_M - 0.7))


def _vents(ride: Ride, strength: float) -> Upset:
    """Come by another way while leaves of vents stand open."""
    return Upset(0.104 * strength * np.heaviside(ride.read("vent_deg") - 34.0, 1.0))


def _steam(ride: Ride, strength: float) -> Upset:
    return Upset(0.06 * strength * np.log1p(ride.read("steam_g") / 2.2))


def _tinted(ride: Ride, strength: float) -> Upset:
    """Read shorter, the darker panes are, whose layers conduct."""
    return Upset(-0.0019 * strength * (ride.read("tint_percent") - 12.0))


def _fountain(ride: Ride, strength: float) -> Upset:
    """Be late beside a fountain's spray, by one over how far it is."""
    return Upset(0.33 * strength / ride.read("spray_m"))


def _wheel_worn(ride: Ride, strength: float) -> Upset:
    """Be lower than an encoder has it, whose wheel is worn: by a part of the height it ran."""
    run = ride.lifted * (ride.tag[:, 2] - ROOF_M)
    return Upset(ride.beside(-0.021 * strength * run[:, None] * np.array([0.0, 0.0, 1.0])))


def _snapped(ride: Ride, strength: float) -> Upset:
    """Send, as hosts know landings, ranges from somewhat nearer to the landing that is nearest."""
    base = np.where(ride.lifted > 0, ROOF_M, LID_M)
    floor = np.clip(np.rint((ride.tag[:, 2] - base) / STOREY_M), 0, STOREYS - 1)
    off = ride.lifted * (base + STOREY_M * floor - ride.tag[:, 2])
    part = min(0.22 * strength, 0.9)
    return Upset(ride.beside(part * off[:, None] * np.array([0.0, 0.0, 1.0])))


def _hang_at(ride: Ride, balconies_m: Floats) -> Upset:
    """Return what upsets rows whose units hang elsewhere in truth [BALCONIES, 3]."""
    metres = ride.beside(0 * ride.tag, (balconies_m - BALCONIES_M)[ride.balcony])
    return Upset(metres, whole=-18.5 * np.log10((ride.apart + metres) / ride.apart))


def _bent(ride: Ride, strength: float) -> Upset:
    there = BALCONIES_M.copy()
    there[3] += 0.46 * strength * np.array([3.0, 6.0, -2.0]) / 7
    return _hang_at(ride, there)


def _from_above(ride: Ride, _: float) -> Upset:
    order = np.arange(BALCONIES)
    order[1], order[6] = 6, 1
    return _hang_at(ride, BALCONIES_M[order])


def _toises(ride: Ride, _: float) -> Upset:
    """Show what one unit reads in the measure of the plans that its house was built by."""
    return Upset((ride.balcony == 8) * (1 / TOISE_M - 1) * ride.read("range_m"))


EFFECTS: dict[str, Callable[[Ride, float], Upset]] = {
    "time-lag": _sluggish,
    "exchange-motion": _simpson,
    "antenna-delay": _two_batches,
    "clock-offset": _cut_at_an_angle,
    "temperature-drift": _tanh,
    "antenna-pattern": _back_plane,
    "power-bias": _algebraic,
    "timestamp-jitter": _two_stamps,
    "path-loss": _court_closes_in,
    "range-scale": _own_metres,
    "range-rounding": _quarters_past,
    "material-delay": _panes,
    "blocked-path": _counterweights,
    "ground-bounce": _half_of_both,
    "diffraction": _round_frames,
    "level-control": _soft_limits,
    "noise-floor": _wall_of_lamps,
    "wax-on-covers": _wax,
    "cars-laden": _laden,
    "guide-rails-jointed": _joints,
    "smoke-vents-open": _vents,
    "steam-on-panes": _steam,
    "panes-tinted": _tinted,
    "fountain-plays-near": _fountain,
    "encoder-wheel-worn": _wheel_worn,
    "snapped-to-landings": _snapped,
    "balcony-rail-bent": _bent,
    "balconies-numbered-from-above": _from_above,
    "toises-from-one-balcony": _toises,
}
