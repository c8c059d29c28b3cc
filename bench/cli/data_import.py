"""What `bench data import` does and prints."""

from __future__ import annotations

import json
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from bench.cli.console import say
from bench.errors import BenchError
from bench.text import named

if TYPE_CHECKING:
    from bench.recordings.logs.read import Imported, LogOptions


def import_one(source: str, out: Path, options: LogOptions) -> Imported:
    """Read a data set, recordings file, log or folder of logs and write it as Parquet.

    Raises BenchError for bad input, and log options with what is no log.
    """
    from bench.recordings.io import PARQUET_SUFFIXES, write_recordings
    from bench.recordings.logs.read import Imported, LogOptions, is_logs, read_logs
    from bench.recordings.open import is_path, open_recordings

    if out.suffix not in PARQUET_SUFFIXES:
        raise BenchError(f"{out}: recordings are written as Parquet; expected a .parquet name")
    if (is_path(source) or Path(source).is_dir()) and is_logs(Path(source)):
        imported = read_logs(Path(source), options)
    elif options != LogOptions():
        raise BenchError(
            f"{source}: --map, --csv, --link, --link-by and --from-name are for text tables and "
            "folders of them"
        )
    else:
        imported = Imported(open_recordings(source)[0])
    write_recordings(imported.recordings, out)
    return imported


def print_imported(imported: Imported, out: Path, as_json: bool) -> None:
    """Print what was written, how it was read, and on stderr what looks wrong."""
    for line in imported.warnings:
        say(f"warning: {named(line)}", err=True)
    if as_json:
        say(json.dumps(_summary(imported, out), indent=1))
        return
    from bench.recordings.clean import describe

    recordings = imported.recordings
    for line in imported.notes:
        say(f"  {named(line)}")
    dropped = f"; dropped: {describe(recordings.dropped)}" if recordings.dropped else ""
    say(f"{named(out)}: {len(recordings)} rows of {named(recordings.label)}{dropped}")
    links = recordings.frame["link"].nunique() if "link" in recordings.frame else "no"
    mae_m = np.abs(recordings.errors_m()).mean()
    say(f"  {links} links, mean |range error| {mae_m:.3f} m")


def _summary(imported: Imported, out: Path) -> dict[str, object]:
    recordings = imported.recordings
    return {
        "out": str(out),
        "rows": len(recordings),
        "links": int(recordings.frame["link"].nunique()) if "link" in recordings.frame else None,
        "mae_m": float(np.abs(recordings.errors_m()).mean()),
        "columns": [str(column) for column in recordings.frame.columns],
        "dropped": dict(recordings.dropped),
        "notes": imported.notes,
        "warnings": imported.warnings,
    }
