"""Writing C: numbers, tables, indentation, names."""

from __future__ import annotations

import math
import re
from collections.abc import Iterable, Sequence

import numpy as np
from numpy.typing import NDArray

WIDTH = 98
_KEYWORDS = frozenset(
    (
        *("auto", "break", "case", "char", "const", "continue", "default", "do", "double", "else"),
        *("enum", "extern", "float", "for", "goto", "if", "inline", "int", "long", "register"),
        *("restrict", "return", "short", "signed", "sizeof", "static", "struct", "switch"),
        *("typedef", "union", "unsigned", "void", "volatile", "while", "asm", "typeof", "error_m"),
    )
)

_LOCALS = r"[a-z]{1,2}\d*|total|sum|part|from|to|result|row|limit|count|unknown|low|steps"


def number(value: float) -> str:
    """Return a float32 as C, exact: nine digits tell any two of them apart; NaN is 0 / 0."""
    if not math.isfinite(value):
        sign = "-" if value < 0 else ""
        return f"{sign}({int(not math.isnan(value))}.0f / 0.0f)"
    text = f"{float(np.float32(value)):.9g}"
    return f"{text}f" if re.search(r"[.e]", text) else f"{text}.0f"


def table(name: str, kind: str, values: Iterable[str]) -> str:
    """Return a constant array, its lines filled."""
    items = list(values)
    lines = [f"static const {kind} {name}[{len(items)}] = {{"]
    return "\n".join([*lines, *filled(items), "};"])


def filled(items: Sequence[str]) -> list[str]:
    """Return items with commas in lines of at most `WIDTH` characters."""
    lines, line = [], "   "
    for item in items:
        if len(line) + len(item) + 2 > WIDTH:
            lines.append(line)
            line = "   "
        line += f" {item},"
    return [*lines, line]


def floats(values: NDArray[np.float32]) -> list[str]:
    """Return float32 numbers as C."""
    return [number(value) for value in values.reshape(-1).tolist()]


def integers(values: NDArray[np.generic]) -> list[str]:
    """Return integers as C."""
    smallest = "(-2147483647 - 1)"
    return [smallest if v == -(1 << 31) else str(v) for v in values.reshape(-1).tolist()]


def indented(lines: Iterable[str], by: int = 1) -> list[str]:
    """Return lines indented by so many steps of four; preprocessor lines stay at the margin."""
    return [line if line.startswith("#") or not line else "    " * by + line for line in lines]


def block(head: str, body: Sequence[str]) -> list[str]:
    """Return `head {` body `}`."""
    return [f"{head} {{", *indented(body), "}"]


def identifiers(names: Sequence[str]) -> list[str]:
    """Return names as distinct C identifiers: what C does not take becomes `_`."""
    found: list[str] = []
    for name in names:
        plain = re.sub(r"[^0-9A-Za-z_]", "_", name)[:32] or "input"
        taken = plain in _KEYWORDS or re.fullmatch(_LOCALS, plain) is not None
        if not plain[0].isalpha() or taken or plain.lower().startswith("uwb_"):
            plain = f"in_{plain}"
        while plain in found or plain.upper() in (one.upper() for one in found):
            plain += "_"
        found.append(plain)
    return found
