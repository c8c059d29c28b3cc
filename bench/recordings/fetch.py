"""Downloading a data set from its publisher: checked, resumed, never silently unverified.

pooch finds a record's files and checksums through the publisher's own interface (DOI), compares
the checksum before a file gets its name, and skips files that are already here. What it lacks is
resuming: `ResumingDownloader` keeps what has arrived and asks the server only for the rest.
"""

from __future__ import annotations

import hashlib
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

from bench.errors import BenchError
from bench.recordings.sources.base import Source, download_folder

Progress = Callable[[str, int, int | None], None]
"""Called with the file's name, the bytes so far and the bytes in all (None: not known)."""

ATTEMPTS = 3
CHUNK_BYTES = 1 << 16
TIMEOUT_S = 30


@dataclass(frozen=True)
class RemoteFile:
    """One file of a data set: `known_hash` as pooch writes it (`md5:..`), None where unknown."""

    name: str
    url: str
    known_hash: str | None


def fetch(
    source: Source,
    accept_unverified: bool = False,
    sha256: str | None = None,
    progress: Progress | None = None,
) -> list[Path]:
    """Download a data set's files into its folder and unpack archives; return the files.

    A file without a known checksum is only downloaded with `sha256` (one such file) or
    `accept_unverified`. Raises BenchError where there is nothing to fetch, the publisher cannot be
    reached (saying what to download by hand), or a checksum does not match (nothing is left).
    """
    files = _with_hash(source, _remote_files(source), sha256)
    unknown = [file.name for file in files if file.known_hash is None]
    if unknown and not accept_unverified:
        raise BenchError(
            f"{source.name}: no checksum is known for {', '.join(unknown)}; give it with --sha256, "
            "or say --accept-unverified to download without a check"
        )
    return [path for file in files for path in _fetch_one(source, file, progress)]


def by_hand(source: Source) -> str:
    """Return what to download by hand and where to put it."""
    page = source.publisher.page if source.publisher else "its publisher"
    return f"download it by hand from {page} and put the files in {download_folder(source.name)}"


def _remote_files(source: Source) -> list[RemoteFile]:
    """Return the files of a data set with the publisher's checksums."""
    publisher = source.publisher
    if publisher is None:
        raise BenchError(f"{source.name}: nothing to fetch, it is made on this machine")
    if publisher.doi:
        return _record_files(source, publisher.doi, publisher.hashes)
    if not publisher.urls:
        raise BenchError(f"{source.name}: no direct download is known; {by_hand(source)}")
    return [RemoteFile(_safe(n), url, publisher.hashes.get(n)) for n, url in publisher.urls.items()]


def _record_files(source: Source, doi: str, hashes: Mapping[str, str]) -> list[RemoteFile]:
    """Return the files of a record by DOI, as its repository lists them."""
    import pooch
    from pooch.downloaders import doi_to_repository

    try:
        repository = doi_to_repository(doi, timeout=TIMEOUT_S)
        registry = pooch.create(download_folder(source.name), f"doi:{doi}/")
        repository.populate_registry(registry)
        found = dict(registry.registry)
        urls = {name: repository.download_url(name) for name in found}
    except (
        Exception
    ) as problem:  # pooch lets through whatever the network or the server's answer is
        raise _unreachable(source, problem) from problem
    return [RemoteFile(_safe(n), url, hashes.get(n) or found[n]) for n, url in urls.items()]


def _unreachable(source: Source, problem: Exception) -> BenchError:
    """Return the error for a publisher that cannot be reached, saying what to do by hand."""
    kind = type(problem).__name__
    return BenchError(f"{source.name}: the publisher cannot be reached ({kind}); {by_hand(source)}")


def _safe(name: str) -> str:
    """Return a file name from elsewhere. Raises BenchError where it leads out of the folder."""
    if name != Path(name).name or name.startswith(".") or "\\" in name or not name.isprintable():
        raise BenchError(f"the publisher lists a file called {name!r}; expected a plain file name")
    return name


