"""What is to be run: names resolved before anything is computed or written."""

from __future__ import annotations

from dataclasses import dataclass

from bench.errors import BenchError
from bench.plugins import Group, Plugin, find, plugins

MOST_SEEDS = 10_000


@dataclass(frozen=True)
class Plan:
    """The models, backends and devices asked for, and the seeds."""

    models: tuple[Plugin, ...]
    backends: tuple[Plugin, ...]
    devices: tuple[Plugin, ...]
    seeds: tuple[int, ...]


def make_plan(model: str, backend: str, device: str, seeds: int) -> Plan:
    """Resolve comma-separated names or `all`. Raises BenchError (did-you-mean) on any unknown."""
    if not 1 <= seeds <= MOST_SEEDS:
        raise BenchError(f"--seeds {seeds}: expected a whole number from 1 to {MOST_SEEDS}")
    return Plan(
        resolve("models", model),
        resolve("backends", backend),
        resolve("devices", device),
        tuple(range(seeds)),
    )


def resolve(group: Group, names: str) -> tuple[Plugin, ...]:
    """Return the plug-ins named, in the order named; `all` leaves out those that cannot load."""
    if names.strip() == "all":
        return tuple(plugin for plugin in plugins(group) if plugin.problem() is None)
    wanted = [name.strip() for name in names.split(",") if name.strip()]
    if not wanted:
        raise BenchError(f"no {group} named: expected a name, several with commas, or 'all'")
    return tuple(find(group, name) for name in dict.fromkeys(wanted))
