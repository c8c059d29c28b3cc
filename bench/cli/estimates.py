"""Figures for devices that are not here, made when a result is shown."""

from __future__ import annotations

from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from reports.load import Estimate, Estimator, Run


def estimator(folder: Path) -> Estimator:
    """Return what gives a run's latency and energy on every device there is, as of now.

    Counted where the result folder holds the count of its artifact, else estimated.
    """
    from msgspec import convert

    from bench.runner.count_runs import devices_of
    from bench.runner.folder import ResultFolder
    from bench.runner.plan import resolve
    from reports.load import Estimate

    devices, results = resolve("devices", "all"), ResultFolder(folder)

    def estimated(run: Run) -> list[Estimate]:
        found = devices_of(run, devices, results)
        return [convert(asdict(one), Estimate) for one in found]

    return estimated
