"""From names to results: benchmark runs, diagnoses and simulations as single calls."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.runner.api import RunSet as RunSet
    from bench.runner.api import run as run
    from bench.runner.diagnosis import diagnose as diagnose
    from bench.runner.observer import Observer as Observer
    from bench.runner.simulation import Simulation as Simulation
    from bench.runner.simulation import simulate as simulate

_HOMES = {
    "Observer": "bench.runner.observer",
    "RunSet": "bench.runner.api",
    "Simulation": "bench.runner.simulation",
    "diagnose": "bench.runner.diagnosis",
    "run": "bench.runner.api",
    "simulate": "bench.runner.simulation",
}
__all__ = list(_HOMES)
__getattr__ = lazily(__name__, _HOMES)
