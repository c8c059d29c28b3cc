"""Being told how a run goes on."""

from __future__ import annotations


class Observer:
    """Hears what a run is doing; every method is a no-op, override what you show."""

    def stage(self, what: str) -> None:
        """Tell that something begins that has no fraction."""

    def runs(self, done: int, total: int) -> None:
        """Tell how many runs are finished, out of how many."""

    def progress(self, what: str, fraction: float) -> None:
        """Tell how far `what` has come, 0 to 1."""

    def note(self, line: str) -> None:
        """Tell something worth a line: a skip with its reason, a failure."""
