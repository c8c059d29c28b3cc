"""Every model against one of them, data set by data set: paired differences over links."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from reports.document import Block, Bullets, Cell, Column, Document, Heading, Paragraph, Table
from reports.errors import ReportError
from reports.load import Results
from reports.numbers import UNKNOWN, count, metres, seed_details
from reports.ranking.compare import Difference, Side, compared_sides, sides_of
from reports.seeds import Accuracy
from reports.together import Line as Shares
from reports.together import lines, section

KINDS = ("NLoS", "LoS")
LEGEND = (
    "MAE: mean |error| that remains, with its 95 % interval over links. Difference: MAE of the "
    "model minus that of the one compared with, on the same rows, with its 95 % interval over "
    "links (not adjusted for the number of models); negative is better."
)


@dataclass(frozen=True)
class Line:
    """One model of a data set, and its differences on NLoS and LoS rows, where there are such."""

    side: Side
    differences: tuple[Difference | None, ...]


def against(results: Results, baseline: str, backend: str, seed: int = 0) -> Document:
    """Return tables of every model of a backend against `baseline`: per data set, then together.

    Raises ReportError where the baseline was run on none of them.
    """
    document: Document = [Heading(f"Every model against {baseline}, {backend}", 1)]
    boards = _boards(sides_of(results), backend)
    for sides in boards:
        base = next((side for side in sides if side.entry.model == baseline), None)
        if base is not None:
            document += _section(base, [_line(side, base, seed) for side in sides])
    if len(document) == 1:
        raise ReportError(f"{baseline} was run on no data set with backend {backend}")
    found = lines(boards, baseline, seed)
    return [*document, Paragraph(LEGEND), *section(found, baseline)]


def shares(results: Results, baseline: str, backend: str, seed: int = 0) -> list[Shares]:
    """Return every model's differences in shares of the baseline's MAE; see `reports.together`."""
    return lines(_boards(sides_of(results), backend), baseline, seed)


def _boards(sides: Sequence[Side], backend: str) -> list[list[Side]]:
    """Return the sides of one backend by data set and split, best first."""
    found: dict[tuple[str, str], list[Side]] = {}
    for side in sides:
        if side.entry.backend == backend:
            found.setdefault((side.data, side.split), []).append(side)
    return list(found.values())


def _line(side: Side, base: Side, seed: int) -> Line:
    made = [compared_sides(base, side, kind, seed) for kind in KINDS]
    return Line(side, tuple(one if isinstance(one, Difference) else None for one in made))


def _section(base: Side, lines: Sequence[Line]) -> list[Block]:
    kind = " (SIMULATED)" if base.simulated else ""
    columns = [Column("Model", number=False)]
    for rows in KINDS:
        columns += [Column(f"{rows} MAE (m)", rows), Column(f"minus {base.entry.model} (m)", rows)]
    columns.append(Column("Parameters", "size"))
    return [
        Heading(f"{base.data}{kind}, split {base.split}", 2),
        Table(tuple(columns), tuple(_cells(line, base) for line in lines)),
        Bullets(tuple(_verdicts(base, lines))),
    ]


def _cells(line: Line, base: Side) -> tuple[Cell, ...]:
    entry = line.side.entry
    cells = [Cell(f"{entry.model} (floor)" if entry.is_floor else entry.model)]
    for score, gap in zip((entry.nlos, entry.los), line.differences, strict=True):
        cells += [_mae(score), Cell("") if line.side is base else _gap(gap)]
    size = entry.size.parameters if entry.size else None
    return (*cells, Cell(UNKNOWN if size is None else count(size)))


def _mae(score: Accuracy | None) -> Cell:
    if score is None:
        return Cell(UNKNOWN)
    return Cell(metres(score.mae_m.value), seed_details(score.mae_m, 4))


def _gap(gap: Difference | None) -> Cell:
    if gap is None:
        return Cell(UNKNOWN)
    found = gap.difference_m
    if found.low is None or found.high is None:
        return Cell(f"{found.value:+.4f}")
    text, ends = f"{found.value:+.4f}", f"[{found.low:+.4f}, {found.high:+.4f}]"
    return Cell(text, (ends,), best=found.high < 0)


def _verdicts(base: Side, lines: Sequence[Line]) -> list[str]:
    """Return, in words, who is at least as good as the baseline on all kinds of rows."""
    others = [line for line in lines if line.side is not base]
    level = [line.side.entry.model for line in others if _at_least_as_good(line)]
    beyond = [line.side.entry.model for line in others if _worse_beyond_noise(line)]
    name = base.entry.model
    return [
        f"At least as good as {name} on every kind of row (the figures as they stand): "
        f"{', '.join(level) or 'no model'}.",
        f"Worse than {name} beyond noise on some kind of row: {', '.join(beyond) or 'no model'}.",
    ]


def _known(line: Line) -> list[Difference]:
    return [one for one in line.differences if one is not None]


def _at_least_as_good(line: Line) -> bool:
    known = _known(line)
    return bool(known) and all(one.difference_m.value <= 0 for one in known)


def _worse_beyond_noise(line: Line) -> bool:
    return any((one.difference_m.low or 0.0) > 0 for one in _known(line))
