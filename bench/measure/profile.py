"""What a device profile says: coefficients with a range, a unit, a source and how sure it is.

A profile is one TOML file. Every table that holds a `value` is a coefficient; its dotted path is
its name, so `[launch_cycles.int8]` is "launch_cycles.int8". A profile that names a `core` has the
coefficients of `cores/CORE.toml` beside it as well, fitted to counts on that core. Tables under
`modes` replace coefficients when the device runs in that mode (another clock, another runtime).
"""

from __future__ import annotations

import math
import tomllib
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal, get_args

from bench.errors import BenchError, unknown_name
from bench.files import read_text

Kind = Literal["measured", "counted", "datasheet", "assumed"]
UNITS = {
    "frequency_mhz": "MHz",
    "host_mhz": "MHz",
    "t0_us": "us",
    "launch_cycles": "cycles per kernel",
    "macs_per_cycle": "multiply-adds per cycle",
    "cycles_per_output": "cycles per value written",
    "cycles_per_read": "cycles per value read",
    "cycles_per_input": "cycles per value of a row",
    "call_cycles": "cycles per call",
    "fit_factor": "counted cycles per estimated cycle",
    "power_w": "W",
    "cycle_energy_pj": "pJ per cycle",
    "flash_kib": "KiB",
    "ram_kib": "KiB",
    "code_kib": "KiB",
    "runtime_ram_kib": "KiB",
    "flash_wait_cycles": "cycles per read of data from flash",
    "cycle_factor": "measured cycles per counted cycle",
}
"""Every coefficient by the first part of its name, and the unit it must be given in."""


@dataclass(frozen=True)
class Coefficient:
    """One figure of a device: `low` <= `value` <= `high` in `unit`, and where it comes from.

    `kind`: "measured" (read off a measurement, ours or published), "counted" (in an emulator),
    "datasheet" (the maker says so), or "assumed" (recalled or reasoned, not looked up: the range is
    wide on purpose).
    """

    value: float
    low: float
    high: float
    unit: str
    source: str
    kind: Kind


@dataclass(frozen=True)
class Profile:
    """A device as the model in `bench.measure.estimate` sees it.

    `precisions` are those it can run ("fp32", "fp16", "int8"); `integer_only` devices run no
    other layer. `coefficients` are by dotted name; `modes` hold replacements by mode. `core` names
    the core that C is counted on (`bench.measure.counting`), empty where it has none; `generator`
    whose code the estimates stand for.
    """

    name: str
    title: str
    precisions: tuple[str, ...]
    coefficients: Mapping[str, Coefficient]
    integer_only: bool = False
    modes: Mapping[str, Mapping[str, Coefficient]] = field(default_factory=dict)
    core: str = ""
    generator: str = ""

    def values(self) -> dict[str, float]:
        """Return every coefficient's value by name."""
        return {name: entry.value for name, entry in self.coefficients.items()}

    def value(self, name: str) -> float | None:
        """Return one coefficient's value, or None where the profile does not have it."""
        entry = self.coefficients.get(name)
        return None if entry is None else entry.value

    def in_mode(self, mode: str) -> Profile:
        """Return the profile in one of its modes. Raises BenchError for an unknown one.

        What a mode gives stands for all that is more specific too: its "macs_per_cycle.fp32"
        replaces "macs_per_cycle.conv.fp32".
        """
        if mode not in self.modes:
            raise unknown_name(f"mode of {self.name}", mode, self.modes)
        given = self.modes[mode]
        kept = {name: one for name, one in self.coefficients.items() if not _covered(name, given)}
        return replace(self, coefficients={**kept, **given})

    def with_values(self, values: Mapping[str, float]) -> Profile:
        """Return the profile with other values (a fit's); ranges keep their ratio to the value.

        Raises BenchError for a name the profile does not have.
        """
        changed = dict(self.coefficients)
        for name, value in values.items():
            if name not in changed:
                raise unknown_name(f"coefficient of {self.name}", name, changed)
            changed[name] = _moved(changed[name], value)
        return replace(self, coefficients=changed)


def load_profile(path: Path) -> Profile:
    """Read a profile. Raises BenchError naming the file, the entry and what was expected."""
    try:
        content = tomllib.loads(read_text(path))
    except (BenchError, ValueError, RecursionError) as problem:
        raise BenchError(f"cannot read device profile {path}: {problem}") from problem
    try:
        return _profile({**_shared(path, content), **content})
    except (KeyError, TypeError, ValueError, OverflowError) as problem:
        said = f"{problem} is missing" if isinstance(problem, KeyError) else problem
        raise BenchError(f"device profile {path}: {said}") from problem


def _shared(path: Path, content: Mapping[str, Any]) -> dict[str, Any]:
    """Return what the profiles of one core share, where there is such a file beside them."""
    shared = path.parent / "cores" / f"{content.get('core')}.toml"
    return tomllib.loads(shared.read_text(encoding="utf-8")) if shared.is_file() else {}


def _profile(content: dict[str, Any]) -> Profile:
    modes = content.pop("modes", {})
    return Profile(
        name=str(content.pop("name")),
        title=str(content.pop("title")),
        precisions=tuple(content.pop("precisions")),
        integer_only=bool(content.pop("integer_only", False)),
        core=str(content.pop("core", "")),
        generator=str(content.pop("generator", "")),
        coefficients=_coefficients(content),
        modes={name: _coefficients(tables) for name, tables in modes.items()},
    )


def _coefficients(tables: Mapping[str, Any], prefix: str = "") -> dict[str, Coefficient]:
    """Return the coefficients of nested tables by dotted name."""
    found: dict[str, Coefficient] = {}
    for key, table in tables.items():
        name = f"{prefix}{key}"
        if not isinstance(table, dict):
            raise ValueError(f"{name!r} is no coefficient: a table with a value was expected")
        if "value" in table:
            found[name] = _coefficient(name, table)
        else:
            found |= _coefficients(table, f"{name}.")
    return found


def _coefficient(name: str, table: dict[str, Any]) -> Coefficient:
    try:
        entry = Coefficient(**table)
        ordered = 0 <= entry.low <= entry.value <= entry.high < math.inf
    except TypeError:
        wanted = ", ".join(Coefficient.__dataclass_fields__)
        raise ValueError(f"{name}: exactly these entries were expected: {wanted}") from None
    if not ordered:
        raise ValueError(f"{name}: 0 <= low <= value <= high was expected")
    if entry.unit != (unit := UNITS.get(name.partition(".")[0])):
        raise ValueError(f"{name}: unit {entry.unit!r}, expected {unit!r}")
    if entry.kind not in get_args(Kind) or not entry.source:
        raise ValueError(f"{name}: a source and one of {', '.join(get_args(Kind))} were expected")
    return entry


def _covered(name: str, given: Iterable[str]) -> bool:
    """Return True where a coefficient is one of those given, or a more specific one."""
    first, *parts = name.split(".")
    return any(
        first == other and parts[len(parts) - len(rest) :] == rest
        for other, *rest in (one.split(".") for one in given)
    )


def _moved(entry: Coefficient, value: float) -> Coefficient:
    if entry.value == 0:
        return replace(entry, value=value, low=min(value, entry.low), high=max(value, entry.high))
    scale = value / entry.value
    return replace(entry, value=value, low=entry.low * scale, high=entry.high * scale)
