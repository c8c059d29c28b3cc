"""The measuring side: accuracy, latency, memory, energy, and estimates for other devices."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.measure.energy import host_meter as host_meter
    from bench.measure.latency import Timing as Timing
    from bench.measure.latency import TimingTarget as TimingTarget
    from bench.measure.latency import measure as measure
    from bench.measure.machine import describe_machine as describe_machine
    from bench.measure.metrics import score as score
    from bench.measure.profile import Profile as Profile
    from bench.measure.profile import load_profile as load_profile

_HOMES = {
    "Profile": "bench.measure.profile",
    "Timing": "bench.measure.latency",
    "TimingTarget": "bench.measure.latency",
    "describe_machine": "bench.measure.machine",
    "host_meter": "bench.measure.energy",
    "load_profile": "bench.measure.profile",
    "measure": "bench.measure.latency",
    "score": "bench.measure.metrics",
}
__all__ = list(_HOMES)
__getattr__ = lazily(__name__, _HOMES)
