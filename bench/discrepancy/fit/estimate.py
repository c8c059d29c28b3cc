"""A fitted value with its interval."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ParameterEstimate:
    """A fitted parameter with its 90 % interval, and whether it stopped at a physical bound."""

    name: str
    value: float
    low: float
    high: float
    unit: str
    at_bound: bool = False

    def __str__(self) -> str:
        edge = " (at its physical bound)" if self.at_bound else ""
        return f"{self.name} = {self.value:.4g} [{self.low:.4g}, {self.high:.4g}] {self.unit}{edge}"
