"""`bench backends`: list the backends."""

from __future__ import annotations

import click

from bench.cli.listing import show


@click.command(epilog="Example: bench backends --json")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(as_json: bool) -> None:
    """List the backends, where each comes from, and why one cannot be used."""
    show("backends", "Backends (how a fitted model runs)", as_json)
