"""The paper's figures, from paper.toml beside this file."""

from __future__ import annotations

import tomllib
from functools import cache
from importlib.resources import files
from typing import Any

Printed = dict[str, Any]


@cache
def _content() -> Printed:
    return tomllib.loads(files("bench.reproduce").joinpath("paper.toml").read_text("utf-8"))


def before() -> Printed:
    """Return the paper's errors before mitigation, in metres."""
    return dict(_content()["before"])


def rows(table: str) -> list[Printed]:
    """Return the printed rows of a table of paper.toml, as printed."""
    return [dict(row) for row in _content()[table]]


def find(table: str, **where: str) -> Printed:
    """Return the printed row of a table with these values, empty where the paper has none."""
    for row in rows(table):
        if all(row.get(name) == value for name, value in where.items()):
            return row
    return {}
