"""What every kind of obstacle delays and takes of the level, by robust least squares.

Tables name kinds, and say neither of what make nor how thick; one scale for all of them is no fit.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray
from scipy.sparse import csr_array

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added, Comparison, View, common
from bench.discrepancy.data.observables import LEVEL, REPORTED_LEVELS
from bench.discrepancy.fit.least_squares import robust
from bench.discrepancy.fit.settings import WALL_PRIOR_DB, WALL_PRIOR_M, WALL_TURNS
from bench.discrepancy.settings import RESIDUAL_MEMBERS
from bench.physics.effects.fitted.wall_delay import MOST_M, WallDelay
from bench.physics.effects.propagation.material_delay import MaterialDelay
from bench.physics.slabs import crossed, kinds_crossed

Floats = NDArray[np.float64]


def wall_delay(comparison: Comparison, view: View, added: Added) -> WallDelay | None:
    """Return what kinds of obstacles do to ranges and levels of the rows, None without any.

    With waveforms obstacles act on paths, as the library's do.
    """
    kinds = () if view.waveform else kinds_crossed(view.scene)
    made = residual_range(comparison, view, common(added, view), RESIDUAL_MEMBERS)
    if not kinds or made is None:
        return None
    delays = delays_of_kinds(crossed(view.scene, kinds), made[1])
    found = WallDelay(kinds, tuple(delays.tolist()))
    whole = comparison.ensemble(view, added, RESIDUAL_MEMBERS)
    if LEVEL not in whole.names:
        return found
    return replace(found, losses_db=_losses(view, kinds, whole.residual_of(LEVEL)))


def of_every_kind(
    comparison: Comparison, view: View, added: Added, effect: MaterialDelay
) -> MaterialDelay | None:
    """Return an effect on waveforms with every kind of obstacle's own delays and losses.

    Losses as levels say, delays as ranges: what is weakened a receiver may find later, too, so they
    are sought in turns, delays beside the losses. None without obstacles or ranges.
    """
    kinds = kinds_crossed(view.scene)
    if not kinds:
        return None
    walls, delays = crossed(view.scene, kinds), np.zeros(len(kinds))
    bare = replace(effect, delay_scale=1.0, kinds=kinds, delays_m=(0.0,) * len(kinds))
    found = _with_losses(comparison, view, added, bare)
    for _ in range(WALL_TURNS):
        made = residual_range(comparison, view, common((*added, found), view), RESIDUAL_MEMBERS)
        if made is None:
            return None
        delays = delays_of_kinds(walls, made[1] + walls @ delays)
        found = replace(found, delays_m=tuple(delays.tolist()))
    return found


def _with_losses(
    comparison: Comparison, view: View, added: Added, effect: MaterialDelay
) -> MaterialDelay:
    """Return an effect on waveforms with what one obstacle of every kind takes of first paths.

    As levels of first paths say, else of all that arrives, in turns. Unchanged where none is known.
    """
    kinds, walls = effect.kinds, crossed(view.scene, effect.kinds)
    found = replace(effect, loss_scale=1.0, losses_db=(0.0,) * len(kinds))
    for _ in range(WALL_TURNS):
        made = comparison.ensemble(view, (*added, found), RESIDUAL_MEMBERS)
        level = next((name for name in reversed(REPORTED_LEVELS) if name in made.names), None)
        if level is None:
            return effect
        left = made.residual_of(level) - walls @ np.array(found.losses_db)
        if not (losses := _losses(view, kinds, left)):
            return effect
        found = replace(found, losses_db=losses)
    return found


def delays_of_kinds(walls: Floats, residual_m: Floats) -> Floats:
    """Return what one obstacle of each kind delays [k], of rows with `walls` [n, k] in their way.

    Walls only delay: one that would shorten does nothing, and the others are fitted without it.
    """
    out, able = np.zeros(walls.shape[1]), np.arange(walls.shape[1])
    while len(able):
        prior = np.full(len(able), WALL_PRIOR_M)
        found = robust(csr_array(walls[:, able]), residual_m, prior)
        if (found >= 0).all():
            out[able] = np.minimum(found, MOST_M)
            break
        able = np.delete(able, np.argmin(found))
    return out


def _losses(view: View, kinds: tuple[str, ...], left_db: Floats) -> tuple[float, ...]:
    """Return what one obstacle of each kind takes of a level, in dB, none where none is known.

    Beside a constant and a line over the logarithm of the distance, which are no wall's.
    """
    known = np.isfinite(left_db) & (view.scene.true_range_m > 0)
    if not known.any():
        return ()
    far = np.log10(view.scene.true_range_m[known])
    walls = crossed(view.scene, kinds)[known]
    design = np.column_stack([-walls, np.ones(len(far)), far - far.mean()])
    prior = np.full(design.shape[1], WALL_PRIOR_DB)
    found = robust(csr_array(design), left_db[known], prior)[: len(kinds)]
    return tuple(np.maximum(found, 0.0).tolist())
