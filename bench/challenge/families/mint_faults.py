"""Laws and faults of the set-up that the mint hides, which no library has.

numpy and pandas alone; shared by the mint's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.challenge.families.mint_court import (
    FLUE_C,
    QUOINS,
    QUOINS_M,
    REED_M,
    TOISE_M,
    WAVE_M,
    Course,
    Tally,
    Toll,
    carries,
    flies,
    looks_in,
    rides,
    runs,
    unwinds,
)

Floats = NDArray[np.float64]
Act = Callable[[Tally, float], Toll]
AT_A_METRE_DBM, EACH_TENFOLD_DB = -65.6, 19.0  # of levels
FURTHER, SOONER, HURRIES, SPRINGS, HANGS_S2, CUTS_M = 0.3, 0.3, 0.16, 1.2, 0.6, 0.8
"""Parts, s^2 and m; see what has tags go."""
PASSAGE_M: Floats = np.array([[0.0, 0.0], [38.0, 10.0]])
LEAKS_M = 0.018  # late for the root of a Pa
SMOOTHS_S = 0.65  # to either side
EACH_PA_M = 0.083  # of heights, by air's weight
LEAF_M, HUNG = 0.55, (5, 9, 12)  # how wide leaves are; quoins that hang on these
STATION_M, ASKEW_RAD, FROM_RAD = (19.0, 15.0), 0.032, 0.7  # of a theodolite; at most; about where
LEVEL_M, BENDS = (3.0, 15.0), 0.0005  # of a level; up for each m^2
SAGS_M, RECOVERS_S = 0.014, 1.3  # late for each answer; to 1 / e
COARSE_M, RIPPLES = 0.3, 0.22  # of a coarse count; of which so much is read too soon
STRIKES_S, STUNS_S = 2.3, 1.0  # between strikes; for how long answers are held
FLAT = 0.45  # of heights' squares that is left out


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far))


def _dust(tally: Tally, strength: float) -> Toll:
    """Come by quoins that dust lies on, which has room for so much."""
    return Toll(-0.17 * strength * np.expm1(-tally["dust_mg"] / 11.0))


def _fumes(tally: Tally, strength: float) -> Toll:
    """Come sooner through covers that fumes have thinned, ever less so."""
    return Toll(-0.07 * strength * np.log1p(tally["fume_ppm"] / 4.0))


def _strip(tally: Tally, strength: float) -> Toll:
    return Toll(0.021 * strength * tally["strip_mm"])


def _borax(tally: Tally, strength: float) -> Toll:
    """Come through borax that creeps as drops spread (Tanner 1979, by a power)."""
    return Toll(0.17 * strength * (tally["fluxed_h"] / 26.0) ** 0.4)


def _hopper(tally: Tally, strength: float) -> Toll:
    return Toll(0.088 * strength / tally["hopper_m"] ** 2)


def _bullion(tally: Tally, strength: float) -> Toll:
    return Toll(0.2 * strength * (tally["bullion_t"] / 6.0) ** 1.6)


def _anneals(tally: Tally, strength: float) -> Toll:
    """Come by copper that reddens for half of the time and pales for half."""
    part = tally["anneal_min"] / 48.0
    return Toll(0.7 * strength * part * (1 - part))


def _ribs(tally: Tally, strength: float) -> Toll:
    return Toll(0.059 * strength * np.cos(2 * np.pi * tally["reed_m"] / REED_M + 1.1))


def _fan(tally: Tally, strength: float) -> Toll:
    return Toll(np.where(tally["flue_c"] > FLUE_C, 0.096 * strength, 0.0))


def caged_m(one: Floats, other: Floats) -> Floats:
    """Return how long straight ways between ends [n, 3] are in the caged passage, in m [n]."""
    way = other[:, :2] - one[:, :2]
    way = np.where(np.abs(way) < 1e-9, 1e-9, way)
    cuts = np.sort(np.stack([(side - one[:, :2]) / way for side in PASSAGE_M]), axis=0)
    share = cuts[1].min(axis=1).clip(max=1.0) - cuts[0].max(axis=1).clip(min=0.0)
    return np.asarray(np.linalg.norm(other - one, axis=1) * share.clip(min=0.0))


def slowed(gate_m: Floats) -> Floats:
    """Return by which part waves are late between plates so far apart in m [n]."""
    return np.asarray(1 / np.sqrt(1 - (0.5 * WAVE_M / gate_m) ** 2) - 1)


def _cage(tally: Tally, strength: float) -> Toll:
    """Go the slower the narrower a passage's cages are, as guided waves do (Rayleigh 1897)."""
    within = caged_m(tally.tag_m, tally.quoin_m)
    return Toll(strength * within * slowed(0.01 * tally["gate_cm"]))


