"""What a report consists of, before it is Markdown or terminal output. All texts are plain."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass


@dataclass(frozen=True)
class Heading:
    """A heading; level 1 is the title."""

    text: str
    level: int


@dataclass(frozen=True)
class Paragraph:
    """A paragraph of text."""

    text: str


@dataclass(frozen=True)
class Bullets:
    """A list of short facts."""

    items: tuple[str, ...]


@dataclass(frozen=True)
class Cell:
    """One figure: `text` (bold where it is the `best` of its column), below it the `details`."""

    text: str
    details: tuple[str, ...] = ()
    best: bool = False


@dataclass(frozen=True)
class Column:
    """A column. `group` says which columns stay together where the page is narrow ("" = keys)."""

    header: str
    group: str = ""
    number: bool = True


@dataclass(frozen=True)
class Table:
    """Rows of cells, one cell per column."""

    columns: tuple[Column, ...]
    rows: tuple[tuple[Cell, ...], ...]


@dataclass(frozen=True)
class Image:
    """A picture beside the report, by relative path."""

    path: str
    alt: str


@dataclass(frozen=True)
class Link:
    """A sentence that leads to another file, by relative path."""

    text: str
    path: str


def bounded(items: Sequence[str], most: int = 20) -> Bullets:
    """Return the first `most` items, and how many more there are: a page stays a page."""
    more = len(items) - most
    return Bullets((*items[:most], *((f"and {more} more",) if more > 0 else ())))


Block = Heading | Paragraph | Bullets | Table | Image | Link
Document = list[Block]
