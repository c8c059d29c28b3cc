"""What every real case returns."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import pandas as pd

from bench.discrepancy.diagnosis import Diagnosis

Progress = Callable[[str], None]


@dataclass(frozen=True)
class Check:
    """One bar: what is asked, what was measured, whether it is met."""

    asked: str
    measured: str
    met: bool


@dataclass(frozen=True)
class RealCase:
    """A real case: its diagnosis, its checks, and tables for the report (Markdown lines)."""

    title: str
    diagnosis: Diagnosis
    checks: tuple[Check, ...]
    lines: tuple[str, ...]


def first_named(found: Diagnosis) -> str:
    """Return the names of the first verdict, or its kind."""
    first = found.selection.verdicts[0]
    return " or ".join(first.names) or type(first).__name__


def every_named(found: Diagnosis) -> str:
    """Return the names of all verdicts, "nothing" without one."""
    return "; ".join(" or ".join(names) for names in found.selection.names if names) or "nothing"


def names_it(found: Diagnosis, name: str) -> bool:
    """Return whether an effect is named, alone or as one of a class."""
    return any(name in names for names in found.selection.names)


def markdown_table(frame: pd.DataFrame) -> list[str]:
    """Return a frame as a Markdown table, numbers with four digits."""
    head = ["| " + " | ".join(map(str, frame.columns)) + " |", "|" + " --- |" * frame.shape[1]]
    body = [
        "| " + " | ".join(f"{v:.4g}" if isinstance(v, float) else str(v) for v in row) + " |"
        for row in frame.itertuples(index=False)
    ]
    return [*head, *body]
