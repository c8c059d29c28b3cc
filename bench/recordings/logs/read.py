"""Somebody's own logs, a file or a folder of one form, as recordings."""

from __future__ import annotations

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

import pandas as pd

from bench.errors import BenchError
from bench.recordings.clean import clean
from bench.recordings.csv_table import read_text_table, with_lists
from bench.recordings.logs.dialect import Dialect, find_dialect
from bench.recordings.logs.letters import in_our_letters
from bench.recordings.logs.links import MISSING, make_links
from bench.recordings.logs.mapping import Mapped, apply_maps, parse_maps
from bench.recordings.logs.registers import add_registers
from bench.recordings.logs.suspicions import suspicions
from bench.recordings.table import CIR_COLUMNS, Recordings

SUFFIXES = (".csv", ".csv.gz", ".txt", ".tsv", ".dat", ".log")
FILE, FOLDER = "file", "folder"


@dataclass(frozen=True)
class LogOptions:
    """How logs are to be read: the texts of --map, --csv, --link, --link-by and --from-name."""

    maps: tuple[str, ...] = ()
    csv: str | None = None
    link: tuple[str, ...] = ()
    link_by: str | None = None
    from_name: str | None = None


@dataclass(frozen=True)
class Imported:
    """Recordings, what was derived on the way, and what looks wrong, a line each."""

    recordings: Recordings
    notes: list[str] = field(default_factory=list)
    warnings: list[str] = field(default_factory=list)


def is_logs(path: Path) -> bool:
    """Return whether a path is a folder or a text table by its name."""
    return path.is_dir() or path.name.endswith(SUFFIXES)


def read_logs(path: Path, options: LogOptions | None = None) -> Imported:
    """Read a text table, or every text table under a folder, all of one form.

    From a folder each row also gets `file` (its path in the folder, without ending) and `folder`;
    `--from-name` adds the named groups of a regular expression found in that path. Then names
    that differ from ours in case alone, mapping and units, registers, links, and the rules of
    `bench.recordings.clean`.

    Raises BenchError, naming file and column: no such file, no table, files of different form, a
    bad option, or mostly unusable rows (with the likely cause where one is seen).
    """
    options = options or LogOptions()
    maps = parse_maps(options.maps)
    frame, dialect = _read_all(path, options)
    name = str(path)
    frame, respelt = in_our_letters(frame, {*(one.source for one in maps), *options.link})
    frame = apply_maps(frame, maps, name, dialect.decimal)
    frame = with_lists(_cir_points(frame, dialect), path)
    frame, notes = add_registers(frame, name)
    now = {one.source: one.column for one in maps}
    named = [column if column in frame else now.get(column, column) for column in options.link]
    links = make_links(frame, named, options.link_by, name)
    frame = frame if links is None else frame.assign(link=links)
    warnings = [*suspicions(frame), *([] if "link" in frame else [MISSING])]
    read = _cleaned(frame, name, warnings)
    stem = path.name if path.is_dir() else path.name.partition(".")[0]
    recordings = Recordings(read[0], source=stem, dropped=read[1])
    return Imported(recordings, [str(dialect), *_mapped_notes(maps), *respelt, *notes], warnings)


def _cleaned(
    frame: pd.DataFrame, name: str, warnings: list[str]
) -> tuple[pd.DataFrame, dict[str, int]]:
    """Return the usable rows; what makes most of them unusable is said with its likely cause."""
    lacking = [c for c in ("range_m", "true_range_m") if c not in frame]
    if lacking and "error_m" not in frame:
        have = ", ".join(map(str, frame.columns))
        raise BenchError(
            f"{name}: no column {lacking[0]!r}; say which column it is and its unit, as in "
            f"--map {lacking[0].removesuffix('_m')}=COLUMN:mm (it has: {have})"
        )
    try:
        read = clean(frame, name)
    except BenchError as problem:
        causes = [line for line in warnings if line != MISSING]
        raise BenchError("; ".join([str(problem), *causes])) from problem
    return read.frame, dict(read.dropped)


def _mapped_notes(maps: list[Mapped]) -> Iterator[str]:
    for one in maps:
        unit = f" in {one.unit}" if one.unit else ""
        yield f"{one.column} from {one.source!r}{unit}"


