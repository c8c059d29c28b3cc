"""The result folder: runs, timings, artifacts and predictions, each written in one step."""

from __future__ import annotations

import json
import os
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from bench.errors import BenchError
from bench.files import write_atomically
from bench.provenance import file_sha256
from bench.results import SCHEMA_VERSION, RunRecord, TimingRecord, from_json, to_json

Record = TypeVar("Record", RunRecord, TimingRecord)


@dataclass(frozen=True)
class ResultFolder:
    """`runs/*.json`, `timings/*.json`, `artifacts/*.onnx`, `predictions/*.parquet` under `root`."""

    root: Path

    def check_writable(self) -> None:
        """Raise BenchError before any work is done where nothing could be written."""
        place = self.root
        while not place.exists():
            place = place.parent
        if not place.is_dir():
            raise BenchError(f"--out {self.root}: {place} is a file, expected a folder")
        if not os.access(place, os.W_OK | os.X_OK):
            raise BenchError(f"--out {self.root}: {place} is read-only, expected a writable folder")

    def artifact_path(self, digest: str, fold: int) -> Path:
        """Return where the model file of one run and fold belongs."""
        return self.root / "artifacts" / f"{digest}-{fold}.onnx"

    def predictions_path(self, digest: str) -> Path:
        """Return where the per-row predictions of a run belong."""
        return self.root / "predictions" / f"{digest}.parquet"

    def find_run(self, digest: str) -> RunRecord | None:
        """Return a finished run whose artifact is still there unchanged, else None."""
        record = self._read(self.root / "runs" / f"{digest}.json", RunRecord)
        if record is None or record.status == "skipped":
            return record
        artifact = self.root / (record.artifact or "")
        whole = artifact.is_file() and file_sha256(artifact) == record.artifact_sha256
        return record if whole else None

    def write_run(self, record: RunRecord) -> None:
        """Write a run under its key's hash."""
        write_atomically(self.root / "runs" / f"{record.key.digest()}.json", to_json(record))

    def find_timing(self, digest: str) -> TimingRecord | None:
        """Return the timing of that digest, else None."""
        return self._read(self.root / "timings" / f"{digest}.json", TimingRecord)

    def write_timing(self, digest: str, record: TimingRecord) -> None:
        """Write a timing under its digest."""
        write_atomically(self.root / "timings" / f"{digest}.json", to_json(record))

    @staticmethod
    def _read(path: Path, kind: type[Record]) -> Record | None:
        """Return the record in a file, or None where it is absent, damaged or of another schema."""
        try:
            content: Mapping[str, Any] = json.loads(path.read_text(encoding="utf-8"))
            if content["schema_version"] != SCHEMA_VERSION:
                return None
            return from_json(kind, content)
        except (OSError, ValueError, KeyError, TypeError):
            return None
