"""The table of `bench count` as Markdown, in a file of its own or between the marks of a page."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from bench.cli.count_view import lines
from bench.files import is_regular, read_text, write_atomically
from bench.measure.counting.measured import Measured
from bench.runner.count_models import CountRow

START, END = "<!-- bench count -->", "<!-- end of bench count -->"
COLUMNS = (
    *("device", "model", "backend", "how", "cycles (M)", "latency (ms)", "energy (mJ)"),
    *("flash (KB)", "RAM (KB)", "outputs equal"),
)


def markdown_table(rows: Sequence[CountRow], board: Measured | None) -> str:
    """Return the table with what it was made of; rows that were not counted have their reason."""
    checked = {(row.device, row.model, row.backend): _equal(row) for row in rows}
    table = [(*line, checked[line[0], line[1], line[2]]) for line in lines(rows, board)]
    written = [COLUMNS, ("---",) * 4 + ("---:",) * 6, *table]
    said = [f"| {' | '.join(cell.replace('|', '/') for cell in line)} |" for line in written]
    return "\n".join([_made_of(rows), "", *said]) + "\n"


def write_markdown(path: Path, table: str) -> None:
    """Write the table between the marks where the file has them, else as the whole file.

    Raises BenchError where the file cannot be read or written.
    """
    page = read_text(path) if is_regular(path) else ""
    before, start, rest = page.partition(START)
    _, end, after = rest.partition(END)
    text = f"{before}{start}\n{table}{end}{after}" if start and end else table
    write_atomically(path, text)


def _made_of(rows: Sequence[CountRow]) -> str:
    """Return what rows and which compilers the counts are of."""
    counts = [row.counted.count for row in rows if row.counted is not None]
    numbers = sorted({count.rows for count in counts})
    by_compiler: dict[str, set[str]] = {}
    for count in counts:
        by_compiler.setdefault(count.compiler, set()).add(count.core)
    made = "; ".join(f"{name} for {', '.join(sorted(of))}" for name, of in by_compiler.items())
    many = " or ".join(map(str, numbers)) or "no"
    return f"Counted: {many} rows of {rows[0].data} each. {made or 'Nothing was compiled'}."


def _equal(row: CountRow) -> str:
    """Return how many outputs were this machine's, and how far off the others are at most."""
    if row.counted is None:
        return ""
    check = row.counted.agreement
    off = f", {check.largest_m * 1000:.2g} mm off" if check.equal < check.rows else ""
    return f"{check.equal} of {check.rows}{off}"
