"""Every model against one of them in per cent of its MAE, on each data set and on all at once."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from reports.document import Block, Cell, Column, Heading, Paragraph, Table
from reports.numbers import UNKNOWN
from reports.ranking.compare import Side, same_rows
from reports.ranking.paired import RESAMPLES, Floats, Interval, Paired

Board = Sequence[Side]
KINDS = ("NLoS", "LoS")
TOGETHER = "all together"


@dataclass(frozen=True)
class Line:
    """A model's difference on each data set and kind of row by its label; None where unknown."""

    model: str
    found: Mapping[str, Interval | None]


def lines(boards: Sequence[Board], baseline: str, seed: int = 0) -> list[Line]:
    """Return every model but `baseline`, the best on all data sets' NLoS rows first.

    `boards` are the sides of one backend by data set; those without the baseline are left out.
    Nothing where fewer than two are left.
    """
    kept = [board for board in boards if _named(board, baseline)]
    if len(kept) < 2:
        return []
    names = dict.fromkeys(side.entry.model for board in kept for side in board)
    made = [_line(name, kept, baseline, seed) for name in names if name != baseline]
    return sorted(made, key=_rank)


def section(found: Sequence[Line], baseline: str) -> list[Block]:
    """Return `lines` as a table; nothing of none."""
    if not found:
        return []
    columns = [Column(f"{label} (%)", label) for label in found[0].found]
    return [
        Heading(f"Together, in per cent of {baseline}'s MAE", 2),
        Table((Column("Model", number=False), *columns), tuple(map(_cells, found))),
        Paragraph(
            f"MAE of the model minus that of {baseline} on the same rows, in per cent of the "
            "latter's, with its 95 % interval over links. Together: the mean of the data sets', "
            "each counting alike; links are drawn anew within each (percentile bootstrap). "
            "No figure where a model was not run on all of them."
        ),
    ]


def relative(pairs: Sequence[Paired], seed: int = 0) -> Interval:
    """Return the mean over data sets of (first - second) / second, with its 95 % interval.

    Each pair holds two models on one data set's links; its sums are in metres, the result is a
    share. No interval where a data set has fewer than two links.
    """
    rng = np.random.default_rng(seed)
    value = float(np.mean([_share(one, np.ones(one.links)) for one in pairs]))
    if min(one.links for one in pairs) < 2:
        return Interval(value)
    drawn = [_share(one, _draws(one.links, rng)) for one in pairs]
    low, high = np.percentile(np.mean(drawn, axis=0), (2.5, 97.5)).tolist()
    return Interval(value, low, high)


def _draws(links: int, rng: np.random.Generator) -> Floats:
    """Return how often each link is drawn [resamples, links]."""
    return rng.multinomial(links, np.full(links, 1 / links), RESAMPLES).astype(np.float64)


def _share(pair: Paired, times: Floats) -> Floats:
    """Return (first - second) / second for links taken so many times [.., links] -> [..]."""
    first, second = (times @ sums for sums in pair.sums_m)
    return np.asarray((first - second) / second)


def _groups(boards: Sequence[Board]) -> list[tuple[str, list[Board]]]:
    """Return each data set by its name, then the real ones together, then all."""
    real = [board for board in boards if not board[0].simulated]
    groups = [(_label(board[0]), [board]) for board in boards]
    if 1 < len(real) < len(boards):
        groups.append(("real together", real))
    return [*groups, (TOGETHER, list(boards))]


def _label(side: Side) -> str:
    return f"{side.data} (SIMULATED)" if side.simulated else side.data


def _line(name: str, boards: Sequence[Board], baseline: str, seed: int) -> Line:
    found = {
        f"{label}, {kind}": _found(name, group, baseline, kind, seed)
        for label, group in _groups(boards)
        for kind in KINDS
    }
    return Line(name, found)


def _rank(line: Line) -> float:
    known = line.found[f"{TOGETHER}, {KINDS[0]}"]
    return float("inf") if known is None else known.value


def _cells(line: Line) -> tuple[Cell, ...]:
    return (Cell(line.model), *map(_cell, line.found.values()))


def _found(
    name: str, boards: Sequence[Board], baseline: str, kind: str, seed: int
) -> Interval | None:
    pairs = [_pair(name, board, baseline, kind == "LoS") for board in boards]
    known = [pair for pair in pairs if pair is not None]
    return relative(known, seed) if len(known) == len(boards) else None


def _pair(name: str, board: Board, baseline: str, los: bool) -> Paired | None:
    one, other = _named(board, name), _named(board, baseline)
    if one is None or other is None:
        return None
    try:
        return same_rows(one, other, los)
    except (OSError, ValueError):
        return None


def _named(board: Board, name: str) -> Side | None:
    return next((side for side in board if side.entry.model == name), None)


def _cell(found: Interval | None) -> Cell:
    if found is None:
        return Cell(UNKNOWN)
    text = f"{100 * found.value:+.1f}"
    if found.low is None or found.high is None:
        return Cell(text)
    ends = f"[{100 * found.low:+.1f}, {100 * found.high:+.1f}]"
    return Cell(text, (ends,), best=found.high < 0)
