"""`bench plugin new`: start a plug-in package of your own."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

if TYPE_CHECKING:
    from bench.scaffold.package import Kind


@click.group(epilog="Example: bench plugin new ridge-cir")
def command() -> None:
    """Start a plug-in package of your own.

    A plug-in is an installed package with an entry point; the harness finds it by itself.
    """


@command.command(epilog="Example: bench plugin new ridge-cir -o ~/plug-ins")
@click.argument("name")
@click.option(
    "--kind",
    type=click.Choice(["model", "dataset"]),
    default="model",
    show_default=True,
    help="What it adds.",
)
@click.option(
    "-o",
    "--out",
    "parent",
    type=click.Path(path_type=Path),
    default=Path(),
    help="Folder to make the package in.  [default: here]",
)
@click.option("--json", "as_json", is_flag=True, help="Print what was written as JSON.")
def new(name: str, kind: Kind, parent: Path, as_json: bool) -> None:
    """Write a complete, installable package NAME: code, its tests, pyproject.toml, README."""
    from bench.scaffold import write_package

    folder, files = write_package(name, kind, parent)
    if as_json:
        click.echo(json.dumps({"folder": str(folder), "kind": kind, "files": files}, indent=1))
    else:
        _explain(name, kind, folder, files)


def _explain(name: str, kind: Kind, folder: Path, files: Sequence[str]) -> None:
    click.echo(f"wrote {folder}:")
    for path in files:
        click.echo(f"  {path}")
    quoted = shlex.quote(str(folder))
    click.echo(f'next: pip install -e "{folder}[dev]" && pytest {quoted}')
    chosen = f"--model {name}" if kind == "model" else f"--model all --data {name}"
    click.echo(f"then: bench run {chosen} --backend fp32")
