"""The slope of a true range over time, by as many neighbours as its noise and its turns allow.

Exact truth is best told by the nearest rows, for devices turn. Truth that was measured or rounded
is off by as much over a short time as over a long one: a speed of few neighbours is then mostly
noise, and what goes with the speed seems to go with it less (errors in variables).
"""

from __future__ import annotations

import numpy as np
from numpy.typing import NDArray
from scipy.ndimage import maximum_filter1d, minimum_filter1d

LONGEST_GAP_S = 2.0
"""Between rows further apart in time nothing is known of the motion: robots turn within seconds."""
BESIDE = (-2, -1, 1, 2)
"""Neighbours of a row, by whose true ranges its speed is taken where these are exact."""
EVEN_STEPS = 3.0
"""Times the shortest of their steps in time, that the longest is at most: across a short one beside
long ones hardly anything but the noise of the truth is seen."""
NEAR_STEPS = 100.0
"""The same of a cubic or quintic: rows at nearly one time are one row to it, and too few."""
REACH = (3, 4, 6, 8, 12, 16, 24, 32, 48)
"""Rows on either side, of which a cubic is taken where the truth is noisy."""
ENOUGH = 30
"""Rows with such a cubic, to say how noisy the truth of a series is."""
DEGREE = 3
"""A straight line would be slow where a device turns."""
SHARP = 5
"""Degree of what seven rows are noisy about: a cubic would leave turns, too."""
MEDIAN_SQUARE = 0.4549
"""Median of a squared normal value: of one, which a quintic leaves of seven rows."""
TRIED = 2000
"""Rows of a series, by which the number of neighbours is chosen."""
AT_ONCE = 1 << 13
"""Rows whose neighbours are held in memory."""

Floats = NDArray[np.float64]


