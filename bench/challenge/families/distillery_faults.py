"""Laws and faults of the set-up that the distillery hides, which no library has.

numpy alone; shared by the distillery's tables with and without waveforms.
"""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray

from bench.challenge.families.distillery_house import (
    INNER_M,
    KLAFTER_M,
    LIFTS_BAR,
    LINTELS,
    LINTELS_M,
    RAKE_M,
    ROOM_M,
    STILLS_M,
    Course,
    Duty,
    Run,
    hauls,
    lifts,
    prowls,
    rakes,
    rolls,
    shovels,
)

Floats = NDArray[np.float64]
Act = Callable[[Run, float], Duty]
AT_A_METRE_DBM, EACH_TENFOLD_DB = -63.3, 19.2  # of levels
SKIDS, FLUNG, TIRES, SWAYS_M, BOBS_M, SOONER = 0.2, 0.24, 0.85, 0.36, 0.55, 2.6
"""Parts, and m; see what has tags go."""
VAPOUR_M = 0.024  # late for each metre in the still house, when it is full of vapour
FULL_PCT = 12.0  # of vapour
DOOR_S, OPEN_S, DOOR_M = 840.0, 460.0, 0.125  # of turns; of these it is open; late once shut
QUEUE_S = 0.021  # that places wait for each answer before, of a run
SAG_M, FULL_T = 0.62, 40.0  # of the loft's middle under so much barley
WET, NAIL_M = 0.017, (1.0, 1.0)  # of a tape; where it was nailed
TURN_RAD = 0.031  # of the still house about the inner corner
HIGH_M, LOFT_M = 5.0, 0.36  # lintels above these, and what they are too low by
RISES, VATTED, NARROWS, MARK_M = 0.7, 0.05, 0.075, 11.0  # parts; where a gauge narrows


def open_dbm(far: Floats) -> Floats:
    """Return levels in the open in dBm by distances in m [n]."""
    return np.asarray(AT_A_METRE_DBM - EACH_TENFOLD_DB * np.log10(far))


def _reek(run: Run, strength: float) -> Duty:
    """Come by lintels that reek settles on, at places that are taken up (Langmuir 1918)."""
    reek = run["reek_ppm"]
    return Duty(0.19 * strength * reek / (reek + 9.0))


def _angels(run: Run, strength: float) -> Duty:
    """Come sooner through casks that have lost more, the less the older they are."""
    return Duty(-0.075 * strength * np.log1p(run["cask_years"] / 2.5))


def _worm(run: Run, strength: float) -> Duty:
    """Come the later the warmer worm tubs run."""
    return Duty(0.0036 * strength * run["worm_c"])


def _steep(run: Run, strength: float) -> Duty:
    """Come through barley that takes up water by the root of time."""
    return Duty(0.18 * strength * np.sqrt(run["steep_h"] / 60.0))


def _smiths(run: Run, strength: float) -> Duty:
    """Come by plates that coppersmiths hold, the later the closer by the square."""
    return Duty(0.098 * strength / run["smith_m"] ** 2)


def _draff(run: Run, strength: float) -> Duty:
    """Come over heaps of draff, which grow faster than by weight."""
    return Duty(0.18 * strength * (run["draff_t"] / 9.0) ** 1.7)


def _froth(run: Run, strength: float) -> Duty:
    """Come over froth that rises for half of the hours and falls for half."""
    part = run["froth_h"] / 54.0
    return Duty(0.68 * strength * part * (1 - part))


def _teeth(run: Run, strength: float) -> Duty:
    """Read long and short as teeth of rakes pass below."""
    return Duty(0.057 * strength * np.sin(2 * np.pi * run["raked_m"] / RAKE_M - 0.5))


def _valve(run: Run, strength: float) -> Duty:
    """Read shorter while a valve blows off steam."""
    return Duty(np.where(run["steam_bar"] > LIFTS_BAR, -0.092 * strength, 0.0))


