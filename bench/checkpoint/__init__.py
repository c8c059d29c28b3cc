"""What lets a stopped diagnosis go on: a journal of finished steps, as plain JSON."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.checkpoint.journal import Journal as Journal
    from bench.checkpoint.journal import Kept as Kept

_HOMES = {
    "Journal": "bench.checkpoint.journal",
    "Kept": "bench.checkpoint.journal",
}
__all__ = list(_HOMES)
__getattr__ = lazily(__name__, _HOMES)
