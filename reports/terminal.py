"""Documents in a terminal: wide tables are cut into their column groups."""

from __future__ import annotations

from collections.abc import Iterator
from functools import singledispatch

from rich.box import SIMPLE_HEAD
from rich.console import Console, RenderableType
from rich.padding import Padding
from rich.table import Table as RichTable
from rich.text import Text

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


def print_document(document: Document, console: Console) -> None:
    """Print every block, a blank line between them."""
    for block in document:
        for part in parts(block):
            console.print(Padding(part, (0, 0, 1, 0)))


@singledispatch
def parts(block: Block) -> Iterator[RenderableType]:
    """Yield what rich prints for one block."""
    raise TypeError(f"no terminal output for {type(block).__name__}")


@parts.register
def _(block: Heading) -> Iterator[RenderableType]:
    yield Text(block.text, style="bold underline" if block.level == 1 else "bold")


@parts.register
def _(block: Paragraph) -> Iterator[RenderableType]:
    yield Text(block.text)


@parts.register
def _(block: Bullets) -> Iterator[RenderableType]:
    yield Text("\n".join(f"- {item}" for item in block.items))


@parts.register
def _(block: Image) -> Iterator[RenderableType]:
    yield Text(f"{block.alt}: {block.path}")


@parts.register
def _(block: Table) -> Iterator[RenderableType]:
    groups = list(dict.fromkeys(column.group for column in block.columns if column.group))
    for group in groups or [""]:
        chosen = [i for i, c in enumerate(block.columns) if c.group in ("", group)]
        yield _rich_table(block, chosen)


def _rich_table(block: Table, chosen: list[int]) -> RichTable:
    table = RichTable(box=SIMPLE_HEAD, padding=(0, 1, 0, 0))
    for index in chosen:
        _add_column(table, block.columns[index])
    for row in block.rows:
        table.add_row(*(_text(row[index]) for index in chosen))
    return table


def _add_column(table: RichTable, column: Column) -> None:
    table.add_column(column.header, justify="right" if column.number else "left", overflow="fold")


def _text(cell: Cell) -> Text:
    text = Text()
    text.append(cell.text, style="bold green" if cell.best else "")
    for detail in cell.details:
        text.append(f"\n{detail}", style="dim")
    return text
