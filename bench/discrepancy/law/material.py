"""The rows that a law is looked for in: residuals, covariates, devices and positions."""

from __future__ import annotations

import json
from dataclasses import dataclass, replace

import numpy as np
import pandas as pd
from numpy.typing import NDArray

from bench.discrepancy.data.columns import numeric
from bench.discrepancy.data.covariates import Covariates, covariates
from bench.discrepancy.law.settings import (
    LAW_FACING,
    LAW_FLOOR_M,
    LAW_HALF_TURN,
    LAW_KNOWN_SHARE,
    LAW_LONGEST_NAME,
    LAW_MOST_COLUMNS,
    LAW_MOST_FACTORS,
    LAW_SAME_PLACE_M,
)
from bench.physics.formula.algebras import Numbers
from bench.physics.formula.parse import tree, walk
from bench.physics.formula.units import column_unit, factor_of, stem

Floats = NDArray[np.float64]
_AXES = "xyz"
_WORDS = {
    "true_range_m": "true range", "time_s": "time", "temperature_c": "temperature",
    "reply_time_s": "reply time", "azimuth_deg": "heading", "clock_offset_ppm": "clock offset",
    "radial_speed_m_per_s": "radial speed",
}  # fmt: skip
_DERIVED = {  # what follows from two positions: words, unit
    "atan2(rx_y_m - tx_y_m, rx_x_m - tx_x_m)": ("bearing of the link", "rad"),
    "rx_z_m - tx_z_m": ("height of rx over tx", "m"),
}

_BEARING, _ = _DERIVED  # as an expression
FACING = f"azimuth_deg - {_BEARING}"  # what an antenna off the centre that turns is off by
_ROUND = ("azimuth_deg", "atan2(")  # how expressions of headings and bearings begin

BEHIND = "behind "  # how words of a place begin that is beyond an obstacle
SIGHT = "line of sight: "  # those of rows with or without line of sight
NO_SIGHT = f"{SIGHT}False"


@dataclass(frozen=True)
class Column:
    """A covariate: its text in an expression, words for people, unit, values [n] in that unit.

    `reference` is a typical value, fixed once.
    """

    text: str
    words: str
    unit: str
    values: Floats
    reference: float

    @property
    def angle(self) -> bool:
        """Whether it goes round: headings do, of other angles those that span half a turn."""
        known = self.values[np.isfinite(self.values)]
        span = float(np.ptp(known)) if len(known) else 0.0
        return self.text.startswith(_ROUND) or span >= LAW_HALF_TURN.get(self.unit, np.inf)


@dataclass(frozen=True)
class Factor:
    """What a law is multiplied with: `text` in an expression ("" = all rows), weights [n]."""

    text: str
    words: str
    unit: str
    weights: Floats

    @property
    def group(self) -> bool:
        """Whether it is a device or category, not a number."""
        return self.text != "" and self.unit == "1" and bool(np.isin(self.weights, (0, 1)).all())


@dataclass(frozen=True)
class Material:
    """Rows: `residual_m` [n] recorded - simulated range, link codes [n], covariates, factors.

    `range_m` [n] is the simulated range; `ends` maps tx and rx to positions [n, 3], where known;
    `devices` maps them to names [n]; `axes` are those that positions have. `rounded`: the simulated
    ranges are rounded as the recorded ones are. `rise_m` [n]: how much higher rx stands than tx,
    where true ranges may be distances on the floor (see `_rise`).
    """

    residual_m: Floats
    links: NDArray[np.intp]
    columns: tuple[Column, ...]
    factors: tuple[Factor, ...]
    range_m: Floats
    true_range_m: Floats
    devices: dict[str, NDArray[np.object_]]
    ends: dict[str, Floats]
    axes: str = "xyz"
    rounded: bool = False
    rise_m: Floats | None = None

    def take(self, rows: NDArray[np.intp]) -> Material:
        """Return some rows, some of them perhaps several times."""
        return Material(
            self.residual_m[rows],
            self.links[rows],
            tuple(replace(c, values=c.values[rows]) for c in self.columns),
            tuple(replace(f, weights=f.weights[rows]) for f in self.factors),
            self.range_m[rows],
            self.true_range_m[rows],
            {end: names[rows] for end, names in self.devices.items()},
            {end: places[rows] for end, places in self.ends.items()},
            self.axes,
            self.rounded,
            None if self.rise_m is None else self.rise_m[rows],
        )