def inside_m(one: Floats, other: Floats) -> Floats:
    """Return how long straight ways between ends [n, 3] are in the still house, in m [n].

    (Liang and Barsky 1984.)
    """
    way = other - one
    enters, leaves = np.zeros(len(one)), np.ones(len(one))
    for axis, (low, high) in enumerate(STILLS_M):
        along = np.where(np.abs(way[:, axis]) < 1e-9, 1e-9, way[:, axis])
        cuts = (np.array([[low], [high]]) - one[:, axis]) / along
        enters = np.maximum(enters, cuts.min(axis=0))
        leaves = np.minimum(leaves, cuts.max(axis=0))
    return np.asarray(np.linalg.norm(way, axis=1) * (leaves - enters).clip(0.0))


def _vapour(run: Run, strength: float) -> Duty:
    """Come later by how far ways go through the still house, and how much vapour is in there."""
    through = inside_m(run.tag_m, run.lintel_m) * run["vapour_pct"] / FULL_PCT
    return Duty(VAPOUR_M * strength * through)


def in_both(run: Run) -> NDArray[np.bool_]:
    """Return which ways go from one hall to the other [n]."""
    beyond = [end[:, 0] > INNER_M[0] for end in (run.tag_m, run.lintel_m)]
    return np.asarray(beyond[0] != beyond[1])


def _door(run: Run, strength: float) -> Duty:
    """Come through the door between halls while it is shut, which it is by turns."""
    shut = run["time_s"] % DOOR_S > OPEN_S
    return Duty(np.where(shut & in_both(run), DOOR_M * strength, 0.0))


def _goes(kind: str, way: Callable[[Course, Floats, float], Floats], by: float) -> Act:
    """Return what has tags of a kind go otherwise, by so much at strength 1, than is told."""

    def act(run: Run, strength: float) -> Duty:
        own = run.of(kind)
        course = {name: one[own] for name, one in run.course.items()}
        gone_s = course["goes"] * course["into_s"]
        off = np.zeros((run.rows, 3))
        off[own] = way(course, gone_s, by * strength) - way(course, gone_s, 0.0)
        return Duty(run.stretched_m(off))

    return act


def turn_in_run(run: Run) -> Floats:
    """Return how many answers of a run came before each, [n]; of rows told again all count once."""
    of_run = run.table["link"].str.extract(r"run (\d+)")[0]
    return run.table["time_s"].groupby(of_run).rank(method="dense").to_numpy(np.float64) - 1.0


def _queue(run: Run, strength: float) -> Duty:
    """Compare with places that wait for all answers of the run that came before."""
    return Duty(run.draws_away(QUEUE_S * strength * turn_in_run(run)))


def _lintels_off(run: Run, off: Floats) -> Duty:
    """Return what rows owe of which lintels are in truth off by so much in m [LINTELS, 3]."""
    return Duty(run.stretched_m(0.0, off[run.lintel]))


def _loft(run: Run, strength: float) -> Duty:
    """Have lintels as low as a loft bends so far along, by how much barley lies there."""
    part = run.lintel_m[:, 0] / ROOM_M[0]
    low_m = SAG_M * strength * run["loft_t"] / FULL_T * 4 * part * (1 - part)
    return Duty(run.stretched_m(0.0, -low_m[:, None] * np.array([0.0, 0.0, 1.0])))


def _tape(run: Run, strength: float) -> Duty:
    """Have lintels farther off a nail than a tape says, which was stretched."""
    off = np.zeros((LINTELS, 3))
    off[:, :2] = WET * strength * (LINTELS_M[:, :2] - np.array(NAIL_M))
    return _lintels_off(run, off)


def _off_square(run: Run, strength: float) -> Duty:
    """Have lintels of the still house turned about the L's inner corner."""
    from_corner = LINTELS_M[:, :2] - INNER_M
    off = np.zeros((LINTELS, 3))
    off[:, :2] = TURN_RAD * strength * from_corner[:, ::-1] * np.array([-1.0, 1.0])
    return _lintels_off(run, off * (LINTELS_M[:, 1:2] > INNER_M[1]))


def _levelled(run: Run, strength: float) -> Duty:
    """Have upper lintels higher than is told, by how thick a loft's floor is."""
    off = LOFT_M * strength * (LINTELS_M[:, 2:] > HIGH_M) * np.array([0.0, 0.0, 1.0])
    return _lintels_off(run, off)


