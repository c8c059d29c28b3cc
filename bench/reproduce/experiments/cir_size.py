"""REMnet's error against the number K of CIR samples it is given."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import NDArray

from bench.measure.metrics import over_seeds, score
from bench.reproduce import paper
from bench.reproduce.build import make_outcome
from bench.reproduce.context import Context
from bench.reproduce.outcome import Figure, Outcome, Row, Series, Table
from bench.reproduce.sweep import sweep
from bench.results import Interval

SIZES = (8, 16, 32, 64, 96, 128, 152, 157)
QUICK_SIZES = (8, 32, 128)
SEEDS, QUICK_SEEDS = 10, 3
EPOCHS, QUICK_EPOCHS = 30, 10
PAPERS_SIZE = 128
_PROTOCOL = (
    "REMnet on the first K samples of the window (five before the detected first path, then on), "
    "trained {seeds} times from different seeds at every K ({epochs} epochs), on the first fold "
    "of the split; MAE on its NLoS test rows. Mean over seeds; interval 95 %: Student's t over "
    "seeds and bootstrap over links, in quadrature. The paper gives a picture; its figure at "
    "K = 128 is that of Table I."
)


@dataclass(frozen=True)
class Data:
    """The rows of one fold: CIRs [n, 157] in counts, errors [n] in metres, links [n]."""

    train_cirs: NDArray[np.float32]
    train_errors_m: NDArray[np.float32]
    test_cirs: NDArray[np.float32]
    test_errors_m: NDArray[np.float32]
    test_links: NDArray[np.str_]


@dataclass(frozen=True)
class Point:
    """One K: all its seeds are trained together."""

    samples: int
    seeds: tuple[int, ...]
    epochs: int


def run(context: Context) -> Outcome:
    """Return MAE against K, as a table and a picture."""
    points = _points(context.quick)
    data = _data(context)
    results = sweep(context, "cir-size", train_point, data, points)
    figures = [_over_seeds(found) for found in results]
    printed = paper.find("optimisation", model="remnet", backend="fp32")["nlos_mae_m"]
    rows = [
        Row((str(point.samples),), "NLoS MAE", "m", figure,
            printed if point.samples == PAPERS_SIZE else None)
        for point, figure in zip(points, figures, strict=True)
    ]  # fmt: skip
    raw = float(np.abs(data.test_errors_m).mean())
    note = f"Before mitigation: {raw:.4f} m. Split: {context.material.split.name}."
    protocol = _PROTOCOL.format(seeds=len(points[0].seeds), epochs=points[0].epochs)
    table = Table("MAE against the number of CIR samples", ("K",), rows)
    title = "CIR size: how many samples REMnet needs"
    picture = _figure(points, figures, raw)
    return make_outcome(context, "cir-size", title, protocol, [table], [picture], [note])


def train_point(data: Data, point: Point) -> list[dict[str, Any]]:
    """Return the NLoS MAE of every seed, each with its interval over links."""
    from zoo.remnet import REMnet
    from zoo.training.together import fit_together

    models = [
        REMnet(cir_samples=point.samples, epochs=point.epochs, random_state=seed)
        for seed in point.seeds
    ]
    fit_together(models, [data.train_cirs] * len(models), [data.train_errors_m] * len(models))
    return [_scored(data, model.predict(data.test_cirs)) for model in models]


def _scored(data: Data, predicted_m: NDArray[np.float32]) -> dict[str, Any]:
    return vars(score(data.test_errors_m, predicted_m, data.test_links).mae_m)


def _points(quick: bool) -> list[Point]:
    sizes = QUICK_SIZES if quick else SIZES
    seeds = tuple(range(QUICK_SEEDS if quick else SEEDS))
    return [Point(size, seeds, QUICK_EPOCHS if quick else EPOCHS) for size in sizes]


def _data(context: Context) -> Data:
    material, fold = context.material, context.material.split.folds[0]
    test = fold.test_nlos if len(fold.test_nlos) else fold.test_los
    return Data(
        material.cirs[fold.train],
        material.errors_m[fold.train],
        material.cirs[test],
        material.errors_m[test],
        material.links[test],
    )


def _over_seeds(found: Sequence[dict[str, Any]]) -> Interval:
    return over_seeds([Interval(**one) for one in found])


def _figure(points: Sequence[Point], figures: Sequence[Interval], raw: float) -> Figure:
    sizes = [float(point.samples) for point in points]
    low = [one.value if one.low is None else one.low for one in figures]
    high = [one.value if one.high is None else one.high for one in figures]
    series = [
        Series(
            "REMnet, mean over seeds", sizes, [one.value for one in figures], low=low, high=high
        ),
        Series("before mitigation", [sizes[0], sizes[-1]], [raw, raw], style="dashed"),
    ]
    return Figure(
        "mae", "Error against the number of CIR samples", "lines", "CIR samples K",
        "NLoS MAE (m)", series,
    )  # fmt: skip
