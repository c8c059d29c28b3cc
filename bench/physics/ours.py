"""Whether code is of this package, or of a user: that may hold what no other process has."""

from __future__ import annotations


def is_ours(kind: type) -> bool:
    """Return whether a part of a simulator is one of this package."""
    return kind.__module__.startswith("bench.physics.")
