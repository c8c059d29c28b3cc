"""What the brickworks hides in ranges and levels: effects in forms of its own, laws and faults.

numpy alone; shared by the brickworks' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.brickworks_reader import DELAYED, FRACTION, METRES, RISE, spline
from bench.challenge.families.brickworks_yard import (
    ALN_M,
    BETWEEN,
    BUCKSTAYS,
    BUCKSTAYS_M,
    HALL_M,
    PER_PPM_M,
    ROD_M,
    TAGS,
    WAVE_M,
    Push,
    Upshot,
    done,
)

Floats = NDArray[np.float64]
Complexes = NDArray[np.complex128]
STACKED = {False: 0.2, True: 0.07}  # of links, and where these are scarce
DUST, DUST_M, UNEVEN_M = 2.6 - 0.06j, 0.009, 0.005  # permittivity, depth; how uneven plates are
RAMS_M: Floats = np.array([(4.0, 4.4, 0.6), (4.0, 14.3, 0.6), (40.0, 8.9, 0.6), (40.0, 18.7, 0.6)])
LAGS: Floats = np.array([0.606, 1.305, 2.12, 3.61])  # of two poles, at eighths of chances
FLIGHTS = ((0.0, 0.25), (1.0, 0.5), (2.0, 0.25))  # of three messages: replies since; shares
HEAVED_M, HOTTEST_M = 0.19, 24.0  # of the kiln's bed, and where
RETURNED, ROPE_M, GRAVITY = 0.05, 5.2, 9.81  # a share of strokes; of grabs; m/s^2
ANOTHER_SECOND_S = 0.45


def _two_poles(push: Push, strength: float) -> Upshot:
    """Compare with places through a filter of two poles, slower for some tags than for others."""
    slow_s = push.shared(1).uniform(0.04, 0.07, len(TAGS))[push.tag]
    return Upshot(np.mean([push.further_in(strength * slow_s * lag) for lag in LAGS], axis=0))


def _three_flights(push: Push, strength: float) -> Upshot:
    """Give the mean of three messages' ways, of which the middle one counts twice."""
    reply_s = 0.95 * strength * push.get("reply_time_s")
    return Upshot(sum(share * push.further_in(one * reply_s) for one, share in FLIGHTS))


def _feeders(push: Push, strength: float) -> Upshot:
    """Be late by feeders, short ones or long ones of two makes, and by tags' own patches."""
    feeder = push.shared(2).beta(0.7, 0.8, BUCKSTAYS)[push.buckstay]
    patch = push.shared(3).beta(2.0, 2.0, len(TAGS))[push.tag]
    return Upshot(strength * (0.19 * feeder + 0.1 * patch))


def _cut_crystals(push: Push, strength: float) -> Upshot:
    """Leave some of crystals' offset, and tags' cubic of warmth, as cuts of AT have it."""
    own = push.shared(4).uniform(-1.0, 1.0, BUCKSTAYS + len(TAGS))
    warm = (push.get("temperature_c") - 34.0) / 10.0
    ppm = own[BUCKSTAYS + push.tag] - own[push.buckstay] + 0.35 * warm - 0.12 * warm**3
    return Upshot(0.0135 * strength * PER_PPM_M * ppm * push.get("reply_time_s"))


def _saturating(push: Push, strength: float) -> Upshot:
    """Drift by what an oven's walls have taken up: ever less for each degree."""
    warm = np.maximum(push.get("temperature_c") - 17.0, -5.0)
    return Upshot(strength * (0.33 * (1 - np.exp(-warm / 15.0)) - 0.2))


def _beside_a_mast(push: Push, strength: float) -> Upshot:
    """Be late and weak where a mast is in the way: Poisson's kernel of the direction."""
    off = np.radians(push.get("azimuth_deg")) - push.shared(5).uniform(0.0, 2 * np.pi)
    narrow = 0.42
    shade = (1 - narrow**2) / (1 + narrow**2 - 2 * narrow * np.cos(off)) - 1
    return Upshot(
        0.07 * strength * (shade + 0.25), whole_db=-1.6 * min(strength, 1.5) * (shade + 0.6)
    )


def _sigmoid(push: Push, strength: float) -> Upshot:
    """Be late where it is weak: by an algebraic sigmoid of the level."""
    over = (push.get("rx_power_dbm") + 82.0) / 4.2
    return Upshot(-0.094 * strength * over / np.sqrt(1 + over**2))


