"""`--guard`: every model asked for, in its guarded form, under a name of its own."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any

from bench.errors import BenchError
from bench.plugins import Plugin
from bench.runner.plan import Plan

SUFFIX = "+guard"


@dataclass(frozen=True)
class GuardedPlugin(Plugin):
    """A model that is loaded guarded, named NAME+guard on every board."""

    def load(self) -> Any:
        """Return the guarded class; BenchError where the model is no class or cannot be had."""
        from zoo.base import MitigationModel
        from zoo.guard import guarded

        found = super().load()
        if not (isinstance(found, type) and issubclass(found, MitigationModel)):
            raise BenchError(f"--guard: {self.name.removesuffix(SUFFIX)!r} is no model class")
        return guarded(found)


def with_guard(plan: Plan) -> Plan:
    """Return the plan with every model guarded; floors, which nothing is learnt of, as they are."""
    return replace(plan, models=tuple(_guarded(one) for one in plan.models))


def _guarded(plugin: Plugin) -> Plugin:
    if getattr(plugin.load(), "floor", False):
        return plugin
    named = {**vars(plugin), "name": plugin.name + SUFFIX}
    return GuardedPlugin(**named)
