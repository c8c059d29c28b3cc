"""Columns that say, to first order, what an effect can do to ranges (see `Effect.ways`)."""

from __future__ import annotations

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.physics.batch import REPORTED_LEVELS
from bench.physics.scene import Scene
from bench.physics.units import Floats

LEAST_EIGENVALUE = 1e-3  # of the largest: directions with less say nothing


def device_columns(rows: Scene) -> tuple[Floats, Floats]:
    """Return which device is the transmitter and which the receiver, 0 or 1, both [n, devices]."""
    tx, rx = rows.group("tx"), rows.group("rx")
    names = np.unique(np.concatenate([tx, rx]))
    return (tx[:, None] == names) * 1.0, (rx[:, None] == names) * 1.0


def smooth_columns(values: Floats, knots: Floats, length: float) -> Floats:
    """Return columns [n, k] whose random sums are smooth curves over `values` [n], of size 1.

    A Gaussian process of squared exponential covariance, `length` in the unit of the values, by
    its main directions at the knots (Rasmussen and Williams 2006, section 4.3).
    """
    covariance = np.exp(-0.5 * ((knots[:, None] - knots[None]) / length) ** 2)
    size, direction = np.linalg.eigh(covariance)
    keep = size > LEAST_EIGENVALUE * size.max()
    hats = np.stack([np.interp(values, knots, one) for one in np.eye(len(knots))], axis=1)
    return np.asarray(hats @ (direction[:, keep] * np.sqrt(size[keep])))


def spread_over(values: Floats, count: int = 13, share: float = 0.2) -> Floats:
    """Return smooth columns over the whole span of `values` [n], `share` of it their length."""
    low, high = float(np.nanmin(values)), float(np.nanmax(values))
    known = np.where(np.isfinite(values), values, np.nanmedian(values))
    if high <= low:
        return np.ones((len(values), 1))
    return smooth_columns((known - low) / (high - low), np.linspace(0, 1, count), share)


def known_mostly(values: Floats) -> NDArray[np.float64] | None:
    """Return values [n] with unknown ones at the median; None where many are, or all are equal."""
    known = np.isfinite(values)
    if known.mean() < 0.9 or np.ptp(values[known]) == 0:
        return None
    return np.where(known, values, np.median(values[known]))


def lacking_levels(frame: pd.DataFrame) -> str:
    """Return in words which column shows levels, "" where recorded rows have one, or waveforms.

    What acts on levels alone, or by them, is a mere curve over the distance without.
    """
    return "" if {*REPORTED_LEVELS, "cir"} & {*frame.columns} else REPORTED_LEVELS[0]
