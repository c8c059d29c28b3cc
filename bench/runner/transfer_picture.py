"""A picture of a transfer matrix: error left over error before, one panel each for NLoS and LoS."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.files import atomic_path, check_picture_name
from bench.results import Score
from bench.runner.transfer import Cell, TransferMatrix

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure
    from matplotlib.image import AxesImage

WORST = 3.0  # times the raw error, where the colours end


def save_matrix(matrix: TransferMatrix, path: Path) -> None:
    """Draw the matrix to a .png, .svg or .pdf file.

    Raises BenchError for another kind of file, and where the file cannot be written.
    """
    check_picture_name(path)
    figure = draw_matrix(matrix)
    with atomic_path(path) as scratch:
        figure.savefig(scratch, dpi=150)


def draw_matrix(matrix: TransferMatrix) -> Figure:
    """Return the figure: each cell has the MAE left in metres and that before; blue is better."""
    from matplotlib.figure import Figure

    across, down = len(matrix.data), len(matrix.rows)
    figure = Figure(figsize=(2 * (1.35 * across + 1.6), 0.8 * down + 1.9), layout="constrained")
    axes = figure.subplots(1, 2, sharey=True)
    for ax, kind in zip(axes, ("nlos", "los"), strict=True):
        image = _draw_panel(ax, matrix, kind)
    bar = figure.colorbar(image, ax=axes, shrink=0.8, ticks=np.log2([1 / 3, 1 / 2, 1, 2, 3]))
    bar.set_ticklabels(["1/3", "1/2", "1", "2", "3"])
    bar.set_label("MAE left / MAE before")
    figure.suptitle(f"{matrix.model} on {matrix.backend}: MAE left (m), before in brackets")
    return figure


def _draw_panel(ax: Axes, matrix: TransferMatrix, kind: str) -> AxesImage:
    grid = [[matrix.cell(train, test) for test in matrix.data] for train in matrix.rows]
    ratios = np.array([[_log_ratio(getattr(one, kind)) for one in row] for row in grid])
    end = np.log2(WORST)
    image = ax.imshow(ratios, cmap="RdBu_r", vmin=-end, vmax=end, aspect="auto")
    for place, one in np.ndenumerate(np.array(grid, dtype=object)):
        score = getattr(one, kind)
        dark = score is not None and abs(_log_ratio(score)) > 0.7 * end
        text, colour = _text(score), "white" if dark else "#222222"
        ax.text(place[1], place[0], text, ha="center", va="center", fontsize=8, color=colour)
    ax.set_title({"nlos": "NLoS rows", "los": "LoS rows"}[kind], loc="left", fontsize=10)
    tested = [matrix.cell(test, test) for test in matrix.data]
    ax.set_xticks(range(len(tested)), [_marked(one.test, one.test_simulated) for one in tested])
    trained = [row[-1] for row in grid]
    ax.set_yticks(range(len(trained)), [_label(one) for one in trained])
    ax.set_xlabel("tested on")
    if kind == "nlos":
        ax.set_ylabel("trained on")
    return image


def _label(cell: Cell) -> str:
    return _marked(cell.train, cell.train_simulated)


def _marked(name: str, simulated: bool) -> str:
    return f"{Path(name).stem}\n(SIMULATED)" if simulated else Path(name).stem


def _log_ratio(score: Score | None) -> float:
    """Return log2 of the error left over that before; NaN where there is none."""
    if score is None or not score.raw_mae_m:
        return float("nan")
    return float(np.log2(max(score.mae_m.value, 1e-9) / score.raw_mae_m))


def _text(score: Score | None) -> str:
    return "-" if score is None else f"{score.mae_m.value:.3f}\n({score.raw_mae_m:.3f})"
