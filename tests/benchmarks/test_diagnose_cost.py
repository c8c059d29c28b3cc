"""Cost of `bench diagnose` against the full library: 1 000 and 10 000 rows with CIRs.

LONG=1 adds 100 000 rows, which take minutes more.

The recordings are SIMULATED by the rooms chain, and diagnosed against that chain without its pulse
ringing. Each size runs through the command line in a process of its
own, reading the Parquet and writing the report. A diagnosis of many missing effects takes more
rounds, so more of the same.
"""

from __future__ import annotations

import json
import os
import subprocess
import sys
from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

from bench.physics.rooms import Rooms
from bench.physics.toml_file import to_toml

HIDDEN = "pulse-ringing"
SIZES = (1_000, 10_000, *((100_000,) if os.environ.get("LONG") else ()))
GOAL_CORE_S = 120.0  # 60 s on two cores, for 10 000 rows
GOAL_MIB = 2048.0
CODE = """
import json, resource, sys, time
from bench.cli.main import group
started = time.perf_counter()
group(sys.argv[1:], standalone_mode=False)
wall_s = time.perf_counter() - started
used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
print(json.dumps([wall_s, sum(one.ru_utime + one.ru_stime for one in used),
                  used[0].ru_maxrss / 1024]))
"""


@dataclass(frozen=True)
class Cost:
    """What one diagnosis took, with its forks; `peak_mib` without what these write of their own."""

    rows: int
    wall_s: float
    cpu_s: float
    peak_mib: float


def test_cost_grows_less_than_the_rows(tmp_path: Path) -> None:
    """Print seconds by the clock and of processor time, peak memory, and ratios between sizes."""
    costs = [_cost(rows, tmp_path) for rows in SIZES]
    print("\nrows      wall s   processor s   peak MiB")
    for cost in costs:
        print(f"{cost.rows:7d} {cost.wall_s:8.1f} {cost.cpu_s:11.1f} {cost.peak_mib:10.0f}")
    for less, more in pairwise(costs):
        ratio = more.cpu_s / less.cpu_s
        print(f"{less.rows} -> {more.rows} rows: {ratio:.2f} times the processor time")
        assert ratio < 1.2 * more.rows / less.rows
    assert costs[1].cpu_s < GOAL_CORE_S
    assert max(cost.peak_mib for cost in costs) < GOAL_MIB


def _cost(rows: int, folder: Path) -> Cost:
    """Return the cost of diagnosing `rows` simulated rows."""
    whole = Rooms().simulator
    simulator = folder / "without.toml"
    fewer = tuple(effect for effect in whole.effects if effect.name != HIDDEN)
    simulator.write_text(to_toml(replace(whole, effects=fewer)))
    recorded = folder / f"{rows}.parquet"
    _run(["simulate", "rooms", "--rooms", "-n", str(rows), "-o", str(recorded), "--json"])
    out = folder / f"diagnosis-{rows}"
    words = ["diagnose", "--recorded", str(recorded), "--simulated", str(simulator)]
    wall, cpu, peak = _run([*words, "-o", str(out), "--json"])
    assert (out / "report.md").exists()
    return Cost(rows, wall, cpu, peak)


def _run(words: list[str]) -> tuple[float, float, float]:
    """Return seconds by the clock, of processor time, and peak MiB of a command of its own."""
    done = subprocess.run(
        [sys.executable, "-c", CODE, *words], capture_output=True, text=True, check=True
    )
    wall, cpu, peak = json.loads(done.stdout.splitlines()[-1])
    return wall, cpu, peak