def _two_counters(push: Push, strength: float) -> Upshot:
    """Scatter by what two counters leave over: a triangle."""
    return Upshot(0.088 * strength * push.rng.triangular(-1.0, 0.0, 1.0, push.rows))


def _in_dust(push: Push, strength: float) -> Upshot:
    """Lose more by a power of the way, as among leaves (Weissberger 1982), and by links."""
    ware = push.each_link(lambda n: push.rng.lognormal(0.0, 0.35, n))
    return Upshot(whole_db=-strength * (1.6 * (push.far / 3.0) ** 0.588 + 0.8 * ware))


def _resonators(push: Push, strength: float) -> Upshot:
    """Count by resonators of tags, all of which are slow."""
    slow = push.shared(6).triangular(0.0054, 0.0062, 0.0070, len(TAGS))[push.tag]
    return Upshot(strength * slow * push.get("range_m"))


def _counted_up(push: Push, strength: float) -> Upshot:
    """Write whole steps, those that have begun among them."""
    step, read = 0.11 * strength, push.get("range_m")
    return Upshot(step * np.ceil(read / step) - read)


def _ware(push: Push, strength: float) -> Upshot:
    """Go through ware with air in it, as it stands: a mixture's law (Maxwell Garnett 1904).

    Stacks and panes stand along the kilns.
    """
    lean = np.abs(push.there - push.hung) / push.far[:, None]
    late, lost = np.zeros(push.rows), np.zeros(push.rows)
    for kind, (thick_m, air, dense, db) in BETWEEN.items():
        rows = push.each_link(lambda n: push.rng.triangular(0.6, 1.0, 1.5, n)) * push.meets(kind)
        straight = lean[:, 1 if kind == "brick" else 0].clip(0.45, 1.0)
        holes = (1 - dense) / (1 + 2 * dense)
        mixed = dense * (1 + 3 * air * holes / (1 - air * holes))
        late += rows * thick_m * (np.sqrt(mixed - 1 + straight**2) - straight)
        lost += rows * db * straight**-0.5
    return Upshot(0.95 * strength * late, first_db=-min(strength, 1.5) * lost)


def _off_the_roof(push: Push, strength: float) -> Upshot:
    """Hear, behind stacks, nothing but what the roof's sheets throw back."""
    there = push.behind(STACKED[push.scarce])
    image = push.there * [1.0, 1.0, -1.0] + [0.0, 0.0, 2 * HALL_M[2]]
    more = np.linalg.norm(image - push.hung, axis=1) - push.far
    late = 0.45 + 2.6 * (1 - np.exp(-more / 4.5))
    return Upshot(there * late * (0.45 + 0.55 * strength), -1.9 * there, -3.4 * there)


def plate_ray(push: Push, strength: float) -> tuple[Floats, Complexes]:
    """Return how much longer the way by the floor is in m, and its complex share, [n] each.

    Floors are of steel plates with dust on them, uneven as a sea is (Miller, Brown and Vegh 1984);
    antennas lie level. What stands on the plates takes some, by links.
    """
    way = np.linalg.norm(push.there * [1.0, 1.0, -1.0] - push.hung, axis=1)
    down = (push.there[:, 2] + push.hung[:, 2]) / way
    inside = np.sqrt(DUST - 1 + down**2)
    upper = (down - inside) / (down + inside)
    turned = np.exp(-4j * np.pi * DUST_M * inside / WAVE_M)
    layer = (upper - turned) / (1 - upper * turned)
    rough = 2 * (2 * np.pi * UNEVEN_M * down / WAVE_M) ** 2
    free = push.each_link(lambda n: push.rng.triangular(0.5, 0.85, 1.0, n))
    size = min(0.66 * strength**0.5, 0.94) * np.exp(-rough) * np.i0(rough) * free * push.far / way
    longer = way - push.far
    return longer, size * layer * np.exp(-2j * np.pi * longer / WAVE_M)


