"""Keeping a slowly parsed data set as Parquet, so that it is parsed once.

The cached file's name is a hash of everything its content follows from: the bytes of every file
read, the code that reads them and the versions of the libraries that code uses. Change any of them
and the file is not found; damage it and it is not read.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable
from pathlib import Path

from bench.errors import BenchError
from bench.files import cache_dir
from bench.provenance import file_sha256, json_digest, modules_code_hash, package_version
from bench.recordings.clean import Cleaned
from bench.recordings.io import read_recordings, write_recordings
from bench.recordings.sources.base import Source
from bench.recordings.table import Recordings

_LIBRARIES = ("numpy", "pandas", "pyarrow")


def cached(
    source: Source, files: Iterable[Path], modules: Iterable[str], build: Callable[[], Cleaned]
) -> Recordings:
    """Return what `build()` gave for these very files and this very code, building it if need be.

    `modules` are the dotted names of the modules that do the reading. Where the cache cannot be
    written the built recordings are returned all the same.
    """
    target = cache_dir() / "parsed" / f"{source.name}-{_key(files, modules)}.parquet"
    if target.exists():
        try:
            return read_recordings(target)
        except BenchError:
            target.unlink(missing_ok=True)
    read = build()
    recordings = Recordings(read.frame, source.name, source.licence, dropped=read.dropped)
    try:
        write_recordings(recordings, target)
    except BenchError:
        return recordings
    return read_recordings(target)


def _key(files: Iterable[Path], modules: Iterable[str]) -> str:
    """Return 20 hex digits that change with any input file, module or library version."""
    read = [[path.name, file_sha256(path)] for path in sorted(files)]
    versions = {library: package_version(library) for library in _LIBRARIES}
    return json_digest([read, modules_code_hash(modules), versions])
