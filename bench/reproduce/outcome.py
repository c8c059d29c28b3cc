"""What an experiment gives: tables and the data of figures, as one JSON file `reports` renders."""

from __future__ import annotations

import json
import math
from collections.abc import Callable, Sequence
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any, Literal

from bench.errors import BenchError
from bench.files import read_json, write_atomically
from bench.provenance import is_sealed, sealed
from bench.results import Interval

SCHEMA_VERSION = 1
Value = float | int | str | Interval | None


@dataclass(frozen=True)
class Row:
    """One line of a comparison: ours with its interval, the paper's figure or None.

    `label` names the row (one entry per label column of the table). Difference = ours - paper is
    computed where both are numbers, never stored. `digits` None takes the table's. `of_data`: it
    describes the recordings, uncorrected, and no method.
    """

    label: tuple[str, ...]
    quantity: str
    unit: str
    ours: Value
    paper: float | None = None
    note: str = ""
    digits: int | None = None
    of_data: bool = False


@dataclass(frozen=True)
class Table:
    """A titled comparison. `labels` names the label columns; `digits` after the decimal point."""

    title: str
    labels: tuple[str, ...]
    rows: Sequence[Row]
    digits: int = 4
    notes: Sequence[str] = ()


@dataclass(frozen=True)
class Series:
    """Points of a figure: x, y (and z), with optional intervals of x and y.

    `style` overrides how the kind of figure would draw it: a line, a dashed one, steps, big or
    hollow markers. In a trade-off, series of one `colour` (or `marker`) name share that look, and
    the legend lists the looks.
    """

    name: str
    x: Sequence[float | str]
    y: Sequence[float]
    z: Sequence[float] | None = None
    low: Sequence[float] | None = None
    high: Sequence[float] | None = None
    style: Literal["", "line", "dashed", "step", "marker", "hollow"] = ""
    x_low: Sequence[float] | None = None
    x_high: Sequence[float] | None = None
    colour: str = ""
    marker: str = ""


@dataclass(frozen=True)
class Figure:
    """The data of one picture; `kind` says how `reports` draws it. Axis labels carry units.

    `data` says what it shows where that is not the outcome's recordings.
    """

    name: str
    title: str
    kind: Literal["lines", "bars", "scatter", "scatter3d", "histogram", "tradeoff"]
    x_label: str
    y_label: str
    series: Sequence[Series]
    z_label: str = ""
    log_x: bool = False
    log_y: bool = False
    equal_axes: bool = False
    data: str = ""


@dataclass(frozen=True)
class Outcome:
    """One experiment, done. `protocol` says in words what was run and what differs from the paper.

    `simulated` marks every rendering. `elapsed_s` is wall time on the machine it ran on, with
    whatever runs were found done; `longest_s` is the longest that any making of it on the same
    recordings took, which is the one that had to train. `key` stands for all that determines it.
    """

    experiment: str
    title: str
    data: str
    data_fingerprint: str
    simulated: bool
    quick: bool
    protocol: str
    tables: Sequence[Table] = ()
    figures: Sequence[Figure] = ()
    notes: Sequence[str] = ()
    elapsed_s: float = 0.0
    longest_s: float = 0.0
    host: dict[str, Any] = field(default_factory=dict)
    key: str = ""
    created_utc: str = ""
    schema_version: int = SCHEMA_VERSION
    kind: str = "reproduction"


def write_outcome(outcome: Outcome, path: Path) -> None:
    """Write an outcome as JSON in one step; figures that are not finite become null."""
    write_atomically(path, json.dumps(sealed(_finite(asdict(outcome))), indent=1) + "\n")


def read_key(path: Path, tell: Callable[[str], None] = lambda _: None) -> str | None:
    """Return the key of an outcome file, None where there is none that can be believed.

    `tell` hears of one that was edited or damaged.
    """
    if not path.exists():
        return None
    content = _content(path)
    if content is None:
        tell(f"{path}: edited or damaged since it was written; it is made again")
        return None
    return str(content["key"]) if content.get("schema_version") == SCHEMA_VERSION else None


def _content(path: Path) -> dict[str, Any] | None:
    """Return an outcome file's content, None where it is not what was written."""
    try:
        content = read_json(path)
    except BenchError:
        return None
    return content if is_sealed(content) else None


def read_longest_s(path: Path, outcome: Outcome) -> float:
    """Return how long an earlier making of this outcome took, 0 where there was none."""
    try:
        content = read_json(path)
        same = [content[name] for name in _SAME] == [getattr(outcome, name) for name in _SAME]
        return max(content["elapsed_s"], content.get("longest_s", 0.0)) if same else 0.0
    except (BenchError, KeyError, TypeError):
        return 0.0


_SAME = ("experiment", "data_fingerprint", "quick")


def _finite(value: Any) -> Any:
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_finite(item) for item in value]
    return value