def _seals(tally: Tally, strength: float) -> Toll:
    """Come through air that leaks by the root of what pressures differ (Torricelli)."""
    differ = tally["vault_pa"] - tally["hall_pa"]
    return Toll(LEAKS_M * strength * np.sign(differ) * np.sqrt(np.abs(differ)))


def _goes(kind: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a kind go otherwise, by so much at strength 1, than is told."""

    def act(tally: Tally, strength: float) -> Toll:
        own, off = tally.are(kind), np.zeros((tally.rows, 3))
        course = {name: one[own] for name, one in tally.course.items()}
        gone_s = course["moving"] * course["into_s"]
        off[own] = way(course, gone_s, by * strength) - way(course, gone_s, 0.0)
        return Toll(tally.grown_m(off))

    return act


def _smoothed(tally: Tally, strength: float) -> Toll:
    """Compare with places that are told as the middle of one before and one after."""
    later_s = SMOOTHS_S * np.sqrt(strength)
    return Toll(-0.5 * (tally.recedes(later_s) + tally.recedes(-later_s)))


def _barometer(tally: Tally, strength: float) -> Toll:
    """Have tags lower than is told of them while fans draw air out."""
    down_m = EACH_PA_M * strength * tally["fans_pa"]
    return Toll(tally.grown_m(-down_m[:, None] * np.array([0.0, 0.0, 1.0])))


def _door(tally: Tally, strength: float) -> Toll:
    """Have quoins that hang on leaves where these have swung to."""
    angle = np.radians(tally["door_deg"])
    off = np.column_stack([np.cos(angle) - 1, np.sin(angle), 0.0 * angle])
    hung = np.isin(tally.quoin, HUNG)[:, None]
    return Toll(tally.grown_m(0.0, LEAF_M * strength * hung * off))


def _quoins_off(tally: Tally, off: Floats) -> Toll:
    """Return what is taken if quoins are in truth off by so much in m [QUOINS, 3]."""
    return Toll(tally.grown_m(0.0, off[tally.quoin]))


def _off_centre(tally: Tally, strength: float) -> Toll:
    """Have quoins turned about a station, by how far a circle's mark is off centre there."""
    from_station = QUOINS_M[:, :2] - np.array(STATION_M)
    bearing = np.arctan2(from_station[:, 1], from_station[:, 0])
    askew = ASKEW_RAD * strength * np.sin(bearing - FROM_RAD)
    off = np.zeros((QUOINS, 3))
    off[:, :2] = askew[:, None] * from_station[:, ::-1] * np.array([-1.0, 1.0])
    return _quoins_off(tally, off)


def _bent_sight(tally: Tally, strength: float) -> Toll:
    """Have quoins higher by the square of how far a level looked, over a floor that was hot."""
    far = np.linalg.norm(QUOINS_M[:, :2] - np.array(LEVEL_M), axis=1)
    return _quoins_off(tally, np.outer(BENDS * strength * far**2, [0.0, 0.0, 1.0]))


def crowded(tally: Tally) -> Floats:
    """Return how many answers of a turn came just before each, old ones the less [n]."""
    made, time_s = np.zeros(tally.rows), tally["time_s"]
    for number in np.unique(tally.of_run):
        own = tally.of_run == number
        when, where = np.unique(time_s[own], return_inverse=True)
        ago = when[:, None] - when
        left = np.where(ago > 0, np.exp(-ago.clip(0.0) / RECOVERS_S), 0.0).sum(axis=1)
        made[own] = left[where]
    return made


def _sags(tally: Tally, strength: float) -> Toll:
    return Toll(SAGS_M * strength * crowded(tally))


def _ripples(tally: Tally, strength: float) -> Toll:
    """Lose a coarse count of those that have just begun another."""
    begun = tally["range_m"] / COARSE_M % 1.0
    return Toll(np.where(begun < RIPPLES, -COARSE_M * strength, 0.0))


def by_telling(tally: Tally) -> pd.DataFrame:
    """Return links, times, ranges and tellings of rows: which of equal rows is which."""
    rows = tally.table[["link", "time_s", "range_m"]].reset_index(drop=True)
    return rows.assign(telling=rows.groupby(["link", "time_s"]).cumcount())


def out_of_order(tally: Tally, bag: int) -> Floats:
    """Return ranges of links of which each bag's are told the last first, in m [n]."""
    rows = by_telling(tally).sort_values("time_s", kind="stable")
    made = pd.Series(0.0, index=rows.index)
    for _, own in rows.groupby(["link", "telling"], sort=False)["range_m"]:
        ranges = own.to_numpy()
        made[own.index] = np.concatenate(
            [ranges[at : at + bag][::-1] for at in range(0, len(ranges), bag)]
        )
    return np.asarray(made.sort_index(), np.float64)


def _bags(tally: Tally, strength: float) -> Toll:
    """Tell answers by bags, of which the last is on top."""
    return Toll(out_of_order(tally, 1 + int(np.ceil(strength))) - tally["range_m"])


def _held(tally: Tally, strength: float) -> Toll:
    """Tell the last answer of a link again while a press strikes."""
    rows = by_telling(tally).sort_values("time_s", kind="stable")
    struck = rows["time_s"] % STRIKES_S < min(STUNS_S * strength, 0.9 * STRIKES_S)
    kept = rows.assign(range_m=rows["range_m"].mask(struck))
    last = kept.groupby(["link", "telling"])["range_m"].ffill()
    told = last.fillna(rows["range_m"]).sort_index().to_numpy(np.float64)
    return Toll(told - tally["range_m"])


def _flat(tally: Tally, strength: float) -> Toll:
    """Leave out some of how much higher quoins are than tags."""
    higher = tally.quoin_m[:, 2] - tally.tag_m[:, 2]
    left = tally.far**2 - min(FLAT * strength, 0.95) * higher**2
    return Toll(np.sqrt(left) - tally.far)


def _elsewhere(tally: Tally, off_m: dict[int, Floats]) -> Toll:
    """Return what is taken if some quoins are so far off [3] in m: levels too."""
    off = np.zeros((QUOINS, 3))
    for quoin, by in off_m.items():
        off[quoin] = by
    longer = tally.grown_m(0.0, off[tally.quoin])
    return Toll(longer, open_dbm(tally.far + longer) - open_dbm(tally.far))


def _barged(tally: Tally, strength: float) -> Toll:
    return _elsewhere(tally, {13: 0.52 * strength * np.array([6.0, 3.0, -2.0]) / 7.0})


def _sealed(tally: Tally, _: float) -> Toll:
    apart = QUOINS_M[16] - QUOINS_M[6]
    return _elsewhere(tally, {6: apart, 16: -apart})


def _toises(tally: Tally, _: float) -> Toll:
    """Write, of one quoin, how many toises it is."""
    return Toll(np.where(tally.quoin == 10, (1 / TOISE_M - 1) * tally["range_m"], 0.0))


OF_THE_MINT: dict[str, Act] = {
    "gold-dust-settles-on-quoins": _dust,
    "pickle-fumes-eat-at-covers": _fumes,
    "strip-is-rolled-thick": _strip,
    "borax-creeps-since-fluxed": _borax,
    "coin-hopper-swung-close": _hopper,
    "bullion-piled-before-quoins": _bullion,
    "annealing-reddens-and-pales": _anneals,
    "ribs-of-reeding-wheels-pass": _ribs,
    "fan-thrown-in-at-a-hot-flue": _fan,
    "caged-passage-guides-what-passes": _cage,
    "seals-leak-by-what-pressures-differ": _seals,
    "presses-swing-further-than-told": _goes("press", flies, FURTHER),
    "rails-bend-sooner-than-drawn": _goes("truck", rides, SOONER),
    "warders-hurry-across": _goes("warder", looks_in, HURRIES),
    "coils-spring-open": _goes("coil", unwinds, SPRINGS),
    "ladles-hang-back-as-they-gain": _goes("ladle", carries, HANGS_S2),
    "couriers-cut-across-sooner": _goes("courier", runs, CUTS_M),
    "places-smoothed-both-ways": _smoothed,
    "heights-told-by-a-barometer": _barometer,
    "strongroom-door-swings-its-quoins": _door,
    "circle-of-the-theodolite-off-centre": _off_centre,
    "levels-sighted-over-a-hot-floor": _bent_sight,
    "batteries-sag-as-answers-crowd": _sags,
    "coarse-count-read-before-it-ripples": _ripples,
    "bags-of-answers-opened-out-of-order": _bags,
    "answers-held-while-presses-strike": _held,
    "ranges-told-along-the-floor": _flat,
    "quoin-barged-by-a-dray": _barged,
    "quoins-sealed-with-each-others-stamps": _sealed,
    "toises-from-one-quoin": _toises,
}
