"""What every command prints with: plain text, one standard output, nobody else's on it.

Names, notes and messages come from files and plug-ins: no control character of theirs reaches the
terminal and no markup in them is interpreted. rich is imported when something is shown, not before.
"""

from __future__ import annotations

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import cache
from typing import TYPE_CHECKING, Any, TextIO

import click

from bench.text import plain

if TYPE_CHECKING:
    from rich.console import Console

Tell = Callable[[str], None]
_OURS: list[TextIO] = []
WIDTH_ELSEWHERE = 120  # characters of a line where nobody watches: a file, a pipe


def out() -> TextIO:
    """Return the standard output, also while plug-ins find the standard error in its place."""
    return _OURS[-1] if _OURS else sys.stdout


def say(text: object = "", err: bool = False, nl: bool = True) -> None:
    """Print text on standard output (or error), control characters as visible escapes."""
    click.echo(plain(str(text)), file=sys.stderr if err else out(), nl=nl)


@contextmanager
def foreign_prints_to_stderr() -> Iterator[None]:
    """While a command works, whatever is not said with `say` or `console` goes to standard error.

    So a library or plug-in that prints, from compiled code too, never spoils `--json`.
    """
    if _OURS:
        yield
        return
    real, sys.stdout = sys.stdout, sys.stderr
    ours = _apart(real)
    _OURS.append(ours)
    try:
        yield
        ours.flush()
    finally:
        _OURS.pop()
        sys.stdout = real
        if ours is not real:
            _put_back(ours)


def _apart(real: TextIO) -> TextIO:
    """Return a stream of its own to where `real` leads; descriptor 1 then leads to the error."""
    try:
        if real.fileno() != 1:
            return real
        real.flush()
        ours = os.fdopen(os.dup(1), "w", encoding=real.encoding, errors="backslashreplace")
        os.dup2(2, 1)
    except (OSError, ValueError, AttributeError):  # none, or captured
        return real
    return ours


def _put_back(ours: TextIO) -> None:
    os.dup2(ours.fileno(), 1)
    with suppress(OSError):  # what could not be written was told by the flush before
        ours.close()


@cache
def _plain_console() -> type[Console]:
    from rich.console import Console, ConsoleOptions, RenderableType
    from rich.segment import Segment

    class PlainConsole(Console):
        """A console that interprets no markup and lets no control character of a text through."""

        def render(
            self, renderable: RenderableType, options: ConsoleOptions | None = None
        ) -> Iterable[Segment]:
            for text, style, control in super().render(renderable, options):
                yield Segment(text if control else plain(text), style, control)

        def on_broken_pipe(self) -> None:
            raise BrokenPipeError

    return PlainConsole


def console(stderr: bool = False, quiet: bool = False) -> Console:
    """Return a console for tables and progress; wide where nobody watches."""
    settings: dict[str, Any] = {"markup": False, "emoji": False, "highlight": False}
    settings |= {"file": sys.stderr if stderr else out(), "quiet": quiet}
    made = _plain_console()(**settings)
    if made.is_terminal or "COLUMNS" in os.environ:
        return made
    return _plain_console()(**settings, width=WIDTH_ELSEWHERE)


@contextmanager
def busy(what: str) -> Iterator[Tell]:
    """Show on standard error, in a terminal, that something is going on; yields what changes it."""
    from rich.text import Text

    with console(stderr=True).status(Text(f"{what} ...")) as status:
        yield lambda text: status.update(Text(text))


def print_json(value: Any) -> None:
    """Print a value as indented JSON."""
    say(json.dumps(value, indent=1))


def print_table(title: str, columns: Sequence[str], rows: Iterable[Sequence[str]]) -> None:
    """Print rows of text under `columns`; what does not fit is folded, never cut.

    The first column holds names, which are kept whole.
    """
    from rich.table import Table

    table = Table(title=title, title_justify="left")
    for position, column in enumerate(columns):
        table.add_column(column, overflow="fold", no_wrap=position == 0)
    for row in rows:
        table.add_row(*row)
    console().print(table)
