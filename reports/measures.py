"""The columns of a leaderboard: what each shows, which way is better, and the marks for best."""

from __future__ import annotations

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from typing import Literal

from reports.boards import Entry
from reports.document import Cell, Column, Table
from reports.load import Interval, Size
from reports.numbers import UNKNOWN, count, low_to_high, metres, ratio, seed_details, significant
from reports.seeds import Accuracy, SeedMean

Better = Literal["low", "high"]
Rows = Callable[[Entry], Accuracy | None]
"""Which rows' accuracy: NLoS or LoS."""


@dataclass(frozen=True)
class Figure:
    """One cell and the value it is compared by; `value` None takes no part in the comparison."""

    cell: Cell
    value: float | None = None


NLOS, LOS, SPEED, SIZE = "NLoS", "LoS", "speed", "size"
"""The groups of columns that stay together on a narrow page."""
NOTHING = Figure(Cell(UNKNOWN))


@dataclass(frozen=True)
class Measure:
    """One column: how to read it from an entry, and which way is better (None: neither)."""

    column: Column
    read: Callable[[Entry], Figure]
    better: Better | None = None


KEYS = (
    Measure(Column("Model", number=False), lambda entry: Figure(Cell(_model(entry)))),
    Measure(Column("Backend", number=False), lambda entry: Figure(Cell(entry.backend))),
)


def table(entries: Sequence[Entry], measures: Sequence[Measure]) -> Table:
    """Return the table of these entries and measures, the best of each column marked."""
    columns = [_marked([one.read(entry) for entry in entries], one.better) for one in measures]
    return Table(tuple(one.column for one in measures), tuple(zip(*columns, strict=True)))


def accuracy_measures() -> list[Measure]:
    """Return the columns of accuracy after mitigation. The floor takes part: it can win."""
    return [
        _metres("NLoS MAE (m)", _nlos, lambda score: score.mae_m),
        _ratio("NLoS R²", _nlos, lambda score: score.r2),
        _metres("NLoS σ (m)", _nlos, lambda score: score.sigma_m),
        _metres("LoS MAE (m)", _los, lambda score: score.mae_m),
        _ratio("LoS R²", _los, lambda score: score.r2),
        Measure(Column("Seeds", LOS), lambda entry: Figure(Cell(str(len(entry.seeds))))),
    ]


def cost_measures() -> list[Measure]:
    """Return the columns of measured speed and of size. The floor, which costs nothing, is out."""
    return [
        _latency(1),
        _latency(4),
        Measure(Column("Throughput (rows/s)", SPEED), _throughput, "high"),
        Measure(Column("Peak memory (MB)", SPEED), _peak_memory, "low"),
        _size("File (kB)", lambda size: size.file_bytes / 1000, significant),
        _size("Weights (kB)", lambda size: size.weight_bytes / 1000, significant),
        _size("Parameters", lambda size: size.parameters, count),
        _size("MACs", lambda size: size.macs, count),
        Measure(
            Column("Integer kernels", SIZE, number=False),
            lambda entry: Figure(Cell(entry.integer_kernels or UNKNOWN)),
        ),
    ]


def interval_measure(
    column: Column, read: Callable[[Entry], Interval | None], better: Better = "low"
) -> Measure:
    """Return a column of figures with low and high, such as estimates. The floor is out."""

    def figure(entry: Entry) -> Figure:
        known = read(entry)
        if known is None:
            return NOTHING
        cell = Cell(significant(known.value), low_to_high(known))
        return _cost(entry, cell, known.value)

    return Measure(column, figure, better)


def _nlos(entry: Entry) -> Accuracy | None:
    return entry.nlos


def _los(entry: Entry) -> Accuracy | None:
    return entry.los


def _metres(header: str, rows: Rows, pick: Callable[[Accuracy], SeedMean]) -> Measure:
    return Measure(Column(header, _group(rows)), _accuracy(rows, pick, metres, 4), "low")


def _ratio(header: str, rows: Rows, pick: Callable[[Accuracy], SeedMean]) -> Measure:
    return Measure(Column(header, _group(rows)), _accuracy(rows, pick, ratio, 3), "high")


def _group(rows: Rows) -> str:
    return NLOS if rows is _nlos else LOS


def _accuracy(
    rows: Rows,
    pick: Callable[[Accuracy], SeedMean],
    text: Callable[[float], str],
    decimals: int,
) -> Callable[[Entry], Figure]:
    def figure(entry: Entry) -> Figure:
        scored = rows(entry)
        if scored is None:
            return NOTHING
        mean = pick(scored)
        return Figure(Cell(text(mean.value), seed_details(mean, decimals)), mean.value)

    return figure


def _latency(batch: int) -> Measure:
    def figure(entry: Entry) -> Figure:
        one = entry.latency(batch)
        if one is None:
            return _withheld(entry)
        details = (f"[{significant(one.low_us)}, {significant(one.high_us)}]",)
        text = significant(one.median_us) + _dagger(entry)
        if one.unstable:
            return Figure(Cell(text, (*details, "unstable")))
        return _cost(entry, Cell(text, details), one.median_us)

    return Measure(Column(f"Latency, batch {batch} (µs)", SPEED), figure, "low")


def _withheld(entry: Entry) -> Figure:
    """Return the cell of a speed that is not known, or that a busy machine kept from being so."""
    busy = entry.timing is not None and entry.timing.withheld is not None
    return Figure(Cell(UNKNOWN, ("machine busy",))) if busy else NOTHING


def _throughput(entry: Entry) -> Figure:
    if entry.timing is None or entry.timing.throughput_rows_per_s is None:
        return _withheld(entry)
    value = entry.timing.throughput_rows_per_s
    cell = Cell(count(value) + _dagger(entry))
    if any(one.unstable for one in entry.timing.latency):
        return Figure(replace(cell, details=("unstable",)))
    return _cost(entry, cell, value)


def _peak_memory(entry: Entry) -> Figure:
    if entry.timing is None:
        return NOTHING
    value = entry.timing.peak_memory_bytes / 1e6
    return _cost(entry, Cell(significant(value) + _dagger(entry)), value)


def _size(header: str, pick: Callable[[Size], float], text: Callable[[float], str]) -> Measure:
    def figure(entry: Entry) -> Figure:
        if entry.size is None:
            return NOTHING
        value = pick(entry.size)
        return _cost(entry, Cell(text(value)), value)

    return Measure(Column(header, SIZE), figure, "low")


def _cost(entry: Entry, cell: Cell, value: float) -> Figure:
    return Figure(cell, None if entry.is_floor else value)


def _model(entry: Entry) -> str:
    return f"{entry.model} (floor)" if entry.is_floor else entry.model


def _dagger(entry: Entry) -> str:
    return "" if entry.own_timing else " †"


def _marked(figures: Sequence[Figure], better: Better | None) -> list[Cell]:
    """Return the cells, those that read like the best one marked; none where all read alike."""
    ranked = [one for one in figures if one.value is not None and math.isfinite(one.value)]
    if better is None or len({one.cell.text for one in ranked}) < 2:
        return [one.cell for one in figures]
    sign = 1 if better == "low" else -1
    best = min(ranked, key=lambda one: sign * (one.value or 0.0)).cell.text
    return [replace(one.cell, best=one in ranked and one.cell.text == best) for one in figures]
