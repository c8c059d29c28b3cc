"""Documents as GitHub-flavoured Markdown. Names from files are escaped, never interpreted."""

from __future__ import annotations

import re
from functools import singledispatch
from urllib.parse import quote

from reports.document import (
    Block,
    Bullets,
    Cell,
    Column,
    Document,
    Heading,
    Image,
    Link,
    Paragraph,
    Table,
)
from reports.plain import plain

_SPECIAL = re.compile(r"[\\`*|]|(?<!\w)_|_(?!\w)|~~|\](?=[(\[])|^(?:#+|[-+>])(?=\s)")


def to_markdown(document: Document) -> str:
    """Return the document as Markdown text, ending in a newline."""
    return "\n\n".join(render(block) for block in document) + "\n"


def escape(text: str) -> str:
    """Return text that Markdown shows as it is, on one line."""
    line = " ".join(plain(text).split()).replace("&", "&amp;").replace("<", "&lt;")
    return _SPECIAL.sub(lambda match: "\\" + match.group(), line)


@singledispatch
def render(block: Block) -> str:
    """Return one block as Markdown."""
    raise TypeError(f"no Markdown for {type(block).__name__}")


@render.register
def _(block: Heading) -> str:
    return f"{'#' * block.level} {escape(block.text)}"


@render.register
def _(block: Paragraph) -> str:
    return escape(block.text)


@render.register
def _(block: Bullets) -> str:
    return "\n".join(f"- {escape(item)}" for item in block.items)


@render.register
def _(block: Image) -> str:
    return f"![{escape(block.alt)}]({quote(block.path)})"


@render.register
def _(block: Link) -> str:
    return f"[{escape(block.text)}]({quote(block.path)})"


@render.register
def _(block: Table) -> str:
    lines = [
        _line([escape(column.header) for column in block.columns]),
        _line([_rule(column) for column in block.columns]),
        *(_line([_cell(cell) for cell in row]) for row in block.rows),
    ]
    return "\n".join(lines)


def _line(cells: list[str]) -> str:
    return f"| {' | '.join(cells)} |"


def _rule(column: Column) -> str:
    return "---:" if column.number else "---"


def _cell(cell: Cell) -> str:
    text = f"**{escape(cell.text)}**" if cell.best else escape(cell.text)
    # A second line inside a cell: Markdown tables know no other way.
    return f"{text}<br>{escape(' '.join(cell.details))}" if cell.details else text
