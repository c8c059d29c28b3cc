"""What lies in a diagnosis's folder, for those who go on from it."""

from __future__ import annotations

from pathlib import Path
from typing import Any, Final

from bench.errors import BenchError
from bench.files import read_json
from bench.text import named

REPORT: Final = "diagnosis.json"  # the diagnosis as plain data
INPUTS: Final = "inputs.json"  # what it was made from


def read_part(folder: Path, part: str) -> dict[str, Any]:
    """Return a JSON file of a diagnosis. Raises BenchError where there is none, or no object."""
    path = folder / part
    if not path.is_file():
        raise BenchError(
            f"{named(folder)}: no diagnosis there; expected a folder of `bench diagnose -o`"
        )
    content = read_json(path)
    if not isinstance(content, dict):
        raise BenchError(f"{named(path)}: not what `bench diagnose` writes")
    return content
