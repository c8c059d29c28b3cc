"""Lists of plug-ins: what there is, where it comes from, and what cannot be used and why."""

from __future__ import annotations

import json
from dataclasses import asdict
from typing import Any

import click

from bench.plugins import Group, Plugin, plugins


def show(group: Group, title: str, as_json: bool) -> None:
    """Print every plug-in of a group as a table, or as JSON."""
    facts = [_facts(plugin) for plugin in plugins(group)]
    if as_json:
        click.echo(json.dumps(facts, indent=1))
        return
    from rich.console import Console
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for column in ("name", "what it is", "from"):
        table.add_column(column, overflow="fold")
    for one in facts:
        what = one["problem"] or one["summary"]
        table.add_row(one["name"], what, one["distribution"])
    Console().print(table)


def _facts(plugin: Plugin) -> dict[str, Any]:
    return {**asdict(plugin), "summary": plugin.summary(), "problem": plugin.problem()}