def _with_hash(source: Source, files: list[RemoteFile], sha256: str | None) -> list[RemoteFile]:
    """Return the files with the user's checksum on the one whose checksum is not known."""
    if sha256 is None:
        return files
    digits = sha256.lower().removeprefix("sha256:")
    if len(digits) != 64 or not set(digits) <= set("0123456789abcdef"):
        raise BenchError(f"--sha256 {sha256}: expected 64 hexadecimal digits")
    unknown = [file for file in files if file.known_hash is None] or files
    if len(unknown) != 1:
        names = ", ".join(file.name for file in unknown)
        raise BenchError(f"{source.name}: --sha256 is for one file, but there are: {names}")
    given = replace(unknown[0], known_hash=f"sha256:{digits}")
    return [given if file is unknown[0] else file for file in files]


def _fetch_one(source: Source, file: RemoteFile, progress: Progress | None) -> list[Path]:
    """Download and, where it is an archive, unpack one file."""
    import pooch
    import requests

    pooch.get_logger().setLevel("WARNING")
    folder = download_folder(source.name)
    unpack = pooch.Unzip(extract_dir=Path(file.name).stem) if file.name.endswith(".zip") else None
    registry = pooch.create(
        folder, "", registry={file.name: file.known_hash}, urls={file.name: file.url}
    )
    downloader = ResumingDownloader(folder, file, progress)
    try:
        got = registry.fetch(file.name, processor=unpack, downloader=downloader)
    except requests.RequestException as problem:
        raise _unreachable(source, problem) from problem
    except ValueError as problem:
        raise BenchError(
            f"{source.name}: {file.name} does not have the checksum {file.known_hash}; it was "
            "deleted. Try again, or tell the publisher"
        ) from problem
    except (OSError, BadZipFile) as problem:
        raise BenchError(f"cannot write {folder / file.name}: {problem}") from problem
    return [Path(name) for name in (got if isinstance(got, list) else [got])]


class ResumingDownloader:
    """Downloads over HTTP into a partial file that survives interruption; pooch calls it.

    A partial file is only continued where a checksum is known, which then proves the whole.
    """

    def __init__(self, folder: Path, file: RemoteFile, progress: Progress | None) -> None:
        digest = hashlib.sha256(f"{file.url} {file.known_hash}".encode()).hexdigest()[:12]
        self.partial = folder / f".{file.name}.{digest}.partial"
        self._file = file
        self._progress = progress

    def __call__(self, url: str, output_file: str, pooch: Any) -> None:
        """Download `url` to `output_file`, continuing what an earlier call left behind."""
        from requests import exceptions

        if self._file.known_hash is None:
            self.partial.unlink(missing_ok=True)
        broken = (exceptions.ConnectionError, exceptions.Timeout, exceptions.ChunkedEncodingError)
        for attempt in range(1, ATTEMPTS + 1):
            try:
                self._download(url)
                break
            except broken:
                if attempt == ATTEMPTS:
                    raise
        self.partial.replace(output_file)

    def _download(self, url: str) -> None:
        """Ask for what is missing and append it. Raises ConnectionError where it stays short."""
        import requests

        have = self.partial.stat().st_size if self.partial.exists() else 0
        headers = {"Accept-Encoding": "identity"} | ({"Range": f"bytes={have}-"} if have else {})
        with requests.get(url, headers=headers, stream=True, timeout=TIMEOUT_S) as answer:
            if answer.status_code == requests.codes.requested_range_not_satisfiable:
                return self._all_here(url, have, answer.headers)
            answer.raise_for_status()
            continued = answer.status_code == requests.codes.partial_content
            total = self._append(answer, have if continued else 0)
        if total is not None and self.partial.stat().st_size < total:
            raise requests.ConnectionError("the connection ended early")
        return None

    def _append(self, answer: Any, start: int) -> int | None:
        """Write the answer behind the first `start` bytes; return the size in all, if known."""
        length = answer.headers.get("Content-Length")
        total = start + int(length) if length else None
        with self.partial.open("ab" if start else "wb") as file:
            for chunk in answer.iter_content(CHUNK_BYTES):
                file.write(chunk)
                if self._progress:
                    self._progress(self._file.name, file.tell(), total)
        return total

    def _all_here(self, url: str, have: int, headers: Mapping[str, str]) -> None:
        """Accept a partial file that is complete; start over where it is not what is offered."""
        total = headers.get("Content-Range", "").rpartition("/")[2]
        if total != str(have):
            self.partial.unlink()
            self._download(url)
