"""The curve of a receiver's own control of levels, as recorded levels tell it.

Every make turns strong signals down by another curve: by a line, a root, a saturation, in steps.
Where a simulator is run again it says what arrives, so recorded levels show the curve itself. It
only rises: the more arrives, the more is turned down. What the form of the library leaves over
would else look like another effect on levels. Where a receiver accumulates all symbols it turns
nothing down, so a path loss, of which weak signals lose most, is not taken for it.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import isotonic_regression

from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.select.backfitting import polished
from bench.discrepancy.select.receiver_logs import Logged, logs
from bench.discrepancy.select.settings import (
    CONTROL_BEND_DB,
    CONTROL_RATIO,
    CONTROL_TURNS,
    LEVEL_FOLDS,
)
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import (
    FIT_MEMBERS,
    HUBER,
    MAD_TO_STD,
    RESOLUTION,
    ROBUST_PASSES,
    SEARCH_FIRST,
)
from bench.physics.effect import Effect
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.units import Floats


def with_curve(search: Search, added: Added) -> Added:
    """Return the effects, a control of levels among them with the curve that levels show.

    Of ranges alone, where a simulator is run again. In turns with the other effects: what a path
    loss takes the curve cannot, and the other way round.
    """
    known = any(isinstance(one, LevelControl) for one in added)
    if not known or search.fit.waveform or not isinstance(search.comparison, Resimulation):
        return added
    seen = logs(search, search.sharpest)
    for _ in range(CONTROL_TURNS):
        before, added = added, _with_curve(search, seen, added)
        if len(added) == 1 or added == before:
            break
        added = polished(search.comparison, search.sharpest, added, 1, anew=False)
    return added


def _with_curve(search: Search, seen: Logged, added: Added) -> Added:
    return tuple(
        curved(search, seen, without(added, one), one) if isinstance(one, LevelControl) else one
        for one in added
    )


def own_curve_of(effect: Effect) -> bool:
    """Return whether an effect holds a curve over the level that was read off recordings."""
    return isinstance(effect, LevelControl) and bool(effect.curve_dbm)


@dataclass(frozen=True)
class Fallen:
    """Levels of rows [n] beside some effects: what arrives in dBm, and by how much less is read.

    `most_db` [n] is what a control takes at most, as counts of symbols fall; `codes` tell links,
    `known` the rows of the view.
    """

    level_dbm: Floats
    fallen_db: Floats
    most_db: Floats
    codes: NDArray[np.intp]
    known: NDArray[np.bool_]

    @property
    def curve(self) -> tuple[Floats, Floats]:
        """The knots in dBm of the curve that these rows show, and what it takes there in dB."""
        return rising(self.level_dbm, self.fallen_db, self.most_db)

    @property
    def missed_db(self) -> Floats:
        """What curves of other links leave of these rows [n]."""
        out = np.empty_like(self.fallen_db)
        parts = (self.level_dbm, self.fallen_db, self.most_db)
        for fold in range(LEVEL_FOLDS):
            held = self.codes % LEVEL_FOLDS == fold
            curve = rising(*(one[~held] for one in parts))
            out[held] = self.fallen_db[held] - np.interp(self.level_dbm[held], *curve)
        return out


def fallen(search: Search, seen: Logged, others: Added) -> Fallen | None:
    """Return how far levels have fallen beside some effects; None where that is not known.

    `seen` are the logs of the sharpest rows.
    """
    rows = search.sharpest
    bare = search.comparison.ensemble(rows, others, FIT_MEMBERS, SEARCH_FIRST)
    if LEVEL not in bare.names:
        return None
    arriving, less = bare.simulated_of(LEVEL).mean(axis=0), -bare.residual_of(LEVEL)
    known = seen.known(arriving, less, seen.count_db)
    if not known.any() or np.ptp(arriving[known]) == 0:
        return None
    level = arriving[known]
    most_db = CONTROL_RATIO * np.interp(level, *rising(level, -seen.count_db[known]))
    codes = np.unique(rows.links[known], return_inverse=True)[1]
    return Fallen(level, less[known], most_db, codes, known)


def curved(search: Search, logged: Logged, others: Added, control: LevelControl) -> Effect:
    """Return a control of levels with the curve that recorded levels show beside other effects.

    As it is where levels of links left out are no nearer with that curve.
    """
    seen = fallen(search, logged, others)
    if seen is None:
        return control
    added = (*others, control)
    whole = search.comparison.ensemble(search.sharpest, added, FIT_MEMBERS, SEARCH_FIRST)
    left = np.abs(whole.residual_of(LEVEL)[seen.known]).mean()
    if not np.abs(seen.missed_db).mean() < left:
        return control
    knots, curve_db = seen.curve
    at = tuple((knots - control.shift_db).tolist())
    return replace(control, compression=1.0, curve_dbm=at, curve_db=tuple(curve_db.tolist()))


def rising(
    level_dbm: Floats, fallen_db: Floats, most_db: Floats | None = None
) -> tuple[Floats, Floats]:
    """Return knots in dBm and the curve there in dB: what rows [n] have fallen by at their level.

    It is not negative, and not above `most_db` [n], which rises too; it only rises (isotonic
    regression: Barlow et al. 1972), so steps keep their places; Huber's, as a few rows stand behind
    obstacles.
    """
    at, first, place = np.unique(level_dbm, return_index=True, return_inverse=True)
    most = np.inf if most_db is None else most_db[first]
    weight = np.ones(len(level_dbm))
    for _ in range(ROBUST_PASSES):
        whole = np.bincount(place, weight)
        middle = np.bincount(place, weight * fallen_db) / whole
        curve = np.clip(isotonic_regression(middle, weights=whole).x, 0, most)
        left = np.abs(fallen_db - curve[place])
        edge = HUBER * max(MAD_TO_STD * float(np.median(left)), RESOLUTION["dB"])
        weight = np.minimum(1.0, edge / np.maximum(left, 1e-12))
    bends = _bends(at, curve)
    return at[bends], curve[bends]


def _bends(at: Floats, curve: Floats) -> NDArray[np.intp]:
    """Return the points between which a curve [n] is straight, to what nobody notices."""
    found = [0, len(at) - 1]
    while True:
        off = np.abs(curve - np.interp(at, at[found], curve[found]))
        if off.max() < CONTROL_BEND_DB:
            return np.array(found)
        found = sorted({*found, int(off.argmax())})
