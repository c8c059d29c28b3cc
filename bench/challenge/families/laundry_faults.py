"""Laws and faults of the set-up that the laundry hides, which no library has.

numpy alone; shared by the laundry's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.laundry_plan import AUNE_M, LOUVRES_M, RIBS_M, Change, Errand

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_OCTAVE_DB, NEAREST_M = -61.7, 6.1, 1.2  # of levels; no louder than there
HUNG_M, FALLS = 2.2, 9.81  # from a bag's hook to its tag; m/s2
SINKS_M, WARM_M, WARM_S = 0.0048, 0.155, 1.7  # for each kg; in the end; until e times nearer
COLLIDE_S, COLLIDE_M = 0.046, 0.115  # within which polls collide; how much later they are then
SLOPE, LEVEL_M = 0.0125, 0.35  # of the floor; from which part of the hall on it is as drawn


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_OCTAVE_DB * 0.5 * np.log2(far**2 + NEAREST_M**2))


def _lint(errand: Errand, strength: float) -> Change:
    """Come through grilles, of whose openings each gram of lint closes a part of what is left."""
    return Change(0.18 * strength * (1 - 0.5 ** (errand.read("lint_g") / 6.5)))


def _piles(errand: Errand, strength: float) -> Change:
    """Come through piles of linen, which is pressed below: by height to the power of 1.7."""
    return Change(0.118 * strength * (errand.read("pile_cm") / 70.0) ** 1.7)


def _presses(errand: Errand, strength: float) -> Change:
    """Come past presses of steel, the later the closer."""
    return Change(0.2 * strength / errand.read("press_m"))


def _softener(errand: Errand, strength: float) -> Change:
    """Come through films of softener, which grow ever more slowly: by a logarithm."""
    return Change(0.057 * strength * np.log1p(errand.read("softener_ml") / 2.2))


def _steam(errand: Errand, strength: float) -> Change:
    """Come through steam of ironers, so much for each kg an hour."""
    return Change(0.0018 * strength * errand.read("steam_kgh"))


def _ribs(errand: Errand, strength: float) -> Change:
    """Read long and short as ribs of drums go by."""
    return Change(0.059 * strength * np.cos(2 * np.pi * errand.read("drum_m") / RIBS_M + 0.6))


def _doors(errand: Errand, strength: float) -> Change:
    """Read longer while doors of docks are more than half open, as there is a draught then."""
    return Change(np.where(errand.read("door_pct") > 52.0, 0.096 * strength, 0.0))


def _springs(errand: Errand, strength: float) -> Change:
    """Sink with the spring floors of trolleys under so many kg of linen."""
    sinks = SINKS_M * strength * errand.read("linen_kg") * errand.are("trolley")
    return Change(errand.longer(sinks[:, None] * np.array([0.0, 0.0, -1.0])))


def _lean_back(errand: Errand, strength: float) -> Change:
    """Hang from hooks that speed up: bags lean back by twice what they would in the long run."""
    course, bags = errand.course, errand.are("bag")
    slows_s = np.where(bags > 0, course["lever"], 1.0)
    gains = course["runs"] * course["rate"] / slows_s * np.exp(-course["into_s"] / slows_s)
    leans = 2 * np.arctan(gains / FALLS) * bags
    back = np.stack([-np.cos(course["toward"]), -np.sin(course["toward"])]) * np.sin(leans)
    off = np.stack([*back, 1 - np.cos(leans)], axis=1)
    return Change(errand.longer(HUNG_M * strength * off))


def _hands(errand: Errand, strength: float) -> Change:
    """Be warmed by folders' hands since these took tags up, which come later by that."""
    warm = -np.expm1(-errand.since_s / WARM_S) * errand.are("folder")
    return Change(WARM_M * strength * warm)


def _collide(errand: Errand, strength: float) -> Change:
    """Answer late where another louvre asked just before."""
    return Change(np.where(errand.read("gap_s") < COLLIDE_S, COLLIDE_M * strength, 0.0))


def _stand(errand: Errand, where_m: Floats) -> Change:
    """Return what becomes of rows whose louvres are elsewhere in truth [LOUVRES, 3], in m."""
    more = errand.longer(0.0, (where_m - LOUVRES_M)[errand.louvre])
    return Change(more, open_db((errand.far + more).clip(0.1)) - open_db(errand.far))


def _sloping(errand: Errand, strength: float) -> Change:
    """Be as high as was measured off a floor that falls to its drains in the east."""
    where = LOUVRES_M.copy()
    where[:, 2] -= SLOPE * strength * (LOUVRES_M[:, 0] - LEVEL_M * LOUVRES_M[:, 0].max())
    return _stand(errand, where)


def _knocked(errand: Errand, strength: float) -> Change:
    where = LOUVRES_M.copy()
    where[8] += 0.45 * strength * np.array([4.0, 7.0, -4.0]) / 9.0
    return _stand(errand, where)


def _crosswise(errand: Errand, _: float) -> Change:
    order = np.arange(len(LOUVRES_M))
    order[[3, 9]] = order[[9, 3]]
    return _stand(errand, LOUVRES_M[order])


def _aunes(errand: Errand, _: float) -> Change:
    """Write, at one louvre, ells of Paris, by which linen was once sold."""
    return Change(np.where(errand.louvre == 5, (1 / AUNE_M - 1) * errand.read("range_m"), 0.0))


UNLISTED: dict[str, Callable[[Errand, float], Change]] = {
    "lint-on-grilles": _lint,
    "piles-tower-up": _piles,
    "presses-close-by": _presses,
    "softener-films-tags": _softener,
    "ironers-steam": _steam,
    "drum-ribs-pass": _ribs,
    "dock-doors-rolled-up": _doors,
    "springs-sink-laden": _springs,
    "bags-lean-back-at-first": _lean_back,
    "hands-warm-tags": _hands,
    "polls-collide": _collide,
    "heights-off-a-sloping-floor": _sloping,
    "louvre-knocked-by-a-bag": _knocked,
    "louvres-tagged-crosswise": _crosswise,
    "aunes-from-one-louvre": _aunes,
}
