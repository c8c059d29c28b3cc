"""Whether an error follows a measured level at a fixed distance, as an effect over levels says.

In free space level and distance are one covariate, so a curve over the level fits whatever depends
on the distance. They part where the level is above or below what is usual at its distance: there an
error that follows the level moves along the effect's curve, and one of the distance does not.
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray

from bench.discrepancy.compare.view import Added, Comparison, View, without
from bench.discrepancy.data.observables import RANGE
from bench.discrepancy.select.adequacy import Adequacy
from bench.discrepancy.settings import (
    CENTRAL_95,
    FADING_M,
    FIT_MEMBERS,
    FOLLOWING_DRAWS,
    FOLLOWING_KNOTS,
    FOLLOWING_LEAST,
    FOLLOWING_PLACES,
    FOLLOWING_WIDEST,
    LEAST_SCATTER_M,
    MAD_TO_STD,
)
from bench.physics.effect import Effect

Floats = NDArray[np.float64]
Codes = NDArray[np.intp]


def follows(comparison: Comparison, view: View, added: Added, effect: Effect) -> Adequacy:
    """Return whether the range error follows the column that the effect acts over.

    Adequate where it may: also where levels hardly leave what is usual at their distance.
    """
    name = type(effect).follows
    if not name or not {name, RANGE} <= set(view.recorded.names):
        return Adequacy(True)
    whole, rest = (
        comparison.ensemble(view, one, FIT_MEMBERS) for one in (added, without(added, effect))
    )
    response = whole.simulated[..., whole.place(RANGE)].mean(axis=0)
    response = response - rest.simulated[..., rest.place(RANGE)].mean(axis=0)
    share = following(
        view.recorded.column(name), view.scene.true_range_m, response, whole.residual_of(RANGE),
        view.links,
    )  # fmt: skip
    if share is None or share[2] >= FOLLOWING_LEAST:
        return Adequacy(True)
    why = f"at a fixed distance the error follows only {share[0]:.0%} of what {name} says of it"
    return Adequacy(False, 1 - share[0], note=why)


def following(
    level: Floats, distance_m: Floats, response_m: Floats, left_m: Floats, links: Codes
) -> tuple[float, float, float] | None:
    """Return which share of the response to a level the error shows, with a 95 % interval.

    1 where the error follows the level, 0 where it follows the distance alone. `left_m` [n] is
    what the response leaves. Rows at one place count once: there it is the reading that scatters.
    None where too few rows are known.
    """
    known = np.isfinite(level) & np.isfinite(left_m) & np.isfinite(response_m) & (distance_m > 0)
    level, far, response = level[known], np.log(distance_m[known]), response_m[known]
    left, links = left_m[known], links[known]
    place = np.unique(np.stack([links, (distance_m[known] / FADING_M).astype(int)]), axis=1,
                      return_inverse=True)[1].ravel()  # fmt: skip
    if len(np.unique(place)) < FOLLOWING_PLACES:
        return None
    knots = np.quantile(far, np.linspace(0, 1, FOLLOWING_KNOTS))
    if len(np.unique(knots)) < FOLLOWING_KNOTS:
        return None
    basis = np.stack([np.interp(far, knots, one) for one in np.eye(FOLLOWING_KNOTS)], axis=1)
    usual = np.linalg.lstsq(basis, np.stack([level, response], axis=1), rcond=None)[0]
    curve = usual[np.argsort(usual[:, 0])]
    off = _cut(level - basis @ usual[:, 0])
    middle = basis @ usual[:, 0]
    expected = np.interp(middle + off, *curve.T) - np.interp(middle, *curve.T)
    rows = np.bincount(place).astype(np.float64)
    shown = _cut(left + response - basis @ usual[:, 1])
    mean = [np.bincount(place, v) / rows for v in (expected, shown, *basis.T)]
    first = np.unique(place, return_index=True)[1]
    return _slope(mean[0], mean[1], np.stack(mean[2:], axis=1), np.sqrt(rows), links[first])


def _cut(values: Floats) -> Floats:
    """Return values [n] around their median, cut where they are wild."""
    middle = float(np.median(values))
    wide = FOLLOWING_WIDEST * MAD_TO_STD * float(np.median(np.abs(values - middle)))
    return np.clip(values - middle, -max(wide, LEAST_SCATTER_M), max(wide, LEAST_SCATTER_M))


def _slope(
    expected: Floats, shown: Floats, basis: Floats, weight: Floats, links: Codes
) -> tuple[float, float, float]:
    """Return the slope of `shown` over `expected` beside a curve of the distance, with interval."""
    design = np.column_stack([expected, basis]) * weight[:, None]
    target = shown * weight
    code = np.unique(links, return_inverse=True)[1]
    rng = np.random.default_rng(0)
    found = [_first(design, target)]
    for _ in range(FOLLOWING_DRAWS):
        many = np.sqrt(np.bincount(rng.integers(0, code.max() + 1, code.max() + 1),
                                   minlength=code.max() + 1))[code]  # fmt: skip
        found.append(_first(design * many[:, None], target * many))
    low, high = np.percentile(found[1:], CENTRAL_95)
    return found[0], float(low), float(high)


def _first(design: Floats, target: Floats) -> float:
    return float(np.linalg.lstsq(design, target, rcond=None)[0][0])
