"""Links struck at random where nobody listed obstacles: walls may stand in their way.

What blocks a path leaves a reflection, which comes metres later. A wall lets it through, weaker and
later by its thickness times the excess of its index: a metre of excess takes 0.8 m of concrete
(ITU-R P.2040-3, a relative permittivity of 5.24). So where links are struck by less, and no table
says what stands where, walls and edges could not be tried and are not excluded.
"""

from __future__ import annotations

from collections.abc import Iterable, Sequence

import numpy as np

from bench.discrepancy.select.separate import separating
from bench.discrepancy.select.settings import MOST_OBJECTS, WALLS_M
from bench.discrepancy.select.state import Search
from bench.discrepancy.select.verdict import (
    NEEDS,
    Ambiguous,
    LeftOut,
    Verdict,
    not_tried,
    options_of,
)
from bench.physics.effect import Effect
from bench.physics.effects.propagation.blocked_path import BlockedPath
from bench.physics.effects.propagation.diffraction import Diffraction
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.scene import Scene
from bench.physics.slabs import of_objects, unlisted

OBSTACLES = "obstacles"
NO_EDGES = f"{NEEDS}to know where edges are (obstacle_clearance_m)"
NOT_LISTED = f"{NEEDS}to know what stands in the way of which link (obstacles)"


def with_walls(search: Search, said: Verdict) -> Verdict:
    """Return a verdict on struck links, of ranges alone, with what obstacles that nobody listed do.

    Where a table tells which ways are clear alone, walls were tried as if the same stood in every
    other, which is no trial of those that differ.

    As it is where detours are longer than walls make, for all that is known of their mean.
    """
    if search.fit.waveform or not (isinstance(said, LeftOut) and _short(said)):
        return said
    return with_obstacles(search, (said,), said, tried_alike(search))


def with_obstacles(
    search: Search, fitted: tuple[LeftOut, ...], said: Verdict, alike: Sequence[type[Effect]] = ()
) -> Verdict:
    """Return a verdict of effects that were fitted, with those that need obstacles listed.

    As it is where these were tried; `alike`: as if the same stood in every way, which is no trial.
    """
    kinds = [*needing(search.untried.values()), *alike]
    options = (*fitted, *(not_tried(fitted[0], kind(), NOT_LISTED) for kind in kinds))
    return Ambiguous(options, separating(options)) if kinds else said


def with_edges(search: Search, said: Sequence[Verdict]) -> tuple[Verdict, ...]:
    """Return verdicts, with what goes around objects beside what would go through or block them.

    Of a crate or a rack nobody knows whether waves go through; where its edges are not listed, what
    bends around them could not be tried. Where most rows behind something are behind such objects.
    """
    names = {name for one in said for name in one.names}
    kind = search.kinds.get(Diffraction.name)
    if kind is None or kind.name in names or not _behind_objects(search.searched.scene):
        return tuple(said)
    return tuple(_or_around(one, kind) for one in said)


def _or_around(said: Verdict, kind: type[Effect]) -> Verdict:
    """Return one verdict, with what bends around objects where it is of what acts behind them."""
    able = options_of(said)
    if not any(isinstance(o.effect, MaterialDelay) or _short(o) for o in able):
        return said
    whole = (*able, not_tried(able[0], kind(), NO_EDGES))
    return Ambiguous(whole, separating(whole))


def _behind_objects(rows: Scene) -> bool:
    """Return whether most rows with a listed obstacle have an object whose edges are not listed."""
    edges = np.isfinite(rows.obstacle("obstacle_clearance_m", np.nan))
    objects = (of_objects(rows) & ~edges).any(axis=1)
    behind = (rows.kinds >= 0).any(axis=1)
    return bool(objects.sum() > MOST_OBJECTS * behind.sum())


def needing(kinds: Iterable[type[Effect]]) -> list[type[Effect]]:
    """Return those of some effects that go by what stands in the way."""
    return [kind for kind in kinds if any(OBSTACLES in way for way in kind.needs)]


def tried_alike(search: Search) -> list[type[Effect]]:
    """Return the effects of obstacles that were tried with the same one in every way.

    A table that tells which ways are clear, and not what stands in the others, has walls of any
    make in some of these: they strike links as by chance, beside what all of these have in common,
    too, whether or not that keeps its name.
    """
    kinds = needing(search.kinds.values())
    return kinds if kinds and unlisted(search.every.scene).any() else []


def _short(said: LeftOut) -> bool:
    """Return whether a path is blocked for detours that are surely short in the mean (90 %)."""
    detours = (one for one in said.parameters if one.name == "detour_m")
    return isinstance(said.effect, BlockedPath) and any(one.high < WALLS_M for one in detours)
