"""Learning curves: the error left by how many links of a site were trained on."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.results import Interval, RunRecord
from bench.runner.folder import ResultFolder
from bench.runner.material import Material

if TYPE_CHECKING:
    import pandas as pd

LEVEL = 0.95
FEWEST_DRAWS = 3  # for an interval


@dataclass(frozen=True)
class CurvePoint:
    """The mean absolute error in metres left after so many links, over `draws` draws.

    Intervals are Student's t over the draws' logarithms (draws share links: somewhat short);
    None below three draws. `raw_*` is without mitigation on the same rows.
    """

    model: str
    backend: str
    seed: int
    data: str
    split: str
    links: int
    draws: int
    nlos_mae_m: Interval | None
    los_mae_m: Interval | None
    raw_nlos_mae_m: float | None
    raw_los_mae_m: float | None


def curve_points(
    runs: Iterable[RunRecord],
    materials: Sequence[Material],
    links: Sequence[int],
    folder: ResultFolder,
) -> list[CurvePoint]:
    """Return a point per finished run; `links` [m] were trained on in materials [m]."""
    known = {one.split.name: (one, count) for one, count in zip(materials, links, strict=True)}
    done = [run for run in runs if run.status == "ok"]
    return [_point(run, *known[run.key.split], folder) for run in done]


def _point(run: RunRecord, material: Material, links: int, folder: ResultFolder) -> CurvePoint:
    import pandas as pd

    table = pd.read_parquet(folder.predictions_path(run.key.digest()))
    draw, key = _draws(material), run.key
    figures = [_over_draws(table, draw, los) for los in (False, True)]
    return CurvePoint(
        key.model, key.backend, key.seed, key.data, key.split, links, len(material.split.folds),
        figures[0][0], figures[1][0], figures[0][1], figures[1][1],
    )  # fmt: skip


def _draws(material: Material) -> NDArray[np.intp]:
    """Return which draw each row of the predictions belongs to: they stand draw by draw."""
    sizes = [len(fold.test_nlos) + len(fold.test_los) for fold in material.split.folds]
    return np.repeat(np.arange(len(sizes)), sizes)


def _over_draws(
    table: pd.DataFrame, draw: NDArray[np.intp], los: bool
) -> tuple[Interval | None, float | None]:
    """Return the error left with its interval, and that before, of the LoS or NLoS rows."""
    kind = (table["scored_as_los"] == los).to_numpy()
    if not kind.any():
        return None, None
    error, predicted = (table[name].to_numpy(np.float64) for name in ("error_m", "predicted_m"))
    left, raw = np.abs(error - predicted), np.abs(error)
    present = np.unique(draw[kind])
    means = [np.array([part[kind & (draw == d)].mean() for d in present]) for part in (left, raw)]
    return over_draws(means[0]), float(means[1].mean())


def over_draws(values: NDArray[np.float64]) -> Interval:
    """Return the mean with Student's 95 % interval of logarithms; without one below three values.

    Two values' interval is 13 times as wide as they are apart: it says nothing.
    Errors are positive and spread by factors: on their logarithms no interval reaches below zero.
    """
    from scipy.stats import t

    mean, count = float(values.mean()), len(values)
    if count < FEWEST_DRAWS:
        return Interval(mean)
    logs = np.log(np.maximum(values, 1e-9))
    half = float(t.ppf((1 + LEVEL) / 2, count - 1) * logs.std(ddof=1) / count**0.5)
    return Interval(mean, float(np.exp(logs.mean() - half)), float(np.exp(logs.mean() + half)))
