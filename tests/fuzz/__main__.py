"""`python -m tests.fuzz`: run seeded hostile cases, list what went wrong by cause."""

from __future__ import annotations

import argparse
import importlib
import json
import pkgutil
import random
import shutil
import sys
import tempfile
import time
from collections import Counter, defaultdict
from contextlib import suppress
from pathlib import Path

from tests.fuzz.commands import Case, make_case
from tests.fuzz.harness import Ended, execute, faults, inputs

OWN_PROCESS = 0.05  # share of cases that run as a Python of their own


def main() -> int:
    """Return 0 where no case did anything wrong."""
    asked = _asked()
    _preload()
    found: dict[str, list[int]] = defaultdict(list)
    kinds: Counter[str] = Counter()
    start, slowest = time.monotonic(), (0.0, 0)
    for number in [asked.only] if asked.only is not None else range(asked.cases):
        case, ended, wrong = one_case(asked.seed, number, asked.own_process, asked.only is not None)
        kinds[f"{_command(case)} -> {ended.code}"] += 1
        slowest = max(slowest, (ended.seconds, number))
        for fault in wrong:
            print(f"case {number}: {fault}: {case.words}"[:300], file=sys.stderr)
            print(f"   {ended.err[-700:]!r}", file=sys.stderr, flush=True)
            found[fault].append(number)
    _tell(found, kinds, asked, time.monotonic() - start, slowest)
    return 1 if found else 0


def _asked() -> argparse.Namespace:
    parser = argparse.ArgumentParser(description="Seeded hostile input for every command.")
    parser.add_argument("--cases", type=int, default=600)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--only", type=int, help="run this one case and show what it said")
    parser.add_argument("--own-process", type=float, default=OWN_PROCESS, help="share of cases")
    parser.add_argument("--out", type=Path, help="JSON file for what was found")
    return parser.parse_args()


def _preload() -> None:
    """Import everything once, so that a fork starts at its command. Results do not depend on it."""
    for name in (
        "matplotlib.pyplot",
        "onnxruntime",
        "pandas",
        "pyarrow.parquet",
        "torch",
        "sklearn",
    ):
        importlib.import_module(name)
    import matplotlib

    import bench
    import reports

    matplotlib.use("Agg")
    for package in (bench, reports):
        for module in pkgutil.walk_packages(package.__path__, f"{package.__name__}."):
            if not module.name.endswith(("__main__", ".tests")) and ".scaffold." not in module.name:
                with suppress(ImportError):  # what an extra brings is not everywhere
                    importlib.import_module(module.name)


def one_case(seed: int, number: int, own: float, show: bool) -> tuple[Case, Ended, list[str]]:
    """Make, run and judge one case."""
    rng = random.Random(f"{seed} {number}")
    with tempfile.TemporaryDirectory(prefix="fuzz-") as scratch:
        folder = Path(scratch) / "case"
        folder.mkdir()
        case = make_case(rng, folder)
        before = inputs(case, folder)
        ended = execute(case, folder, rng.random() < own)
        wrong = list(dict.fromkeys(faults(case, folder, before, ended)))
        if show:
            _show(case, ended, folder)
    return case, ended, wrong


def _show(case: Case, ended: Ended, folder: Path) -> None:
    kept = Path(tempfile.gettempdir()) / "fuzz-shown"
    shutil.rmtree(kept, ignore_errors=True)
    shutil.copytree(folder, kept, symlinks=True, ignore=_no_pipes)
    print(f"{case.about}\nbench {case.words}\n{ended.out!r}\n{ended.err}\n{ended.seconds:.1f} s")
    print(f"its files: {kept}")


def _no_pipes(folder: str, names: list[str]) -> set[str]:
    return {name for name in names if not (Path(folder) / name).is_file()
            and not (Path(folder) / name).is_dir()}  # fmt: skip


def _command(case: Case) -> str:
    known = ("data", "run", "simulate", "diagnose", "leaderboard", "models", "backends", "devices")
    known += ("doctor", "plugin", "challenge", "reproduce")
    return next((word for word in case.words[:1] if word in known), "unknown command")


def _tell(
    found: dict[str, list[int]],
    kinds: Counter[str],
    asked: argparse.Namespace,
    seconds: float,
    slowest: tuple[float, int],
) -> None:
    total = sum(kinds.values())
    print(f"{total} cases of seed {asked.seed} in {seconds:.0f} s; the slowest, {slowest[1]}, "
          f"took {slowest[0]:.1f} s")  # fmt: skip
    print(", ".join(f"{kind}: {count}" for kind, count in sorted(kinds.items())))
    for fault, numbers in sorted(found.items(), key=lambda item: -len(item[1])):
        print(f"{len(numbers):4d} x {fault}  (cases {', '.join(map(str, numbers[:6]))})")
    print("no faults" if not found else f"{len(found)} kinds of fault")
    if asked.out:
        facts = {"seed": asked.seed, "cases": total, "faults": found, "ends": kinds}
        asked.out.parent.mkdir(parents=True, exist_ok=True)
        asked.out.write_text(json.dumps(facts, indent=1) + "\n")


if __name__ == "__main__":
    sys.exit(main())
