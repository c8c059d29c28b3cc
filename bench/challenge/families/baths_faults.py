"""Laws and faults of the set-up that the baths hide, which no library has.

numpy alone; shared by the baths' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.baths_hall import (
    ARCHES,
    ARCHES_M,
    FLOATS_M,
    OPEN_PCT,
    PASSO_M,
    Heat,
    Splash,
    round_rad,
    slid_m,
    swum_m,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_DECADE_DB, BLUNT_M = -64.4, 18.4, 0.6  # of levels
LESS = 0.075  # of their way that swimmers come less far
RISES_M, TIGHT_M = 0.38, 2.0  # how much riders ride up in bends: of a pace of 1.4 m/s, out so far
SHAKEN: tuple[int, ...] = (1, 3, 4, 7, 9)
"""Arches whose feet are on the pumps' foundation."""
DEEP_M, SINKS = 24.0, 0.02  # from where on arches settle; how much a metre further on


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_DECADE_DB * np.log10(np.hypot(far, BLUNT_M)))


def _beads(heat: Heat, strength: float) -> Splash:
    """Come through water that beads on arches: by a hyperbola that comes to an end."""
    beads = heat["beads_um"]
    return Splash(0.24 * strength * beads / (beads + 38.0))


def _fur(heat: Heat, strength: float) -> Splash:
    """Come through nozzles that scale furs: by a power."""
    return Splash(0.155 * strength * (heat["fur_mm"] / 8.0) ** 1.7)


def _steel(heat: Heat, strength: float) -> Splash:
    """Come past a slide of steel, the later the closer: by the square."""
    return Splash(0.29 * strength / heat["slide_m"] ** 2)


def _cream(heat: Heat, strength: float) -> Splash:
    """Come through suncream on caps, of which each further layer does less."""
    return Splash(0.068 * strength * np.log1p(heat["cream_mg"] / 1.9))


def _bathers(heat: Heat, strength: float) -> Splash:
    """Come round bathers who splash about, so much for each."""
    return Splash(0.0098 * strength * heat["bathers"])


def _floats(heat: Heat, strength: float) -> Splash:
    """Read long and short as large floats of a lane's rope pass."""
    return Splash(0.061 * strength * np.cos(2 * np.pi * heat["rope_m"] / FLOATS_M + 0.7))


def _roof(heat: Heat, strength: float) -> Splash:
    """Come later while the roof is rolled back."""
    return Splash(np.where(heat["roof_pct"] > OPEN_PCT, 0.088 * strength, 0.0))


def _steam(heat: Heat, strength: float) -> Splash:
    """Come through steam, by how much of it there is, and by how wide its door stands."""
    door = 1 - np.cos(np.radians(heat["ajar_deg"]))
    return Splash(0.34 * strength * heat["steam_pct"] / 100.0 * door)


def _strokes(heat: Heat, strength: float) -> Splash:
    """Have swimmers, whose places are strokes counted from a start, be behind these."""
    course = heat.course
    behind = (
        -LESS * strength * heat.are("swimmer") * swum_m(course, course["stirs"] * course["into_s"])
    )
    way = np.stack([np.cos(course["toward"]), np.sin(course["toward"])], axis=1)
    return Splash(heat.farther(np.pad(behind[:, None] * way, ((0, 0), (0, 1)))))


def _riders(heat: Heat, strength: float) -> Splash:
    """Have riders ride up their slide's outer side: outward, and half as much upward."""
    bends = _bends(heat)
    gone_s = bends["stirs"] * bends["into_s"]
    out_m = bends["swell"] - bends["beat"] * slid_m(bends, gone_s)
    pace = bends["pace"] * -np.expm1(-gone_s / bends["wears"])
    rises = RISES_M * strength * heat.are("rider") * (pace / 1.4) ** 2 * TIGHT_M / out_m
    angle = round_rad(bends, gone_s)
    off = np.column_stack([np.cos(angle), np.sin(angle), np.full(heat.rows, 0.5)])
    return Splash(heat.farther(rises[:, None] * off))


def _bends(heat: Heat) -> dict[str, Floats]:
    """Return courses of riders; of all others a plain one, as these have no bends."""
    rider = heat.are("rider")
    plain = {"beat": 0.05, "swell": 90.0, "wears": 1.0, "pace": 1.0}
    return {
        name: np.where(rider, value, plain.get(name, 0.0)) for name, value in heat.course.items()
    }


def _pumps(heat: Heat, strength: float) -> Splash:
    """Be late at arches that pumps shake, by the square of how fast these turn."""
    shaken = np.isin(heat.arch, SHAKEN)
    return Splash(0.19 * strength * shaken * (heat["pump_hz"] / 50.0) ** 2)


def _stands(heat: Heat, off_m: Floats) -> Splash:
    """Return what rows bear whose arches are off in truth [ARCHES, 3], in m."""
    more = heat.farther(0.0, off_m[heat.arch])
    return Splash(more, open_db(heat.far + more) - open_db(heat.far))


def _settles(heat: Heat, strength: float) -> Splash:
    """Have the deep end settle, and its arches with it, the more the farther out."""
    off_m = np.zeros((ARCHES, 3))
    off_m[:, 2] = -SINKS * strength * (ARCHES_M[:, 0] - DEEP_M).clip(0.0)
    return Splash(heat.farther(0.0, off_m[heat.arch]))


def _struck(heat: Heat, strength: float) -> Splash:
    off_m = np.zeros((ARCHES, 3))
    off_m[6] = 0.42 * strength * np.array([6.0, -3.0, -2.0]) / 7.0
    return _stands(heat, off_m)


def _crosswise(heat: Heat, _: float) -> Splash:
    off_m = np.zeros((ARCHES, 3))
    off_m[[2, 8]] = ARCHES_M[[8, 2]] - ARCHES_M[[2, 8]]
    return _stands(heat, off_m)


def _passi(heat: Heat, _: float) -> Splash:
    """Write, of one arch, passi of Venice."""
    return Splash((heat.arch == 4) * heat["range_m"] * (1 / PASSO_M - 1))


UNLISTED: dict[str, Callable[[Heat, float], Splash]] = {
    "beads-of-water-on-arches": _beads,
    "scale-furs-the-nozzles": _fur,
    "steel-slide-close-by": _steel,
    "suncream-on-caps": _cream,
    "bathers-splash-about": _bathers,
    "lane-floats-pass": _floats,
    "roof-rolled-back": _roof,
    "steam-room-left-ajar": _steam,
    "strokes-reach-less-far": _strokes,
    "riders-ride-up-in-bends": _riders,
    "pumps-shake-their-arches": _pumps,
    "deep-end-settles": _settles,
    "arch-struck-by-a-platform": _struck,
    "arches-wired-crosswise": _crosswise,
    "passi-from-one-arch": _passi,
}
