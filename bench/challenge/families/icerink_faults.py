"""Laws and faults of the set-up that the ice rink hides, which no library has.

numpy alone; shared by the ice rink's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.icerink_rink import (
    BELOW_ROOF,
    LOKET_M,
    MULLIONS,
    MULLIONS_M,
    PANE_M,
    WARM_BRINE_C,
    Marks,
    Period,
    at_rebound,
    glided,
    in_hold,
    on_lap,
    slid_m,
)

Floats = NDArray[np.float64]
AT_A_METRE_DB, DECADE_DB, BEGINS_M = -58.7, 9.3, 1.5  # of levels: by ways, times these and a little
ICE_C = -4.0  # of the ice's surface
LEANS, RUBS, IN_M, GIVES = 0.1, 0.2, 0.3, 0.05  # parts; by how much laps are further in; a part
SAGS_M, FULL_CM = 0.32, 50.0  # of the truss under so much snow
STATION_M, MELTS_RAD = (31.0, 18.0, 1.6), (0.008, -0.0065, 0.012)  # on the ice; turned by the last
TWICE, MOST = 0.3, 0.75  # of answers, at strength 1, and at most


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]: flatter near by."""
    return np.asarray(AT_A_METRE_DB - DECADE_DB * np.log10(far * (far + BEGINS_M)))


def _frost(period: Period, strength: float) -> Marks:
    """Come through frost, of which air holds no more than so much: by an exponential's rest."""
    return Marks(-0.2 * strength * np.expm1(-period["frost_mm"] / 4.5))


def _slush(period: Period, strength: float) -> Marks:
    """Come through slush that is heaped on boards: by a power of how high."""
    return Marks(0.19 * strength * (period["slush_cm"] / 11.0) ** 1.7)


def _scoreboard(period: Period, strength: float) -> Marks:
    """Come past the scoreboard, which is let down, the later the closer: by one over how close."""
    return Marks(0.125 * strength / period["cube_gap_m"])


def _film(period: Period, strength: float) -> Marks:
    """Come through a film that hot water's steam leaves on covers: by a logarithm of minutes."""
    return Marks(0.047 * strength * np.log1p(period["flooded_min"] / 4.0))


def _sticks(period: Period, strength: float) -> Marks:
    """Come past sticks of carbon that stand in a rack, so much for each of these."""
    return Marks(0.0122 * strength * period["sticks"])


def _panes(period: Period, strength: float) -> Marks:
    """Read long and short as seams of the glass pass the guard's wagon."""
    return Marks(0.059 * strength * np.sin(2 * np.pi * period["glide_m"] / PANE_M + 1.3))


def _compressor(period: Period, strength: float) -> Marks:
    """Read longer while the compressor runs, since brine is warm, and mains are low."""
    return Marks(np.where(period["brine_c"] > WARM_BRINE_C, 0.096 * strength, 0.0))


def dew_c(warm: Floats, humid: Floats) -> Floats:
    """Return at how many degrees C air dews [n]: a degree less for each 5 % of damp that lack."""
    return np.asarray(warm - (100.0 - humid) / 5.0)


def _dews(period: Period, strength: float) -> Marks:
    """Come through mist, since air dews at warmer than the ice is: by how much warmer."""
    over = dew_c(period["temperature_c"], period["humid_pct"]) - ICE_C
    return Marks(0.0125 * strength * over.clip(0.0))


def _only(period: Period, sort: str, moved: Floats) -> Marks:
    """Return what rows get of which tags of one sort are off by so much [n, 3], in m."""
    return Marks(np.where(period.are(sort), period.stretched(moved), 0.0))


def _leans(period: Period, strength: float) -> Marks:
    """Have skaters on sharper edges than is told, so that they turn by a part more."""
    course = period.course
    sharper = course | {"bends": course["bends"] * (1 + LEANS * strength)}
    ways = [np.stack(glided(one, period.gone_s), axis=1) for one in (sharper, course)]
    moved = np.zeros((period.rows, 3))
    moved[:, :2] = ways[0] - ways[1]
    return _only(period, "skater", moved)


def _rubs(period: Period, strength: float) -> Marks:
    """Have penguins rub more than is told, since the ice is wet."""
    course = period.course
    real = course["slows"].clip(0.01)
    slid = [slid_m(course | {"slows": by * real}, period.gone_s)
            for by in (1 + RUBS * strength, 1.0)]  # fmt: skip
    return _only(period, "penguin", at_rebound(course, slid[0]) - at_rebound(course, slid[1]))


