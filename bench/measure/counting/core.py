"""What a processor core is to the counter: how to compile for it, emulate it, and price it.

A core is one TOML file of `cores/`. Every figure has `low`, `typical`, `high` and a `source`.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

from bench.errors import BenchError, unknown_name

FOLDER = Path(__file__).parent / "cores"
COLUMNS = ("low", "typical", "high")
Family = Literal["thumb", "riscv32", "aarch64"]
OPTIONAL = {
    "load_then_access": "load",
    "call": "branch_taken",
    "return": "branch_taken",
    "load_use": "",
    "float_use": "",
    "float": "integer",
    "float_mac": "integer",
    "float_divide": "divide",
}
"""Prices a table may leave out, and the one that stands in ("" is nothing)."""
PRICES = (
    *("integer", "multiply", "divide", "load", "store", "multiple_base", "multiple_each"),
    *("branch", "branch_taken", "other", *OPTIONAL),
)


@dataclass(frozen=True)
class Price:
    """Cycles of one class of instruction; for `issue` the factor on the whole sum."""

    low: float
    typical: float
    high: float
    source: str

    def columns(self) -> tuple[float, float, float]:
        """Return low, typical, high."""
        return self.low, self.typical, self.high


NOTHING = Price(0.0, 0.0, 0.0, "no such cost on this core")


@dataclass(frozen=True)
class Core:
    """One core: compiler flags, emulator model and the price of every class of instruction.

    `float_unit`: it has floating-point instructions. `gcc` and `zig` are flags by compiler;
    `gcc_command` is empty where only zig compiles for it; `debian` is the package of that gcc.
    `issue` scales the sum of single-issue cycles (below 1 where instructions go in pairs).
    """

    name: str
    title: str
    family: Family
    emulator: str
    gcc_command: str
    gcc: tuple[str, ...]
    zig: tuple[str, ...]
    debian: str
    float_unit: bool
    issue: Price
    prices: Mapping[str, Price]

    def price(self, name: str) -> Price:
        """Return a price, that of its stand-in where the table leaves it out."""
        if name in self.prices:
            return self.prices[name]
        stand_in = OPTIONAL[name]
        return self.price(stand_in) if stand_in else NOTHING


def core_names() -> list[str]:
    """Return the cores that come with the project."""
    return sorted(path.stem for path in FOLDER.glob("*.toml"))


def load_core(name: str) -> Core:
    """Return one core. Raises BenchError for an unknown name or a table that is not whole."""
    if name not in core_names():
        raise unknown_name("core", name, core_names())
    path = FOLDER / f"{name}.toml"
    try:
        return _core(tomllib.loads(path.read_text(encoding="utf-8")))
    except (KeyError, TypeError, ValueError) as problem:
        raise BenchError(f"core table {path}: {problem}") from problem


def _core(content: dict[str, Any]) -> Core:
    prices = {name: _price(name, entry) for name, entry in content["cycles"].items()}
    if missing := [name for name in PRICES if name not in prices and name not in OPTIONAL]:
        raise ValueError(f"no cycles for {', '.join(missing)}")
    if extra := sorted(set(prices) - set(PRICES)):
        raise ValueError(f"no such class: {', '.join(extra)}")
    return Core(
        name=content["name"],
        title=content["title"],
        family=content["family"],
        emulator=content["emulator"],
        gcc_command=content.get("gcc_command", ""),
        gcc=tuple(content.get("gcc", ())),
        zig=tuple(content["zig"]),
        debian=content.get("debian", ""),
        float_unit=bool(content["float_unit"]),
        issue=_price("issue", content["issue"]),
        prices=prices,
    )


def _price(name: str, entry: dict[str, Any]) -> Price:
    price = Price(**entry)
    if not 0 <= price.low <= price.typical <= price.high or not price.source:
        raise ValueError(f"{name}: 0 <= low <= typical <= high and a source were expected")
    return price
