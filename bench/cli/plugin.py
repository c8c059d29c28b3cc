"""`bench plugin new`: start a plug-in package of your own."""

from __future__ import annotations

import json
import shlex
from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import say
from bench.text import named

if TYPE_CHECKING:
    from bench.scaffold.package import Kind


EPILOG = """\b
Examples:
  bench plugin new ridge-cir -o ~/plug-ins
  bench plugin new humidity --kind effect
  bench plugin new my-board --kind device
"""
THEN = {
    "model": "bench run --model {name} --backend fp32",
    "backend": "bench run --model remnet --backend {name}",
    "dataset": "bench run --model all --data {name} --backend fp32",
    "effect": "bench diagnose --recorded mine.parquet",
    "simulator": "bench simulate {name} --geometry {name} -o simulated.parquet",
    "device": "bench run --model remnet --backend int8 --device {name}",
}


@click.group(epilog="Example: bench plugin new ridge-cir")
def command() -> None:
    """Start a plug-in package of your own.

    A plug-in is an installed package with an entry point; the harness finds it by itself.
    """


@command.command(epilog=EPILOG)
@click.argument("name")
@click.option(
    "--kind",
    type=click.Choice(["model", "backend", "dataset", "effect", "simulator", "device"]),
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
        say(json.dumps({"folder": str(folder), "kind": kind, "files": files}, indent=1))
    else:
        _explain(name, kind, folder, files)


def _explain(name: str, kind: Kind, folder: Path, files: Sequence[str]) -> None:
    say(f"wrote {named(folder)}:")
    for path in files:
        say(f"  {path}")
    shown, quoted = named(folder), named(shlex.quote(str(folder)))
    say(f'next: pip install -e "{shown}[dev]" && pytest {quoted}')
    say(f"then: {THEN[kind].format(name=name)}")
