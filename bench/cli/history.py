"""`bench history`: what changed between versions."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import click

from bench.cli.console import console, say
from bench.errors import BenchError

if TYPE_CHECKING:
    from reports.document import Cell, Document
    from reports.ranking.history import History


@click.command(epilog="Example: bench history results results-of-last-month")
@click.argument("folders", nargs=-1, type=click.Path(path_type=Path))
@click.option("--seed", type=click.IntRange(0), default=0, show_default=True, help="Seed.")
@click.option("--json", "as_json", is_flag=True, help="Print the history as JSON.")
def command(folders: tuple[Path, ...], seed: int, as_json: bool) -> None:
    """Say what changed between versions of code and packages in result FOLDERS (default: results).

    Errors (metres) are compared row by row between consecutive versions, with 95 % intervals over
    links, 5 % for all together. A latency (microseconds) is a regression where it lies outside what
    the earlier ones on that machine predict, their lingering noise taken into account.
    """
    from reports import ReportError
    from reports.ranking.history import history
    from reports.terminal import print_document

    try:
        found = history(folders or (Path("results"),), seed)
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    if as_json:
        say(json.dumps(_content(found), indent=1))
    else:
        print_document(_document(found), console())


def _content(found: History) -> dict[str, Any]:
    """Return the history as plain data."""
    return {
        "versions": list(found.versions),
        "changes": [
            {
                "before": one.before,
                "after": one.after,
                "run": one.difference.second.name,
                "simulated": one.difference.second.simulated,
                "rows": one.difference.rows,
                "difference_m": vars(one.difference.difference_m),
                "p_adjusted": one.difference.p,
                "verdict": one.verdict,
            }
            for one in found.changes
        ],
        "latencies": [{**vars(one), "verdict": one.verdict} for one in found.drifts],
        "refused": list(found.refused),
        "left_out": list(found.left_out),
    }


def _document(found: History) -> Document:
    from reports.document import Bullets, Column, Heading, Paragraph, Table, bounded

    document: Document = [Heading("History", 1), Bullets(found.versions)]
    if found.changes:
        columns = [Column(t, number=n) for t, n in _CHANGES]
        document.append(Table(tuple(columns), tuple(map(tuple, _changes(found)))))
    if found.drifts:
        columns = [Column(t, number=n) for t, n in _DRIFTS]
        document.append(Table(tuple(columns), tuple(map(tuple, _drifts(found)))))
    if found.refused:
        document += [Paragraph("Not compared:"), Bullets(found.refused)]
    if found.left_out:
        document += [Paragraph(f"Files left out: {len(found.left_out)}"), bounded(found.left_out)]
    return document


_CHANGES = (("Run", False), ("Rows", False), ("Change (m)", True), ("p", True), ("Verdict", False))
_DRIFTS = (("Run", False), ("Latency (us)", True), ("Expected (us)", True), ("Verdict", False))


def _changes(found: History) -> list[list[Cell]]:
    from reports.document import Cell

    rows = []
    for one in found.changes:
        gap = one.difference.difference_m
        ends = () if gap.low is None else (f"[{gap.low:+.4f}, {gap.high:+.4f}]",)
        name = one.difference.second.name + (
            " (SIMULATED)" if one.difference.second.simulated else ""
        )
        rows.append(
            [
                Cell(name, (f"{one.before} -> {one.after}",)),
                Cell(one.difference.rows),
                Cell(f"{gap.value:+.4f}", ends),
                Cell(f"{one.difference.p:.3f}"),
                Cell(one.verdict, best=one.verdict == "REGRESSION"),
            ]
        )
    return rows


def _drifts(found: History) -> list[list[Cell]]:
    from reports.document import Cell

    rows = []
    for one in found.drifts:
        known = one.expected_us
        text = f"{known[0]:.1f} to {known[1]:.1f}" if known else "-"
        rows.append(
            [
                Cell(one.name, (one.machine,)),
                Cell(f"{one.medians_us[-1]:.1f}"),
                Cell(text),
                Cell(one.verdict, best=one.verdict == "REGRESSION"),
            ]
        )
    return rows
