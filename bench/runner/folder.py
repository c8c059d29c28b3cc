"""The result folder: runs, timings, artifacts and predictions, each written in one step.

Nothing in it is believed that is not what its key and its hashes say.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TypeVar

from bench.errors import BenchError
from bench.files import is_regular, read_json, remove_leftovers, write_atomically
from bench.provenance import file_sha256, json_digest
from bench.results import CountRecord, RunKey, RunRecord, TimingRecord, from_json, to_json

Record = TypeVar("Record", RunRecord, TimingRecord, CountRecord)
Tell = Callable[[str], None]
_PARTS = ("runs", "timings", "counts", "artifacts", "predictions")


@dataclass(frozen=True)
class ResultFolder:
    """Under `root`: runs, timings and counts (.json), artifacts (.onnx), predictions (.parquet)."""

    root: Path

    def check_writable(self) -> None:
        """Raise BenchError before any work is done where nothing could be written.

        What a killed run left half-written is removed.
        """
        place = self.root
        while not _is_there(place):
            place = place.parent
        if not place.is_dir():
            raise BenchError(f"--out {self.root}: {place} is a file, expected a folder")
        if not os.access(place, os.W_OK | os.X_OK):
            raise BenchError(f"--out {self.root}: {place} is read-only, expected a writable folder")
        for part in _PARTS:
            remove_leftovers(self.root / part)

    def artifact_path(self, digest: str, fold: int) -> Path:
        """Return where the model file of one run and fold belongs."""
        return self.root / "artifacts" / f"{digest}-{fold}.onnx"

    def predictions_path(self, digest: str) -> Path:
        """Return where the per-row predictions of a run belong."""
        return self.root / "predictions" / f"{digest}.parquet"

    def find_run(self, key: RunKey, tell: Tell = lambda _: None) -> RunRecord | None:
        """Return the finished run of a key with every file that belongs to it unchanged, else None.

        `tell` hears, by name, what is there and cannot be believed.
        """
        path = self.root / "runs" / f"{key.digest()}.json"
        record = self._read(path, RunRecord, tell)
        if record is None:
            return None
        for fault in self._faults(record, key):
            tell(f"{path}: {fault}; it is made again")
            return None
        return record

    def write_run(self, record: RunRecord) -> None:
        """Write a run under its key's hash."""
        write_atomically(self.root / "runs" / f"{record.digest()}.json", to_json(record))

    def find_timing(self, like: TimingRecord, tell: Tell = lambda _: None) -> TimingRecord | None:
        """Return the timing of the same artifact on the same machine, else None."""
        path = self.root / "timings" / f"{like.digest()}.json"
        record = self._read(path, TimingRecord, tell)
        if record is None or record.digest() == like.digest():
            return record
        tell(f"{path}: it is the timing of something else; it is made again")
        return None

    def write_timing(self, record: TimingRecord) -> None:
        """Write a timing under its digest."""
        write_atomically(self.root / "timings" / f"{record.digest()}.json", to_json(record))

    def find_count(
        self, artifact_sha256: str, core: str, tell: Tell = lambda _: None
    ) -> CountRecord | None:
        """Return the count of an artifact on a core, else None."""
        path = self._count_path(json_digest([artifact_sha256, core]))
        record = self._read(path, CountRecord, tell)
        if record is None or (record.artifact_sha256, record.core) == (artifact_sha256, core):
            return record
        tell(f"{path}: it is the count of something else; it is made again")
        return None

    def write_count(self, record: CountRecord) -> None:
        """Write a count under its digest."""
        write_atomically(self._count_path(record.digest()), to_json(record))

    def _count_path(self, digest: str) -> Path:
        return self.root / "counts" / f"{digest}.json"

    def _faults(self, record: RunRecord, key: RunKey) -> Iterator[str]:
        """Yield what does not fit: another key, a file that is gone or not what it was."""
        wanted = asdict(key)
        for name, found in asdict(record.key).items():
            if found != wanted[name]:
                yield f"it is of another run: {name} is {found!r}, expected {wanted[name]!r}"
        if record.simulated != key.simulated:
            yield "its mark for simulated data is not that of its key"
        if record.status == "ok":
            yield from self._damaged(record)

    def _damaged(self, record: RunRecord) -> Iterator[str]:
        digest = record.digest()
        folds = enumerate(record.artifacts_sha256)
        files = [(self.artifact_path(digest, fold), expected) for fold, expected in folds]
        files.append((self.predictions_path(digest), str(record.predictions_sha256)))
        for path, expected in files:
            if not is_regular(path):
                yield f"{path} is missing"
            elif file_sha256(path) != expected:
                yield f"{path} is damaged"
        if record.artifacts_sha256[:1] != (record.artifact_sha256,):
            yield "it names no artifact"

    @staticmethod
    def _read(path: Path, kind: type[Record], tell: Tell) -> Record | None:
        """Return the record in a file; None where there is none, or none that can be believed."""
        if not _is_there(path):
            return None
        try:
            return from_json(kind, read_json(path))
        except (BenchError, ValueError) as problem:
            said = str(problem).removeprefix(f"{path}: ")
            tell(f"{path}: {said}; it is made again")
            return None


def _is_there(path: Path) -> bool:
    """Return True where anything has that name, a link to nothing too. Raises BenchError."""
    try:
        path.lstat()
    except (FileNotFoundError, NotADirectoryError):
        return False
    except (OSError, ValueError) as problem:
        said = problem.strerror if isinstance(problem, OSError) else problem
        raise BenchError(f"{path}: no name for a file: {said}") from problem
    return True