def _pulled(push: Push, strength: float) -> Upshot:
    """Be where a constant fraction of both pulses is: that of the floor comes a little later."""
    longer, share = plate_ray(push, strength)
    at = np.linspace(-1.1, 2.6, 75)
    late = longer[:, None] / METRES
    now, before = (
        np.abs(spline(x) + share[:, None] * spline(x - late)) for x in (at, at - DELAYED)
    )
    over = np.where(now > 0.12, before - FRACTION * now, -1.0)
    over[:, -1] = 1.0
    where, rows = (over >= 0).argmax(axis=1).clip(min=1), np.arange(push.rows)
    high, low = over[rows, where], over[rows, where - 1]
    found = at[where] - (at[1] - at[0]) * (high / np.maximum(high - low, 1e-9)).clip(0.0, 1.0)
    moved = METRES * (found - DELAYED + RISE)
    added = np.abs(1 + share * np.exp(-((longer / 0.7) ** 2)))
    return Upshot((1.5 * moved).clip(-0.24, 0.3), whole_db=20 * np.log10(added.clip(min=0.4)))


def edge_db(depth: Floats) -> Floats:
    """Return what an edge takes in dB [n], by Fresnel's number of its depth (Lee 1985)."""
    deep = np.clip(depth, -0.8, None)
    between = 0.4 - np.sqrt(np.maximum(0.1184 - (0.38 - 0.1 * deep.clip(1.0, 2.4)) ** 2, 0.0))
    left = np.select(
        [deep < 0, deep < 1, deep < 2.4],
        [0.5 - 0.62 * deep, 0.5 * np.exp(-0.95 * deep.clip(0.0)), between],
        0.225 / np.maximum(deep, 1.0),
    )
    return np.asarray(-20 * np.log10(left))


def _over_doors(push: Push, strength: float) -> Upshot:
    """Bend over a kiln's door of steel, and go along the thick edge that it has."""
    steel = push.meets("metal")
    part = push.each_link(lambda n: push.rng.uniform(0.2, 0.8, n))
    high = np.sqrt(strength) * push.each_link(lambda n: push.rng.uniform(0.1, 0.34, n))
    legs = push.far * part, push.far * (1 - part)
    bent = np.hypot(legs[0], high) + np.hypot(legs[1], high) - push.far
    thick = strength * push.each_link(lambda n: push.rng.uniform(0.045, 0.12, n))
    deep = high * np.sqrt(2 * push.far / (WAVE_M * legs[0] * legs[1]))
    return Upshot(
        steel * (bent + thick).clip(max=0.46), first_db=-0.62 * steel * edge_db(deep).clip(max=22.0)
    )


def _soft_knee(push: Push, strength: float) -> Upshot:
    """Let through less of what is above a level, by a soft knee; sum the fewer symbols."""
    over = (push.get("rx_power_dbm") + 84.0) / 8.0
    less = min(0.3 * strength, 0.8) * 8.0 * np.log10(1 + 10**over)
    return Upshot(whole_db=-less, sums_db=-1.25 * less)


def _converters(push: Push, strength: float) -> Upshot:
    """Hear the rams' converters, louder at pushes with full loads: weak rows scatter."""
    off = np.linalg.norm(push.hung[:, None] - RAMS_M, axis=2)
    own = push.shared(7).lognormal(-0.2, 0.4, BUCKSTAYS)[push.buckstay]
    load = push.each_push(lambda n: push.rng.beta(1.3, 1.3, n))
    db = strength * (own + 3.4 * load * (1 / (1 + (off / 9.0) ** 2)).sum(axis=1))
    weak = 10 ** (-(push.get("rx_power_dbm") + 84.0) / 20) * np.sqrt(10 ** (db / 10) - 1)
    return Upshot(0.016 * weak * push.rng.normal(size=push.rows), hiss_db=db)


def _glaze(push: Push, strength: float) -> Upshot:
    """Come through glaze, of which covers hold no more than so much."""
    return Upshot(0.19 * strength * (1 - np.exp(-push.get("glaze_mg") / 4.5)))


def _wet(push: Push, strength: float) -> Upshot:
    """Come through ware that is the wetter."""
    return Upshot(0.0064 * strength * (push.get("water_pct") - 3.0))


def _draught(push: Push, strength: float) -> Upshot:
    """Lean with flues that the draught draws in: by a power of it."""
    return Upshot(0.17 * strength * (push.get("draught_pa") / 170.0) ** 1.9)


def _tie_rods(push: Push, strength: float) -> Upshot:
    """Read long at tie rods of the kiln, and short between them."""
    return Upshot(0.054 * strength * np.cos(2 * np.pi * push.get("rods_m") / ROD_M + 0.6))


