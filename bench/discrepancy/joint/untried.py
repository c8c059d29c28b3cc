"""Effects that could not be tried, where they may do the same to ranges as what was found.

Into the rows of another simulator's table not every effect can be put. One that draws every row
anew also scatters ranges; independent scatter is then a name beside it, unless levels scatter too
little: a level that changes by a share moves a rising edge by at most that share of its rise time.
Effects of walls and edges need them listed. Where nobody did, they obstruct some links as by
chance: the straight path is weaker and later there, whichever it is.
"""

from __future__ import annotations

import numpy as np

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.resimulation import Resimulation
from bench.discrepancy.compare.view import Added, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.joint.rows import compared_rows
from bench.discrepancy.joint.settings import DB_PER_NEPER, MEMBERS, RISE_NS
from bench.discrepancy.select.adequacy import LEVELS
from bench.discrepancy.select.separate import separating
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.unlisted import tried_alike, with_obstacles
from bench.discrepancy.select.verdict import (
    NEEDS,
    UNTRIED,
    Ambiguous,
    LeftOut,
    Verdict,
    not_tried,
    options_of,
)
from bench.discrepancy.select.within_links import components
from bench.discrepancy.settings import ONE_SIDED_95
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.obstructed_path import ObstructedPath
from bench.physics.effects.receiver.interference import NarrowbandInterference
from bench.physics.effects.receiver.noise_floor import NoiseFloor
from bench.physics.units import C_M_PER_NS

NOTE = f"{NEEDS}a simulator that can be run again"
MORE_TONES = f"{UNTRIED}: several tones at once, beside the one that is named"
NO_RAYS = "it fits less well, but the rays round what stands in the way are not in the table"


def with_untried(
    search: Search, added: Added, said: tuple[Verdict, ...], dense: tuple[str, ...] = ()
) -> tuple[Verdict, ...]:
    """Return the verdicts, as classes with what could not be tried and may do the same.

    `dense`: names whose late samples show that they are not what resembles them.
    """
    said = tuple(with_tones(_with_unplaced(search, one, dense), added) for one in said)
    rivals = [kind for kind in search.untried.values() if kind.by_rows]
    if not rivals:
        return said
    return tuple(_of_class(search, added, one, rivals) for one in said)


def _with_unplaced(search: Search, said: Verdict, dense: tuple[str, ...]) -> Verdict:
    """Return one verdict, with what resembles it where nobody told the places of that."""
    fitted = options_of(said)
    alike = ("" if one.effect.name in dense else type(one.effect).resembles for one in fitted)
    kinds = [search.untried.get(name) for name in alike]
    more = tuple(
        not_tried(one, kind(), NEEDS + kind.lacking(search.fit.frame.columns))
        for one, kind in zip(fitted, kinds, strict=True)
        if kind is not None
    )
    options = (*fitted, *more)
    return Ambiguous(options, separating(options)) if more else said


def with_tones(said: Verdict, added: Added) -> Verdict:
    """Return one verdict, with more tones as what a noise floor beside a tone may be.

    Of several tones at once the library's one explains a part; the rest comes and goes within a
    record and does what noise does, the more so the more there are.
    """
    fitted = options_of(said)
    tones = [one for one in added if isinstance(one, NarrowbandInterference)]
    names = {type(one.effect) for one in fitted}
    if not tones or NoiseFloor not in names or NarrowbandInterference in names:
        return said
    options = (*fitted, not_tried(fitted[0], tones[0], MORE_TONES))
    return Ambiguous(options, separating(options))


def _of_class(search: Search, added: Added, said: Verdict, rivals: list[type[Effect]]) -> Verdict:
    """Return one verdict, with the rivals that levels do not exclude where it is of scatter."""
    if not isinstance(said, LeftOut) or not type(said.effect).independent:
        return said
    if levels_exclude(search, added, said.effect):
        return said
    options = (said, *(not_tried(said, kind(), NOTE) for kind in rivals))
    return Ambiguous(options, separating(options))


def with_unlisted(search: Search, said: Verdict) -> Verdict:
    """Return the verdict on what struck links, with what unlisted obstacles do.

    An obstructed path is what these do to a link that they stand in the way of. In a table that is
    what a blocked path does, too: of the rays round what stands there the table has none.
    """
    fitted = options_of(said)
    known = {type(one.effect) for one in fitted}
    if ObstructedPath in known:
        return with_obstacles(search, fitted, said, tried_alike(search))
    again = isinstance(search.comparison, Resimulation)
    if BlockedPath not in known or again or ObstructedPath.name not in search.kinds:
        return said
    options = (*fitted, not_tried(fitted[0], ObstructedPath(), NO_RAYS))
    return Ambiguous(options, separating(options))


def levels_exclude(search: Search, added: Added, effect: Effect) -> bool:
    """Return whether levels scatter too little within links to scatter ranges as `effect` does."""
    rows = compared_rows(search)
    whole, rest = (
        search.comparison.ensemble(rows, one, MEMBERS) for one in (added, without(added, effect))
    )
    change = whole.simulated_of(RANGE) - rest.simulated_of(RANGE)
    needed_db = DB_PER_NEPER * float(np.nanstd(change)) / (C_M_PER_NS * RISE_NS)
    most = [scatter_at_most(rest, name) for name in LEVELS if name in rest.names]
    return bool(most) and min(most) < needed_db


def scatter_at_most(made: Ensemble, name: str) -> float:
    """Return how much more a level may scatter within links than simulated, dB (95 %).

    Infinity where no link has several rows whose level is known.
    """
    code = np.unique(made.links, return_inverse=True)[1]
    values = made.versions_of(name)
    known = np.isfinite(values).all(axis=0)
    several = known & (np.bincount(code, known)[code] > 1)
    loose = int(several.sum()) - len(np.unique(code[several]))
    if loose < 1:
        return float("inf")
    parts = np.array([components(each[several], code[several])[1] for each in values])
    usual = parts[1:].mean()
    error = np.sqrt(2 / loose) * max(parts[0], usual)
    return float(np.sqrt(max(parts[0] - usual + ONE_SIDED_95 * error, 0.0)))
