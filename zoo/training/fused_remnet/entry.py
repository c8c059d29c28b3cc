"""The one function Python calls in the fused kernels, compiled once and kept on disk."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba

from zoo.training.fused_remnet.steps import Data, Network, Settings, lead

Run = Callable[[Network, Data, Settings, int, bool], float]
_njit: Any = numba.njit  # numba's own types change from version to version


@cache
def entry() -> Run:
    """Return `run(network, data, settings, steps_done, learn)`, which holds no Python lock.

    It returns the summed absolute error in metres; without `learn` weights stay and the last
    batch's gradient is left in `network.grads`.
    """
    # numba's disk cache watches this file only: the closure puts every source into its key
    fingerprint = _source_fingerprint()

    def run(network: Network, data: Data, settings: Settings, done: int, learn: bool) -> float:
        fingerprint  # noqa: B018
        return lead(network, data, settings, done, learn)

    return _compiled(run)


def _source_fingerprint() -> str:
    files = sorted(Path(__file__).parent.glob("*.py"))
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _compiled(run: Run) -> Run:
    compiled: Run
    try:
        compiled = _njit(run, nogil=True, cache=True)
    except RuntimeError:  # no folder to cache in can be written
        compiled = _njit(run, nogil=True)
    return compiled
