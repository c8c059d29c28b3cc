"""Outcomes -> documents: ours with its interval, the paper's figure, the difference."""

from __future__ import annotations

from collections.abc import Sequence

from reports.document import (
    Block,
    Bullets,
    Cell,
    Column,
    Document,
    Heading,
    Image,
    Paragraph,
    Table,
)
from reports.numbers import UNKNOWN
from reports.reproduction.load import Figured, FigureFile, OutcomeFile, RowFile, TableFile, Value
from reports.reproduction.worse import worse

FIGURES = "figures"
_KEY = (
    "Ours: [low, high] is the 95 % interval. diff. = ours - the paper's figure, which is "
    "quoted as printed."
)


def outcome_page(outcome: OutcomeFile, pictured: bool = True) -> Document:
    """Return the page of one experiment; its pictures are left out on request."""
    return [Heading(outcome.title, 1), *_body(outcome, pictured, level=2)]


def index_page(
    outcomes: Sequence[OutcomeFile], impossible: Sequence[tuple[str, str]] = ()
) -> Document:
    """Return one page with every experiment and picture, and what these recordings do not allow."""
    start: list[Block] = [Heading("Reproduction of the paper", 1), Paragraph(_KEY)]
    return [*start, *_sections(outcomes, ".svg"), *_not_possible(impossible)]


def full_page(
    outcomes: Sequence[OutcomeFile],
    impossible: Sequence[tuple[str, str]],
    facts: Sequence[str],
    figures: str,
) -> Document:
    """Return a page that stands alone: what it rests on, where we are worse, every experiment.

    `facts`: lines on how it was made; `figures`: the pictures' folder relative to the page (PNG).
    """
    data = ", ".join(dict.fromkeys(standing(one) for one in outcomes))
    blocks: Document = [
        Heading("Reproduction of the paper", 1),
        Paragraph(f"Recordings: {data}. {_KEY}"),
        Bullets((*facts, _times(outcomes), *_machines(outcomes))),
    ]
    if lines := worse(outcomes):
        blocks += [Heading("Where we do worse than the paper", 2), Bullets(tuple(lines))]
    return [*blocks, *_sections(outcomes, ".png", figures), *_not_possible(impossible)]


def picture_path(outcome: OutcomeFile, figure: str, suffix: str, folder: str = FIGURES) -> str:
    """Return a picture's path relative to the page."""
    return f"{folder}/{outcome.experiment}-{figure}{suffix}"


def standing(outcome: OutcomeFile) -> str:
    """Return the data's name with all that a reader must not miss."""
    marks = ["SIMULATED"] * outcome.simulated + ["QUICK"] * outcome.quick
    return f"{outcome.data} ({', '.join(marks)})" if marks else outcome.data


def shown(outcome: OutcomeFile, figure: FigureFile) -> str:
    """Return what a picture shows: the outcome's recordings, unless it says otherwise."""
    if not figure.data:
        return standing(outcome)
    return f"{figure.data} (QUICK)" if outcome.quick else figure.data


def _sections(outcomes: Sequence[OutcomeFile], suffix: str, figures: str = FIGURES) -> list[Block]:
    blocks: list[Block] = []
    for outcome in outcomes:
        blocks.append(Heading(outcome.title, 2))
        blocks += _body(outcome, pictured=True, level=3, suffix=suffix, figures=figures)
    return blocks


def _not_possible(impossible: Sequence[tuple[str, str]]) -> list[Block]:
    if not impossible:
        return []
    lines = tuple(f"{name}: {reason}" for name, reason in impossible)
    return [Heading("Not possible on these recordings", 2), Bullets(lines)]


def _times(outcomes: Sequence[OutcomeFile]) -> str:
    """Return how long every experiment took, and all of them."""
    each = ", ".join(f"{one.experiment} {one.trained_s:,.0f}" for one in outcomes)
    total_s = sum(one.trained_s for one in outcomes)
    return (
        f"Measured time: {total_s:,.0f} s ({total_s / 60:.0f} min) in all; in seconds: {each}. "
        "Each experiment's is of the making that trained what it was first to need."
    )


def _machines(outcomes: Sequence[OutcomeFile]) -> list[str]:
    return list(dict.fromkeys(f"Machine: {_machine(one)}." for one in outcomes))


def _machine(outcome: OutcomeFile) -> str:
    host = outcome.host
    return f"{host.get('cpu')} ({host.get('cores')} cores)"


