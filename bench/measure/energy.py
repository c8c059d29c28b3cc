"""Energy of one call measured by the machine's own counters, where it has any.

Intel and AMD processors count the energy of the package (RAPL: Intel SDM volume 3B, section
"Platform specific power management support"); Linux shows the counters under
/sys/class/powercap. Other machines get a `NoMeter` that says why.
"""

from __future__ import annotations

import time
from abc import ABC, abstractmethod
from collections.abc import Callable, Iterator
from contextlib import suppress
from pathlib import Path

import numpy as np

from bench.results import Interval

POWERCAP = Path("/sys/class/powercap")
BURSTS = 6  # the fewest whose extremes enclose their median with 95 % confidence
BURST_S = 0.2  # two hundred updates of the counters
Burst = Callable[[float], int]
"""Runs calls for about that many seconds; returns how many."""


class EnergyMeter(ABC):
    """Reads the energy this machine has used. `how` says what is measured, or why nothing is.

    >>> class Bench(EnergyMeter):
    ...     how = "laboratory supply"
    ...     def read_mj(self) -> float | None:
    ...         return supply.energy_mj()
    """

    how: str

    @abstractmethod
    def read_mj(self) -> float | None:
        """Return millijoules used since some fixed moment, or None where it cannot be known."""


class NoMeter(EnergyMeter):
    """Measures nothing and says why."""

    def __init__(self, why: str) -> None:
        self.how = f"not measured: {why}"

    def read_mj(self) -> float | None:
        """Return None."""
        return None


class Rapl(EnergyMeter):
    """The package counters of RAPL, summed over packages. They wrap; the wraps are added up.

    Units: microjoules in sysfs, millijoules here. Resolution 15 to 61 uJ, updated about every
    millisecond, so only stretches of many milliseconds mean anything. Covers the whole package:
    other processes are in it, and the idle power that `energy_per_call` takes off.
    """

    how = "measured: RAPL package energy above idle, batch 1"

    def __init__(self, zones: list[Path]) -> None:
        self._zones = zones
        self._spans = [int((zone / "max_energy_range_uj").read_text()) for zone in zones]
        self._last = self._raw()
        self._total_uj = 0

    def read_mj(self) -> float | None:
        """Return millijoules since this object was made."""
        now = self._raw()
        for old, new, span in zip(self._last, now, self._spans, strict=True):
            self._total_uj += (new - old) % (span + 1)
        self._last = now
        return self._total_uj / 1000

    def _raw(self) -> list[int]:
        return [int((zone / "energy_uj").read_text()) for zone in self._zones]


def host_meter(root: Path = POWERCAP) -> EnergyMeter:
    """Return the meter of this machine, or the `NoMeter` that says why it has none."""
    zones = list(_packages(root))
    if not zones:
        return NoMeter("no RAPL counters on this machine")
    try:
        return Rapl(zones)
    except PermissionError:
        return NoMeter(f"RAPL counters need root: sudo chmod a+r {root}/*/energy_uj")
    except (OSError, ValueError) as problem:
        return NoMeter(f"RAPL counters cannot be read: {problem}")


def energy_per_call(meter: EnergyMeter, burst: Burst, burst_s: float = BURST_S) -> Interval | None:
    """Return millijoules per call above idle, or None where the meter cannot tell.

    Six times: an idle stretch, then a burst of calls just as long; (burst - idle energy) / calls.
    The value is the median, the interval the extremes, which enclose it with 97 % confidence.
    """
    if meter.read_mj() is None:
        return None
    each = [_one_burst(meter, burst, burst_s) for _ in range(BURSTS)]
    return Interval(float(np.median(each)), min(each), max(each))


def _one_burst(meter: EnergyMeter, burst: Burst, burst_s: float) -> float:
    idle_mw = _power_mw(meter, lambda: time.sleep(burst_s))
    before, start = meter.read_mj() or 0.0, time.perf_counter()
    calls = burst(burst_s)
    seconds = time.perf_counter() - start
    return ((meter.read_mj() or 0.0) - before - idle_mw * seconds) / calls


def _power_mw(meter: EnergyMeter, work: Callable[[], None]) -> float:
    """Return milliwatts while `work` runs."""
    before, start = meter.read_mj() or 0.0, time.perf_counter()
    work()
    return ((meter.read_mj() or 0.0) - before) / (time.perf_counter() - start)


def _packages(root: Path) -> Iterator[Path]:
    """Yield the zones named package-N (not their parts, which they include)."""
    for zone in sorted(root.glob("intel-rapl:*")):
        with suppress(OSError):
            if (zone / "name").read_text().strip().startswith("package"):
                yield zone
