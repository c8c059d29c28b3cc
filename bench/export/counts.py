"""Counts that stand in a REPORT.md already: of the same C they still hold."""

from __future__ import annotations

from collections.abc import Collection
from dataclasses import dataclass
from pathlib import Path

from bench.errors import BenchError
from bench.files import read_text

COUNTED = "| counted: emulated "
MOST_BYTES = 1_000_000


@dataclass(frozen=True)
class Counts:
    """Rows of a report's table, as they stand, and the parts they are of."""

    parts: tuple[str, ...] = ()
    lines: tuple[str, ...] = ()


def counted_before(report: Path, again: Collection[str]) -> Counts:
    """Return the counted rows of a report, but for the parts that are counted `again`."""
    try:
        text = read_text(report, MOST_BYTES)
    except BenchError:  # none, or no report
        return Counts()
    rows = [line for line in text.splitlines() if line.startswith("| ") and COUNTED in line]
    others = [(_part(line), line) for line in rows if _part(line) not in again]
    return Counts(
        tuple(dict.fromkeys(part for part, _ in others)), tuple(line for _, line in others)
    )


def _part(line: str) -> str:
    return line.removeprefix("| ").partition(":")[0]
