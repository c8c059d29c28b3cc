"""What still tells simulated errors from recorded ones: their spread, and what they go with.

A correction is learnt from how the error goes with the registers. Where it goes with them more
loosely in a simulator, or the other way, what is learnt there is wrong for the recordings.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray
from scipy.stats import spearmanr

from bench.discrepancy.compare.matching import link_means
from bench.runner.worth.site import Examples, Site
from zoo.modules.blocks import LEVEL_FIGURES
from zoo.modules.features import FEATURES

FIGURES = (*LEVEL_FIGURES, "range_m", *FEATURES)
PERCENTILES = (5, 50, 95)
FEWEST_LINKS = 8  # below, a rank correlation over links says nothing
Floats = NDArray[np.float64]


@dataclass(frozen=True)
class Remains:
    """One figure of surveyed links, RECORDED, and of rows SIMULATED originally and as diagnosed.

    The means over splits. `unit` is "m" of a percentile of errors, "1" of a rank correlation.
    """

    figure: str
    unit: str
    recorded: float
    original: float
    diagnosed: float


def remains(sites: Sequence[Site]) -> tuple[Remains, ...]:
    """Return percentiles of the errors, then their rank correlation with every known figure."""
    sides = [[_figures(one) for one in (here.survey, here.before, here.after)] for here in sites]
    names = [name for name in sides[0][0] if all(name in one for side in sides for one in side)]
    mean = {name: np.mean([[one[name] for one in side] for side in sides], axis=0)
            for name in names}  # fmt: skip
    return tuple(
        Remains(name, "m" if "error" in name else "1", *map(float, mean[name])) for name in names
    )


def _figures(rows: Examples) -> dict[str, float]:
    """Return the figures of one side that are known, by name."""
    errors, figures = _per_link(rows)
    out = {f"error, {at}th percentile": float(np.percentile(rows.errors_m, at))
           for at in PERCENTILES}  # fmt: skip
    for name, values in zip(FIGURES, figures.T, strict=False):
        known = np.isfinite(values)
        if known.sum() >= FEWEST_LINKS and np.ptp(values[known]) > 0:
            out[name] = float(spearmanr(values[known], errors[known]).statistic)
    return out


def _per_link(rows: Examples) -> tuple[Floats, Floats]:
    """Return the mean error [k] and the mean figures [k, c] of every link."""
    codes = np.unique(rows.links, return_inverse=True)[1].astype(np.intp)
    every = np.column_stack([rows.errors_m, rows.rows]).astype(np.float64)
    means = link_means(every, codes)
    return means[:, 0], means[:, 1:]
