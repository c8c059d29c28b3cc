"""Finding models, backends, data sets, effects, simulators and devices through entry points.

Nothing is imported until it is named. Ours are declared in our own pyproject.toml, exactly as a
third party declares its own.
"""

from __future__ import annotations

import ast
from dataclasses import dataclass, replace
from importlib.machinery import PathFinder
from importlib.metadata import EntryPoint
from importlib.util import find_spec
from inspect import signature
from pathlib import Path
from typing import Any, Literal

from bench.entry_points import entries
from bench.errors import BenchError, foreign, unknown_name

Group = Literal["models", "backends", "datasets", "effects", "simulators", "devices"]
_SINGULAR: dict[Group, str] = {
    "models": "model",
    "backends": "backend",
    "datasets": "data set",
    "effects": "effect",
    "simulators": "simulator",
    "devices": "device",
}
EXAMPLE = "`bench plugin new NAME --kind {}`"
OUR_DISTRIBUTION = "uwb-bench"
_MADE: tuple[Group, ...] = ("models", "backends", "datasets", "simulators")
"""Groups whose plug-ins are called without arguments before they are used."""


@dataclass(frozen=True)
class Plugin:
    """One registered name: where it lives and which distribution brings it."""

    group: Group
    name: str
    target: str
    distribution: str
    fault: str | None = None

    @property
    def built_in(self) -> bool:
        """True where this project itself registers it."""
        return self.distribution == OUR_DISTRIBUTION

    def load(self) -> Any:
        """Import and return the object. Raises BenchError with the reason where that fails."""
        with foreign(self._unavailable):
            if self.fault is not None:
                raise BenchError(f"{self._unavailable}: {self.fault}")
            return EntryPoint(self.name, self.target, f"bench.{self.group}").load()

    def make(self) -> Any:
        """Import it and call it where that can be done. Raises BenchError like `load`."""
        loaded = self.load()
        if needed := _needed(loaded):
            kind = _SINGULAR[self.group]
            raise BenchError(
                f"{self._unavailable}: {self.target} asks for {needed}; expected a {kind}, or a "
                f"class or function without arguments that gives one (an example: "
                f"{EXAMPLE.format(kind.replace(' ', ''))})"
            )
        with foreign(self._unavailable):
            return loaded() if callable(loaded) else loaded

    @property
    def _unavailable(self) -> str:
        return f"{_SINGULAR[self.group]} {self.name!r} is unavailable"

    def summary(self) -> str:
        """Return the first line of its docstring, read from the source without importing it."""
        module, _, attribute = self.target.partition(":")
        try:
            tree = ast.parse(source_path(module).read_text(encoding="utf-8"))
        except (OSError, SyntaxError, ImportError, ValueError, RecursionError, AttributeError):
            return ""
        for node in tree.body:
            if isinstance(node, ast.ClassDef | ast.FunctionDef) and node.name == attribute:
                return (ast.get_docstring(node) or "").split("\n")[0]
        return ""

    def problem(self) -> str | None:
        """Return why it cannot be used, or None. Built-ins are trusted and not imported."""
        if self.built_in:
            return None
        try:
            self.make() if self.group in _MADE else self.load()
        except BenchError as error:
            return str(error).partition(f"{self.name!r} is ")[2] or str(error)
        return None


def _needed(made: Any) -> str:
    """Return the arguments that calling it would need, "" where none, or where nobody can tell."""
    if not callable(made):
        return ""
    try:
        known = signature(made).parameters.values()
    except (ValueError, TypeError):
        return ""
    lone = [one for one in known if one.kind not in (one.VAR_POSITIONAL, one.VAR_KEYWORD)]
    return ", ".join(repr(one.name) for one in lone if one.default is one.empty)


def source_path(module: str) -> Path:
    """Return the file of a dotted module name, importing nothing. Raises ImportError."""
    spec = find_spec(module.partition(".")[0])  # the top level: editable installs have a finder
    for depth in range(2, module.count(".") + 2):
        if spec is not None:
            name = ".".join(module.split(".")[:depth])
            spec = PathFinder.find_spec(name, list(spec.submodule_search_locations or []))
    if spec is None or spec.origin is None:
        raise ImportError(f"no source found for {module!r}")
    return Path(spec.origin)


def plugins(group: Group) -> list[Plugin]:
    """Return every plug-in of a group, ours first, then as found. A name of ours stays ours.

    One whose name differs from an earlier one's in case alone is there, but cannot be used.
    """
    found: dict[str, Plugin] = {}
    for entry in entries(f"bench.{group}"):
        plugin = Plugin(group, entry.name, entry.target, entry.distribution, entry.fault)
        if plugin.built_in or entry.name not in found:
            found[entry.name] = plugin
    ordered = sorted(found.values(), key=lambda plugin: not plugin.built_in)
    first = {plugin.name.casefold(): plugin for plugin in reversed(ordered)}
    return [_told_apart(plugin, first[plugin.name.casefold()]) for plugin in ordered]


def _told_apart(plugin: Plugin, first: Plugin) -> Plugin:
    """Return the plug-in, at fault where its name is another's but for case."""
    if plugin is first or plugin.fault is not None:
        return plugin
    fault = f"its name is {first.name!r} of {first.distribution} but for case; expected another"
    return replace(plugin, fault=fault)


def find(group: Group, name: str) -> Plugin:
    """Return the plug-in of that name. Raises BenchError with a did-you-mean."""
    known = {plugin.name: plugin for plugin in plugins(group)}
    if name not in known:
        raise unknown_name(_SINGULAR[group], name, known)
    return known[name]


def named(group: Group, kind: type) -> Plugin | None:
    """Return the plug-in that registers this class, None where none does."""
    target = f"{kind.__module__}:{kind.__qualname__}"
    return next((plugin for plugin in plugins(group) if plugin.target == target), None)


def load(group: Group, name: str) -> Any:
    """Return the object registered under `name`. Raises BenchError where it cannot be had."""
    return find(group, name).load()
