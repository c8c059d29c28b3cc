"""Names of obstacles in one cell of text."""

from __future__ import annotations

import json


def parse_names(cell: object) -> list[str]:
    """Return the obstacle names of one cell: a JSON list, or names separated by semicolons."""
    if not isinstance(cell, str):
        return []
    if cell.lstrip().startswith("["):
        try:
            return [str(name) for name in json.loads(cell)]
        except ValueError:
            return []
    return [name.strip() for name in cell.split(";") if name.strip()]
