"""Text from elsewhere (names, notes, error messages), made safe to show on a terminal or a page."""

from __future__ import annotations

import re

_STRANGE = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f"  # control characters but line end and tab
    r"\u2028\u2029\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # line ends, writing direction
    r"\ud800-\udfff]"  # halves of surrogate pairs: bytes that are no text
)

_TAG = re.compile(r"<(?=[A-Za-z/!?])")


def plain(text: str) -> str:
    r"""Return text in which control characters stand as visible escapes; line ends and tabs stay.

    Escape sequences, changes of writing direction and halves of surrogate pairs are such, too.

    >>> plain("a\x1b[31mb")
    'a\\x1b[31mb'
    """
    return _STRANGE.sub(_escape, text)


def _escape(found: re.Match[str]) -> str:
    return found[0].encode("unicode_escape").decode()


def one_line(text: str) -> str:
    """Return text as `plain` gives it, its lines and tabs joined by spaces."""
    return " ".join(plain(text).split())


def named(name: object) -> str:
    r"""Return a file, folder or column as it is named, line ends and tabs as visible escapes too.

    >>> named("a\nb")
    'a\\nb'
    """
    return _STRANGE.sub(_escape, str(name)).translate({9: r"\t", 10: r"\n"})


def unmarked(text: str) -> str:
    """Return one line that a picture shows as it is: no dollar of it begins a formula."""
    return one_line(text).replace("$", r"\$")


def unlinked(text: str) -> str:
    r"""Return a line of Markdown in which no name begins a tag of HTML, or a link.

    >>> unlinked("of **<b>[x](http://y)**")
    'of **&lt;b>[x]\\(http://y)**'
    """
    return _TAG.sub("&lt;", text).replace("](", "]\\(")


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


def significant(value: float, digits: int) -> str:
    """Return a number with so many significant digits, without a power of ten below a million."""
    text = f"{value + 0.0:.{digits}g}"  # + 0.0: a negative zero is said as zero
    return f"{float(text):.0f}" if "e+" in text and abs(value) < 1e6 else text
