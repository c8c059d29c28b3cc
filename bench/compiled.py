"""Loops as machine code, made by numba when first run."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from typing import Any

ANY_ORDER = {"reassoc", "contract", "nsz"}  # of sums; NaN keeps its meaning


@cache  # few loops; one that goes is read again at every call
def compiled(loop: Callable[..., None], finite: bool = False) -> Callable[..., None]:
    """Return a loop as machine code that lets other threads run.

    Sums are made in any order. `finite`: values are never NaN, which makes it faster.
    """
    import numba

    how: dict[str, Any] = {"nogil": True, "fastmath": True if finite else ANY_ORDER}
    made: Callable[..., None]
    try:
        made = numba.njit(cache=True, **how)(loop)
    except RuntimeError:  # nowhere to keep the machine code: compile it in every process
        made = numba.njit(**how)(loop)
    return made
