"""Reading the entry points of installed distributions; a damaged file breaks none but its own.

`importlib.metadata.entry_points()` raises for every plug-in where one file is malformed; here each
file is read on its own and a line that is none is an entry with its fault.
"""

from __future__ import annotations

import re
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from functools import lru_cache
from importlib.metadata import Distribution, distributions
from pathlib import Path

from bench.text import one_line, reason

_TARGET = re.compile(r"^[A-Za-z_][\w.]*(:[A-Za-z_][\w.]*)?(\s*\[.*\])?$")
_SECTION = re.compile(r"^\[(.*)\]$")


@dataclass(frozen=True)
class Entry:
    """One line of an entry_points.txt; `fault` says why it cannot be used, None where it can."""

    name: str
    target: str
    distribution: str
    fault: str | None = None


def entries(group: str) -> Iterator[Entry]:
    """Yield the entries of a group (`bench.models`) of every distribution, in order of the path."""
    for text, fault, name in _ours(_installed()):
        if fault is not None:
            yield Entry(name, "", name, fault)
        yield from _of_group(text, group, name)


def _installed() -> tuple[tuple[str, int], ...]:
    """Return what says whether distributions came or went: the path, and when its folders changed.

    Whoever installs one puts a folder there.
    """
    return tuple((path, _changed_ns(path)) for path in sys.path)


def _changed_ns(path: str) -> int:
    try:
        return Path(path).stat().st_mtime_ns
    except OSError:
        return 0


@lru_cache(maxsize=1)
def _ours(installed: tuple[tuple[str, int], ...]) -> list[tuple[str, str | None, str]]:
    """Return text, fault and name of every distribution that tells of `bench.`, read once."""
    found: dict[str, tuple[str, str | None, str]] = {}
    for distribution in distributions(path=[path for path, _ in installed]):
        text, fault = _text(distribution)
        if "bench." in text or fault is not None:
            name = _name(distribution)  # an older installation comes further down the path
            found.setdefault(name, (text, fault, name))
    return list(found.values())


def _text(distribution: Distribution) -> tuple[str, str | None]:
    """Return the file's text; a fault where it is there, tells of `bench.` and is no text."""
    try:
        return distribution.read_text("entry_points.txt") or "", None
    except UnicodeDecodeError as problem:
        ours = b"bench." in problem.object
        return "", f"its entry_points.txt is not UTF-8 ({problem.reason})" if ours else None
    except Exception:
        return "", None


def _name(distribution: Distribution) -> str:
    try:
        return one_line(str(distribution.metadata["Name"] or "unknown"))
    except Exception as problem:
        return f"unknown ({reason(problem)})"


def _of_group(text: str, group: str, distribution: str) -> Iterator[Entry]:
    section = ""
    for number, raw in enumerate(text.splitlines(), 1):
        line = raw.strip()
        if found := _SECTION.match(line):
            section = found[1].strip()
        elif line and section == group and not line.startswith(("#", ";")):
            yield _entry(line, number, distribution)


def _entry(line: str, number: int, distribution: str) -> Entry:
    name, equals, target = (part.strip() for part in line.partition("="))
    fault = None
    if not equals or not name:
        fault = f"line {number} of its entry_points.txt is no 'name = module:object'"
    elif not _TARGET.match(target):
        fault = f"its entry point leads to {one_line(target)!r}; expected module:object"
    return Entry(one_line(name) or distribution, target, distribution, fault)
