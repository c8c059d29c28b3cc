"""Peak memory of a stretch of work in this process."""

from __future__ import annotations

import sys
from contextlib import suppress
from pathlib import Path

import psutil

_STATUS = Path("/proc/self/status")
_CLEAR_REFS = Path("/proc/self/clear_refs")


class PeakMemory:
    """Resident memory above what the process held when this object was made, in bytes.

    Linux: the kernel's high-water mark (`VmHWM`), set back to the present first where /proc
    allows it. Windows: the peak working set. macOS: `ru_maxrss`. Without the reset (macOS,
    Windows) an earlier, higher peak hides the later one; then the memory held at the end counts.
    Not `ru_maxrss` on Linux: there a child starts with its parent's mark.
    """

    def __init__(self) -> None:
        self._process = psutil.Process()
        with suppress(OSError):
            _CLEAR_REFS.write_text("5")  # proc(5): 5 resets the peak resident set size
        self._start = self._process.memory_info().rss
        self._old_peak = high_water_bytes()

    def peak_bytes(self) -> int:
        """Return the peak since the start, above the start; at least 0."""
        now, peak = self._process.memory_info().rss, high_water_bytes()
        highest = peak if peak > self._old_peak else now
        return max(0, int(max(highest, now) - self._start))


def high_water_bytes() -> int:
    """Return the most resident memory this process ever held, as its system tells it."""
    if _STATUS.exists():
        lines = _STATUS.read_text().splitlines()
        return 1024 * next(int(line.split()[1]) for line in lines if line.startswith("VmHWM"))
    info = psutil.Process().memory_info()
    if hasattr(info, "peak_wset"):
        return int(info.peak_wset)
    import resource  # not on Windows

    usage = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return usage if sys.platform == "darwin" else usage * 1024