def slopes(time_s: Floats, true_m: Floats) -> Floats:
    """Return the slope at every time [n] of one series: between both neighbours, or the nearer one.

    Of the two neighbours on either side where these are about as far apart as each other; of more
    where the truth is so noisy that these tell the slope better.
    """
    step, rise = np.diff(time_s), np.diff(true_m)
    near = (step > 0) & (step <= LONGEST_GAP_S)
    rise, step = np.where(near, rise, 0.0), np.where(near, step, 0.0)
    before, after = np.r_[0.0, step], np.r_[step, 0.0]
    climbed = np.r_[0.0, rise] + np.r_[rise, 0.0]
    span = before + after
    out = np.where(span > 0, climbed / np.where(span > 0, span, 1.0), np.nan)
    if len(time_s) <= len(BESIDE):
        return out
    even = _within(step, len(BESIDE) // 2, EVEN_STEPS)
    narrow = np.full(len(out), np.nan)
    out[even], narrow[even] = _of_four(time_s, true_m, even)
    return _smoothed(out, narrow, time_s, true_m, step)


def _within(step: Floats, reach: int, even: float = NEAR_STEPS) -> NDArray[np.intp]:
    """Return which times [k] have so many neighbours on either side, all of them apart and near.

    The longest of their steps [n - 1] is at most `even` times the shortest.
    """
    if len(step) < 2 * reach:
        return np.empty(0, np.intp)
    inner = slice(reach, len(step) - reach + 1)  # windows wholly within the series
    least = minimum_filter1d(step, 2 * reach)[inner]
    most = maximum_filter1d(step, 2 * reach)[inner]
    return np.flatnonzero((least > 0) & (least * even >= most)) + reach


def _of_four(time_s: Floats, true_m: Floats, middle: NDArray[np.intp]) -> tuple[Floats, Floats]:
    """Return the slope [k] at some times of the polynomial through these and four neighbours.

    A device that turns is slower between two neighbours than at the time between them: the straight
    line errs with the square of their distance in time, this with its fourth power. The second is
    the variance of the slope where that of the truth is 1.
    """
    away = np.stack([time_s[middle + one] - time_s[middle] for one in BESIDE])
    climbed = np.stack([true_m[middle + one] - true_m[middle] for one in BESIDE])
    weights = np.stack([
        np.prod([other / (other - mine) for n, other in enumerate(away) if n != number], axis=0)
        / mine
        for number, mine in enumerate(away)
    ])  # fmt: skip
    noise = (weights**2).sum(axis=0) + weights.sum(axis=0) ** 2
    return np.asarray((weights * climbed).sum(axis=0)), np.asarray(noise)


def _smoothed(out: Floats, narrow: Floats, time_s: Floats, true_m: Floats, step: Floats) -> Floats:
    """Return slopes [n] of as many neighbours as bring them nearest to the true ones.

    `narrow` [n] is the variance of those of four neighbours, where that of the truth is 1.
    """
    made, free = out.copy(), np.isfinite(narrow)
    for reach in reversed(_able(out, narrow, time_s, true_m, step)):
        at = _within(step, reach)
        at = at[free[at]]  # ends have fewer neighbours
        made[at], free[at] = _of_cubics(time_s, true_m, at, reach)[0], False
    return made


def _able(
    out: Floats, narrow: Floats, time_s: Floats, true_m: Floats, step: Floats
) -> tuple[int, ...]:
    """Return how many neighbours on either side are taken: the most that help, and all fewer.

    What a cubic over more rows departs by from one over fewer, beyond noise, is its own error: of
    the rows that both have it makes the best (Hausman 1978).
    """
    noise, least, best = _noise_m2(time_s, true_m, step), np.inf, 0
    every = [(out, narrow)]
    for reach in REACH if noise > 0 else ():
        at = _some(_within(step, reach))
        at = at[np.isfinite(every[-1][1][at])]
        if len(at) < ENOUGH:
            break
        slope, wide = _of_cubics(time_s, true_m, at, reach)
        if reach == REACH[0]:
            least = noise * float(np.mean(narrow[at]))
        parts = [(slope - made[at]) ** 2 - noise * (own[at] - wide) for made, own in every]
        bent = max(0.0, *(float(part.mean()) for part in parts))
        error = bent + noise * float(np.mean(wide))
        if error < least:
            least, best = error, reach
            every.append((_put(out, at, slope), _put(narrow * np.nan, at, wide)))
    return tuple(one for one in REACH if one <= best)


def _some(rows: NDArray[np.intp]) -> NDArray[np.intp]:
    """Return some of many rows, evenly spread: the same ones as of more."""
    step = 1 << max(int(np.ceil(np.log2(max(rows.max(initial=0), 1) / TRIED))), 0)
    return np.asarray(rows[rows % step == 0])


def _put(values: Floats, at: NDArray[np.intp], some: Floats) -> Floats:
    """Return values [n] with some [k] in their places."""
    made = values.copy()
    made[at] = some
    return made


def _noise_m2(time_s: Floats, true_m: Floats, step: Floats) -> float:
    """Return the variance of the noise of a series, by how seven rows depart from a quintic."""
    at = _some(_within(step, REACH[0]))
    if len(at) < ENOUGH:
        return 0.0
    there, design, _ = _around(time_s, true_m, at, REACH[0], SHARP)
    left = there - np.einsum("kmi,ki->km", design, _fitted(there, design)[0])
    return float(np.median((left**2).sum(axis=1))) / MEDIAN_SQUARE


def _of_cubics(
    time_s: Floats, true_m: Floats, middle: NDArray[np.intp], reach: int
) -> tuple[Floats, Floats]:
    """Return slopes [k] of cubics through rows around some times, and their variance [k].

    The variance where that of the truth is 1.
    """
    slopes, wide = [], []
    for some in np.array_split(middle, len(middle) // AT_ONCE + 1):
        there, design, half = _around(time_s, true_m, some, reach, DEGREE)
        factors, inverse = _fitted(there, design)
        slopes.append(factors[:, 1] / half)
        wide.append(inverse[:, 1, 1] / half**2)
    return np.concatenate(slopes), np.concatenate(wide)


def _around(
    time_s: Floats, true_m: Floats, middle: NDArray[np.intp], reach: int, degree: int
) -> tuple[Floats, Floats, Floats]:
    """Return the truth [k, m] around some times beside that at these, and powers of the time.

    These [k, m, degree + 1] are of the time over the farthest one away, which is the third [k].
    """
    rows = middle[:, None] + np.arange(-reach, reach + 1)
    away = time_s[rows] - time_s[middle][:, None]
    half = np.abs(away).max(axis=1)
    design = np.ones((*away.shape, degree + 1))
    design[..., 1:] = (away / half[:, None])[..., None]
    np.multiply.accumulate(design, axis=-1, out=design)  # sooner than powers of floats
    return true_m[rows] - true_m[middle][:, None], design, half


def _fitted(there: Floats, design: Floats) -> tuple[Floats, Floats]:
    """Return the factors [k, d] of least squares, and the inverse [k, d, d] of their precision."""
    inverse = np.asarray(np.linalg.inv(design.transpose(0, 2, 1) @ design), np.float64)
    return np.einsum("kij,kmj,km->ki", inverse, design, there, optimize=True), inverse
