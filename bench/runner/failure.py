"""A run that broke."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Failure:
    """A run that broke: it is reported and never cached."""

    model: str
    backend: str
    seed: int
    reason: str

    def __str__(self) -> str:
        return f"{self.model} on {self.backend} failed: {self.reason}"