def material(
    frame: pd.DataFrame, residual_m: Floats, links: NDArray[np.intp], like: Material | None = None
) -> Material:
    """Return the material of rows whose residual is known; `frame` is a recordings table.

    With `like` it has the covariates and factors of another material, in its order.
    """
    keep = np.flatnonzero(np.isfinite(residual_m))
    frame, residual_m, links = (
        frame.iloc[keep].reset_index(drop=True),
        residual_m[keep],
        links[keep],
    )
    true = numeric(frame, "true_range_m")
    error = numeric(frame, "error_m")
    error = np.where(np.isfinite(error), error, numeric(frame, "range_m") - true)
    columns, factors = _own(frame) if like is None else _same(frame, like)
    names = {end: frame[end].astype(str).to_numpy(object) for end in ("tx", "rx") if end in frame}
    return Material(
        residual_m,
        links[keep],
        columns,
        factors,
        true + error - residual_m,
        true,
        names,
        _positions(frame, true),
        "".join(a for a in _AXES if f"tx_{a}_m" in frame and f"rx_{a}_m" in frame),
        rise_m=_rise(frame, true),
    )


def _own(frame: pd.DataFrame) -> tuple[tuple[Column, ...], tuple[Factor, ...]]:
    """Return the covariates and factors that rows have."""
    known = covariates(frame)
    columns = _columns(frame, known)
    return columns, _factors(columns, known, len(frame))


def _same(frame: pd.DataFrame, like: Material) -> tuple[tuple[Column, ...], tuple[Factor, ...]]:
    """Return the covariates and factors of another material for these rows."""
    return _same_columns(frame, like), _same_factors(frame, like)


def _columns(frame: pd.DataFrame, known: Covariates) -> tuple[Column, ...]:
    """Return the numeric covariates, the usual ones first, and what follows from positions."""
    every = dict(known.numbers)
    if "true_range_m" in frame:
        every = {"true_range_m": numeric(frame, "true_range_m")} | every
    names = sorted(every, key=lambda n: (n not in _WORDS, list(every).index(n)))
    made = [column(name, every[name]) for name in names if name.isidentifier()]
    made += _derived(frame)
    kept = [c for c in made if _telling(c.values) and not _facing_always(c)]
    return tuple(kept[:LAW_MOST_COLUMNS])


def _same_columns(frame: pd.DataFrame, like: Material) -> tuple[Column, ...]:
    """Return the covariates of another material for these rows."""
    derived = {one.text: one.values for one in _derived(frame)}
    return tuple(
        replace(c, values=derived[c.text] if c.text in derived else numeric(frame, c.text))
        for c in like.columns
    )


def _same_factors(frame: pd.DataFrame, like: Material) -> tuple[Factor, ...]:
    """Return the factors of another material for these rows."""
    rows = FrameColumns(frame)
    first = replace(like.factors[0], weights=np.ones(len(frame)))
    return (first, *(replace(f, weights=rows.weights(f.text)) for f in like.factors[1:]))


@dataclass(frozen=True)
class FrameColumns:
    """The columns of a table, as an expression names them."""

    frame: pd.DataFrame

    def number(self, name: str) -> Floats:
        """Return a numeric column [n], NaN where unknown."""
        return numeric(self.frame, name)

    def label(self, name: str, text: str) -> Floats:
        """Return 1.0 [n] where a column of names, or any obstacle, is `text`."""
        if name == "obstacles":
            return np.array([text in cell for cell in self.frame[name]], np.float64)
        return np.asarray(self.frame[name].astype(str) == text, np.float64)

    def weights(self, text: str) -> Floats:
        """Return a factor [n], a column in its own unit or a condition, 0 where unknown."""
        if text in self.frame or not text.startswith("("):
            return np.nan_to_num(self.number(text))
        made = walk(tree(text), Numbers(self, {}, {}))
        return np.nan_to_num(np.broadcast_to(made, len(self.frame)))


def column(name: str, values: Floats) -> Column:
    """Return a column of the table as a covariate."""
    text = column_unit(name)
    words = _WORDS.get(name, stem(name).replace("_", " "))
    return Column(name, words, text, values, _reference(values))


def _derived(frame: pd.DataFrame) -> list[Column]:
    """Return covariates that follow from both positions, where they are known."""
    if not {f"{end}_{axis}_m" for end in ("tx", "rx") for axis in _AXES} <= set(frame.columns):
        return []
    gap = {a: numeric(frame, f"rx_{a}_m") - numeric(frame, f"tx_{a}_m") for a in _AXES}
    values = (np.arctan2(gap["y"], gap["x"]), gap["z"])
    made = [
        Column(text, words, unit_text, value, _reference(value))
        for (text, (words, unit_text)), value in zip(_DERIVED.items(), values, strict=True)
    ]
    if "azimuth_deg" in frame:
        off = np.angle(np.exp(1j * (np.radians(numeric(frame, "azimuth_deg")) - values[0])))
        made.append(Column(FACING, "heading off the link's bearing", "rad", off, _reference(off)))
    return made


