"""Units as text: a factor to base units times powers of sympy symbols, checked when combined."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from math import pi
from typing import TYPE_CHECKING

from bench.errors import unknown_name

if TYPE_CHECKING:
    from sympy import Expr

_SIZES: dict[str, tuple[float, str]] = {
    "m": (1.0, "m"), "km": (1e3, "m"), "cm": (1e-2, "m"), "mm": (1e-3, "m"), "ft": (0.3048, "m"),
    "s": (1.0, "s"), "h": (3600.0, "s"), "ms": (1e-3, "s"), "us": (1e-6, "s"), "ns": (1e-9, "s"),
    "dB": (1.0, "dB"), "dBm": (1.0, "dB"), "K": (1.0, "K"), "degC": (1.0, "K"), "V": (1.0, "V"),
    "1": (1.0, ""), "rad": (1.0, ""), "deg": (pi / 180, ""), "ppm": (1e-6, ""), "%": (0.01, ""),
}  # fmt: skip
# Ends of column names, longest first; a column without one is a number of no unit.
_ENDS = {
    "_m_per_s": "m/s", "_dbm": "dBm", "_db": "dB", "_deg": "deg", "_ppm": "ppm", "_ns": "ns",
    "_us": "us", "_ms": "ms", "_s": "s", "_cm": "cm", "_mm": "mm", "_m": "m", "_c": "degC",
    "_v": "V",
}  # fmt: skip
_POWER = re.compile(r"(.+?)(?:\*\*|\^)([+-]?\d)")


@dataclass(frozen=True)
class Unit:
    """A unit: `factor` times `kind`, a product of powers of base symbols (1 where it has none)."""

    factor: float
    kind: Expr


@lru_cache(maxsize=512)
def unit(text: str) -> Unit:
    """Return the unit of a text such as `m/m`, `m*s**-1`, `m/degC` or `1`, read left to right.

    Raises BenchError on a name that is no unit.
    """
    import sympy  # half a second, that a diagnosis without laws does not have to wait

    kind = sympy.Integer(1)
    for _, base, power in _powers(text):
        kind *= sympy.Symbol(base, positive=True) ** power if base else 1
    return Unit(factor_of(text), kind)


@lru_cache(maxsize=512)
def factor_of(text: str) -> float:
    """Return how many base units a unit has, as `unit` says. Raises BenchError as it does."""
    factor = 1.0
    for size, _, power in _powers(text):
        factor *= size**power
    return factor


def _powers(text: str) -> Iterator[tuple[float, str, int]]:
    """Yield size, base and power of every unit in a text. Raises BenchError where one is none."""
    sign = 1
    for part in re.split(r"((?<!\*)\*(?!\*)|/)", text.replace(" ", "") or "1"):
        if part in ("*", "/"):
            sign = 1 if part == "*" else -1
            continue
        found = _POWER.fullmatch(part)
        name, power = (found[1], int(found[2])) if found else (part, 1)
        yield *_size(name, text), sign * power


def _size(name: str, text: str) -> tuple[float, str]:
    """Return the size and base of one unit. Raises BenchError where it is none."""
    if name not in _SIZES:
        raise unknown_name(f"unit in {text!r}:", name, _SIZES)
    return _SIZES[name]


def column_unit(column: str) -> str:
    """Return the unit that a column's name ends in, as text; `1` where it names none."""
    return next((text for end, text in _ENDS.items() if column.endswith(end)), "1")


def stem(column: str) -> str:
    """Return a column's name without the unit that it ends in."""
    return next((column.removesuffix(end) for end in _ENDS if column.endswith(end)), column)


def over(top: str, *below: str) -> str:
    """Return a unit divided by others, as text: m over degC is `m/degC`."""
    for text in below:
        turned = text.translate(str.maketrans("*/", "/*")) if "**" not in text else text
        top += "" if text == "1" else f"/{turned}"
    return {"m/m*s": "s"}.get(top, top)


def times(top: str, *more: str) -> str:
    """Return `top` times units, as text."""
    return "*".join([top, *(text for text in more if text != "1")])


def kind_words(kind: Expr) -> str:
    """Return a kind of unit for people: `m/s`, or `no unit`."""
    return "no unit" if kind == 1 else str(kind)
