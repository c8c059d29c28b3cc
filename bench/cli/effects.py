"""`bench effects`: the library that a diagnosis names from, and what every effect stands on."""

from __future__ import annotations

from dataclasses import asdict
from inspect import getdoc
from typing import TYPE_CHECKING, Any

import click

from bench.cli.console import print_json, print_table, say
from bench.cli.listing import show
from bench.plugins import load

if TYPE_CHECKING:
    from bench.physics.effect import Effect

NOTE = "bench effects NAME shows how one is recognised, its parameters with bounds, and its source."


@click.command(epilog="Example: bench effects level-control")
@click.argument("name", required=False)
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of text.")
def command(name: str | None, as_json: bool) -> None:
    """List the effects that a simulator may leave out, or show what one is and stands on."""
    if name is None:
        show("effects", "Effects (what a simulator may leave out)", as_json)
        if not as_json:
            say(NOTE)
    elif as_json:
        print_json(_facts(load("effects", name)))
    else:
        _show_one(_facts(load("effects", name)))


def _facts(kind: type[Effect]) -> dict[str, Any]:
    """Return what an effect is, as plain data."""
    return {
        "name": kind.name,
        "named_as": kind.explains or kind.name,
        "words": " ".join((getdoc(kind) or "").split()),
        "recognised_by": kind.signature,
        "source": kind.source,
        "acts_on": kind.stage,
        "needs": [" and ".join(way) for way in kind.needs],
        "needs_cir": not kind.without_cir,
        "negative_control": kind.control,
        "parameters": [asdict(one) for one in kind.parameters()],
    }


def _show_one(facts: dict[str, Any]) -> None:
    """Print one effect: words, then every parameter with its unit and bounds."""
    say(f"{facts['name']}: {facts['words']}")
    needs = " or ".join(facts["needs"])
    lines = {
        "named in a diagnosis as": facts["named_as"] if facts["named_as"] != facts["name"] else "",
        "recognised by": facts["recognised_by"],
        "acts on": facts["acts_on"],
        "needs columns": needs + " and CIRs" * (facts["needs_cir"] and bool(needs)),
        "negative control": facts["negative_control"],
        "source": facts["source"],
    }
    for what, said in lines.items():
        if said:
            say(f"  {what}: {said}")
    columns = ("parameter", "unit", "from", "to", "default", "meaning")
    rows = [_row(one) for one in facts["parameters"]]
    if rows:
        print_table("Parameters", columns, rows)


def _row(one: dict[str, Any]) -> tuple[str, ...]:
    numbers = (f"{one[key]:g}" for key in ("low", "high", "default"))
    return (one["name"], one["unit"], *numbers, one["meaning"])
