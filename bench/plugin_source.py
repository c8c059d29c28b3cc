"""Where the source of a plug-in lies: every module of its distribution, importing none of them."""

from __future__ import annotations

from collections.abc import Iterator
from functools import cache
from importlib.metadata import Distribution, PackageNotFoundError, distribution
from importlib.util import find_spec
from pathlib import Path

from bench.plugins import Plugin


def places_of(plugin: Plugin) -> tuple[Path, ...]:
    """Return the packages and modules of the distribution that brings a plug-in, and its own.

    Namespace packages and editable installations included; nothing where it has no source.
    """
    return _places(plugin.target.partition(":")[0].partition(".")[0], _others(plugin))


def _others(plugin: Plugin) -> str:
    return "" if plugin.built_in else plugin.distribution  # ours are hashed by what they decide


@cache
def _places(own: str, other: str) -> tuple[Path, ...]:
    names = {own, *_top_levels(other)} - {""}
    found = {place for name in names for place in _locations(name)}
    return tuple(sorted(found | set(_linked(other))))


def _locations(name: str) -> Iterator[Path]:
    """Yield the folders of a package, a namespace package's all, or the file of a module."""
    try:
        spec = find_spec(name)
    except (ImportError, ValueError, AttributeError):
        return
    if spec is not None and spec.submodule_search_locations is not None:
        yield from (Path(place) for place in spec.submodule_search_locations)
    elif spec is not None and spec.origin and Path(spec.origin).is_file():
        yield Path(spec.origin)


def _top_levels(name: str) -> set[str]:
    """Return the top-level names a distribution brings, by its own lists."""
    found = _distribution(name)
    if found is None:
        return set()
    listed = (found.read_text("top_level.txt") or "").split()
    files = [path for path in found.files or [] if path.suffix == ".py"]
    return {*listed, *(path.parts[0].removesuffix(".py") for path in files)}


def _linked(name: str) -> Iterator[Path]:
    """Yield the packages in the folders an editable installation puts on the path."""
    found = _distribution(name)
    links = [path for path in (found.files if found else None) or [] if path.suffix == ".pth"]
    for line in (line for link in links for line in _lines(Path(str(link.locate())))):
        folder = Path(line)
        if not line.startswith("import") and folder.is_dir():
            yield from folder.glob("*.py")
            yield from (path.parent for path in folder.glob("*/__init__.py"))


def _lines(path: Path) -> list[str]:
    try:
        return [line.strip() for line in path.read_text().splitlines() if line.strip()]
    except (OSError, UnicodeDecodeError):
        return []


def _distribution(name: str) -> Distribution | None:
    try:
        return distribution(name) if name else None
    except (PackageNotFoundError, ValueError):
        return None
