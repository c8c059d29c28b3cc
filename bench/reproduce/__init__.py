"""Every table and figure of the paper on any recordings, with the paper's number beside ours."""

from __future__ import annotations

from typing import TYPE_CHECKING

from bench.lazy import lazily

if TYPE_CHECKING:
    from bench.reproduce.api import Reproduction as Reproduction
    from bench.reproduce.api import reproduce as reproduce
    from bench.reproduce.catalogue import Experiment as Experiment
    from bench.reproduce.context import Context as Context

_HOMES = {
    "Context": "bench.reproduce.context",
    "Experiment": "bench.reproduce.catalogue",
    "Reproduction": "bench.reproduce.api",
    "reproduce": "bench.reproduce.api",
}
__all__ = list(_HOMES)
__getattr__ = lazily(__name__, _HOMES)
