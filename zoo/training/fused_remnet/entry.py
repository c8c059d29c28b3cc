"""The one function Python calls in the fused kernels, compiled once and kept on disk."""

from __future__ import annotations

import hashlib
from collections.abc import Callable
from functools import cache
from pathlib import Path
from typing import Any

import numba

from zoo.training.fused_remnet.steps import HELP, Data, Network, Recipe, help_out, lead

Run = Callable[[Network, Data, Recipe, int, int], float]
_njit: Any = numba.njit  # numba's own types change from version to version


@cache
def entry() -> Run:
    """Return `run(network, data, recipe, steps_done, role)`, which holds no Python lock.

    `role` is LEAD, HELP or GRADIENT: one function, so that the kernels below it are compiled
    once. It returns the summed absolute error in metres (0 from a helper). The counters must be
    zero before; then any number of helpers may run beside the leader.
    """
    # numba's disk cache watches this file only: the closure puts every source into its key
    fingerprint = _source_fingerprint()

    def run(network: Network, data: Data, recipe: Recipe, steps_done: int, role: int) -> float:
        fingerprint  # noqa: B018
        if role == HELP:
            help_out(network, data, recipe, role)
            return 0.0
        return lead(network, data, recipe, steps_done, role)

    return _compiled(run)


def _source_fingerprint() -> str:
    files = sorted(Path(__file__).parent.glob("fast_remnet*.py"))
    return hashlib.sha256(b"".join(file.read_bytes() for file in files)).hexdigest()


def _compiled(run: Run) -> Run:
    compiled: Run
    try:
        compiled = _njit(run, nogil=True, cache=True)
    except RuntimeError:  # no folder to cache in can be written
        compiled = _njit(run, nogil=True)
    return compiled