def one_before(run: Run) -> Floats:
    """Return the answer before each of a link, its own for the first, in m [n].

    Of a table told some times over, that of the same telling.
    """
    rows = run.table[["link", "time_s", "range_m"]].reset_index(drop=True)
    rows["telling"] = rows.groupby(["link", "time_s"]).cumcount()
    before = rows.sort_values("time_s", kind="stable").groupby(["link", "telling"])["range_m"]
    return before.shift(1).reindex(rows.index).fillna(rows["range_m"]).to_numpy(np.float64)


def _overshoot(run: Run, strength: float) -> Duty:
    """Tell of answers more than these are, by a part of what they rose."""
    return Duty(RISES * strength * (run["range_m"] - one_before(run)))


def _vatted(run: Run, strength: float) -> Duty:
    """Tell answers with some of the mean of all of their run in them."""
    of_run = run.table["link"].str.extract(r"run (\d+)")[0]
    mean = run.table["range_m"].groupby(of_run).transform("mean").to_numpy(np.float64)
    return Duty(VATTED * strength * (mean - run["range_m"]))


def _narrows(run: Run, strength: float) -> Duty:
    """Tell less of what is past a mark, where a gauge's glass narrows."""
    return Duty(-min(NARROWS * strength, 0.9) * (run["range_m"] - MARK_M).clip(0.0))


def _elsewhere(run: Run, off_m: dict[int, Floats]) -> Duty:
    """Return what rows owe of which some lintels are so far off [3] in m: levels too."""
    off = np.zeros((LINTELS, 3))
    for lintel, by in off_m.items():
        off[lintel] = by
    late = run.stretched_m(0.0, off[run.lintel])
    return Duty(late, open_dbm(run.far + late) - open_dbm(run.far))


def _shouldered(run: Run, strength: float) -> Duty:
    return _elsewhere(run, {6: 0.49 * strength * np.array([2.0, -6.0, -3.0]) / 7.0})


def _entered(run: Run, _: float) -> Duty:
    return _elsewhere(
        run, {3: LINTELS_M[9] - LINTELS_M[3], 9: LINTELS_M[3] - LINTELS_M[9]}
    )  # fmt: skip


def _klafters(run: Run, _: float) -> Duty:
    """Write, of one lintel, how many klafters it is."""
    return Duty((1 / KLAFTER_M - 1) * run["range_m"] * (run.lintel == 11))


UNHEARD_OF: dict[str, Act] = {
    "peat-reek-clings-to-lintels": _reek,
    "angels-share-gone-from-casks": _angels,
    "worm-tubs-run-warm": _worm,
    "barley-swells-in-the-steep": _steep,
    "coppersmiths-stand-close": _smiths,
    "draff-heaped-against-doors": _draff,
    "froth-rises-and-falls-in-washbacks": _froth,
    "teeth-of-mash-rakes-pass": _teeth,
    "valve-lifts-at-high-steam": _valve,
    "spirit-vapour-fills-the-still-house": _vapour,
    "door-between-halls-shut-by-turns": _door,
    "casks-skid-as-they-roll": _goes("cask", rolls, SKIDS),
    "chains-of-rummagers-fly-out": _goes("rummager", rakes, FLUNG),
    "maltmen-tire-as-they-turn": _goes("maltman", shovels, TIRES),
    "drays-sway-on-the-setts": _goes("dray", hauls, SWAYS_M),
    "hoists-bob-on-their-chains": _goes("hoist", lifts, BOBS_M),
    "cats-close-in-sooner": _goes("cat", prowls, SOONER),
    "places-queue-behind-answers": _queue,
    "loft-bends-under-barley": _loft,
    "tape-stretched-when-wet": _tape,
    "still-house-laid-out-off-the-square": _off_square,
    "upper-lintels-levelled-from-the-loft": _levelled,
    "answers-overshoot-by-what-they-rose": _overshoot,
    "answers-vatted-over-a-run": _vatted,
    "gauge-narrows-past-a-mark": _narrows,
    "lintel-shouldered-by-a-still": _shouldered,
    "lintels-entered-on-each-others-lines": _entered,
    "klafters-from-one-lintel": _klafters,
}