def _further_in(period: Period, strength: float) -> Marks:
    """Have resurfacers lap further in than is told, since laps overlap more."""
    laps = [on_lap(period.course, period.gone_s, by) for by in (IN_M * strength, 0.0)]
    return _only(period, "resurfacer", laps[0] - laps[1])


def _gives(period: Period, strength: float) -> Marks:
    """Have arms give in pairs' hold as these turn: by the square of how fast."""
    own = {name: np.where(period.are("pair"), one, 1.0) for name, one in period.course.items()}
    own["slows"] = np.where(period.are("pair"), own["slows"], 99.0)
    held = [in_hold(own, period.gone_s, by) for by in (GIVES * strength, 0.0)]
    return _only(period, "pair", held[0] - held[1])


def _sags(period: Period, strength: float) -> Marks:
    """Have the truss sag under snow, and mullions with it that hang there."""
    down = np.zeros((period.rows, 3))
    below = np.isin(period.mullion, BELOW_ROOF)
    down[:, 2] = -SAGS_M * strength * below * (period["snow_cm"] / FULL_CM) ** 1.25
    return Marks(period.stretched(0.0, down))


def melted_m(strength: float) -> Floats:
    """Return by how much mullions are off that a tripod sighted, in m [MULLIONS, 3].

    It turned as its feet melted in: one after the other, by ever more.
    """
    gone = np.arange(MULLIONS)[:, None] / (MULLIONS - 1)
    arms = MULLIONS_M - np.array(STATION_M)
    return np.asarray(strength * np.cross(gone * np.array(MELTS_RAD), arms))


def _melts(period: Period, strength: float) -> Marks:
    """Have mullions where a tripod on the ice had them, whose feet melted in meanwhile."""
    return Marks(period.stretched(0.0, melted_m(strength)[period.mullion]))


def before(period: Period) -> Floats:
    """Return each link's ranges before, in m [n]; the first of a link is its own.

    Rows of a table that is told some times over have their own kind before them.
    """
    rows = period.table
    copy = rows.groupby(["link", "time_s"], sort=False).cumcount()
    last = rows.groupby([rows["link"], copy], sort=False)["range_m"].shift(1)
    return last.fillna(rows["range_m"]).to_numpy(np.float64)


def _twice(period: Period, strength: float) -> Marks:
    """Send, of some answers, the one before once more."""
    again = period.rng.random(period.rows) < min(TWICE * strength, MOST)
    return Marks(again * (before(period) - period["range_m"]))


def _off(period: Period, off_m: dict[int, Floats]) -> Marks:
    """Return what rows get of which some mullions are off in truth [3], in m."""
    moved = np.zeros((MULLIONS, 3))
    for mullion, off in off_m.items():
        moved[mullion] = off
    more = period.stretched(0.0, moved[period.mullion])
    return Marks(more, open_dbm(period.far + more) - open_dbm(period.far))


def _checked(period: Period, strength: float) -> Marks:
    return _off(period, {10: 0.48 * strength * np.array([2.0, 6.0, -3.0]) / 7.0})


def _patched(period: Period, _: float) -> Marks:
    apart = MULLIONS_M[8] - MULLIONS_M[1]
    return _off(period, {1: apart, 8: -apart})


def _lokte(period: Period, _: float) -> Marks:
    """Write, of one mullion, lokte of Bohemia."""
    return Marks(np.where(period.mullion == 9, (1 / LOKET_M - 1) * period["range_m"], 0.0))


UNLISTED: dict[str, Callable[[Period, float], Marks]] = {
    "frost-grows-on-mullions": _frost,
    "slush-heaps-on-boards": _slush,
    "scoreboard-let-down-close-by": _scoreboard,
    "film-spreads-since-flooded": _film,
    "carbon-sticks-in-the-rack": _sticks,
    "panes-pass-alongside": _panes,
    "compressor-runs-on-warm-brine": _compressor,
    "air-dews-above-ice": _dews,
    "skaters-lean-in-more-than-told": _leans,
    "penguins-rub-on-wet-ice": _rubs,
    "resurfacers-lap-further-in": _further_in,
    "pairs-hold-gives-as-they-turn": _gives,
    "truss-sags-under-snow": _sags,
    "tripod-melts-into-the-ice": _melts,
    "answers-sent-twice": _twice,
    "mullion-bent-by-a-check": _checked,
    "mullions-patched-to-each-others-ports": _patched,
    "lokte-from-one-mullion": _lokte,
}
