"""Runs the diagnosis on concealed cases. Answers are sealed: their hash before the run."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from bench.challenge.cases import make_case
from bench.challenge.generator.conceal import Hidden, draw_case
from bench.challenge.generator.waveforms import draw_wave
from bench.challenge.scoring import Outcome, outcome, removed_m
from bench.challenge.truths import compared
from bench.challenge.waves import FIRST, run_wave
from bench.discrepancy.method import Options, diagnose
from bench.errors import BenchError
from bench.files import read_json, write_atomically
from bench.parallel import Spread
from bench.provenance import SEAL, is_sealed, json_digest, packages_code_hash, sealed

Progress = Callable[[str], None]


def run_case(number: int, seed: int) -> Outcome:
    """Diagnose one case and score it."""
    case = make_case(number, seed)
    options = Options(seed)
    found = diagnose(case.recorded, case.simulated, options)
    beside = compared(case, found)
    made = outcome(case.hidden, found, number, case.way, case.strength_z)
    removed, oracle = removed_m(case, found, seed)
    return replace(
        made,
        removed=removed,
        oracle=oracle,
        covered=[one.covered for one in beside],
        parameter_errors=[one.error for one in beside],
    )


def seal(cases: int, seed: int, waves: int = 0) -> str:
    """Return the hash of every answer, to be published before the run."""
    answers = [asdict(draw_case(number, seed)) for number in range(cases)]
    answers += [asdict(draw_wave(number, seed)) for number in range(waves)]
    return json_digest(answers, 64)


def code() -> str:
    """Return the hash of every source file that decides an answer or its score."""
    return packages_code_hash("bench/challenge", "bench/discrepancy", "bench/physics")


def run_blind(
    cases: int,
    seed: int,
    folder: Path,
    progress: Progress,
    spread: Spread | None = None,
    waves: int = 0,
) -> list[Outcome]:
    """Run (or resume) the blind challenge; one JSON file per case in `folder`/cases.

    `waves` more cases hide effects of the waveform; they are numbered from `FIRST`. Finished cases
    are kept if the same code made them, else run again. Raises BenchError where the folder holds a
    challenge of another seed.
    """
    _publish(cases, seed, folder, waves)
    every = [*range(cases), *range(FIRST, FIRST + waves)]
    missing = [number for number in every if _kept(_path(folder, number)) is None]
    finished = len(every) - len(missing)
    progress(f"{finished} of {len(every)} cases")
    for _, made in (spread or Spread()).map(_work, seed, missing):
        write_atomically(_path(folder, made.number), _text(made))
        finished += 1
        progress(f"{finished} of {len(every)} cases")
    return [_read(read_json(_path(folder, number))) for number in every]


def _kept(path: Path) -> Any:
    """Return what a case's file holds, None where there is none that can be believed."""
    try:
        content = read_json(path)
    except BenchError:
        return None
    return content if is_sealed(content) and content["number"] == int(path.stem) else None


def _publish(cases: int, seed: int, folder: Path, waves: int) -> None:
    """Write the seal before anything is run; drop cases that other code finished."""
    path = folder / "sealed.json"
    before = read_json(path) if path.exists() else {"seed": seed, "code": code()}
    if not isinstance(before, dict) or before.get("seed") != seed:
        found = before.get("seed") if isinstance(before, dict) else "unknown"
        raise BenchError(f"{folder} holds a challenge of seed {found}, not {seed}")
    if before.get("code") != code():
        for old in (folder / "cases").glob("*.json"):
            old.unlink()
    answers = {"cases": cases, "waves": waves, "sha256": seal(cases, seed, waves)}
    published = {"seed": seed, **answers, "code": code()}
    write_atomically(path, json.dumps(published, indent=1) + "\n")


def _path(folder: Path, number: int) -> Path:
    """Return the file of one case."""
    return folder / "cases" / f"{number:04d}.json"


def _work(seed: int, number: int) -> Outcome:
    """Run one case, of the range or of the waveform by its number."""
    return run_case(number, seed) if number < FIRST else run_wave(number - FIRST, seed)


def _text(outcome: Outcome) -> str:
    """Return an outcome as the text of its file."""
    content = json.loads(json.dumps(asdict(outcome), default=float))
    return json.dumps(sealed(content), indent=1) + "\n"


def _read(data: dict[str, Any]) -> Outcome:
    """Return an outcome read back from its file."""
    data = {name: value for name, value in data.items() if name != SEAL}
    hidden = data["hidden"]
    kept: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in hidden.items()}
    answer: Any = Hidden(**kept)
    return Outcome(**{**data, "hidden": answer})
