"""Laws and faults of the set-up that the velodrome hides, which no library has.

numpy alone; shared by the velodrome's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.velodrome_track import (
    BALUSTRADE_M,
    ENDAZE_M,
    GATE_PCT,
    GRAVITY,
    JOIST_M,
    MOST_BENT,
    POSTS,
    POSTS_M,
    RISES_M,
    STATIONS_M,
    Handicap,
    Race,
    along_and_lane,
    bends,
    on_boards,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, PER_DECADE_DB, A_METRE_DB, BLUNT_M2 = -58.9, 9.6, 0.03, 0.4  # of levels
PRESSED_M = 0.16  # how much lower riders are for each weight of theirs that bends add
FLATTER = 0.085  # the part of their bank that boards lack
MOST_RPM, PULLS_M = 2600.0, 0.14  # an engine's, and by how much it makes ranges longer then
CHAINED = 0.0042  # by how much each metre of another line is too long
GLANCE_S = 1e-3  # in which paces are measured


def open_db(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(
        AT_A_METRE_DB - PER_DECADE_DB * np.log10(far**2 + BLUNT_M2) - A_METRE_DB * far
    )


def _wax(race: Race, strength: float) -> Handicap:
    """Come through wax that films posts: exponentially to an end."""
    return Handicap(0.18 * strength * (1 - np.exp(-race["wax_um"] / 31.0)))


def _damp(race: Race, strength: float) -> Handicap:
    """Come past boards that swell in damp air: by a power."""
    return Handicap(0.2 * strength * (race["damp_pct"] / 80.0) ** 2.4)


def _lap_board(race: Race, strength: float) -> Handicap:
    """Come past a lap board, the later the closer: by one over the square of how close."""
    return Handicap(0.21 * strength / race["board_m"] ** 2)


def _oil(race: Race, strength: float) -> Handicap:
    """Come through oil off chains on tags, of which each further drop does less."""
    return Handicap(-0.055 * strength * np.log1p(race["oil_ul"] / 5.5))


def _flags(race: Race, strength: float) -> Handicap:
    """Come past flags that wave in the stands, so much for each of these."""
    return Handicap(0.0091 * strength * race["flags"])


def _joists(race: Race, strength: float) -> Handicap:
    """Read long and short as joists pass below the boards."""
    return Handicap(0.061 * strength * np.cos(2 * np.pi * race["under_m"] / JOIST_M + 0.8))


def _gate(race: Race, strength: float) -> Handicap:
    """Come later while the tunnel's gate stands open."""
    return Handicap(np.where(race["gate_pct"] > GATE_PCT, 0.094 * strength, 0.0))


def _fog(race: Race, strength: float) -> Handicap:
    """Come through fog of a show, which fans thin: by one over how fast they turn, and a bit."""
    return Handicap(0.34 * strength * race["fog_pct"] / 100.0 / (1 + race["fans_hz"] / 5.0))


def paces(race: Race) -> Floats:
    """Return how fast tags go along the line in m/s [n]."""
    into_s = race.course["into_s"]
    ahead, back = (along_and_lane(race.course, into_s + t)[0] for t in (GLANCE_S, -GLANCE_S))
    return (ahead - back) / (2 * GLANCE_S)


def _pressed(race: Race, strength: float) -> Handicap:
    """Have riders pressed down in bends: by what these add to their weight, of a square and one.

    Who holds riders, and dernies, are not.
    """
    along, lane = along_and_lane(race.course, race.course["into_s"])
    aside = paces(race) ** 2 * MOST_BENT * bends(along) / GRAVITY
    lower = PRESSED_M * strength * race.are("sprinter", "slinger") * (np.hypot(1.0, aside) - 1)
    tall = race.course["tall"]
    return Handicap(race.longer(on_boards(along, lane, tall - lower) - race.rider))


def _flatter(race: Race, strength: float) -> Handicap:
    """Have boards lie flatter than drawn: tags are lower the higher up they ride, and lean less."""
    along, lane = along_and_lane(race.course, race.course["into_s"])
    there = on_boards(along, lane, race.course["tall"], FLATTER * strength)
    return Handicap(race.longer(there - race.rider))


def _ignition(race: Race, strength: float) -> Handicap:
    """Have dernies' engines pull the clocks of their tags: by the square of how fast they turn."""
    turns = (race["derny_rpm"] / MOST_RPM) ** 2
    return Handicap(PULLS_M * strength * race.are("derny") * turns)


def _chained(race: Race, strength: float) -> Handicap:
    """Have posts set out along another line, which is longer: each is the farther on the later."""
    on_m = np.zeros((POSTS, 3))
    longer = STATIONS_M * (1 + CHAINED * strength)
    behind = on_boards(longer, np.full(len(longer), BALUSTRADE_M), RISES_M)
    on_m[: len(longer)] = behind - POSTS_M[: len(longer)]
    return Handicap(race.longer(0.0, on_m[race.post]))


def _elsewhere(race: Race, off_m: Floats) -> Handicap:
    """Return what rows bear whose posts are off in truth [POSTS, 3], in m."""
    more = race.longer(0.0, off_m[race.post])
    return Handicap(more, open_db(race.far + more) - open_db(race.far))


def _struck(race: Race, strength: float) -> Handicap:
    off_m = np.zeros((POSTS, 3))
    off_m[7] = 0.48 * strength * np.array([6.0, -2.0, -3.0]) / 7.0
    return _elsewhere(race, off_m)


def _crosswise(race: Race, _: float) -> Handicap:
    off_m = np.zeros((POSTS, 3))
    off_m[[0, 5]] = POSTS_M[[5, 0]] - POSTS_M[[0, 5]]
    return _elsewhere(race, off_m)


def _endazes(race: Race, _: float) -> Handicap:
    """Write, of one post, endazes."""
    return Handicap(np.where(race.post == 8, race["range_m"] / ENDAZE_M - race["range_m"], 0.0))


UNLISTED: dict[str, Callable[[Race, float], Handicap]] = {
    "wax-films-the-posts": _wax,
    "boards-swell-in-damp": _damp,
    "lap-board-close-by": _lap_board,
    "chain-oil-on-tags": _oil,
    "flags-wave-in-stands": _flags,
    "joists-pass-below": _joists,
    "tunnel-gate-stands-open": _gate,
    "fog-that-fans-thin": _fog,
    "riders-pressed-down-in-bends": _pressed,
    "boards-flatter-than-drawn": _flatter,
    "ignition-pulls-dernies-tags": _ignition,
    "stations-chained-along-another-line": _chained,
    "post-struck-by-a-bicycle": _struck,
    "posts-plugged-crosswise": _crosswise,
    "endazes-from-one-post": _endazes,
}
