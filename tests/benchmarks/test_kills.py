"""Kill a command many times at random moments; what is left must end in the results of one run.

    KILLS=1000 python -m pytest -q -s tests/benchmarks/test_kills.py --override-ini addopts=""

`run`, `diagnose`, `simulate` and `reproduce` share the kills. Every kill is a SIGKILL of a whole
process group at a moment drawn from the length of an undisturbed run. After some kills the command
is let finish, its results compared with the undisturbed ones, and all is deleted but its caches.
A kill that comes after the end is not counted.
"""

from __future__ import annotations

import hashlib
import json
import os
import random
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd
import pytest

KILLS = int(os.environ.get("KILLS", "40"))
BETWEEN = 5  # kills before the command is let finish
PASSING = {"created_utc", "host", "fit_s", "samples_us", "seconds", "rows_per_s", "timings"}
PASSING |= {"training", "sha256", "seal", "content_sha256", "rows_per_second"}


@dataclass(frozen=True)
class Killed:
    """A command to kill: its words, and what digests the results it leaves in a folder."""

    words: list[str]
    digest: Callable[[Path], str]


def table(path: Path) -> Path:
    """Write noise: 96 ranges over 12 links in 2 rooms."""
    rng = np.random.default_rng(1)
    link = np.arange(96) % 12
    true_m = rng.uniform(1, 9, 12)[link]
    cir = np.abs(rng.normal(0, 60, (96, 160)))
    cir[:, 7] += rng.uniform(5000, 9000, 96)
    frame = pd.DataFrame({"range_m": true_m + rng.gamma(2, 0.06, 96), "true_range_m": true_m})
    frame["cir"], frame["first_path_index"] = list(cir.astype(np.float32)), 6.3
    frame["los"], frame["link"] = link % 3 == 0, [f"l{k}" for k in link]
    frame["environment"] = np.where(link % 2, "a", "b")
    frame["temperature_c"] = rng.uniform(0, 40, 12)[link]
    frame.to_parquet(path)
    return path


def records(folder: Path) -> str:
    """Digest every run record and prediction, without what names time or machine."""
    found = {}
    for path in sorted(folder.rglob("*.json")):
        content = json.loads(path.read_text())
        if "timings" not in path.parts:
            found[str(path.relative_to(folder))] = _without(content)
    for path in sorted(folder.rglob("*.parquet")):
        frame = pd.read_parquet(path)
        found[str(path.relative_to(folder))] = frame.to_json(double_precision=15)
    return hashlib.sha256(json.dumps(found, sort_keys=True).encode()).hexdigest()


def _without(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _without(item) for key, item in value.items() if key not in PASSING}
    return [_without(item) for item in value] if isinstance(value, list) else value


def simulated(folder: Path) -> str:
    return hashlib.sha256(next(folder.glob("*.parquet")).read_bytes()).hexdigest()


def texts(folder: Path) -> str:
    """Digest the TOML and the pages of a diagnosis."""
    found = [path.read_bytes() for path in sorted(folder.rglob("*")) if path.suffix == ".toml"]
    assert found
    return hashlib.sha256(b"".join(found)).hexdigest()


def commands(made: Path) -> dict[str, Killed]:
    """Return the four commands; `OUT` stands for the folder or file they write."""
    data = str(table(made / "t.parquet"))
    run = ["run", "--model", "none,constant", "--backend", "fp32,graph", "--split", "link-kfold:2"]
    diagnose = ["diagnose", "--recorded", data, "--paths-only", "--observe", "error_m"]
    reproduce = ["reproduce", "residuals", "--data", data, "--split", "link-kfold:2", "--quick"]
    return {
        "run": Killed([*run, "--data", data, "--seeds", "2", "--out", "OUT"], records),
        "diagnose": Killed([*diagnose, "-o", "OUT"], texts),
        "simulate": Killed(
            ["simulate", "rooms", "--rooms", "-n", "3000", "-o", "OUT/s.parquet"], simulated
        ),
        "reproduce": Killed([*reproduce, "--out", "OUT"], records),
    }


def start(words: list[str], out: Path, cache: Path) -> subprocess.Popen[bytes]:
    own = {"BENCH_CACHE": str(cache), "BENCH_WAIT_S": "0", "OMP_NUM_THREADS": "1"}
    return subprocess.Popen(
        [sys.executable, "-m", "bench", *(word.replace("OUT", str(out)) for word in words)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env={**os.environ, **own},
        start_new_session=True,
    )


def finish(words: list[str], out: Path, cache: Path) -> float:
    """Let a command end; return how long it took."""
    begin = time.monotonic()
    process = start(words, out, cache)
    _, said = process.communicate()
    assert process.returncode == 0, said.decode()[-2000:]
    return time.monotonic() - begin


def leftovers(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if ".part" in path.name]


def kill(words: list[str], out: Path, cache: Path, after_s: float) -> bool:
    """Kill a command some time after its start; False where it had ended by itself."""
    process = start(words, out, cache)
    try:
        process.wait(timeout=after_s)
    except subprocess.TimeoutExpired:
        os.killpg(process.pid, signal.SIGKILL)
    process.communicate()
    return process.returncode < 0


@pytest.mark.parametrize("name", ["run", "diagnose", "simulate", "reproduce"])
def test_kills_end_in_the_results_of_an_undisturbed_run(name: str, tmp_path: Path) -> None:
    killed = commands(tmp_path)[name]
    took_s = finish(killed.words, tmp_path / "whole", tmp_path / "cache-whole")
    expected = killed.digest(tmp_path / "whole")
    rng, done, rounds = random.Random(name), 0, 0
    while done < KILLS // 4:
        out, cache = tmp_path / f"out{rounds}", tmp_path / f"cache{rounds}"
        for moment in _moments(rng, took_s):
            done += kill(killed.words, out, cache, moment)
        finish(killed.words, out, cache)
        assert killed.digest(out) == expected
        assert not leftovers(out)
        shutil.rmtree(out)
        shutil.rmtree(cache, ignore_errors=True)
        rounds += 1
    print(f"\n{name}: {done} kills in {rounds} rounds, all with equal results", end="")


def _moments(rng: random.Random, took_s: float) -> Iterator[float]:
    """Yield moments to kill at: most of them after the imports, when something is being done."""
    for _ in range(BETWEEN):
        yield took_s * (rng.random() if rng.random() < 0.3 else rng.uniform(0.3, 1.0))


def test_two_processes_in_one_folder_give_the_numbers_of_one(tmp_path: Path) -> None:
    killed = commands(tmp_path)["run"]
    finish(killed.words, tmp_path / "whole", tmp_path / "cache-whole")
    both = [start(killed.words, tmp_path / "both", tmp_path / "cache") for _ in range(2)]
    for process in both:
        _, said = process.communicate()
        assert process.returncode == 0, said.decode()[-2000:]
    assert records(tmp_path / "both") == records(tmp_path / "whole")
    assert not leftovers(tmp_path / "both")
