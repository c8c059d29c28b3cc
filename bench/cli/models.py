"""`bench models`: list the models."""

from __future__ import annotations

import click

from bench.cli.listing import show


@click.command(epilog="Example: bench models --json")
@click.option("--json", "as_json", is_flag=True, help="Print JSON instead of a table.")
def command(as_json: bool) -> None:
    """List the models, where each comes from, and why one cannot be used."""
    show("models", "Mitigation models", as_json)