def _facing_always(one: Column) -> bool:
    """Return whether headings are bearings, or as far off these in all rows."""
    if one.text != FACING:
        return False
    known = one.values[np.isfinite(one.values)]
    return bool(abs(np.mean(np.exp(1j * known))) > LAW_FACING)


def _reference(values: Floats) -> float:
    """Return a typical size of values, in two digits."""
    typical = float(np.nanmedian(np.abs(values))) if np.isfinite(values).any() else 0.0
    return float(f"{typical:.1e}") or 1.0


def _telling(values: Floats) -> bool:
    """Return whether a covariate is known nearly everywhere, and not constant."""
    known = np.isfinite(values)
    return bool(known.mean() >= LAW_KNOWN_SHARE and np.ptp(values[known]) > 0)


def _factors(columns: tuple[Column, ...], known: Covariates, rows: int) -> tuple[Factor, ...]:
    """Return what a law may be multiplied with: nothing, devices and categories, numbers."""
    groups = [
        Factor(text, words, "1", mask.astype(np.float64))
        for name, mask in known.groups.items()
        if (found := condition(name)) is not None
        for text, words in [found]
    ]
    numbers = [
        Factor(c.text, c.words, c.unit, np.nan_to_num(c.values)) for c in columns if not c.angle
    ]
    few = [*numbers, *groups][: LAW_MOST_FACTORS - 1]
    return (Factor("", "", "1", np.ones(rows)), *few)


def condition(group: str) -> tuple[str, str] | None:
    """Return the expression and words of a covariate group, None where none can be written.

    `rx=a2` is `(rx == "a2")`; only what a simulator knows of its rows can be written.
    """
    name, _, value = group.partition("=")
    if len(value) > LAW_LONGEST_NAME or not value.isprintable():
        return None
    if name in ("tx", "rx", "environment"):
        return f"({name} == {json.dumps(value)})", f"{name} is {value}"
    if name == "obstacle":
        return f"(obstacles == {json.dumps(value)})", f"{BEHIND}{value}"
    if name == "los" and value in ("True", "False"):
        return f"(los {'>' if value == 'True' else '<'} 0.5)", f"{SIGHT}{value}"
    ends = value.split("->")
    if name != "pair" or len(ends) != 2:
        return None
    both = " * ".join(
        f"({end} == {json.dumps(one)})" for end, one in zip(("tx", "rx"), ends, strict=True)
    )
    return f"({both})", f"tx is {ends[0]} and rx is {ends[1]}"


def _positions(frame: pd.DataFrame, true_m: Floats) -> dict[str, Floats]:
    """Return positions of both ends [n, 3], where known; {} where true ranges contradict them."""
    if not {f"{end}_{axis}_m" for end in ("tx", "rx") for axis in "xy"} <= set(frame.columns):
        return {}
    ends = {
        end: np.stack([np.nan_to_num(numeric(frame, f"{end}_{a}_m")) for a in _AXES], axis=1)
        for end in ("tx", "rx")
    }
    between = np.linalg.norm(ends["tx"] - ends["rx"], axis=1)
    agree = float(np.median(np.abs(between - true_m))) < LAW_SAME_PLACE_M
    return ends if agree else {}


def _rise(frame: pd.DataFrame, true_m: Floats) -> Floats | None:
    """Return how much higher rx stands than tx [n], None where true ranges have it in them.

    Where places on the floor are known, true ranges must be their distances in every row; where
    only heights are, ranges alone can tell.
    """
    ends = {axis: (f"rx_{axis}_m", f"tx_{axis}_m") for axis in _AXES}
    gap_m = {
        axis: numeric(frame, one) - numeric(frame, two)
        for axis, (one, two) in ends.items()
        if {one, two} <= set(frame.columns)
    }
    if "z" not in gap_m or not np.isfinite(gap_m["z"]).all() or not gap_m["z"].any():
        return None
    if not {"x", "y"} <= set(gap_m):
        return gap_m["z"]
    off_m = np.abs(np.hypot(gap_m["x"], gap_m["y"]) - true_m)
    return gap_m["z"] if float(np.nan_to_num(off_m, nan=np.inf).max()) <= LAW_FLOOR_M else None


def base_values(of: Column) -> Floats:
    """Return a column's values in base units: angles in radians."""
    return of.values * factor_of(of.unit)
