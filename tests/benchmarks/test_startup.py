"""How long the command line takes to say what there is: `bench --help`, `bench models`.

The command runs on one thread and waits for nothing, so its processor time is what it takes on a
machine that has nothing else to do; where the machine is that quiet, the clock must say so too.
"""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

resource = pytest.importorskip("resource", reason="no processor times of children here")
BENCH = Path(sys.executable).parent / "bench"
RUNS = 9
LIMIT_S = 0.3


def _processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def _fastest_s(*command: str) -> tuple[float, float]:
    """Return clock and processor seconds of the fastest of several runs."""
    taken = []
    for _ in range(RUNS):
        start, busy = time.perf_counter(), _processor_s()
        subprocess.run(command, check=True, capture_output=True)
        taken.append((time.perf_counter() - start, _processor_s() - busy))
    return min(taken)


@pytest.mark.parametrize("arguments", [["--help"], ["models"], ["models", "--json"], ["backends"]])
def test_listing_takes_less_than_0_3_s(arguments: list[str]) -> None:
    bare_s, _ = _fastest_s(sys.executable, "-c", "pass")
    clock_s, processor_s = _fastest_s(str(BENCH), *arguments)
    text = f"{clock_s:.3f} s, {processor_s:.3f} s of processor (Python alone {bare_s:.3f} s)"
    print(f"\nbench {' '.join(arguments)}: {text}", end="")
    assert processor_s < LIMIT_S
    assert clock_s < LIMIT_S or processor_s < 0.8 * clock_s  # the rest went to other processes
