"""Parts to count on: their profiles by name, with a core, an emulator and a compiler for it."""

from __future__ import annotations

from collections.abc import Iterable, Iterator
from pathlib import Path

from bench.errors import BenchError
from bench.measure.counting import find_compiler, load_core
from bench.measure.counting.compile import Which
from bench.measure.counting.emulate import check_tools
from bench.measure.on_devices import load_device
from bench.measure.profile import Profile, load_profile
from bench.plugins import find, plugins

SUFFIXES = ("", "f", "plus")  # of a core's name: a Cortex-M4 with its unit, a Cortex-M0+


def countable(names: str, which: Which = "auto") -> tuple[Profile, ...]:
    """Return the parts named, with commas, or "all"; a name may be a profile's file (.toml).

    Raises BenchError for unknown names, parts without a core, and tools that are missing.
    """
    profiles = tuple(_profiles(names))
    check_tools()
    for core in dict.fromkeys(profile.core for profile in profiles):
        find_compiler(load_core(core), which)
    return profiles


def _profiles(names: str) -> Iterator[Profile]:
    """Yield the parts named ("all": those with a core). Raises BenchError where one has none."""
    if names.strip() == "all":
        yield from _with_cores()
        return
    wanted = [name.strip() for name in names.split(",") if name.strip()]
    if not wanted:
        raise BenchError("--device names no part: expected a name, or several with commas")
    for name in dict.fromkeys(wanted):
        profile = load_profile(Path(name)) if name.endswith(".toml") else _part(name)
        if not profile.core:
            raise BenchError(f"device {name} has no core to count on; its figures are estimates")
        yield profile


def _part(name: str) -> Profile:
    """Return a part by name. Raises BenchError; where it is a core's, with the parts that have it.

    >>> _part("cortex-m0+")
    Traceback (most recent call last):
    bench.errors.BenchError: 'cortex-m0+' is a core, no device: name a part that has it (rp2040)
    """
    known = {one.name for one in plugins("devices")}
    if name not in known and (having := _parts_of_core(name, _with_cores())):
        there = ", ".join(having)
        raise BenchError(f"{name!r} is a core, no device: name a part that has it ({there})")
    return load_device(find("devices", name))


def _with_cores() -> list[Profile]:
    loaded = [one.load() for one in plugins("devices") if one.problem() is None]
    return [one for one in loaded if isinstance(one, Profile) and one.core]


def _parts_of_core(name: str, profiles: Iterable[Profile]) -> list[str]:
    said = name.lower().replace("+", "plus").removeprefix("arm-").removeprefix("cortex-")
    cores = {f"{prefix}{said}{suffix}" for prefix in ("", "cortex-") for suffix in SUFFIXES}
    return [one.name for one in profiles if one.core in cores]
