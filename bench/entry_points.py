"""Reading the entry points of installed distributions; a damaged file breaks none but its own.

`importlib.metadata.entry_points()` raises for every plug-in where one file is malformed; here each
file is read on its own and a line that is none is an entry with its fault.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import Distribution, distributions

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
    seen: set[str] = set()
    for distribution in distributions():
        text, fault = _text(distribution)
        if "bench." not in text and fault is None:
            continue
        name = _name(distribution)
        if name in seen:
            continue  # an older installation further down the path
        seen.add(name)
        if fault is not None:
            yield Entry(name, "", name, fault)
        yield from _of_group(text, group, name)


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
