"""How a text table is written: what separates fields, and what stands before decimals."""

from __future__ import annotations

import csv
import gzip
import re
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from bench.errors import BenchError

DELIMITERS = (";", "\t", "|", ",")
SAMPLE_LINES = 200
ALIKE = 0.9  # share of lines that must have as many fields as the header
_WORDS = {"tab": "\t", "space": " "}
_COMMA = re.compile(r"[+-]?\d+,\d+([eE][+-]?\d+)?")
_POINT = re.compile(r"[+-]?\d+\.\d+([eE][+-]?\d+)?")


@dataclass(frozen=True)
class Dialect:
    """Field `delimiter`, `decimal` mark, `encoding`, and `skip` lines before the header."""

    delimiter: str = ","
    decimal: str = "."
    encoding: str = "utf-8"
    skip: int = 0

    def __str__(self) -> str:
        names = {mark: word for word, mark in _WORDS.items()}
        named = names.get(self.delimiter, repr(self.delimiter))
        return f"fields separated by {named}, decimal {self.decimal!r}"


def find_dialect(path: Path, spec: str | None = None) -> Dialect:
    """Return how a file is written, by its first 200 lines; `spec` as in `--csv` decides marks.

    `spec` is the delimiter and, if it is not a point, the decimal mark: `;,` or `tab,` or `;`.
    Lines that are blank or begin with # before the header are skipped. Raises BenchError for an
    empty or binary file, a header without names, marks that make no sense, and lines of so unequal
    numbers of fields that the delimiter cannot be told.
    """
    given = None if spec is None else parse_marks(spec)
    lines, encoding = _sample(path)
    skip = next((n for n, line in enumerate(lines) if line.strip()[:1] not in ("", "#")), None)
    if skip is None:
        raise BenchError(f"{path}: empty; expected a header line and one line per range")
    lines = [line for line in lines[skip:] if line.strip()]
    delimiter = given[0] if given else _delimiter(lines)
    if not given:
        _refuse_ragged(path, lines, delimiter)
    rows = [_split(line, delimiter) for line in lines]
    if all(_is_number(field) for field in rows[0]):
        raise BenchError(
            f"{path}: line {skip + 1} holds numbers; expected the names of the columns there"
        )
    decimal = given[1] if given else _decimal(rows[1:], delimiter)
    return Dialect(delimiter, decimal, encoding, skip)


def parse_marks(spec: str) -> tuple[str, str]:
    """Return (delimiter, decimal) of `--csv`. Raises BenchError where it is neither."""
    for word, mark in _WORDS.items():
        if spec.startswith(word):
            spec = mark + spec[len(word) :]
    decimal = spec[1:] or "."
    if not spec or decimal not in (".", ",") or decimal == spec[0] or spec[0].isalnum():
        raise BenchError(
            f"--csv {spec!r}: expected the field delimiter and the decimal mark, such as ';,' or "
            "',.' or 'tab,'"
        )
    return spec[0], decimal


def _sample(path: Path) -> tuple[list[str], str]:
    """Return the first lines and their encoding. Raises BenchError where it is no text."""
    opener = gzip.open if path.suffix == ".gz" else open
    try:
        with opener(path, "rb") as stream:
            start = [line for line, _ in zip(stream, range(SAMPLE_LINES), strict=False)]
    except (OSError, EOFError) as problem:
        raise BenchError(f"{path}: cannot be read: {problem}") from problem
    content = b"".join(start)
    if b"\0" in content:
        raise BenchError(f"{path}: binary; expected a text table")
    try:
        return content.decode("utf-8-sig").splitlines(), "utf-8"
    except UnicodeDecodeError:
        return content.decode("cp1252", errors="replace").splitlines(), "cp1252"


def _delimiter(lines: Sequence[str]) -> str:
    """Return the mark that cuts the header and nearly all lines into equally many fields."""
    for mark in DELIMITERS:
        counts = [len(_split(line, mark)) for line in lines]
        if counts[0] > 1 and sum(count == counts[0] for count in counts) >= ALIKE * len(counts):
            return mark
    columns = [len(line.split()) for line in lines]
    usual = Counter(columns).most_common(1)[0]
    return " " if columns[0] > 1 and usual[0] == columns[0] else ","


def _refuse_ragged(path: Path, lines: Sequence[str], delimiter: str) -> None:
    """Raise BenchError where the header is cut by a mark that most lines are not cut alike by."""
    if len(_split(lines[0], delimiter)) > 1:
        return
    for mark in DELIMITERS:
        width = len(_split(lines[0], mark))
        ragged = [line for line in lines if len(_split(line, mark)) != width]
        if width > 1 and ragged:
            raise BenchError(
                f"{path}: {mark!r} cuts the header into {width} fields, but {len(ragged)} of "
                f"{len(lines) - 1} lines into other numbers, the first: {ragged[0][:60]!r}; mend "
                f"those lines, or name delimiter and decimal mark, as in --csv {mark + ','!r}"
            )


def _split(line: str, delimiter: str) -> list[str]:
    """Return the fields of a line, quotes respected."""
    if delimiter == " ":
        return line.split()
    return next(csv.reader([line], delimiter=delimiter, skipinitialspace=True), [])


def _decimal(rows: Sequence[Sequence[str]], delimiter: str) -> str:
    """Return the decimal mark: a comma where more fields are written with one than with a point."""
    if delimiter == ",":
        return "."
    fields = [field.strip() for row in rows for field in row]
    commas = sum(bool(_COMMA.fullmatch(field)) for field in fields)
    return "," if commas > sum(bool(_POINT.fullmatch(field)) for field in fields) else "."


def _is_number(field: str) -> bool:
    """Return whether a field is a number in either notation, or blank."""
    try:
        float(field.strip().replace(",", ".") or 0)
    except ValueError:
        return False
    return True
