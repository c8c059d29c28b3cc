"""Figures for devices that are not here, made when a result is shown."""

from __future__ import annotations

from dataclasses import asdict
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reports.load import Estimate, Estimator, Run


def estimator() -> Estimator:
    """Return what estimates a run's latency and energy on every device there is, as of now."""
    from msgspec import convert

    from bench.measure.on_devices import estimates_of
    from bench.runner.plan import resolve
    from reports.load import Estimate

    devices = resolve("devices", "all")

    def estimated(run: Run) -> list[Estimate]:
        found = estimates_of(run.cost, run.precision, devices)
        return [convert(asdict(one), Estimate) for one in found]

    return estimated
