"""Reading one result file: only a regular one, of sane size, unedited since it was written."""

from __future__ import annotations

import hashlib
import json
import os
import stat
from pathlib import Path
from typing import Any

SCHEMA_VERSION = 2
MAX_FILE_BYTES = 64_000_000  # a record with raw samples takes well under one megabyte
SEAL = "content_sha256"


def believed(path: Path, version: int = SCHEMA_VERSION) -> dict[str, Any]:
    """Return a file's JSON object. Raises ValueError or OSError where it is not to be believed.

    It must be of that schema version, and hash to the hash it holds.
    """
    try:
        content = json.loads(_read(path))
    except ValueError as problem:
        raise ValueError(f"not JSON: {problem}") from problem
    if not isinstance(content, dict):
        raise ValueError("not a JSON object")
    if content.get("schema_version") != version:
        found = content.get("schema_version")
        raise ValueError(f"schema_version {found!r}, expected {version}")
    if content.pop(SEAL, None) != digest(content):
        raise ValueError("its content was edited or damaged since it was written")
    return content


def digest(content: Any) -> str:
    """Return the SHA-256 of plain data as JSON with sorted keys, in hex."""
    return hashlib.sha256(json.dumps(content, sort_keys=True).encode()).hexdigest()


def _read(path: Path) -> bytes:
    """Return a file's bytes; a pipe or a device is refused before a byte of it is read."""
    descriptor = os.open(path, os.O_RDONLY | getattr(os, "O_NONBLOCK", 0))
    with os.fdopen(descriptor, "rb") as stream:
        found = os.fstat(stream.fileno())
        if not stat.S_ISREG(found.st_mode):
            raise OSError("not a regular file")
        if found.st_size > MAX_FILE_BYTES:
            raise OSError(f"larger than {MAX_FILE_BYTES} bytes")
        return stream.read()
