"""Laws and faults of the set-up that the circus hides, which no library has.

numpy alone; shared by the circus' tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.circus_tent import (
    ARSHIN_M,
    LACED_PCT,
    PANEL_M,
    POLES,
    POLES_M,
    TENT_M,
    Act,
    Trick,
    along_wire,
    swing_rad,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_DECADE_DB, BLUNT_M = -62.5, 18.9, 0.25  # of levels
GIVES = 0.085  # of a rope's length, at a swing's lowest place, by each weight of a flier's
DIPS_M = 0.46  # how much wires come down amid below who walks there
RACKED: tuple[int, ...] = (4, 6, 7, 8, 10)
"""Poles that stand windward."""
GALE_MS, RACKS_M = 14.0, (0.34, -0.15, -0.05)  # a gust, and how far it takes those, in m
BOWS = 0.0052  # how far poles bow inward, by each square of a metre of how high they are


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_DECADE_DB * np.log10(far + BLUNT_M))


def _chalk(act: Act, strength: float) -> Trick:
    """Come through chalk that dusts poles: exponentially to an end."""
    return Trick(-0.19 * strength * np.expm1(-act["chalk_mg"] / 36.0))


def _rain(act: Act, strength: float) -> Trick:
    """Come through canvas that rain has soaked: by a power."""
    return Trick(0.21 * strength * (act["rain_mm"] / 9.0) ** 1.6)


def _cage(act: Act, strength: float) -> Trick:
    """Come past the lions' cage, the later the closer: by one over how close."""
    return Trick(0.27 * strength / act["cage_m"])


def _rosin(act: Act, strength: float) -> Trick:
    """Come through rosin on tags, of which each further gram does less."""
    return Trick(0.062 * strength * np.log1p(act["rosin_g"] / 0.9))


def _crowd(act: Act, strength: float) -> Trick:
    """Come past a crowd that leans in, so much for each of it."""
    return Trick(0.0086 * strength * act["watchers"])


def _fence(act: Act, strength: float) -> Trick:
    """Read long and short as panels of the ring's fence pass."""
    return Trick(0.064 * strength * np.sin(2 * np.pi * act["fence_m"] / PANEL_M - 0.4))


def _laced(act: Act, strength: float) -> Trick:
    """Come later while the tent's sides are laced up."""
    return Trick(np.where(act["laced_pct"] > LACED_PCT, 0.091 * strength, 0.0))


def _smoke(act: Act, strength: float) -> Trick:
    """Come through smoke that lamps heat: by how much of it there is, and a root of their power."""
    hot = np.sqrt(act["lamp_kw"] / 12.0)
    return Trick(0.31 * strength * act["smoke_pct"] / 100.0 * hot)


def _ropes(act: Act, strength: float) -> Trick:
    """Have ropes of trapezes give by what pulls at them: weight, and what their swing adds.

    From where angles a, of at most A, have let them come, that is 3 cos a - 2 cos A.
    """
    flies = act.are("flier")
    angle = np.where(flies, swing_rad(_hanging(act), act.gone_s()), 0.0)
    pull = 3 * np.cos(angle) - 2 * np.cos(act.course["throw"])
    longer = GIVES * strength * flies * act.course["reach"] * pull
    out = longer * np.sin(angle)
    aim = act.course["aim"]
    down = np.stack([out * np.cos(aim), out * np.sin(aim), -longer * np.cos(angle)], axis=1)
    return Trick(act.gains(down))


def _hanging(act: Act) -> dict[str, Floats]:
    """Return courses of fliers; of all others a plain one, as these do not swing."""
    flies = act.are("flier")
    return {name: np.where(flies, value, 1.0) for name, value in act.course.items()}


def _wire(act: Act, strength: float) -> Trick:
    """Have wires come down below walkers, by a parabola of where these are."""
    part = along_wire(act.course, act.gone_s()) * act.are("walker")
    down = 4 * DIPS_M * strength * part * (1 - part)
    return Trick(act.gains(-down[:, None] * np.array([0.0, 0.0, 1.0])))


def _gusts(act: Act, strength: float) -> Trick:
    """Have gusts take windward poles along, by the square of how fast they blow."""
    blown = np.isin(act.pole, RACKED) * (act["gust_ms"] / GALE_MS) ** 2
    return Trick(act.gains(0.0, strength * blown.clip(max=2.2)[:, None] * np.array(RACKS_M)))


def _bow(act: Act, strength: float) -> Trick:
    """Have poles bow inward below their canvas, by the square of how high their radios are."""
    inward = np.array(TENT_M)[:2] / 2 - POLES_M[:, :2]
    inward /= np.linalg.norm(inward, axis=1)[:, None]
    off_m = np.zeros((POLES, 3))
    off_m[:, :2] = BOWS * strength * POLES_M[:, [2]] ** 2 * inward
    return Trick(act.gains(0.0, off_m[act.pole]))


def _elsewhere(act: Act, off_m: Floats) -> Trick:
    """Return what rows bear whose poles are off in truth [POLES, 3], in m."""
    more = act.gains(0.0, off_m[act.pole])
    return Trick(more, open_db(act.far + more) - open_db(act.far))


def _lorry(act: Act, strength: float) -> Trick:
    off_m = np.zeros((POLES, 3))
    off_m[1] = 0.45 * strength * np.array([-4.0, 8.0, 1.0]) / 9.0
    return _elsewhere(act, off_m)


def _crosswise(act: Act, _: float) -> Trick:
    off_m = np.zeros((POLES, 3))
    off_m[4], off_m[9] = POLES_M[9] - POLES_M[4], POLES_M[4] - POLES_M[9]
    return _elsewhere(act, off_m)


def _arshins(act: Act, _: float) -> Trick:
    """Write, of one pole, arshins."""
    return Trick((act.pole == 10) * act["range_m"] * (1 / ARSHIN_M - 1))


UNLISTED: dict[str, Callable[[Act, float], Trick]] = {
    "chalk-dusts-the-poles": _chalk,
    "rain-soaks-the-canvas": _rain,
    "lions-cage-close-by": _cage,
    "rosin-on-tags": _rosin,
    "crowd-leans-in": _crowd,
    "fence-panels-pass": _fence,
    "sides-laced-up": _laced,
    "smoke-under-lamps": _smoke,
    "trapezes-ropes-give": _ropes,
    "wire-dips-under-walkers": _wire,
    "gusts-rack-their-poles": _gusts,
    "poles-bow-under-canvas": _bow,
    "pole-struck-by-a-lorry": _lorry,
    "poles-wired-crosswise": _crosswise,
    "arshins-from-one-pole": _arshins,
}
