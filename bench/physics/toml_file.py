"""Simulators as TOML text: base, ordered effects, seed. Reading what was written gives it back."""

from __future__ import annotations

import json
import tomllib
from dataclasses import asdict, fields
from pathlib import Path
from typing import Any

from bench.errors import BenchError, unknown_name
from bench.files import read_text
from bench.physics.base import Base
from bench.physics.effect import Effect
from bench.physics.simulator import Simulator
from bench.plugins import load
from bench.text import one_line

_TOP = ("name", "seed", "base", "effects")


def to_toml(simulator: Simulator) -> str:
    """Return the simulator as TOML text, every parameter written out."""
    lines = [f"name = {_value(simulator.name)}", f"seed = {simulator.seed}", "", "[base]"]
    lines += _assignments(asdict(simulator.base))
    for effect in simulator.effects:
        lines += ["", "[[effects]]", f"effect = {_value(effect.name)}"]
        lines += _assignments(asdict(effect))
    return "\n".join(lines) + "\n"


def from_toml(text: str, where: str = "simulator") -> Simulator:
    """Return the simulator of a TOML text.

    Raises BenchError (naming `where`) on bad TOML, an unknown key, effect or parameter (with a
    did-you-mean) and a value that is no number or outside its physical bounds.
    """
    try:
        data = tomllib.loads(text)
        if not data:
            raise BenchError(
                "it is empty: expected [base] or [[effects]] of a simulator; leave --simulated out "
                "to compare with the base simulator alone"
            )
        return _simulator(data)
    except BenchError as problem:
        raise BenchError(f"{where}: {problem}") from problem
    except (ValueError, RecursionError, OverflowError) as problem:
        raise BenchError(f"{where}: not TOML of a simulator: {one_line(str(problem))}") from problem


def read_toml(path: Path) -> Simulator:
    """Return the simulator of a TOML file. Raises BenchError like `from_toml`."""
    return from_toml(read_text(path), str(path))


def _simulator(data: dict[str, Any]) -> Simulator:
    for key in data:
        if key not in _TOP:
            raise unknown_name("key", key, _TOP)
    seed, name = data.get("seed", 0), data.get("name", "simulator")
    if not isinstance(seed, int) or isinstance(seed, bool) or seed < 0:
        raise BenchError(f"seed = {seed!r}, expected a whole number of 0 or more")
    if not isinstance(name, str):
        raise BenchError(f"name = {name!r}, expected a text")
    effects = _tables(data.get("effects", []))
    return Simulator(_base(data.get("base", {})), tuple(map(_effect, effects)), seed, name)


def _base(values: Any) -> Base:
    if not isinstance(values, dict):
        raise BenchError("[base] must be a table")
    known = [item.name for item in fields(Base)]
    for key in values:
        if key not in known:
            raise unknown_name("base parameter", key, known)
    return Base(**values)


def _tables(values: Any) -> list[dict[str, Any]]:
    if not isinstance(values, list) or not all(isinstance(item, dict) for item in values):
        raise BenchError("effects must be written as [[effects]] tables")
    return values


def _effect(values: dict[str, Any]) -> Effect:
    name = values.get("effect")
    if not isinstance(name, str):
        raise BenchError('every [[effects]] table needs effect = "NAME"')
    kind = load("effects", name)
    made = kind.from_values({key: item for key, item in values.items() if key != "effect"})
    if not isinstance(made, Effect):
        raise BenchError(f"effect {name!r}: the plug-in is no Effect")
    return made


def _assignments(values: dict[str, Any]) -> list[str]:
    return [f"{key} = {_value(value)}" for key, value in values.items()]


def _value(value: Any) -> str:
    """Return a value as TOML; a float is written so that reading gives back the same number."""
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)  # a JSON string is a TOML basic string
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, int):
        return str(value)
    if isinstance(value, list | tuple):
        return "[" + ", ".join(map(_value, value)) + "]"
    return repr(float(value))