def _read_all(path: Path, options: LogOptions) -> tuple[pd.DataFrame, Dialect]:
    """Return the rows of a file, or of all files under a folder, and how the first is written."""
    if not path.exists():
        raise BenchError(f"{path}: no such file or folder")
    files = _files(path) if path.is_dir() else [path]
    dialect = find_dialect(files[0], options.csv)
    frames: list[pd.DataFrame] = []
    for file in files:
        frame = _read_one(file, dialect if file == files[0] else find_dialect(file, options.csv))
        if frames:
            _same_form(frames[0], files[0], frame, file)
        frames.append(frame)
    if path.is_dir():
        frames = [_with_place(f, file, path) for f, file in zip(frames, files, strict=True)]
    named = [_with_name(f, file, path, options) for f, file in zip(frames, files, strict=True)]
    return pd.concat(named, ignore_index=True), dialect


def _files(folder: Path) -> list[Path]:
    """Return the text tables under a folder, links that lead out of it left aside.

    Raises BenchError where there is none.
    """
    root = folder.resolve()
    found = [p for p in sorted(folder.rglob("*")) if p.name.endswith(SUFFIXES) and p.is_file()]
    hidden = [p for p in found if any(part[0] == "." for part in p.relative_to(folder).parts)]
    inside = [p for p in found if p not in hidden and p.resolve().is_relative_to(root)]
    if not inside:
        raise BenchError(
            f"{folder}: no text tables; expected files ending in {', '.join(SUFFIXES)}"
        )
    return inside


def _read_one(path: Path, dialect: Dialect) -> pd.DataFrame:
    frame = read_text_table(
        path, dialect.delimiter, dialect.decimal, dialect.encoding, dialect.skip
    )
    unnamed = [str(c) for c in frame if not str(c).strip()]
    return frame.drop(columns=unnamed)


def _same_form(first: pd.DataFrame, first_file: Path, other: pd.DataFrame, file: Path) -> None:
    """Raise BenchError where two files have different columns."""
    missing = [str(c) for c in first if c not in other]
    extra = [str(c) for c in other if c not in first]
    if missing or extra:
        what = f"no column {missing[0]!r}" if missing else f"a column {extra[0]!r}"
        raise BenchError(
            f"{file}: {what}, unlike {first_file.name}; expected files of one form in a folder"
        )


def _with_place(frame: pd.DataFrame, file: Path, root: Path) -> pd.DataFrame:
    """Return a file's rows with the columns `file` and `folder`."""
    place = file.relative_to(root)
    without_ending = place.as_posix()[: -len("".join(place.suffixes[-1:]))]
    folder = place.parent.as_posix()
    return frame.assign(**{FILE: without_ending, FOLDER: root.name if folder == "." else folder})


def _with_name(frame: pd.DataFrame, file: Path, path: Path, options: LogOptions) -> pd.DataFrame:
    """Return a file's rows with what its name says. Raises BenchError where it says nothing."""
    if options.from_name is None:
        return frame
    try:
        pattern = re.compile(options.from_name)
    except re.error as problem:
        raise BenchError(
            f"--from-name {options.from_name}: {problem}; expected a regular expression with a "
            "named group, such as (?P<distance>[\\d.]+)m"
        ) from problem
    place = file.relative_to(path) if path.is_dir() else Path(file.name)
    match = pattern.search(place.as_posix())
    if match is None or not match.groupdict():
        raise BenchError(
            f"--from-name {options.from_name}: nothing named found in {place}; expected a regular "
            "expression with a named group, such as (?P<distance>[\\d.]+)m"
        )
    return frame.assign(**match.groupdict())


def _cir_points(frame: pd.DataFrame, dialect: Dialect) -> pd.DataFrame:
    """Return the table with points as decimals in CIR cells that other marks separate."""
    if dialect.decimal != ",":
        return frame
    cells = {
        name: frame[name].str.replace(r"(\d),(?=\d)", r"\1.", regex=True)
        for name in CIR_COLUMNS
        if name in frame and frame[name].astype("str").str.contains(r"[;\s|]\s*\S").any()
    }
    return frame.assign(**cells)
