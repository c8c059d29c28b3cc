"""Text from result files, made safe to show: no control character reaches a page or a terminal."""

from __future__ import annotations

import re

_STRANGE = re.compile(
    r"[\x00-\x08\x0b-\x1f\x7f-\x9f"  # control characters but line end and tab
    r"\u2028\u2029\u061c\u200e\u200f\u202a-\u202e\u2066-\u2069"  # line ends, writing direction
    r"\ud800-\udfff]"  # halves of surrogate pairs: bytes that are no text
)


def plain(text: str) -> str:
    """Return text in which control characters stand as visible escapes; line ends and tabs stay."""
    return _STRANGE.sub(lambda found: found[0].encode("unicode_escape").decode(), text)


def tame(text: str) -> str:
    """Return text that a picture shows as it is: plain, no dollar of it begins a formula."""
    return " ".join(plain(text).split()).replace("$", r"\$")
