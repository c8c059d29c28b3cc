"""A board's own cycle counter: read the self-test's output, recalibrate the part's profile.

The self-test of `bench export` prints a line a row, with the cycles of that call:

    row 0: 1012345 cycles, 0.123456 m

Any line with a number in front of or behind the word "cycles" is read; others are left out.
"""

from __future__ import annotations

import json
import re
from collections.abc import Iterable
from dataclasses import dataclass, replace
from pathlib import Path
from statistics import fmean

from bench.errors import BenchError
from bench.files import write_atomically
from bench.measure.counting.count import Count
from bench.measure.profile import UNITS, Coefficient, Profile
from bench.results import Interval

MAX_BYTES = 10_000_000
_NUMBER = r"(?<!\d)([-+]?\d(?:[\d.,'_]{0,30}\d)?(?:[eE][-+]?\d{1,5})?)"
_LINE = re.compile(rf"{_NUMBER}\s{{0,20}}cycles\b|\bcycles\s{{0,20}}[:=]?\s{{0,20}}{_NUMBER}")
_WHOLE = re.compile(r"\d{1,15}")


@dataclass(frozen=True)
class Measured:
    """Cycles of each call, as a board counted them."""

    file: str
    cycles: tuple[int, ...]

    @property
    def mean(self) -> float:
        """Mean cycles of a call."""
        return fmean(self.cycles)

    def interval(self) -> Interval:
        """Return the mean, the fewest and the most."""
        return Interval(self.mean, min(self.cycles), max(self.cycles))


def read_measured(path: Path) -> Measured:
    """Return the cycles in a self-test's output. Raises BenchError where there are none."""
    try:
        if path.stat().st_size > MAX_BYTES:
            raise BenchError(f"{path}: more than {MAX_BYTES} bytes, expected a self-test's output")
        text = path.read_text(encoding="utf-8", errors="replace")
    except OSError as problem:
        raise BenchError(f"cannot read {path}: {problem.strerror or problem}") from problem
    found = [said[1] or said[2] for said in _LINE.finditer(text)]
    if not found:
        raise BenchError(f"{path}: no line like 'row 0: 1012345 cycles' in it")
    return Measured(path.name, tuple(_cycles(path, said) for said in found))


def _cycles(path: Path, said: str) -> int:
    """Return cycles as a number. Raises BenchError where they are no whole number above 0."""
    if not _WHOLE.fullmatch(said) or int(said) == 0:
        raise BenchError(f"{path}: {said!r} cycles: expected a whole number above 0, as 1012345")
    return int(said)


def recalibrated(profile: Profile, count: Count, measured: Measured) -> Profile:
    """Return the profile with the measured cycles per counted cycle as its `cycle_factor`.

    The factor is to the typical count with the part's typical wait states; it holds for the
    network and compiler that were measured and is a better guess than none for others.
    """
    wait = profile.value("flash_wait_cycles") or 0.0
    counted = count.cycles.typical + wait * count.flash_reads
    span = measured.interval()
    low, high = (end / counted for end in (span.low or span.value, span.high or span.value))
    entry = Coefficient(
        span.value / counted, low, high, UNITS["cycle_factor"],
        f"{len(measured.cycles)} calls in {measured.file}, {count.compiler}", "measured",
    )  # fmt: skip
    return replace(profile, coefficients={**profile.coefficients, "cycle_factor": entry})


def write_profile(profile: Profile, path: Path) -> None:
    """Write a profile as the TOML that `load_profile` reads, in one step."""
    lines = [
        f"name = {_text(profile.name)}",
        f"title = {_text(profile.title)}",
        f"precisions = [{', '.join(map(_text, profile.precisions))}]",
        f"core = {_text(profile.core)}",
        f"generator = {_text(profile.generator)}",
        *_tables(profile.coefficients.items(), ""),
    ]
    for mode, entries in profile.modes.items():
        lines += _tables(entries.items(), f"modes.{mode}.")
    write_atomically(path, "\n".join(lines) + "\n")


def _tables(entries: Iterable[tuple[str, Coefficient]], prefix: str) -> list[str]:
    lines = []
    for name, one in entries:
        lines += ["", f"[{prefix}{name}]", f"value = {one.value!r}", f"low = {one.low!r}"]
        lines += [f"high = {one.high!r}", f"unit = {_text(one.unit)}", f"kind = {_text(one.kind)}"]
        lines.append(f"source = {_text(one.source)}")
    return lines


def _text(value: str) -> str:
    """Return a TOML string; JSON's escapes are TOML's."""
    return json.dumps(value, ensure_ascii=False)
