"""`python -m tests.mutation`: plant faults, run tests, say which were not noticed."""

from __future__ import annotations

import argparse
import ast
import json
import random
import sys
import time
import tomllib
from collections.abc import Iterator
from pathlib import Path
from typing import Any

from tests.mutation.fork import preload, run_tests
from tests.mutation.operators import Mutant, mutants

HERE = Path(__file__).parent
BAR = 0.90
SLACK = 4.0  # a mutant that takes this many times as long as the tests do hangs
Row = dict[str, Any]


def main() -> int:
    """Return 0 where at least 90 % are killed and every survivor has a reason."""
    asked = _asked()
    preload()
    rows: list[Row] = []
    for target in tomllib.loads((HERE / "targets.toml").read_text())["target"]:
        if asked.target in target["module"]:
            found = list(_one_target(target, asked.samples, asked.seed))
            rows += found
            print(_line(target["module"], found), flush=True)
            _explain(found)
    if asked.out:
        asked.out.parent.mkdir(parents=True, exist_ok=True)
        asked.out.write_text(json.dumps({"seed": asked.seed, "mutants": rows}, indent=1) + "\n")
    return _conclude(rows)


def _asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Plant faults, one by one, and run the tests.")
    parser.add_argument("--target", default="", help="only modules whose path contains this")
    parser.add_argument("--samples", type=int, default=20, help="mutants per module, 0 for all")
    parser.add_argument("--seed", type=int, default=0, help="seed of the sampling")
    parser.add_argument("--out", type=Path, help="JSON file for every mutant's outcome")
    return parser.parse_args()


def _one_target(target: Row, samples: int, seed: int) -> Iterator[Row]:
    """Yield the outcome of every mutant sampled from one module."""
    path, tests = Path(target["module"]), list(target["tests"])
    source = path.read_text(encoding="utf-8")
    every = list(mutants(source))
    chosen = _sampled(every, samples, f"{seed} {path}")
    outcome, base_s, said = run_tests(tests, path, ast.parse(source), 600)
    if outcome != "passed":
        raise SystemExit(f"{path}: the tests {outcome} without any fault:\n{said}")
    for mutant in chosen:
        start = time.monotonic()
        outcome, _, _ = run_tests(tests, path, mutant.tree, SLACK * base_s + 10)
        yield _row(path, mutant, outcome, len(every), time.monotonic() - start)


def _sampled(every: list[Mutant], samples: int, seed: str) -> list[Mutant]:
    if samples == 0 or samples >= len(every):
        return every
    chosen = random.Random(seed).sample(range(len(every)), samples)
    return [every[index] for index in sorted(chosen)]


def _row(path: Path, mutant: Mutant, outcome: str, of: int, seconds: float) -> Row:
    state = {"passed": "survived", "failed": "killed", "hung": "killed (hung)"}[outcome]
    row = {"module": str(path), "line": mutant.line, "text": mutant.text, "state": state}
    row |= {"before": mutant.before, "after": mutant.after, "seconds": round(seconds, 1), "of": of}
    return row | ({"reason": _reason(row)} if state == "survived" else {})


def _reason(row: Row) -> str:
    """Return why a survivor is no gap of the tests, empty where that is not known."""
    known = tomllib.loads((HERE / "survivors.toml").read_text()).get("survivor", [])
    for one in known:
        if all(one[field] == row[field] for field in ("module", "text", "before", "after")):
            return str(one["reason"])
    return ""


def _line(module: str, rows: list[Row]) -> str:
    killed = sum(row["state"] != "survived" for row in rows)
    seconds = sum(row["seconds"] for row in rows)
    of = rows[0]["of"] if rows else 0
    return f"| `{module}` | {of} | {len(rows)} | {killed} | {seconds:.0f} |"


def _explain(rows: list[Row]) -> None:
    for row in rows:
        if row["state"] == "survived":
            where = f"{row['module']}:{row['line']}"
            what = f"`{row['before']}` -> `{row['after']}`"
            print(f"survived: {where}: {what}: {row['reason']}", flush=True)


def _conclude(rows: list[Row]) -> int:
    survived = [row for row in rows if row["state"] == "survived"]
    share = 1 - len(survived) / max(len(rows), 1)
    open_ones = sum(not row["reason"] for row in survived)
    print(f"{len(rows)} mutants, {share:.1%} killed, {open_ones} survivors without a reason")
    return 0 if rows and share >= BAR and not open_ones else 1


if __name__ == "__main__":
    sys.exit(main())
