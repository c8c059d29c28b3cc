"""Threads that share the pieces of a batch inside compiled code, without a barrier.

The leader opens tickets, one per piece; whoever is free takes the next, leader included; the
leader goes on when all are done. So a helper that the system keeps waiting costs nothing but
its own piece, several teams may run at once, and no thread-pool library decides how to wait.
"""

from __future__ import annotations

import os
from typing import Any

from llvmlite import ir  # type: ignore[import-untyped]

from zoo.training.fused_remnet.vector import call, inlined, operation, types

# the int64 counters of one team, each on a cache line of its own
OPENED, TAKEN, DONE, CLOSED, COUNTERS = 0, 8, 16, 24, 32
_SPINS_BEFORE_YIELD = 200


def _read(builder: Any, counters: Any, index: Any) -> Any:
    return builder.load_atomic(builder.gep(counters, [index]), "seq_cst", 8)


def _add(builder: Any, counters: Any, index: Any, count: Any) -> Any:
    return builder.atomic_rmw("add", builder.gep(counters, [index]), count, "seq_cst")


def _swap(builder: Any, counters: Any, index: Any, old: Any, new: Any) -> Any:
    pair = builder.cmpxchg(builder.gep(counters, [index]), old, new, "seq_cst", "seq_cst")
    return builder.extract_value(pair, 1)


def _yield(builder: Any) -> None:
    if os.name == "posix":  # elsewhere a waiting thread spins on
        call(builder, "sched_yield", ir.IntType(32))


_counters, _index, _count = types.CPointer(types.int64), types.intp, types.int64
# all four atomic and in one order for all threads
_read_counter = operation(_read, _count, _counters, _index)
_add_to = operation(_add, _count, _counters, _index, _count)
# counters[index] = new if it is old; says whether it was
_swap_if = operation(_swap, types.boolean, _counters, _index, _count, _count)
_let_others_run = operation(_yield, types.none)


@inlined
def open_tickets(counters: Any, count: int) -> None:
    """Let `count` more pieces be taken."""
    _add_to(counters, OPENED, count)


@inlined
def take_ticket(counters: Any) -> Any:
    """Return the number of the piece to do next, or -1 if none is open."""
    while True:
        ticket = _read_counter(counters, TAKEN)
        if ticket >= _read_counter(counters, OPENED):
            return -1
        if _swap_if(counters, TAKEN, ticket, ticket + 1):
            return ticket


@inlined
def finish_ticket(counters: Any) -> None:
    """Say that a piece taken is done; what was written for it can be read from here on."""
    _add_to(counters, DONE, 1)


@inlined
def close(counters: Any) -> None:
    """Send the helpers home."""
    _add_to(counters, CLOSED, 1)


@inlined
def closed(counters: Any) -> Any:
    """Whether the leader has closed."""
    return _read_counter(counters, CLOSED) > 0


@inlined
def all_done(counters: Any) -> Any:
    """Whether every open piece is done."""
    return _read_counter(counters, DONE) >= _read_counter(counters, OPENED)


@inlined
def wait_a_little(spins: int) -> int:
    """Spin; give way when it takes long. Return the spins so far."""
    if spins >= _SPINS_BEFORE_YIELD:
        _let_others_run()
    return spins + 1
