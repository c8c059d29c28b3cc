"""One way to say that a check failed."""

from __future__ import annotations


def expect(holds: bool, words: str) -> None:
    """Raise AssertionError with these words unless something holds."""
    if not holds:
        raise AssertionError(words)
