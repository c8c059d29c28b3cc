"""Recorded ranges as positioning problems: a still tag, the anchors that range with it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.positioning import (
    check_anchors,
    dilution_of_precision,
    gauss_newton,
    robust_least_squares,
)

Floats = NDArray[np.float64]
SOLVERS = {"Gauss-Newton": gauss_newton, "robust": robust_least_squares}


@dataclass(frozen=True)
class Tag:
    """A tag at one spot: `truth_m` [d], `anchors_m` [a, d], and ranges [epochs, a] by name.

    Ranges of one epoch are the i-th of every anchor: a still tag's order does not matter.
    """

    name: str
    truth_m: Floats
    anchors_m: Floats
    ranges_m: dict[str, Floats]

    @property
    def dop(self) -> float:
        """Dilution of precision at the true position: metres of position per metre of range."""
        if len(self.anchors_m) < len(self.truth_m):
            return float("inf")
        return float(dilution_of_precision(self.anchors_m, self.truth_m[None])[0])

    def refusal(self) -> str | None:
        """Return why these anchors fix no position, or None."""
        try:
            check_anchors(self.anchors_m, len(self.truth_m))
        except BenchError as reason:
            return str(reason)
        return None

    def range_errors_m(self, kind: str) -> Floats:
        """Return measured - true ranges [epochs, a]."""
        true_m: Floats = np.linalg.norm(self.anchors_m - self.truth_m, axis=1)
        return np.asarray(self.ranges_m[kind] - true_m)

    def fixes(self, kind: str, solver: str) -> tuple[Floats, Floats, NDArray[np.bool_]]:
        """Return fixes [epochs, d], their distance from the truth [epochs], and which converged."""
        done = SOLVERS[solver](self.anchors_m, self.ranges_m[kind])
        away = np.linalg.norm(done.positions_m - self.truth_m, axis=1)
        return done.positions_m, away, done.converged


def tags_of(
    frame: pd.DataFrame, ranges: dict[str, str], dimensions: int, epochs: int
) -> Iterator[Tag]:
    """Yield a tag per position of `tx`, with every anchor (`rx`) it has ranges to.

    `ranges` names the columns that hold ranges in metres. At most `epochs` epochs, spread evenly
    over the shortest link; anchors with fewer than a tenth of the median link's rows are left out.
    """
    axes = "xyz"[:dimensions]
    tag_at, anchor_at = ([f"{end}_{axis}_m" for axis in axes] for end in ("tx", "rx"))
    whole = frame.dropna(subset=[*tag_at, *anchor_at, *ranges.values()])
    for number, (spot, rows) in enumerate(whole.groupby(tag_at, sort=True)):
        links = [(at, part) for at, part in rows.groupby(anchor_at, sort=True)]
        least = 0.1 * float(np.median([len(part) for _, part in links]))
        links = [(at, part) for at, part in links if len(part) >= least]
        count = min(epochs, min(len(part) for _, part in links))
        yield Tag(
            _name(rows, number),
            np.array(spot, np.float64),
            np.array([at for at, _ in links], np.float64),
            {kind: _epochs(links, column, count) for kind, column in ranges.items()},
        )


def _epochs(links: Sequence[tuple[object, pd.DataFrame]], column: str, count: int) -> Floats:
    """Return [count, anchors], each link thinned evenly to `count` rows."""
    columns = []
    for _, part in links:
        rows = np.linspace(0, len(part) - 1, count).round().astype(int)
        columns.append(part[column].to_numpy(np.float64)[rows])
    return np.stack(columns, axis=1)


def _name(rows: pd.DataFrame, number: int) -> str:
    """Return what the links call the tag, else its number."""
    link = str(rows["link"].iloc[0])
    return link.rpartition(" - ")[2] if " - " in link else f"spot {number + 1}"
