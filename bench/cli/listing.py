"""Lists of plug-ins: what there is, where it comes from, and what cannot be used and why."""

from __future__ import annotations

from dataclasses import asdict
from typing import Any

from bench.cli.console import print_json, print_table
from bench.plugins import Group, Plugin, plugins


def show(group: Group, title: str, as_json: bool) -> None:
    """Print every plug-in of a group as a table, or as JSON. Imports none that is built in."""
    facts = [_facts(plugin) for plugin in plugins(group)]
    if as_json:
        print_json(facts)
        return
    rows = [(one["name"], one["problem"] or one["summary"], one["distribution"]) for one in facts]
    print_table(title, ("name", "what it is", "from"), rows)


def _facts(plugin: Plugin) -> dict[str, Any]:
    return {**asdict(plugin), "summary": plugin.summary(), "problem": plugin.problem()}