def _body(
    outcome: OutcomeFile,
    pictured: bool,
    level: int,
    suffix: str = ".svg",
    figures: str = FIGURES,
) -> list[Block]:
    blocks: list[Block] = [Paragraph(f"Recordings: {standing(outcome)}.")]
    blocks.append(Paragraph(outcome.protocol))
    for table in outcome.tables:
        blocks += [Heading(table.title, level), *_table(table)]
    for figure in outcome.figures if pictured else ():
        alt = f"{figure.title}, {shown(outcome, figure)}"
        blocks.append(Image(picture_path(outcome, figure.name, suffix, figures), alt))
    blocks.append(Bullets((*outcome.notes, _made(outcome))))
    return blocks


def _made(outcome: OutcomeFile) -> str:
    return (
        f"Made {outcome.created_utc} in {outcome.elapsed_s:.0f} s on {_machine(outcome)}; earlier "
        "runs that were reused are not in that time. "
        f"Recordings' fingerprint: {outcome.data_fingerprint}."
    )


def _table(table: TableFile) -> list[Block]:
    """Return the table, a line each for ours, the paper's and the difference, and its notes."""
    quantities = list(dict.fromkeys((row.quantity, row.unit) for row in table.rows))
    labels = list(dict.fromkeys(row.label for row in table.rows))
    found = {(row.label, row.quantity): row for row in table.rows}
    whose = any(row.paper is not None for row in table.rows)
    keys = [*table.labels, *([""] if whose else [])]
    columns = [Column(name, number=False) for name in keys]
    columns += [Column(_header(*quantity), group="figures") for quantity in quantities]
    lines = []
    for label in labels:
        rows = [found.get((label, quantity)) for quantity, _ in quantities]
        lines += _lines(label, rows, table.digits, whose)
    notes = [f"{', '.join(r.label)}, {r.quantity}: {r.note}" for r in table.rows if r.note]
    blocks: list[Block] = [Table(tuple(columns), tuple(lines))]
    if remarks := (*table.notes, *notes):
        blocks.append(Bullets(remarks))
    return blocks


def _header(quantity: str, unit: str) -> str:
    return f"{quantity} ({unit})" if unit else quantity


def _lines(
    label: tuple[str, ...], rows: Sequence[RowFile | None], digits: int, whose: bool
) -> list[tuple[Cell, ...]]:
    keys = tuple(map(Cell, label))
    ours = tuple(_ours(row.ours if row else None, _digits(row, digits)) for row in rows)
    if not whose:
        return [(*keys, *ours)]
    lines = [(*keys, Cell("ours"), *ours)]
    if any(row and row.paper is not None for row in rows):
        blank = tuple(Cell("") for _ in keys)
        lines.append((*blank, Cell("paper"), *(_paper(row, _digits(row, digits)) for row in rows)))
        lines.append(
            (*blank, Cell("diff."), *(_difference(row, _digits(row, digits)) for row in rows))
        )
    return lines


def _digits(row: RowFile | None, usual: int) -> int:
    return usual if row is None or row.digits is None else row.digits


def _ours(value: Value, digits: int) -> Cell:
    if isinstance(value, Figured):
        low, high = _text(value.low, digits), _text(value.high, digits)
        known = value.low is not None and value.high is not None
        return Cell(_text(value.value, digits), (f"[{low}, {high}]",) if known else ())
    if value is None or isinstance(value, str):
        return Cell(value or UNKNOWN)
    return Cell(_text(value, digits))


def _paper(row: RowFile | None, digits: int) -> Cell:
    if row is None or row.paper is None:
        return Cell(UNKNOWN)
    return Cell(_whole(row.paper) if isinstance(row.ours, int) else _text(row.paper, digits))


def _difference(row: RowFile | None, digits: int) -> Cell:
    if row is None or row.paper is None:
        return Cell(UNKNOWN)
    ours = row.ours.value if isinstance(row.ours, Figured) else row.ours
    if ours is None or isinstance(ours, str):
        return Cell(UNKNOWN)
    gap = ours - row.paper
    return Cell(f"{gap:+,.0f}" if isinstance(ours, int) else f"{gap:+.{digits}f}")


def _text(value: float | None, digits: int) -> str:
    if value is None:
        return "n/a"
    if isinstance(value, int):
        return _whole(value)
    return f"{value:,.{digits}f}"


def _whole(value: float) -> str:
    return f"{value:,.0f}"
