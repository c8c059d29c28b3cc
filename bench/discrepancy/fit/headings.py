"""A closed curve of range error over the heading, by smoothed least squares."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.residual_range import residual_range
from bench.discrepancy.compare.view import Added, Comparison, View, common
from bench.discrepancy.data.observables import LEVEL
from bench.discrepancy.fit.settings import USUAL_GAIN_DB
from bench.discrepancy.settings import (
    HALF_TURN_DEG,
    HEADING_BENDS,
    HEADING_FOLDS,
    HEADING_SECTOR_DEG,
    HEADING_SECTORS,
    HEADING_STEP_DEG,
    MOST_PATTERN_BIAS_M,
    MOST_PATTERN_GAIN_DB,
    PATTERN_GAIN_SHARE,
    RESIDUAL_MEMBERS,
)
from bench.physics.effects.fitted.pattern_curve import PatternCurve, closed
from bench.physics.effects.fitted.ridge import without_fall
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
    made = residual_range(comparison, view, common(added, view), RESIDUAL_MEMBERS)
    if made is None:
        return None
    residual = made[1]
    bias = curve_over(heading, residual, smoothest(heading, residual, view.links))
    bias = np.clip(bias, -MOST_PATTERN_BIAS_M, MOST_PATTERN_BIAS_M)
    gain = gain_over(comparison, view, added)
    return PatternCurve(HEADINGS_DEG, tuple(bias.tolist()), gain)


def gain_over(comparison: Comparison, view: View, added: Added) -> tuple[float, ...]:
    """Return the gain in dB at HEADINGS_DEG that levels follow, () where they do not.

    Of levels from paths alone: with waveforms they are compared themselves.
    """
    ensemble = comparison.ensemble(view, added, RESIDUAL_MEMBERS)
    if view.waveform or LEVEL not in ensemble.names:
        return ()
    heading, left_db = heading_rad(view.scene), ensemble.residual_of(LEVEL)
    if not np.isfinite(left_db).any():
        return ()
    left_db = _fallen_less(view, heading, left_db)
    smooth, missed, plain = _left_out(heading, left_db - np.nanmedian(left_db), view.links)
    if missed > (1 - PATTERN_GAIN_SHARE) * plain:
        return ()
    gain = np.clip(
        curve_over(heading, left_db, smooth, False), -MOST_PATTERN_GAIN_DB, MOST_PATTERN_GAIN_DB
    )
    return tuple(gain.tolist())


def _fallen_less(view: View, heading: Floats, left_db: Floats) -> Floats:
    """Return levels [n] without a fall over the distance, where headings do not do for it."""
    known = np.isfinite(left_db) & np.isfinite(heading)
    ways, far = USUAL_GAIN_DB * _hats(heading[known]), view.scene.true_range_m[known]
    counts = len(np.unique(view.links)) / len(view.rows)
    out = left_db.copy()
    out[known] = without_fall(ways, left_db[known], far, counts)
    return out


def _hats(heading: Floats) -> Floats:
    """Return how much of each of HEADINGS_DEG a heading [n] is, [n, headings]."""
    return np.stack([closed(heading, HEADINGS_DEG, tuple(row)) for row in _EYE], axis=1)


def curve_over(heading: Floats, residual: Floats, smooth: float, around: bool = True) -> Floats:
    """Return the bias at HEADINGS_DEG from headings [n] in radians, in the unit of residuals [n].

    `around` 0, for a constant is no delay of a pattern; its gain may be one.
    """
    known = np.isfinite(residual) & np.isfinite(heading)
    hats = _hats(heading[known])
    bend = (np.roll(_EYE, 1, axis=1) + np.roll(_EYE, -1, axis=1) - 2 * _EYE) * smooth
    design = np.vstack([hats, bend * np.sqrt(known.sum())])
    target = np.concatenate([residual[known], np.zeros(len(bend))])
    bias = np.linalg.lstsq(design, target, rcond=None)[0]
    if not around:
        return np.asarray(bias)
    seen = hats @ bias
    free = [bias - middle for middle in (bias.mean(), np.mean(seen), np.median(seen))]
    left = [float(np.abs(residual[known] - hats @ one).sum()) for one in free]
    return np.asarray(free[int(np.argmin(left))])


def smoothest(heading: Floats, residual: Floats, links: NDArray[np.intp]) -> float:
    """Return the weight of the bends that leaves least on links left out."""
    return _left_out(heading, residual, links)[0]


def _left_out(
    heading: Floats, residual: Floats, links: NDArray[np.intp]
) -> tuple[float, float, float]:
    """Return the best weight of the bends, and what it and a constant leave on links left out."""
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
    plain = float(np.nansum(np.abs(residual - np.nanmedian(residual))))
    return HEADING_BENDS[int(np.argmin(left))], min(left), plain


_EYE = np.eye(len(HEADINGS_DEG))
