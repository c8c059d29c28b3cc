"""How long the command line takes to say what there is: `bench --help`, `bench models`."""

from __future__ import annotations

import subprocess
import sys
import time
from pathlib import Path

import pytest

BENCH = Path(sys.executable).parent / "bench"
RUNS = 9


def _fastest_s(*command: str) -> float:
    """Return the fastest of several runs in seconds: what the command itself needs."""
    taken = []
    for _ in range(RUNS):
        start = time.perf_counter()
        subprocess.run(command, check=True, capture_output=True)
        taken.append(time.perf_counter() - start)
    return min(taken)


@pytest.mark.parametrize("arguments", [["--help"], ["models"], ["models", "--json"], ["backends"]])
def test_listing_takes_less_than_0_3_s(arguments: list[str]) -> None:
    bare_s = _fastest_s(sys.executable, "-c", "pass")
    bench_s = _fastest_s(str(BENCH), *arguments)
    print(f"\nbench {' '.join(arguments)}: {bench_s:.3f} s (Python alone {bare_s:.3f} s)", end="")
    assert bench_s < 0.3
