"""Laws and faults of the set-up that the bowls green hides, which no library has.

numpy alone; shared by the green's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.bowls_rinks import (
    CROWN_M,
    FATHOM_M,
    GREEN_M,
    KNOTS_M,
    LOOPS_M,
    ROUND,
    Change,
    End,
    rolled,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_DECADE_DB, SOFT_M = -58.6, 19.6, 0.5  # of levels; added to ways
TAUT_PA, BREATHES_M, BANKS = 245.0, 0.0024, 0.35  # how far the crown rises a Pa; of it, at banks
RISES_M = 0.34  # how high the green's middle is over its edges
DRUM_M = 0.36  # how far from a roller's axle its tag is
LEANS = 0.36  # of the skin's slope, in radians, that tapes take up
KEEPS, FORGETS_S = 0.02, 0.012  # of its last voltage; until e times less of it


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DB - PER_DECADE_DB * np.log10(far + SOFT_M))


def _wax(end: End, strength: float) -> Change:
    """Come out of shells through wax that bowlers rub on for grip: a film that fills up."""
    return Change(-0.185 * strength * np.expm1(-end["wax_mg"] / 16.0))


def _nap(end: End, strength: float) -> Change:
    """Come through the nap of carpets, which is wetter the longer it is: to the power of 1.6."""
    return Change(0.115 * strength * (end["nap_mm"] / 5.5) ** 1.6)


def _blower(end: End, strength: float) -> Change:
    """Come past the blower's duct of steel, the later the closer."""
    return Change(0.23 * strength / end["blower_m"])


def _rain(end: End, strength: float) -> Change:
    """Be held up by rain that runs down skin and knots: films grow by a cube root (Nusselt)."""
    return Change(0.083 * strength * np.cbrt(end["rain_mmh"] / 2.0))


def _skirt(end: End, strength: float) -> Change:
    """Come over tubes of water that hold the skirt down, so much for each litre."""
    return Change(0.00018 * strength * end["skirt_l"])


def _loops(end: End, strength: float) -> Change:
    """Read long and short as heating pipes below the carpet go by."""
    return Change(0.058 * strength * np.sin(2 * np.pi * end["loop_m"] / LOOPS_M + 0.9))


def _airlock(end: End, strength: float) -> Change:
    """Read longer while both doors of the airlock stand open: the blower takes the mains down."""
    return Change(np.where(end["airlock_pct"] > 54.0, 0.093 * strength, 0.0))


def _stand(end: End, off_m: Floats) -> Change:
    """Return what becomes of rows whose knots are off by so much in truth [n, 3], in m."""
    more = end.stretched(0.0, off_m)
    return Change(more, open_db((end.far + more).clip(0.1)) - open_db(end.far))


def _breathes(end: End, strength: float) -> Change:
    """Hang on a skin that swells by its pressure, square to itself, and most at its crown.

    Knots were surveyed at `TAUT_PA`.
    """
    angle = ROUND[end.knot]
    square = np.stack(
        [0 * angle, np.cos(angle) / (GREEN_M[1] / 2), np.sin(angle) / CROWN_M], axis=1
    )
    square /= np.linalg.norm(square, axis=1)[:, None]
    swells = BREATHES_M * (end["inside_pa"] - TAUT_PA) * (BANKS + (1 - BANKS) * np.sin(angle))
    return _stand(end, strength * swells[:, None] * square)


def _crowned(end: End, strength: float) -> Change:
    """Play on a crown green, which was drawn level: all tags are higher than it says, amid it."""
    off = 2 * end.below[:, :2] / np.array(GREEN_M) - 1
    rises = RISES_M * strength * (1 - off[:, 0] ** 2) * (1 - off[:, 1] ** 2)
    return Change(end.stretched(rises[:, None] * np.array([0.0, 0.0, 1.0])))


def _drum(end: End, strength: float) -> Change:
    """Have rollers' tags on drums, which turn, where their frames were meant."""
    along = rolled(end.course, end.course["into_s"])[0]
    angle = along / DRUM_M + 2 * np.pi * end.shared(6).random()
    ahead = np.sin(angle) * end.are("roller")
    up = np.cos(angle) * end.are("roller")
    toward = end.course["toward"]
    off = np.stack([ahead * np.cos(toward), ahead * np.sin(toward), up], axis=1)
    return Change(end.stretched(DRUM_M * strength * off))


def _slanted(end: End, strength: float) -> Change:
    """Be lower than was read: tapes hung from knots lay against the skin, and leant with it."""
    leans = LEANS * np.abs(np.cos(ROUND[end.knot]))
    less = KNOTS_M[end.knot, 2] * (1 - np.cos(leans))
    return _stand(end, -strength * less[:, None] * np.array([0.0, 0.0, 1.0]))


def answer_before(end: End) -> tuple[Floats, Floats]:
    """Return the range that the same tag had from its answer before, in m, and how long ago in s.

    [n] each. Where there is none in the table, that of the row itself, and long ago.
    """
    told, time = end["range_m"], end["time_s"]
    before = np.roll(np.arange(end.rows), 1)
    since = time - time[before]
    same = (end.end[before] == end.end) & (since >= 0) & (np.arange(end.rows) > 0)
    same &= end.copy[before] == end.copy
    return np.where(same, told[before], told), np.where(same, since, 9.0)


def _remembers(end: End, strength: float) -> Change:
    """Read times off a capacitor that keeps some of its last voltage (dielectric absorption).

    What was read just before, of another knot mostly, is read once more to a small part.
    """
    before, since = answer_before(end)
    part = KEEPS * strength * np.exp(-since / FORGETS_S)
    return Change(part * (before - end["range_m"]))


def _dragged(end: End, strength: float) -> Change:
    off = 0.48 * strength * np.array([-2.0, 3.0, -6.0]) / 7.0
    return _stand(end, np.where((end.knot == 6)[:, None], off, 0.0))


def _crosswise(end: End, _: float) -> Change:
    order = np.arange(len(KNOTS_M))
    order[[3, 8]] = order[[8, 3]]
    return _stand(end, (KNOTS_M[order] - KNOTS_M)[end.knot])


def _fathoms(end: End, _: float) -> Change:
    """Write, at one knot, fathoms, by which its rope was bought."""
    return Change(np.where(end.knot == 10, (1 / FATHOM_M - 1) * end["range_m"], 0.0))


UNLISTED: dict[str, Callable[[End, float], Change]] = {
    "grip-wax-on-shells": _wax,
    "nap-stands-up": _nap,
    "blower-close-by": _blower,
    "rain-runs-down-the-skin": _rain,
    "skirt-tubes-filled": _skirt,
    "heating-loops-passed": _loops,
    "airlock-held-open": _airlock,
    "skin-breathes": _breathes,
    "crown-of-the-green-left-out": _crowned,
    "tag-on-the-rollers-drum": _drum,
    "heights-taped-down-the-slope": _slanted,
    "converter-remembers-last-answer": _remembers,
    "knot-dragged-by-a-floodlight": _dragged,
    "knots-plugged-crosswise": _crosswise,
    "fathoms-from-one-knot": _fathoms,
}
