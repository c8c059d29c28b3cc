"""Where our figures are worse than the paper's, said first: nobody should have to look for it."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from reports.reproduction.load import Figured, OutcomeFile, RowFile

LOWER_IS_BETTER = ("MAE", "σ", "error")
HIGHER_IS_BETTER = ("R²",)


def worse(outcomes: Sequence[OutcomeFile]) -> list[str]:
    """Return a line for every figure of a method that is worse than the paper's."""
    return [line for outcome in outcomes for line in _lines(outcome)]


def _lines(outcome: OutcomeFile) -> Iterator[str]:
    for table in outcome.tables:
        for row in table.rows:
            if row.paper is not None and (gap := _worse_by(row)) is not None and gap > 0:
                yield f"{outcome.experiment}: {', '.join(row.label)}, {_said(row, table.digits)}"


def _worse_by(row: RowFile) -> float | None:
    """Return by how much ours is worse (negative: better), None where that has no meaning."""
    ours = row.ours.value if isinstance(row.ours, Figured) else row.ours
    words = {word for part in (*row.label, row.quantity) for word in part.split()}
    if row.paper is None or row.of_data or not isinstance(ours, int | float):
        return None
    if words & set(LOWER_IS_BETTER):
        return ours - row.paper
    return row.paper - ours if words & set(HIGHER_IS_BETTER) else None


def _said(row: RowFile, digits: int) -> str:
    """Return the figures in words, with whether the paper's lies inside our interval."""
    assert row.paper is not None
    unit = f" {row.unit}" if row.unit else ""
    ours = row.ours.value if isinstance(row.ours, Figured) else row.ours
    text = f"{row.quantity}: {ours:.{digits}f}{unit}, the paper {row.paper:.{digits}f}{unit}"
    if not isinstance(row.ours, Figured) or row.ours.low is None or row.ours.high is None:
        return text
    within = row.ours.low <= row.paper <= row.ours.high
    return text + (" (inside our interval)" if within else " (outside our interval)")
