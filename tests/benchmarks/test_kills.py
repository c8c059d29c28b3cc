"""Kill a command many times at random moments; what is left must end in the results of one run.

    KILLS=1000 python -m pytest -q -s tests/benchmarks/test_kills.py --override-ini addopts=""

`run`, `diagnose`, `simulate` and `reproduce` share the kills. A kill is a SIGKILL of a whole
process group at a moment drawn (with a seed) from the length of an undisturbed run. After some
kills the command is let finish, its results compared with those of an undisturbed run, and all is
deleted. Commands that are killed are forks of a process that has imported what they need (see
`fork_server`), so that every kill falls on work; that an own `python -m bench` gives the same is
seen once. A kill that comes after the end is not counted. The diagnosis knows two effects alone,
the run is one of those that are not timed: a timing is made again in any case.
"""

from __future__ import annotations

import hashlib
import json
import os
import random
import shutil
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
from fork_server import OWN, ForkServer

KILLS = int(os.environ.get("KILLS", "40"))
SHARES = {"run": 0.25, "diagnose": 0.15, "simulate": 0.35, "reproduce": 0.25}
BETWEEN = 5  # kills, at most, before the command is let finish
PASSING = {"created_utc", "host", "fit_s", "samples_us", "seconds", "rows_per_s", "timings"}
PASSING |= {"training", "sha256", "seal", "content_sha256", "rows_per_second"}
PASSING |= {"elapsed_s", "longest_s"}


@dataclass(frozen=True)
class Killed:
    """A command to kill: its words, and what digests the results it leaves in a folder.

    `effects`: all that a diagnosis knows there, empty for the whole library.
    """

    words: list[str]
    digest: Callable[[Path], str]
    effects: tuple[str, ...] = ()


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


def drift(path: Path) -> Path:
    """Write 64 ranges over 16 links that grow with the temperature: few effects can be tried."""
    rng = np.random.default_rng(2)
    link = np.arange(64) % 16
    frame = pd.DataFrame({"link": [f"l{k}" for k in link], "true_range_m": 2.0 + link})
    frame["temperature_c"] = rng.uniform(0, 50, 16)[link]
    error_m = 0.008 * frame["temperature_c"] + rng.normal(0, 0.03, 64)
    frame["range_m"] = frame["true_range_m"] + error_m
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
    """Digest the TOML, the JSON and the page of a diagnosis."""
    kinds = (".toml", ".json", ".md")
    found = [path.read_bytes() for path in sorted(folder.rglob("*")) if path.suffix in kinds]
    assert found
    return hashlib.sha256(b"".join(found)).hexdigest()


def commands(made: Path) -> dict[str, Killed]:
    """Return the four commands; `OUT` stands for the folder or file they write."""
    data, warm = str(table(made / "t.parquet")), str(drift(made / "w.parquet"))
    run = ["run", "--model", "none", "--backend", "fp32,graph", "--links", "2,4", "--draws", "2"]
    diagnose = ["diagnose", "--recorded", warm, "--paths-only", "--observe", "error_m"]
    reproduce = ["reproduce", "pca,cir-size", "--data", data, "--split", "link-kfold:2", "--quick"]
    return {
        "run": Killed([*run, "--data", data, "--seeds", "2", "--out", "OUT"], records),
        "diagnose": Killed([*diagnose, "-o", "OUT"], texts, ("temperature-drift", "range-scale")),
        "simulate": Killed(
            ["simulate", "rooms", "--rooms", "-n", "1000", "-o", "OUT/s.parquet"], simulated
        ),
        "reproduce": Killed([*reproduce, "--out", "OUT"], records),
    }


def start(words: list[str], out: Path, cache: Path) -> subprocess.Popen[bytes]:
    return subprocess.Popen(
        [sys.executable, "-m", "bench", *(word.replace("OUT", str(out)) for word in words)],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        env={**os.environ, **OWN, "BENCH_CACHE": str(cache)},
    )


def finish(process: subprocess.Popen[bytes]) -> None:
    """Let a command end well."""
    _, said = process.communicate()
    assert process.returncode == 0, said.decode()[-2000:]


def leftovers(folder: Path) -> list[Path]:
    return [path for path in folder.rglob("*") if ".part" in path.name]


@pytest.fixture
def server() -> Iterator[ForkServer]:
    made = ForkServer()
    yield made
    made.close()


@pytest.mark.parametrize("name", SHARES)
def test_kills_end_in_the_results_of_an_undisturbed_run(
    name: str, server: ForkServer, tmp_path: Path
) -> None:
    killed = commands(tmp_path)[name]
    server.knows(killed.effects)
    server.learn(killed.words, tmp_path / "learnt", tmp_path / "cache-learnt")
    took_s = server.run(killed.words, tmp_path / "fork", tmp_path / "cache-fork").seconds
    expected = killed.digest(tmp_path / "fork")
    assert killed.digest(tmp_path / "learnt") == expected
    if not killed.effects:
        finish(start(killed.words, tmp_path / "whole", tmp_path / "cache-whole"))
        assert killed.digest(tmp_path / "whole") == expected
    rng, done, rounds, begin = random.Random(name), 0, 0, time.monotonic()
    while done < SHARES[name] * KILLS:
        done += _round(killed, expected, server, took_s, rng, tmp_path)
        rounds += 1
        if rounds % 10 == 0 or done >= SHARES[name] * KILLS:
            seconds = time.monotonic() - begin
            print(f"\n{name} ({took_s:.1f} s): {done} kills in {rounds} rounds, {seconds:.0f} s: "
                  "all with equal results", end="", flush=True)  # fmt: skip


def _round(
    killed: Killed, expected: str, server: ForkServer, took_s: float, rng: random.Random, made: Path
) -> int:
    """Kill a command a few times, let it finish, compare; return how many kills met it at work."""
    out, cache, done = made / "out", made / "cache", 0
    for _ in range(BETWEEN):
        ended = server.run(killed.words, out, cache, took_s * rng.random())
        assert ended.code in (0, -9), ended.said
        done += ended.code != 0
        if ended.code == 0:
            break
    ended = server.run(killed.words, out, cache)
    assert ended.code == 0, ended.said
    assert killed.digest(out) == expected
    assert not leftovers(out)
    shutil.rmtree(out)
    shutil.rmtree(cache, ignore_errors=True)
    return done


def test_two_processes_in_one_folder_give_the_numbers_of_one(tmp_path: Path) -> None:
    killed = commands(tmp_path)["run"]
    finish(start(killed.words, tmp_path / "whole", tmp_path / "cache-whole"))
    for process in [start(killed.words, tmp_path / "both", tmp_path / "cache") for _ in range(2)]:
        finish(process)
    assert records(tmp_path / "both") == records(tmp_path / "whole")
    assert not leftovers(tmp_path / "both")
