"""Loops as machine code, made by numba when first run."""

from __future__ import annotations

from collections.abc import Callable
from functools import cache

ANY_ORDER = {"reassoc", "contract", "nsz"}  # of sums; NaN keeps its meaning


@cache  # few loops; one that goes is read again at every call
def compiled(loop: Callable[..., None]) -> Callable[..., None]:
    """Return a loop as machine code that lets other threads run."""
    import numba

    made: Callable[..., None]
    try:
        made = numba.njit(nogil=True, cache=True, fastmath=ANY_ORDER)(loop)
    except RuntimeError:  # nowhere to keep the machine code: compile it in every process
        made = numba.njit(nogil=True, fastmath=ANY_ORDER)(loop)
    return made
