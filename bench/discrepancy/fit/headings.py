"""A closed curve of range error over the heading, by smoothed least squares."""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.resimulation import Added, View, World, common
from bench.physics.effects.fitted.pattern_curve import PatternCurve, closed
from bench.physics.effects.propagation.antenna_pattern import heading_rad

Floats = NDArray[np.float64]
MEMBERS = 4
HEADINGS_DEG = tuple(np.arange(-180.0, 180.0, 15.0).tolist())
SMOOTH = (0.03, 0.1, 0.3, 1.0)  # weights of the bends, tried on links left out
FOLDS = 4
SECTORS = 6  # of 12: headings that fill fewer are no circle


def pattern_curve(world: World, view: View, added: Added) -> PatternCurve | None:
    """Return the curve that the residual range of the rows follows over the heading.

    None where headings are not known or all alike. A constant is no pattern: the curve's mean over
    the circle is zero, or over the rows, or its median (a lobe that few rows see), whichever
    leaves least.
    """
    heading = heading_rad(view.scene)
    if len(np.unique(np.floor(np.degrees(heading) / 30))) < SECTORS:
        return None
    ensemble = world.ensemble(view, common(added, view), MEMBERS)
    if "error_m" not in ensemble.names:
        return None
    residual = ensemble.residual[:, ensemble.names.index("error_m")]
    bias = curve_over(heading, residual, smoothest(heading, residual, view.links))
    return PatternCurve(HEADINGS_DEG, tuple(bias.tolist()))


def curve_over(heading: Floats, residual: Floats, smooth: float) -> Floats:
    """Return the bias at HEADINGS_DEG in metres from headings [n] in radians and residuals [n]."""
    known = np.isfinite(residual)
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
    fold = np.unique(links, return_inverse=True)[1] % FOLDS
    left = []
    for smooth in SMOOTH:
        miss = 0.0
        for part in range(FOLDS):
            out = fold == part
            bias = curve_over(heading[~out], residual[~out], smooth)
            guess = closed(heading[out], HEADINGS_DEG, tuple(bias.tolist()))
            miss += float(np.nansum(np.abs(residual[out] - guess)))
        left.append(miss)
    return SMOOTH[int(np.argmin(left))]


_EYE = np.eye(len(HEADINGS_DEG))
