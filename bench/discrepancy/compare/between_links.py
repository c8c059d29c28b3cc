"""What range errors of links go with their levels by, as simulated links show it.

The multipath of a link, which another link does not have, makes it stronger or weaker than others
at its distance, and its first path early or late. So links of one simulated table differ in both
at once, and recorded links do so too: what their levels differ by beyond all that is known of them
tells that part of their errors (an analysis of covariance: Cochran 1957). What a hidden effect does
to levels goes with something known - a distance, a device, a heading, what stands in the way - and
is none of it.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.compare.settings import COUPLED_ERRORS, COUPLED_LINKS, COUPLED_MOST
from bench.discrepancy.compare.view import View
from bench.discrepancy.data.grouped import means_by_group
from bench.discrepancy.data.observables import LEVEL, RANGE
from bench.discrepancy.settings import MAD_TO_STD
from bench.physics.effects.propagation.antenna_pattern import waves

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


def between_links_m(view: View, made: Ensemble, code: Codes) -> Floats:
    """Return what levels of links say of the range errors of their rows [n], in metres.

    Of links by `code` [n]. Zeros where simulated errors of links do not surely go with levels
    (four standard errors), or where there are too few links for all that is known.
    """
    none = np.zeros(len(code))
    count = np.bincount(code)
    known = _known(view, code, count)
    error, level = (made.simulated_of(name) for name in (RANGE, LEVEL))
    recorded = made.recorded_of(LEVEL)
    if len(count) < COUPLED_LINKS * known.shape[1] or not np.isfinite(recorded).all():
        return none
    if not (np.isfinite(error).all() and np.isfinite(level).all()):
        return none
    x, y = (_beside(_of_links(each, code, count), known) for each in (level, error))
    links = np.broadcast_to(np.arange(len(count)), x.shape)
    slope = sure_slope(x.ravel(), y.ravel(), links.ravel())
    if not slope:
        return none
    apart = _beside(_of_links((recorded - level.mean(axis=0))[None], code, count), known)[0]
    most = COUPLED_MOST * MAD_TO_STD * float(np.median(np.abs(x)))
    return np.asarray(slope * np.clip(apart, -most, most)[code])


def sure_slope(x: Floats, y: Floats, links: Codes) -> float:
    """Return the slope of y over x [k] of `links` [k], 0 within four standard errors over them."""
    square = float(x @ x)
    if square <= 0:
        return 0.0
    slope = float(x @ y) / square
    pulls = np.bincount(links, x * (y - slope * x))
    sure = abs(slope) * square > COUPLED_ERRORS * float(np.sqrt(pulls @ pulls))
    return slope if sure else 0.0


def _known(view: View, code: Codes, count: Codes) -> Floats:
    """Return what is known of links [L, q]: distance, what is in the way, devices and headings."""
    rows = view.scene
    distance = np.maximum(rows.true_range_m, 1e-3)
    numbers = [np.ones(len(code)), distance, np.log(distance), rows.clear(), *waves(rows)]
    table = np.column_stack([*numbers, rows.count_by_kind(), *view.covariates.devices()])
    return means_by_group(np.nan_to_num(table), code, count)


def _of_links(values: Floats, code: Codes, count: Codes) -> Floats:
    """Return the means of links [m, L] of values [m, n]."""
    return means_by_group(np.ascontiguousarray(values.T), code, count).T


def _beside(values: Floats, known: Floats) -> Floats:
    """Return values of links [m, L] less what goes with what is known of them [L, q]."""
    factors = np.linalg.lstsq(known, values.T, rcond=None)[0]
    return np.asarray(values - (known @ factors).T)
