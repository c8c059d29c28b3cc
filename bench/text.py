"""Text from elsewhere (names, notes, error messages), made safe to show on a terminal or a page."""

from __future__ import annotations

import unicodedata

_DIRECTIONS = frozenset("\u061c\u200e\u200f\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
_KEPT = frozenset("\n\t")


def plain(text: str) -> str:
    r"""Return text in which control characters stand as visible escapes; line ends and tabs stay.

    Escape sequences, changes of writing direction and halves of surrogate pairs are such, too.

    >>> plain("a\x1b[31mb")
    'a\\x1b[31mb'
    """
    if text.isascii() and text.isprintable():
        return text
    return "".join(_shown(char) for char in text)


def one_line(text: str) -> str:
    """Return text as `plain` gives it, its lines and tabs joined by spaces."""
    return " ".join(plain(text).split())


def reason(problem: BaseException) -> str:
    """Return what an exception says in one line, also where asking it for its text fails."""
    if isinstance(problem, SystemExit):
        return one_line(f"it tried to end the program (exit code {problem.code!r})")
    try:
        text = str(problem)
    except BaseException as second:
        text = f"(its message cannot be had: {type(second).__name__})"
    lines = [line for line in text.splitlines() if line.strip()]
    return one_line(f"{type(problem).__name__}: {lines[0] if lines else 'no message'}")


def _shown(char: str) -> str:
    if char in _KEPT:
        return char
    strange = unicodedata.category(char) in ("Cc", "Cs", "Zl", "Zp") or char in _DIRECTIONS
    return char.encode("unicode_escape").decode() if strange else char
