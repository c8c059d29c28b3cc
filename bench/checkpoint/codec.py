"""What a search finds, as plain data for JSON and back, to the last bit.

Dataclasses of `bench.discrepancy`, effects by their name, arrays with the order of their memory
(which decides how sums are rounded), tuples apart from lists. Nothing else is read back, so a file
can name no code to run.
"""

from __future__ import annotations

from base64 import b64decode, b64encode
from collections.abc import Mapping
from dataclasses import fields, is_dataclass
from importlib import import_module
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.physics.effect import Effect
from bench.plugins import load

Kinds = Mapping[str, type[Effect]]
HERE = "bench.discrepancy."


class NotPlainError(BenchError):
    """A value that has no plain form."""


def to_plain(value: Any, kinds: Kinds) -> Any:
    """Return a value as data for JSON. Raises NotPlainError where that could not be read back.

    `kinds` are effects by name that `bench.plugins` need not know.
    """
    if isinstance(value, np.ndarray):
        return _array(value)
    if isinstance(value, np.generic):
        return {"scalar": _array(np.asarray(value))}
    if value is None or isinstance(value, bool | int | float | str):
        return value
    if isinstance(value, list):
        return [to_plain(item, kinds) for item in value]
    if isinstance(value, tuple):
        return {"tuple": [to_plain(item, kinds) for item in value]}
    if isinstance(value, dict):
        return {"dict": [[to_plain(part, kinds) for part in item] for item in value.items()]}
    return _dataclass(value, kinds)


def from_plain(data: Any, kinds: Kinds) -> Any:
    """Return the value that `to_plain` was given. Raises NotPlainError where it is none of ours."""
    if isinstance(data, list):
        return [from_plain(item, kinds) for item in data]
    if not isinstance(data, dict):
        return data
    if "array" in data:
        return _as_array(data)
    if "scalar" in data:
        return _as_array(data["scalar"])[()]
    if "tuple" in data:
        return tuple(from_plain(item, kinds) for item in data["tuple"])
    if "dict" in data:
        return {key: from_plain(item, kinds) for key, item in data["dict"]}
    kind = _kind(data["effect"], kinds) if "effect" in data else _ours(data["class"])
    return kind(**{name: from_plain(item, kinds) for name, item in data["fields"].items()})


def _array(value: NDArray[Any]) -> dict[str, Any]:
    """Return an array as data."""
    if value.dtype.hasobject:
        raise NotPlainError(f"an array of {value.dtype} has no plain form")
    order: Literal["C", "F"] = "C"
    if value.flags.f_contiguous and not value.flags.c_contiguous:
        order = "F"
    bits = b64encode(value.tobytes(order)).decode()
    return {"array": bits, "dtype": value.dtype.str, "shape": list(value.shape), "order": order}


def _as_array(data: Mapping[str, Any]) -> NDArray[Any]:
    """Return the array of such data."""
    flat = np.frombuffer(b64decode(data["array"]), np.dtype(data["dtype"])).copy()
    return flat.reshape(data["shape"], order=data["order"])


def _dataclass(value: Any, kinds: Kinds) -> dict[str, Any]:
    """Return an effect or a dataclass of this package as data."""
    if not is_dataclass(value):
        raise NotPlainError(f"{type(value).__name__} has no plain form")
    name = f"{type(value).__module__}:{type(value).__qualname__}"
    inside = {item.name: to_plain(getattr(value, item.name), kinds) for item in fields(value)}
    if isinstance(value, Effect):
        known, head = _kind(value.name, kinds), {"effect": value.name}
    else:
        known, head = _ours(name), {"class": name}
    if known is not type(value):
        raise NotPlainError(f"{name} is not what its name leads to")
    return {**head, "fields": inside}


def _kind(name: str, kinds: Kinds) -> type[Any]:
    """Return the effect of that name. Raises NotPlainError where there is none."""
    if name in kinds:
        return kinds[name]
    try:
        found: type[Any] = load("effects", name)
    except BenchError as problem:
        raise NotPlainError(str(problem)) from problem
    return found


def _ours(name: str) -> type[Any]:
    """Return a dataclass of this package. Raises NotPlainError for anything else."""
    module, _, label = name.partition(":")
    found = getattr(import_module(module), label, None) if module.startswith(HERE) else None
    if not (isinstance(found, type) and is_dataclass(found)):
        raise NotPlainError(f"{name} is no dataclass of {HERE[:-1]}")
    return found
