"""How much of this machine others use, and waiting until it is little.

Counted is the processor time of the cores this process may use, less what this process and its
children took of it (`psutil`, from the kernel's own counters). A core that other work keeps busy
slows a measurement on the core beside it (shared caches, shared frequency, two threads of one
core), and nothing inside the measurement shows by how much.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass

import psutil

WINDOW_S = 0.5  # the counters tick in hundredths of a second: shorter spans say little
POLL_S = 0.5
FEW_CORES, SHARE = 0.25, 0.125  # others may use a quarter of a core, or an eighth of many cores
Tell = Callable[[str], None]


@dataclass(frozen=True)
class Reading:
    """The counters at one moment, in seconds: the clock, all work on our cores, our own work."""

    at_s: float
    busy_s: float
    own_s: float


# Where the system keeps no account of ended children, their work passes for others'.
OWN_TIMES = ("user", "system", "children_user", "children_system")


class Load:
    """Tells how many cores others used since it was last asked."""

    def __init__(self) -> None:
        self.cores = _our_cores()
        self._last = self._read()

    @property
    def limit(self) -> float:
        """Cores that others may use before a measurement is taken for disturbed."""
        return max(FEW_CORES, SHARE * len(self.cores))

    def due(self) -> bool:
        """Return whether enough time has passed since the last answer for another one."""
        return time.monotonic() - self._last.at_s >= WINDOW_S

    def others(self) -> float:
        """Return the cores others used on average since the last call (or the beginning)."""
        now, before = self._read(), self._last
        self._last = now
        passed = max(now.at_s - before.at_s, 1e-3)
        return max(0.0, (now.busy_s - before.busy_s) - (now.own_s - before.own_s)) / passed

    def _read(self) -> Reading:
        return Reading(time.monotonic(), _busy_s(self.cores), _own_s())


class Patience:
    """Waits for a quiet machine, in all at most `seconds`; `tell` hears what it waits for."""

    def __init__(self, seconds: float, tell: Tell | None = None) -> None:
        self._end, self._tell = time.monotonic() + seconds, tell

    @property
    def left(self) -> bool:
        """True while there is time left."""
        return time.monotonic() < self._end

    def await_quiet(self, load: Load) -> None:
        """Return when others use little of the machine, or when the time is over."""
        load.others()
        while self.left:
            time.sleep(POLL_S)
            used = load.others()
            if used <= load.limit:
                return
            if self._tell:
                cores = len(load.cores)
                self._tell(f"waiting for a quiet machine (others use {used:.1f} of {cores} cores)")


def _our_cores() -> list[int]:
    """Return the cores this process may use; all of them where the system does not say."""
    try:
        return list(psutil.Process().cpu_affinity())
    except (AttributeError, OSError, psutil.Error):
        return list(range(psutil.cpu_count() or 1))


def _busy_s(cores: list[int]) -> float:
    """Return seconds of work on the cores since the machine started, stolen time included."""
    every = psutil.cpu_times(percpu=True)
    idle = ("idle", "iowait", "guest", "guest_nice")  # guests are counted under user already
    return float(
        sum(
            value
            for core in cores
            if core < len(every)
            for name, value in every[core]._asdict().items()
            if name not in idle
        )
    )


def _own_s() -> float:
    """Return seconds of work of this process and its children, those that have ended included."""
    total = 0.0
    me = psutil.Process()
    for process in (me, *me.children(recursive=True)):
        with suppress(psutil.Error):
            used = process.cpu_times()._asdict()
            total += sum(used.get(name, 0.0) for name in OWN_TIMES)
    return total
