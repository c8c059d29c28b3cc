"""Documents in a terminal: wide tables are cut into their column groups."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from functools import singledispatch
from typing import Literal

from rich.box import SIMPLE_HEAD
from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text

from reports.document import (
    Block,
    Bullets,
    Cell,
    Document,
    Heading,
    Image,
    Link,
    Paragraph,
    Table,
)

GAP = 2  # characters between two columns
WIDEST_TEXT = 24  # characters of a name before it is folded


def print_document(document: Document, console: Console) -> None:
    """Print every block, a blank line between them; no figure is ever cut or broken."""
    for block in document:
        for part in parts(block, console.width):
            console.print(Padding(part, (0, 0, 1, 0)))


@singledispatch
def parts(block: Block, _width: int = 80) -> Iterator[RenderableType]:
    """Yield what rich prints for one block in so many characters."""
    raise TypeError(f"no terminal output for {type(block).__name__}")


@parts.register
def _(block: Heading, _width: int = 80) -> Iterator[RenderableType]:
    yield Text(block.text, style="bold underline" if block.level == 1 else "bold")


@parts.register
def _(block: Paragraph, _width: int = 80) -> Iterator[RenderableType]:
    yield Text(block.text)


@parts.register
def _(block: Bullets, _width: int = 80) -> Iterator[RenderableType]:
    yield Text("\n".join(f"- {item}" for item in block.items))


@parts.register
def _(block: Image, _width: int = 80) -> Iterator[RenderableType]:
    yield Text(f"{block.alt}: {block.path}")


@parts.register
def _(block: Link, _width: int = 80) -> Iterator[RenderableType]:
    yield Text(f"{block.text}: {block.path}")


@parts.register
def _(block: Table, width: int = 80) -> Iterator[RenderableType]:
    keys = [i for i, column in enumerate(block.columns) if not column.group]
    groups = list(dict.fromkeys(column.group for column in block.columns if column.group))
    if not groups:
        yield from (
            _rich_table(block, chosen) for chosen in _packed(block, keys[:1], keys[1:], width)
        )
    for group in groups:
        others = [i for i, column in enumerate(block.columns) if column.group == group]
        yield from (_rich_table(block, chosen) for chosen in _packed(block, keys, others, width))


def _packed(
    block: Table, keys: Sequence[int], others: Sequence[int], width: int
) -> Iterator[list[int]]:
    """Yield columns that fit side by side, the keys before each lot."""
    taken: list[int] = []
    for index in others:
        if taken and _total(block, [*keys, *taken, index]) > width:
            yield [*keys, *taken]
            taken = []
        taken.append(index)
    yield [*keys, *taken]


def _total(block: Table, chosen: Sequence[int]) -> int:
    return sum(_natural(block, index) + GAP for index in chosen)


def _natural(block: Table, index: int) -> int:
    """Return the width a column needs: its longest figure, or the longest word of its header.

    Text may be folded, figures never are.
    """
    cells = [row[index] for row in block.rows]
    lines = [line for cell in cells for line in (cell.text, *cell.details)]
    width = max(map(len, [*lines, *block.columns[index].header.split()]), default=0)
    return width if block.columns[index].number else min(width, WIDEST_TEXT)


def _rich_table(block: Table, chosen: Sequence[int]) -> RichTable:
    table = RichTable(box=SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    for index in chosen:
        _add_column(table, block, index)
    for row in block.rows:
        table.add_row(*(_text(row[index]) for index in chosen))
    return table


def _add_column(table: RichTable, block: Table, index: int) -> None:
    column = block.columns[index]
    justify: Literal["right", "left"] = "right" if column.number else "left"
    table.add_column(
        column.header, justify=justify, overflow="fold", min_width=_natural(block, index)
    )


def _text(cell: Cell) -> Text:
    text = Text()
    text.append(cell.text, style="bold green" if cell.best else "")
    for detail in cell.details:
        text.append(f"\n{detail}", style="dim")
    return text
