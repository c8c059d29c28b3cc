"""A path loss where a receiver's control of levels could not be tried: both may do the same.

A control of levels is told by counts of accumulated symbols; where none are logged it is not
offered, as a level is shifted by many things. But where strong signals read weaker than they should
and weak ones do not, a curve of a receiver does what a slope over the distance does.
"""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.matching import link_means
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.select.separate import separating
from bench.discrepancy.select.settings import CONTROL_SLOPES, LOGGED_LEVELS
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.verdict import NEEDS, Ambiguous, LeftOut, Verdict, not_tried
from bench.discrepancy.sets.settings import NAME_NATS
from bench.discrepancy.settings import FIT_MEMBERS, RESOLUTION
from bench.physics.effects.propagation.path_loss import PathLoss
from bench.physics.effects.receiver.level_control import LevelControl
from bench.physics.units import Floats

NOTE = f"{NEEDS}the count of accumulated symbols (preamble_count)"


def with_uncounted(search: Search, added: Added, said: tuple[Verdict, ...]) -> tuple[Verdict, ...]:
    """Return the verdicts, a path loss with the control of levels that may stand in its place.

    Of ranges alone; as they are where the control was tried.
    """
    if search.fit.waveform or LevelControl.name not in search.untried:
        return said
    return tuple(_with_control(search, added, one) for one in said)


def _with_control(search: Search, added: Added, said: Verdict) -> Verdict:
    if not (isinstance(said, LeftOut) and isinstance(said.effect, PathLoss)):
        return said
    if not _as_well(search, added, said.effect):
        return said
    options = (said, not_tried(said, LevelControl(), NOTE))
    return Ambiguous(options, separating(options))


def _as_well(search: Search, added: Added, effect: PathLoss) -> bool:
    """Return whether levels of links speak for a path loss by less than a name must bring."""
    rows, comparison = search.sharpest, search.comparison
    rest = without(added, effect)
    bare, whole = (comparison.ensemble(rows, some, FIT_MEMBERS) for some in (rest, (*rest, effect)))
    if LEVEL not in bare.names:
        return False
    own = comparison.distinct(rows)
    left, after, level = (
        link_means(one, rows.links)
        for one in (
            bare.first(own).residual_of(LEVEL),
            whole.first(own).residual_of(LEVEL),
            bare.simulated_of(LEVEL).mean(axis=0),
        )
    )
    known = np.isfinite(left) & np.isfinite(after) & np.isfinite(level)
    return bool(known.any()) and lead_over_control(after[known], left[known], level[known]) < (
        NAME_NATS
    )


def lead_over_control(after_db: Floats, left_db: Floats, level_dbm: Floats) -> float:
    """Return by how many nats `after_db` [L] beats the likeliest control of `left_db` [L].

    One that turns down, by the same share of every dB, what arrives above some level: two values,
    as a path loss has. Both scatter as Laplace's law, as a few links stand behind obstacles.
    """
    starts = [level_dbm.min(), *np.quantile(level_dbm, LOGGED_LEVELS)]
    above = np.maximum(level_dbm - np.asarray(starts)[:, None], 0)
    missed = np.abs(left_db + np.multiply.outer(CONTROL_SLOPES, above)).mean(axis=-1)
    mine = float(np.mean(np.abs(after_db)))
    least, other = (max(one, RESOLUTION["dB"]) for one in (mine, float(missed.min())))
    return float(len(left_db) * np.log(other / least))
