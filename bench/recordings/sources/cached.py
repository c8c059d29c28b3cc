"""Keeping a slowly parsed data set as Parquet, so that it is parsed once.

The cached file's name is a hash of everything its content follows from: the bytes of every file
read, the code that reads them and the versions of the libraries that code uses. Change any of them
and the file is not found; damage it and it is not read.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Iterable
from importlib.metadata import version
from importlib.util import find_spec
from pathlib import Path

from bench.errors import BenchError
from bench.files import cache_dir
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
    digest = hashlib.sha256()
    for path in [*sorted(files), *map(_source_of, sorted(modules))]:
        digest.update(path.name.encode() + b"\0")
        with path.open("rb") as file:
            digest.update(hashlib.file_digest(file, "sha256").digest())
    for library in _LIBRARIES:
        digest.update(f"{library} {version(library)}\0".encode())
    return digest.hexdigest()[:20]


def _source_of(module: str) -> Path:
    """Return the file of a module."""
    spec = find_spec(module)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(module)
    return Path(spec.origin)
