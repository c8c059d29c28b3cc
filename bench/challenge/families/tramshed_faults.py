"""Laws and faults of the set-up that the tram shed hides, which no library has.

numpy and pandas alone; shared by the tram shed's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.tramshed_depot import (
    BOILER_M,
    BRACCIO_M,
    GOVERNOR_BAR,
    ROSETTES,
    ROSETTES_M,
    SHED_M,
    SLEEPER_M,
    Course,
    Fares,
    Fine,
    jacked,
    swings,
    traverses,
    turns_out,
    walked_round,
    weaves,
)

Floats = NDArray[np.float64]
Act = Callable[[Fares, float], Fine]
AT_A_METRE_DBM, EACH_TENFOLD_DB = -65.2, 19.6  # of levels
LATER_M, OVER, BROADER, SINKS, LONGER, TRAILS = 1.2, 0.2, 0.4, 0.4, 0.5, 0.22
"""m, parts; see what has tags go."""
PITS_Y, DUST_M = (6.0, 15.0), 0.0042  # across the shed; late for each m therein and mg
SHIMMER_M, SHIMMER_K = 4.5, 0.00075  # from the boiler to 1 / e; late for each m there and K
FED_S, SECTIONS, FED_M = 900.0, 4, 0.14  # each section in turn; of these; late
PICKS_KPA, DROPS_KPA, HELD_M = 62.0, 36.0, 0.105  # of a relay; late while it holds
DRAWN = 0.16  # part of the way to the middle of a turn
SAGS_M = 0.55  # of rosettes, at most
MISSED_M: Floats = np.array([0.5, -0.34, 0.1])  # of a survey that ends where it began
BOWS_M, FULL_T = 0.5, 16.0  # of girders, at most; under so much
HEAVES = 0.006  # m for each mm of frost
CHANGES_S, AROUND_S, CREWS_M = (7200.0, 19000.0, 31500.0), 1500.0, 0.22
"""When crews change; to 1 / e; late at most."""
MERGED = 0.55  # part of the way to the next answer
SMEARED = 0.06  # part of the last caller's answer
SPLICE_M, SPLICED_M = 13.0, 0.11  # from where on a tape is long; by how much
CURVE_M = 72.0  # radius of a curve whose chords are told
TORN: Floats = np.array([-2.0, 3.0, -6.0]) / 7.0


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far))


def _sand(fares: Fares, strength: float) -> Fine:
    """Come by sand that packs until no more goes in (Michaelis and Menten)."""
    return Fine(0.19 * strength * fares["sand_kg"] / (9.0 + fares["sand_kg"]))


def _carbon(fares: Fares, strength: float) -> Fine:
    """Come by a film that grows the slower the thicker it is: the logarithm of days."""
    return Fine(0.052 * strength * np.log1p(fares["wiped_d"] / 11.0))


def _varnish(fares: Fares, strength: float) -> Fine:
    return Fine(2.1e-4 * strength * fares["varnish_um"])


def _slack(fares: Fares, strength: float) -> Fine:
    """Come late as wires hang: the inverse of what draws them (a parabola's sag)."""
    return Fine(0.36 * strength / fares["tension_kn"])


def _wagon(fares: Fares, strength: float) -> Fine:
    return Fine(0.13 * strength / fares["wagon_m"] ** 2)


def _feeders(fares: Fares, strength: float) -> Fine:
    """Come late as feeders warm, by a power of the current a little under Joule's."""
    return Fine(0.068 * strength * fares["feeder_ka"] ** 1.8)


def _lamps(fares: Fares, strength: float) -> Fine:
    return Fine(1.6e-5 * strength * (fares["line_v"] - 555.0) ** 2)


def _sleepers(fares: Fares, strength: float) -> Fine:
    return Fine(0.058 * strength * np.sin(2 * np.pi * fares["sleepers_m"] / SLEEPER_M + 0.8))


def _governor(fares: Fares, strength: float) -> Fine:
    return Fine(np.where(fares["tank_bar"] < GOVERNOR_BAR, 0.091 * strength, 0.0))


def in_pits_m(one: Floats, other: Floats) -> Floats:
    """Return how long straight ways between ends [n, 3] are over the pits, in m [n]."""
    ends = np.clip(np.stack([one[:, 1], other[:, 1]]), *PITS_Y)
    across = np.abs(other[:, 1] - one[:, 1])
    inside = (one[:, 1] > PITS_Y[0]) & (one[:, 1] < PITS_Y[1])
    part = np.where(across > 1e-9, np.abs(ends[1] - ends[0]) / across.clip(1e-9), inside)
    return np.asarray(part * np.linalg.norm(other - one, axis=1))


def _dust(fares: Fares, strength: float) -> Fine:
    """Come by dust of brakes, by the way over the pits."""
    return Fine(DUST_M * strength * in_pits_m(fares.tag_m, fares.rosette_m) * fares["brake_mg"])


def _shimmers(fares: Fares, strength: float) -> Fine:
    """Come by warm air about the boiler: summed along ways, less by a bell of how far off it is."""
    near = np.zeros(fares.rows)
    for part in (np.arange(24) + 0.5) / 24:
        at = fares.tag_m + part * (fares.rosette_m - fares.tag_m)
        off = np.hypot(at[:, 0] - BOILER_M[0], at[:, 1] - BOILER_M[1]) / SHIMMER_M
        near += np.exp(-(off**2)) * fares.far / 24
    return Fine(SHIMMER_K * strength * near * fares["boiler_k"])


def _fed(fares: Fares, strength: float) -> Fine:
    """Come late by rosettes on the section of wire that is fed by now."""
    fed = np.floor(fares["time_s"] / FED_S).astype(np.int64) % SECTIONS
    return Fine(np.where(fares.rosette % SECTIONS == fed, FED_M * strength, 0.0))


def held(pressed: Floats) -> NDArray[np.bool_]:
    """Return when a relay holds [n]: once over PICKS_KPA, until under DROPS_KPA."""
    said = np.where(pressed > PICKS_KPA, 1.0, np.where(pressed < DROPS_KPA, 0.0, np.nan))
    return pd.Series(said).ffill().fillna(0.0).to_numpy() > 0.5


def _relay(fares: Fares, strength: float) -> Fine:
    """Come late while a relay holds, which it does by what was before."""
    _, first, where = np.unique(fares["time_s"], return_index=True, return_inverse=True)
    return Fine(HELD_M * strength * held(fares["relay_kpa"][first])[where].astype(np.float64))


def _goes(duty: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a duty go otherwise, by so much at strength 1, than is told."""

    def act(fares: Fares, strength: float) -> Fine:
        own = fares.on(duty)
        course = {name: one[own] for name, one in fares.course.items()}
        gone_s = course["goes"] * course["into_s"]
        off = np.zeros((fares.rows, 3))
        off[own] = way(course, gone_s, by * strength) - way(course, gone_s, 0.0)
        return Fine(fares.longer_m(off))

    return act


def _middles(fares: Fares, strength: float) -> Fine:
    """Compare with places that are drawn to the middle of all of a turn."""
    turn = fares.table["link"].str.replace(r" by rosette\d+$", "", regex=True).to_numpy()
    middle = pd.DataFrame(fares.tag_m).groupby(turn).transform("mean").to_numpy()
    return Fine(strength * DRAWN / (1 - DRAWN) * fares.longer_m(fares.tag_m - middle))


def _rosettes_off(fares: Fares, off: Floats) -> Fine:
    """Return what is fined if rosettes are in truth off by so much in m [ROSETTES, 3]."""
    return Fine(fares.longer_m(0.0, off[fares.rosette]))


def _sags(fares: Fares, strength: float) -> Fine:
    """Have rosettes lower than is told, the more so amid the shed (a parabola)."""
    amid = 1 - (2 * ROSETTES_M[:, 0] / SHED_M[0] - 1) ** 2
    return _rosettes_off(fares, np.outer(-SAGS_M * strength * amid, [0.0, 0.0, 1.0]))


def _misclosed(fares: Fares, strength: float) -> Fine:
    """Have a survey's misclosure grow from the first rosette to the last."""
    part = np.arange(ROSETTES) / (ROSETTES - 1)
    return _rosettes_off(fares, strength * np.outer(part, MISSED_M))


def _bows(fares: Fares, strength: float) -> Fine:
    """Have rosettes lower by what is lifted, by a beam's half wave across the shed."""
    amid = np.sin(np.pi * fares.rosette_m[:, 1] / SHED_M[1])
    down = BOWS_M * strength * amid * fares["lifted_t"] / FULL_T
    return Fine(fares.longer_m(0.0, np.outer(-down, [0.0, 0.0, 1.0])))


def _heaves(fares: Fares, strength: float) -> Fine:
    """Have tags higher by frost under the setts, the more so towards the doors."""
    up = HEAVES * strength * fares["frost_mm"] * (0.5 + fares.tag_m[:, 0] / SHED_M[0])
    return Fine(fares.longer_m(np.outer(up, [0.0, 0.0, 1.0])))


def _crews(fares: Fares, strength: float) -> Fine:
    """Come the later, the nearer to when crews change."""
    late = [np.exp(-np.abs(fares["time_s"] - at) / AROUND_S) for at in CHANGES_S]
    return Fine(CREWS_M * strength * np.asarray(np.sum(late, axis=0), np.float64))


def in_turn(fares: Fares, by: str) -> pd.DataFrame:
    """Return ranges of rows by time, and which go together: of a column and a copy."""
    rows = fares.table[["link", "tx", "time_s", "range_m"]].reset_index(drop=True)
    copy = rows.groupby(["link", "time_s"]).cumcount().astype(str)
    rows["series"] = rows[by] + " " + copy
    return rows.sort_values("time_s", kind="stable")


def _merged(fares: Fares, strength: float) -> Fine:
    """Tell answers as somewhere between these and the next of their link."""
    rows = in_turn(fares, "link")
    off = rows.groupby("series", sort=False)["range_m"].shift(-1) - rows["range_m"]
    return Fine(min(MERGED * strength, 1.4) * off.fillna(0.0).sort_index().to_numpy(np.float64))


def _smeared(fares: Fares, strength: float) -> Fine:
    """Tell a link's first answer with a part of what its rosette told last, of another link."""
    rows = in_turn(fares, "tx")
    before = rows.groupby("series", sort=False)[["range_m", "link"]].shift(1)
    first = before["link"].notna() & (before["link"] != rows["link"])
    off = (before["range_m"] - rows["range_m"]).where(first, 0.0)
    return Fine(SMEARED * strength * off.sort_index().to_numpy(np.float64))


def _spliced(fares: Fares, strength: float) -> Fine:
    """Tell all that is past a splice of the tape as longer by one length."""
    return Fine(np.where(fares["range_m"] > SPLICE_M, SPLICED_M * strength, 0.0))


def _chords(fares: Fares, strength: float) -> Fine:
    """Tell, of ways along a curve, chords; strength times what these lack."""
    half = 0.5 * fares["range_m"] / CURVE_M
    return Fine(2 * CURVE_M * strength * (np.sin(half) - half))


def _elsewhere(fares: Fares, off_m: dict[int, Floats]) -> Fine:
    """Return what is fined if some rosettes are so far off [3] in m: levels too."""
    off = np.stack([off_m.get(k, np.zeros(3)) for k in range(ROSETTES)])
    longer = fares.longer_m(0.0, off[fares.rosette])
    return Fine(longer, open_dbm(fares.far + longer) - open_dbm(fares.far))


def _torn(fares: Fares, strength: float) -> Fine:
    return _elsewhere(fares, {14: 0.45 * strength * TORN})


def _stencilled(fares: Fares, _: float) -> Fine:
    apart = ROSETTES_M[15] - ROSETTES_M[3]
    return _elsewhere(fares, {3: apart, 15: -apart})


def _braccia(fares: Fares, _: float) -> Fine:
    """Write, of one rosette, how many braccia it is."""
    return Fine((1 / BRACCIO_M - 1) * fares["range_m"] * (fares.rosette == 11))


OF_THE_TRAMSHED: dict[str, Act] = {
    "sand-packs-in-its-boxes": _sand,
    "carbon-films-rosettes-since-wiped": _carbon,
    "varnish-lies-thick-on-tags": _varnish,
    "slack-wire-lets-rosettes-hang": _slack,
    "tower-wagon-parked-close": _wagon,
    "feeders-warm-by-their-current": _feeders,
    "lamps-off-their-rated-voltage": _lamps,
    "sleepers-pass-underneath": _sleepers,
    "air-governor-lets-the-compressor-run": _governor,
    "brake-dust-hangs-along-the-pits": _dust,
    "air-shimmers-about-the-drying-boiler": _shimmers,
    "feeder-sections-fed-by-turns": _fed,
    "relay-holds-between-two-pressures": _relay,
    "trams-turn-out-at-later-blades": _goes("tram", turns_out, LATER_M),
    "traversers-overrun-their-lever": _goes("traverser", traverses, OVER),
    "sweepers-weave-broader-than-told": _goes("sweeper", weaves, BROADER),
    "jacks-sink-between-strokes": _goes("jack", jacked, SINKS),
    "blocks-hang-on-longer-falls": _goes("block", swings, LONGER),
    "poles-trail-behind-their-rope": _goes("pole", walked_round, TRAILS),
    "places-drawn-to-the-middle-of-a-turn": _middles,
    "rosettes-hang-low-amid-their-spans": _sags,
    "survey-closed-without-its-misclosure": _misclosed,
    "girders-bow-under-lifted-cars": _bows,
    "setts-heave-with-frost": _heaves,
    "answers-late-as-crews-change": _crews,
    "answers-merged-with-the-next": _merged,
    "first-answers-smeared-by-the-last-caller": _smeared,
    "tape-spliced-past-a-mark": _spliced,
    "ranges-told-as-chords-of-a-curve": _chords,
    "rosette-torn-by-a-dewired-pole": _torn,
    "rosettes-stencilled-for-each-other": _stencilled,
    "braccia-from-one-rosette": _braccia,
}
