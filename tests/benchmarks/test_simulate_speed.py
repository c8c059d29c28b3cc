"""Speed and memory of the simulator, with the whole chain of the default rooms."""

from __future__ import annotations

import json
import os
import subprocess
import sys
import time
from pathlib import Path

import numpy as np

from bench.parallel import threads
from bench.physics.room_geometry import room_geometry
from bench.physics.rooms import Rooms
from bench.physics.scene import scene

ROWS = 32_768
MANY = 300_000
PER_CORE = 30_000
"""CIRs per second of processor time that hold with room for noise: half of 60 000 on two cores.

38 000 to 53 000 were measured on a busy machine.
"""


def test_cirs_per_second() -> None:
    """Print CIRs per second by the clock and per second of processor time, best of five."""
    rows = scene(room_geometry(np.random.default_rng(0), ROWS))
    simulator = Rooms().simulator
    simulator.observe(rows.slice(0, 4096))
    by_clock, by_core = [], []
    for _ in range(5):
        clock, core = time.perf_counter(), time.process_time()
        simulator.observe(rows)
        by_clock.append(ROWS / (time.perf_counter() - clock))
        by_core.append(ROWS / (time.process_time() - core))
    cores = len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count()
    print(
        f"\nrooms chain: {max(by_clock):.0f} CIRs/s by the clock on {cores} cores, "
        f"{max(by_core):.0f} per core-second"
    )
    assert max(by_core) > PER_CORE


def test_rows_of_the_command_per_second(tmp_path: Path) -> None:
    """Print rows per second of `bench simulate` with geometry and Parquet, and what a core makes.

    By the clock, with the start of the processes that help and without that of the command.
    """
    words = ["simulate", "rooms", "--rooms", "-n", str(MANY), "-o", str(tmp_path / "m.parquet")]
    speed = {}
    for count in ("1", str(threads())):
        done = subprocess.run(
            [sys.executable, "-m", "bench", *words, "--json"],
            capture_output=True, text=True, check=True, env={**os.environ, "BENCH_THREADS": count},
        )  # fmt: skip
        speed[count] = json.loads(done.stdout)["rows_per_s"]
    said = ", ".join(f"{made:.0f} rows/s on {count}" for count, made in speed.items())
    print(f"\n{MANY} rows: {said} cores")
    assert threads() == 1 or speed[str(threads())] > speed["1"]


def test_memory_does_not_grow_with_rows(tmp_path: Path) -> None:
    """Print the peak memory of `bench simulate` for 120 000 and 480 000 rows."""
    peaks = [_peak_mib(rows, tmp_path / f"{rows}.parquet") for rows in (120_000, 480_000)]
    print(f"\npeak memory: {peaks[0]:.0f} MiB for 120 000 rows, {peaks[1]:.0f} for 480 000")
    assert peaks[1] < 1.35 * peaks[0]


def _peak_mib(rows: int, out: Path) -> float:
    """Return the peak resident memory in MiB of simulating `rows` rows, that of helpers with it."""
    code = (
        "import resource, sys\n"
        "from bench.parallel import threads\n"
        "from bench.cli.main import group\n"
        "group(sys.argv[1:], standalone_mode=False)\n"
        "own = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss\n"
        "largest = resource.getrusage(resource.RUSAGE_CHILDREN).ru_maxrss\n"
        "print((own + threads() * largest) / 1024)\n"
    )
    words = ["simulate", "rooms", "--rooms", "-n", str(rows), "-o", str(out)]
    done = subprocess.run(
        [sys.executable, "-c", code, *words], capture_output=True, text=True, check=True
    )
    return float(done.stdout.splitlines()[-1])
