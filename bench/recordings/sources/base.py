"""What a named data set is, and where its files are looked for."""

from __future__ import annotations

import os
from abc import ABC, abstractmethod
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar

from bench.errors import BenchError, unknown_name
from bench.files import cache_dir
from bench.plugins import find

if TYPE_CHECKING:
    from bench.recordings.table import Recordings


@dataclass(frozen=True)
class Publisher:
    """Where a data set is published.

    `page` is for people, `doi` lets the repository's own list of files and checksums be asked for,
    `urls` names single files where there is no such list: file name -> address. `hashes` holds the
    checksums that are known beforehand, as pooch writes them (`sha256:..`, `md5:..`).
    """

    page: str
    doi: str | None = None
    urls: Mapping[str, str] = field(default_factory=dict)
    hashes: Mapping[str, str] = field(default_factory=dict)


class Source(ABC):
    """A named data set: `available()` says why it cannot be read, `load()` reads it.

    `test_environment` is the environment that leave-environment-out tests on by default.
    `publisher` is where the files come from, None where there are none to fetch. `variants` are
    other readings of the same files, by name: asked for as `NAME:VARIANT`, they stand in `variant`.
    `untested` says so where the reader never saw a real file. `superseded` data are kept to repeat
    older figures: by name alone, never among all that are here.
    """

    name: ClassVar[str]
    title: ClassVar[str]
    licence: ClassVar[str]
    simulated: ClassVar[bool] = False
    test_environment: ClassVar[str | None] = None
    publisher: ClassVar[Publisher | None] = None
    variants: ClassVar[Mapping[str, str]] = {}
    untested: ClassVar[str | None] = None
    superseded: ClassVar[bool] = False
    variant: str | None = None

    @property
    def full_name(self) -> str:
        """The name as it is asked for: NAME or NAME:VARIANT."""
        return f"{self.name}:{self.variant}" if self.variant else self.name

    @abstractmethod
    def available(self) -> str | None:
        """Return None where the data can be read now, else what is missing and how to get it."""

    @abstractmethod
    def load(self) -> Recordings:
        """Read (or make) the recordings. Raises BenchError where they cannot be had."""

    def kept(self) -> Path | None:
        """Return the one file whose content alone decides `load`, None where there is none."""
        return None


def open_source(name: str) -> Source:
    """Return the data set registered under `name`, in its variant where it is `NAME:VARIANT`.

    Raises BenchError for an unknown name or variant (with a did-you-mean) and a plug-in that is no
    data set.
    """
    name, _, variant = name.partition(":")
    plugin = find("datasets", name)
    source = plugin.make()
    if not isinstance(source, Source):
        raise BenchError(
            f"data set {name!r} of {plugin.distribution} is no bench.recordings Source "
            f"but {type(source).__name__}"
        )
    if variant and variant not in source.variants:
        raise unknown_name(f"variant of {name}", variant, source.variants)
    source.variant = variant or None
    return source


def is_path(name_or_path: str | Path) -> bool:
    """Return whether it is a path: a Path, or anything but a bare word without a dot."""
    path = Path(name_or_path)
    return isinstance(name_or_path, Path) or len(path.parts) != 1 or "." in str(name_or_path)


def data_root() -> Path | None:
    """Return the folder of $BENCH_DATA, or None where it is not set."""
    named = os.environ.get("BENCH_DATA")
    return Path(named) if named else None


def download_folder(name: str) -> Path:
    """Return the folder that `bench data fetch` puts a data set's files in."""
    return cache_dir() / "datasets" / name


def find_file(name: str, wanted: str) -> Path | None:
    """Return the first file or folder called `wanted` of the data set, or None.

    Looked for at any depth under $BENCH_DATA/NAME and then under the download folder.
    """
    return next(iter(find_files(name, wanted)), None)


def find_files(name: str, wanted: str) -> list[Path]:
    """Return all such files or folders of the data set, from the first place that has any."""
    root = data_root()
    folders = [root / name] if root else []
    for folder in [*folders, download_folder(name)]:
        if found := sorted(folder.rglob(wanted), key=lambda path: (len(path.parts), path)):
            return found
    return []


def how_to_get(source: Source, wanted: str) -> str:
    """Return one line: what is missing, where it is published and where to put it."""
    page = source.publisher.page if source.publisher else "its publisher"
    folder = download_folder(source.name)
    return (
        f"{wanted} not found; run `bench data fetch {source.name}`, or download it by hand from "
        f"{page} and put it in {folder} (or in $BENCH_DATA/{source.name})"
    )