def _damper(push: Push, strength: float) -> Upshot:
    """Come by another way as soon as a damper's blade is up."""
    return Upshot(np.where(push.get("damper_deg") > 52.0, 0.109 * strength, 0.0))


def _press(push: Push, strength: float) -> Upshot:
    """Be late beside a press's motors, by one over how far these are."""
    return Upshot(0.36 * strength / push.get("press_m"))


def _soot(push: Push, strength: float) -> Upshot:
    return Upshot(0.062 * strength * np.log1p(push.get("soot_mg") / 4.0))


def _trail(push: Push, strength: float) -> Upshot:
    """Trail behind their booms on ropes, as bobs of pendulums do that are sped up slowly."""
    span_s = 0.05
    sped = (push.moved(span_s) + push.moved(-span_s)) / span_s**2
    return Upshot(
        push.further(-strength * ROPE_M / GRAVITY * push.is_grab[:, None] * sped * [1.0, 1.0, 0.0])
    )


def _heaves(push: Push, strength: float) -> Upshot:
    """Be higher where the kiln is hottest than a level plan has it: its bed has heaved."""
    off = (push.there[:, 0] - HOTTEST_M) / 7.0
    higher = HEAVED_M * strength * push.is_car * np.exp(-0.5 * off**2)
    return Upshot(push.further(higher[:, None] * [0.0, 0.0, 1.0]))


def _strokes(push: Push, strength: float) -> Upshot:
    """Be less far along than strokes of rams say, as cars roll back after each."""
    course = push.course
    gone = push.is_car * done(course, course["into_s"]) * course["go_x"]
    return Upshot(push.further(-RETURNED * strength * gone[:, None] * [1.0, 0.0, 0.0]))


def _another_second(push: Push, strength: float) -> Upshot:
    """Be of another moment than is written, at one buckstay: its clock was never set."""
    return Upshot((push.buckstay == 4) * push.further_in(ANOTHER_SECOND_S * strength))


def _hung(push: Push, buckstays_m: Floats) -> Upshot:
    """Return what becomes of rows whose readers are elsewhere in truth [BUCKSTAYS, 3]."""
    more = push.further(0.0, (buckstays_m - BUCKSTAYS_M)[push.buckstay])
    return Upshot(more, whole_db=-16.4 * np.log10(1 + more / push.far) - 0.12 * more)


def _bent(push: Push, strength: float) -> Upshot:
    true_m = BUCKSTAYS_M.copy()
    true_m[3] += 0.44 * strength * np.array([2.0, 3.0, -6.0]) / 7
    return _hung(push, true_m)


def _crosswise(push: Push, _: float) -> Upshot:
    true_m = BUCKSTAYS_M.copy()
    true_m[[1, 8]] = BUCKSTAYS_M[[8, 1]]
    return _hung(push, true_m)


def _alnar(push: Push, _: float) -> Upshot:
    """Write, at one buckstay, Swedish alnar, as the kiln's old drawings have it."""
    return Upshot((push.buckstay == 6) * (1 / ALN_M - 1) * push.get("range_m"))


EFFECTS: dict[str, Callable[[Push, float], Upshot]] = {
    "antenna-delay": _feeders,
    "antenna-pattern": _beside_a_mast,
    "blocked-path": _off_the_roof,
    "clock-offset": _cut_crystals,
    "diffraction": _over_doors,
    "exchange-motion": _three_flights,
    "ground-bounce": _pulled,
    "level-control": _soft_knee,
    "material-delay": _ware,
    "noise-floor": _converters,
    "path-loss": _in_dust,
    "power-bias": _sigmoid,
    "range-rounding": _counted_up,
    "range-scale": _resonators,
    "temperature-drift": _saturating,
    "time-lag": _two_poles,
    "timestamp-jitter": _two_counters,
    "glaze-dust-on-covers": _glaze,
    "ware-still-wet": _wet,
    "draught-bends-flues": _draught,
    "tie-rods-passed": _tie_rods,
    "damper-opened": _damper,
    "clay-press-near": _press,
    "soot-on-radomes": _soot,
    "grabs-trail-behind": _trail,
    "kiln-bed-heaves": _heaves,
    "strokes-counted-long": _strokes,
    "one-buckstay-of-another-second": _another_second,
    "buckstay-bent-by-heat": _bent,
    "buckstays-wired-crosswise": _crosswise,
    "alnar-from-one-buckstay": _alnar,
}
