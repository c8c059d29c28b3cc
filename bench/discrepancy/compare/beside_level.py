"""Errors of ranges beside the levels that they go with, as simulated rows of a link show it.

The same multipath that makes a row of a link stronger makes its first path early or late: within a
link, range errors go with levels on both sides. What simulated rows show of that is known of
recorded rows, too, whose levels are (an analysis of covariance: Cochran 1957): it is no scatter,
and it is not what an error that follows the level does, which stands between links.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.between_links import between_links_m, sure_slope
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.grouped import beside_means
from bench.discrepancy.data.observables import LEVEL, RANGE

Floats = NDArray[np.float64]


def beside_level(view: View, made: Ensemble, left_m: Floats) -> Floats:
    """Return what is left of ranges [n], less what goes with the level, in metres.

    Within links and between them (see `between_links`). As it is where no level is on both sides,
    or simulated errors do not surely go with it.
    """
    if LEVEL not in made.names:
        return left_m
    code = alike(view)
    apart = beside_means(made.recorded_of(LEVEL), code)
    within_m = coupling_m_per_db(made, code) * np.nan_to_num(apart)
    return np.asarray(left_m - within_m - between_links_m(view, made, code))


def by_links(view: View, made: Ensemble) -> View:
    """Return rows with the mean level of their link, where simulated errors go with levels within.

    What a row's own level says of its error there is multipath, not an error that follows levels.
    """
    if LEVEL not in made.names or LEVEL not in view.frame:
        return view
    return with_levels_of_links(view) if coupling_m_per_db(made, alike(view)) else view


def with_levels_of_links(view: View) -> View:
    """Return rows with the mean level of their link (see `alike`), as they are without a level."""
    if LEVEL not in view.frame:
        return view
    code, level = alike(view), view.frame[LEVEL].to_numpy(np.float64)
    frame = view.frame.assign(**{LEVEL: level - beside_means(level, code)})
    return View(frame, view.recorded, view.links, view.rows, view.waveform)


def alike(view: View) -> NDArray[np.intp]:
    """Return codes [n] of the links of rows, apart by what stands in the way.

    What a wall takes and delays is no multipath: where walls come and go it is another link.
    """
    way = np.column_stack([view.links, view.scene.kinds, view.scene.clear()])
    return np.asarray(np.unique(way, axis=0, return_inverse=True)[1].ravel(), np.intp)


def coupling_m_per_db(made: Ensemble, code: NDArray[np.intp]) -> float:
    """Return how simulated range errors go with levels within links, in metres per decibel.

    `code` [n] are the links (see `alike`). Zero within four standard errors, over them as the unit.
    """
    error, level = (made.simulated_of(name).T for name in (RANGE, LEVEL))
    known = np.isfinite(error) & np.isfinite(level)
    every = np.broadcast_to(code[:, None], error.shape)[known]
    links = np.unique(every, return_inverse=True)[1]
    if not len(links):
        return 0.0
    x, y = (beside_means(one[known], links) for one in (level, error))
    return sure_slope(x, y, links)
