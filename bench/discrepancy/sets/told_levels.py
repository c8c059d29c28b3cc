"""What levels say of a reflection of the ground, beside what ranges do: both move with it."""

from __future__ import annotations

from itertools import product

import numpy as np
from numpy.typing import NDArray
from scipy.special import logsumexp

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.select.settings import LEVEL_PRINTED_DB
from bench.discrepancy.sets.settings import (
    FEWEST_ROWS,
    GROUND_SIZES,
    GROUND_STEEPNESSES,
    LEVELS_MOST_NATS,
    OTHER_LEVELS_DB,
)
from bench.physics.effects.fitted.ridge import Ridge
from bench.physics.effects.propagation.ground_bounce import GroundBounce
from bench.physics.effects.propagation.two_rays import (
    carriers_ghz,
    fading_db,
    rays,
    smooth_over_geometry,
)

Floats = NDArray[np.float64]


def told_by_levels(rows: View, made: Ensemble) -> dict[str, float]:
    """Return the nats that levels bring for names that ranges are to tell; none where they do not.

    Of two rays: how levels go up and down as both meet, beside smooth curves over the geometry and
    what every device and obstacle does.
    """
    smooth, found = smooth_over_geometry(rows.scene), rays(rows.scene)
    if LEVEL not in made.names or smooth is None or found is None:
        return {}
    left = numeric(rows.frame, LEVEL) - made.simulated_of(LEVEL).mean(axis=0)
    known = np.isfinite(left)
    if known.sum() < FEWEST_ROWS:
        return {}
    ways = product(carriers_ghz(rows.scene), GROUND_SIZES, GROUND_STEEPNESSES)
    faded = np.stack([fading_db(found.ray(*way)) for way in ways], axis=1)
    groups = [one[:, None] for one in rows.covariates.groups.values()]
    others = OTHER_LEVELS_DB * np.hstack([smooth, *groups]).astype(np.float64)
    counts = len(np.unique(rows.links)) / len(rows.rows)
    nats = _evidence(others[known], left[known], faded[known], counts)
    return {GroundBounce.name: min(nats, LEVELS_MOST_NATS)} if nats > 0 else {}


def _evidence(others: Floats, left_db: Floats, ways_db: Floats, counts: float) -> float:
    """Return the log evidence that one of some ways [n, k] is in levels [n], each as likely.

    Beside `others` [n, q], of factors of about one; each row counts as `counts` of one.
    """
    ridge = Ridge(others, left_db, OTHER_LEVELS_DB)
    tried = np.column_stack([left_db, left_db[:, None] - ways_db])
    scatter = float(ridge.scatters(tried).min())
    likely = ridge.evidences(tried, max(scatter, LEVEL_PRINTED_DB), counts)
    return float(logsumexp(likely[1:]) - np.log(ways_db.shape[1]) - likely[0])
