"""A run that broke."""

from __future__ import annotations

from dataclasses import dataclass

from bench.errors import BenchError
from bench.text import one_line, reason


@dataclass(frozen=True)
class Failure:
    """A run that broke: it is reported and never cached."""

    model: str
    backend: str
    seed: int
    reason: str

    def __str__(self) -> str:
        return f"{self.model} on {self.backend} failed: {self.reason}"


def said(problem: BaseException) -> str:
    """Return what a failure says in one line; our own errors without their type."""
    return one_line(str(problem)) if isinstance(problem, BenchError) else reason(problem)


class DeclinedError(BenchError):
    """A backend found, while building, that it does not take the model: the pair is skipped."""
