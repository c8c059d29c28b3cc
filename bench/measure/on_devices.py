"""Estimates of one artifact on devices, made whenever a result is shown: profiles change."""

from __future__ import annotations

from collections.abc import Iterable

from bench.errors import BenchError, foreign
from bench.measure.estimate import NetworkCost, estimate
from bench.measure.profile import Profile
from bench.plugins import Plugin
from bench.results import Estimate
from bench.text import one_line


def load_device(plugin: Plugin) -> Profile:
    """Return a device's profile. Raises BenchError where it cannot be had or is none."""
    profile = plugin.load()
    if not isinstance(profile, Profile):
        kind = type(profile).__name__
        raise BenchError(
            f"device {plugin.name!r} is unavailable: a Profile was expected, not {kind}"
        )
    return profile


def estimates_of(
    cost: NetworkCost | None, precision: str | None, devices: Iterable[Plugin]
) -> list[Estimate]:
    """Return an ESTIMATE of latency (us) and energy (mJ) per device, or why there is none.

    Nothing for an artifact whose cost is not known (a skipped run).
    """
    if cost is None or precision is None:
        return []
    return [_one(cost, precision, plugin) for plugin in devices]


def _one(cost: NetworkCost, precision: str, plugin: Plugin) -> Estimate:
    try:
        with foreign(f"device {plugin.name!r}"):
            found = estimate(load_device(plugin), cost, precision)
    except BenchError as problem:
        return Estimate(plugin.name, None, None, one_line(str(problem)))
    return Estimate(plugin.name, found.latency_us, found.energy_mj, found.reason)
