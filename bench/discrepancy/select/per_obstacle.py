"""Metres that one obstacle of a kind adds, as the ranges of links say.

A thickness, a delay per thickness and a kind's material say one thing together, a step per
obstacle: it is known where none of them is by itself.
"""

from __future__ import annotations

import numpy as np
from scipy.stats import t as student

from bench.discrepancy.compare.matching import link_means
from bench.discrepancy.compare.view import Added, View
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.fit.estimate import ParameterEstimate
from bench.discrepancy.fit.link_line import link_plane
from bench.discrepancy.select.settings import KIND_LINKS
from bench.discrepancy.select.state import Search
from bench.discrepancy.settings import FIT_MEMBERS, INTERVAL_LEVEL, SEARCH_FIRST
from bench.physics.effect import Effect
from bench.physics.slabs import opaque
from bench.physics.units import Floats

Told = tuple[ParameterEstimate, ...]


def told_by_obstacles(search: Search, others: Added, effect: Effect, fitted: Told) -> Told:
    """Return the intervals of an effect, with metres per obstacle of every kind that is listed.

    Beside `others`, of kinds that enough links have in another number than the rest; of an effect
    that acts by kind. `fitted` are the intervals of its parameters, which stay.
    """
    rows = search.fitted_on(effect) if search.fit.waveform else search.sharpest
    if not type(effect).by_kind or not (counts := _counts(rows)):
        return fitted
    made = search.comparison.ensemble(rows, others, FIT_MEMBERS, SEARCH_FIRST)
    left = made.first(search.comparison.distinct(rows)).residual_of(RANGE)
    known = np.isfinite(left)
    links = rows.links[known]
    columns = [np.ones(len(np.unique(links)))]
    columns += [link_means(count[known], links) for count in counts.values()]
    each = _estimates(tuple(counts), np.stack(columns, 1), link_means(left[known], links))
    return (*each, *fitted)


def _counts(rows: View) -> dict[str, Floats]:
    """Return how many of each kind stand in the line of each row [n], but opaque ones."""
    seen, through = rows.scene, ~opaque(rows.scene)
    each = ((seen.kinds == code) & through for code in range(len(seen.kind_names)))
    made = zip(seen.kind_names, (one.sum(axis=1).astype(np.float64) for one in each), strict=True)
    return {name: count for name, count in made if _varied(link_means(count, rows.links))}


def _varied(count: Floats) -> bool:
    """Return whether enough links have other numbers of a kind than most."""
    return int((count != np.median(count)).sum()) >= KIND_LINKS


def _estimates(names: tuple[str, ...], design: Floats, left_m: Floats) -> Told:
    """Return metres per obstacle beside a constant, nothing where kinds come together."""
    if np.linalg.matrix_rank(design) < design.shape[1] or len(left_m) < 2 * design.shape[1]:
        return ()
    found, spread = link_plane(design, left_m)
    wide = float(student.ppf((1 + INTERVAL_LEVEL) / 2, len(left_m) - len(found)))
    halves = wide * np.sqrt(np.diag(spread))
    sized = zip(names, found[1:].tolist(), halves[1:].tolist(), strict=True)
    return tuple(
        ParameterEstimate(f"excess_m[{name}]", value, value - half, value + half, "m")
        for name, value, half in sized
    )
