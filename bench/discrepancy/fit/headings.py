"""A closed curve of range error over the heading, by smoothed least squares."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added, Comparison, View, common
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.settings import (
    HALF_TURN_DEG,
    HEADING_BENDS,
    HEADING_FOLDS,
    HEADING_SECTOR_DEG,
    HEADING_SECTORS,
    HEADING_STEP_DEG,
    MOST_PATTERN_BIAS_M,
    RESIDUAL_MEMBERS,
)
from bench.physics.effects.fitted.pattern_curve import PatternCurve, closed
from bench.physics.effects.propagation.antenna_pattern import heading_rad

Floats = NDArray[np.float64]
HEADINGS_DEG = tuple(np.arange(-HALF_TURN_DEG, HALF_TURN_DEG, HEADING_STEP_DEG).tolist())


def pattern_curve(comparison: Comparison, view: View, added: Added) -> PatternCurve | None:
    """Return the curve that the residual range of the rows follows over the heading.

    None where headings are not known or all alike. A constant is no pattern: the curve's mean over
    the circle is zero, or over the rows, or its median (a lobe that few rows see), whichever
    leaves least.
    """
    heading = heading_rad(view.scene)
    known = heading[np.isfinite(heading)]
    if len(np.unique(np.floor(np.degrees(known) / HEADING_SECTOR_DEG))) < HEADING_SECTORS:
        return None
    ensemble = comparison.ensemble(view, common(added, view), RESIDUAL_MEMBERS)
    if RANGE not in ensemble.names:
        return None
    residual = ensemble.residual_of(RANGE)
    bias = curve_over(heading, residual, smoothest(heading, residual, view.links))
    bias = np.clip(bias, -MOST_PATTERN_BIAS_M, MOST_PATTERN_BIAS_M)
    return PatternCurve(HEADINGS_DEG, tuple(bias.tolist()))


def curve_over(heading: Floats, residual: Floats, smooth: float) -> Floats:
    """Return the bias at HEADINGS_DEG in metres from headings [n] in radians and residuals [n]."""
    known = np.isfinite(residual) & np.isfinite(heading)
    hats = np.stack([closed(heading[known], HEADINGS_DEG, tuple(row)) for row in _EYE], axis=1)
    bend = (np.roll(_EYE, 1, axis=1) + np.roll(_EYE, -1, axis=1) - 2 * _EYE) * smooth
    design = np.vstack([hats, bend * np.sqrt(known.sum())])
    target = np.concatenate([residual[known], np.zeros(len(bend))])
    bias = np.linalg.lstsq(design, target, rcond=None)[0]
    seen = hats @ bias
    free = [bias - middle for middle in (bias.mean(), np.mean(seen), np.median(seen))]
    left = [float(np.abs(residual[known] - hats @ one).sum()) for one in free]
    return np.asarray(free[int(np.argmin(left))])


def smoothest(heading: Floats, residual: Floats, links: NDArray[np.intp]) -> float:
    """Return the weight of the bends that leaves least on links left out."""
    fold = np.unique(links, return_inverse=True)[1] % HEADING_FOLDS
    left = []
    for smooth in HEADING_BENDS:
        miss = 0.0
        for part in range(HEADING_FOLDS):
            out = fold == part
            bias = curve_over(heading[~out], residual[~out], smooth)
            guess = closed(heading[out], HEADINGS_DEG, tuple(bias.tolist()))
            miss += float(np.nansum(np.abs(residual[out] - guess)))
        left.append(miss)
    return HEADING_BENDS[int(np.argmin(left))]


_EYE = np.eye(len(HEADINGS_DEG))
