"""Recordings: the exchange table, its readers, windows and splits by link."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.recordings.io import read_recordings as read_recordings
    from bench.recordings.io import write_recordings as write_recordings
    from bench.recordings.open import open_recordings as open_recordings
    from bench.recordings.open import read as read
    from bench.recordings.table import Recordings as Recordings

_HOMES = {
    "Recordings": "bench.recordings.table",
    "open_recordings": "bench.recordings.open",
    "read": "bench.recordings.open",
    "read_recordings": "bench.recordings.io",
    "write_recordings": "bench.recordings.io",
}
__all__ = list(_HOMES)
__getattr__ = lazily(__name__, _HOMES)
