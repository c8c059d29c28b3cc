"""One progress line on stderr for work that tells what it is doing, and lines that stay."""

from __future__ import annotations

from types import TracebackType
from typing import Self

from rich.text import Text

from bench.cli.console import console, say
from bench.runner.observer import Observer


class StatusView(Observer):
    """Shows what is being done; a fraction as per cent. Notes are printed on stderr."""

    def __init__(self, first: str) -> None:
        self._console = console(stderr=True)
        self._status = self._console.status(Text(first))

    def __enter__(self) -> Self:
        self._status.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, _: TracebackType | None
    ) -> None:
        self._status.stop()

    def stage(self, what: str) -> None:
        """Show what begins; a line of its own where nobody watches, as in a log."""
        self._status.update(Text(what))
        if not self._console.is_terminal:
            say(what, err=True)

    def progress(self, what: str, fraction: float) -> None:
        """Show how far it has come."""
        self._status.update(Text(f"{what} {100 * fraction:.0f} %"))

    def note(self, line: str) -> None:
        """Print a line that stays."""
        say(line, err=True)
