"""What a package offers, imported when it is first asked for: `import bench` stays light."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from importlib import import_module
from typing import Any


def lazily(package: str, homes: Mapping[str, str]) -> Callable[[str], Any]:
    """Return the `__getattr__` of a package; `homes` says in which module each name is defined.

    >>> __getattr__ = lazily("bench.recordings", {"Recordings": "bench.recordings.table"})
    >>> __getattr__("Recordings").__name__
    'Recordings'
    """

    def attribute(name: str) -> Any:
        if name not in homes:
            raise AttributeError(f"module {package!r} has no attribute {name!r}")
        return getattr(import_module(homes[name]), name)

    return attribute
