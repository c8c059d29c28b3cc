"""Reading outcome files; what is wrong with one is said in a line."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated, Any, Literal

import msgspec

from reports.believe import believed
from reports.errors import ReportError

SCHEMA_VERSION = 1

Number = float | None
"""None: the figure was not finite."""


@dataclass(frozen=True)
class Figured:
    """A figure of ours with its 95 % interval."""

    value: Number
    low: Number
    high: Number


Value = Figured | int | float | str | None


@dataclass(frozen=True)
class RowFile:
    """One figure of ours and the paper's, None where either has none.

    `of_data`: it describes the recordings, and no method.
    """

    label: tuple[str, ...]
    quantity: str
    unit: str
    ours: Value
    paper: Number
    note: str
    digits: int | None = None
    of_data: bool = False


@dataclass(frozen=True)
class TableFile:
    """A comparison; `labels` names the parts of a row's label."""

    title: str
    labels: tuple[str, ...]
    rows: tuple[RowFile, ...]
    digits: int
    notes: tuple[str, ...]


@dataclass(frozen=True)
class SeriesFile:
    """Points of a picture."""

    name: str
    x: tuple[float | str | None, ...]
    y: tuple[Number, ...]
    z: tuple[Number, ...] | None
    low: tuple[Number, ...] | None
    high: tuple[Number, ...] | None
    style: Literal["", "line", "dashed", "step", "marker", "hollow"]
    x_low: tuple[Number, ...] | None = None
    x_high: tuple[Number, ...] | None = None
    colour: str = ""
    marker: str = ""


@dataclass(frozen=True)
class FigureFile:
    """The data of one picture; its name becomes part of a file name."""

    name: Annotated[str, msgspec.Meta(pattern="^[A-Za-z0-9_-]+$")]
    title: str
    kind: Literal["lines", "bars", "scatter", "scatter3d", "histogram", "tradeoff"]
    x_label: str
    y_label: str
    z_label: str
    series: tuple[SeriesFile, ...]
    log_x: bool
    log_y: bool
    equal_axes: bool
    data: str = ""


@dataclass(frozen=True)
class OutcomeFile:
    """One experiment as it was written."""

    kind: Literal["reproduction"]
    schema_version: Literal[1]
    experiment: Annotated[str, msgspec.Meta(pattern="^[A-Za-z0-9_-]+$")]
    title: str
    data: str
    data_fingerprint: str
    simulated: bool
    quick: bool
    protocol: str
    tables: tuple[TableFile, ...]
    figures: tuple[FigureFile, ...]
    notes: tuple[str, ...]
    elapsed_s: float
    host: Mapping[str, Any]
    created_utc: str
    longest_s: float = 0.0

    @property
    def trained_s(self) -> float:
        """Return the longest that making it took: the time with the trainings it needed."""
        return max(self.elapsed_s, self.longest_s)


def read_outcomes(folder: Path) -> list[OutcomeFile]:
    """Return the outcomes of a folder, by name. Raises ReportError like `read_outcome`."""
    return [read_outcome(path) for path in sorted(folder.glob("*.json"))]


def read_outcome(path: Path) -> OutcomeFile:
    """Return one outcome. Raises ReportError where the file is absent, damaged or another kind."""
    try:
        outcome = msgspec.convert(believed(path, SCHEMA_VERSION), OutcomeFile)
        for figure in outcome.figures:
            _check(figure)
    except (OSError, ValueError, RecursionError) as problem:
        raise ReportError(f"{path}: cannot be read as an outcome: {problem}") from problem
    return outcome


def _check(figure: FigureFile) -> None:
    """Raise ValueError where a picture cannot be drawn from its points."""
    for one in figure.series:
        where = f"figure {figure.name!r}, series {one.name!r}"
        columns = (one.x, one.y, one.z, one.low, one.high, one.x_low, one.x_high)
        if len({len(column) for column in columns if column is not None}) > 1:
            raise ValueError(f"{where}: columns of unequal length")
        if figure.kind == "scatter3d" and one.z is None:
            raise ValueError(f"{where}: no z")
        if figure.kind != "bars" and any(isinstance(value, str) for value in one.x):
            raise ValueError(f"{where}: x is not a number")
