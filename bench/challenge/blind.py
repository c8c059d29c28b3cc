"""Runs `bench.diagnose` on blind cases. Answers are sealed: their hash before the run."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from time import process_time
from typing import Any

from bench.challenge.cases import Case, drawn_of, make_case
from bench.challenge.planted import detected
from bench.challenge.removal import removed
from bench.challenge.scoring import Outcome, blank, outcome
from bench.challenge.truths import compared
from bench.discrepancy.diagnosis import Diagnosis
from bench.errors import BenchError
from bench.files import read_json, write_atomically
from bench.parallel import Spread
from bench.provenance import (
    SEAL,
    is_sealed,
    json_digest,
    modules_code_hash,
    packages_code_hash,
    sealed,
)
from bench.runner.diagnosis import diagnose
from bench.text import reason

Progress = Callable[[str], None]
SEALED = 360


def run_case(number: int, seed: int, families: tuple[str, ...] = ()) -> Outcome:
    """Diagnose one case, as the public call does by default, and score it.

    A refusal in one line is scored "refused"; any other exception "crash".
    """
    case = make_case(number, seed, families)
    start = process_time()
    try:
        found = diagnose(case.recorded, case.simulated)
        taken = process_time() - start
        return replace(_scored(case, found, number), seconds=round(taken, 1))
    except BenchError as problem:
        return blank(case, number, "refused", str(problem))
    except Exception as problem:  # a crash is a score, and the other cases go on
        return blank(case, number, "crash", reason(problem))


def _scored(case: Case, found: Diagnosis, number: int) -> Outcome:
    """Return the outcome of a diagnosis with all that is measured about it."""
    beside = compared(case, found)
    fall, most = removed(case, found)
    empty = not case.drawn.hidden
    return replace(
        outcome(case, found, number),
        removed=fall,
        removable=most,
        covered=[one.covered for one in beside],
        parameter_errors=[one.error for one in beside],
        detected=detected(case, found, 0) if empty else {},
    )


def seal(cases: int, seed: int, families: tuple[str, ...] = ()) -> str:
    """Return the hash of every answer, to be published before the run.

    Of `SEALED` cases at least: a run that is cut short has the seal of the whole one.
    """
    every = range(max(cases, SEALED))
    answers = [[asdict(part) for part in drawn_of(number, seed, families)] for number in every]
    return json_digest(answers, 64)


def code() -> str:
    """Return the hash of every source file that decides an answer or its score."""
    parts = ("cases", "planted", "removal", "scoring", "truths")
    modules = modules_code_hash(f"bench.challenge.{name}" for name in parts)
    places = ("bench/challenge/families", "bench/discrepancy", "bench/physics")
    return json_digest([modules, packages_code_hash(*places)])


def run_blind(
    cases: int,
    seed: int,
    folder: Path,
    progress: Progress,
    spread: Spread | None = None,
    families: tuple[str, ...] = (),
) -> list[Outcome]:
    """Run (or resume) the blind challenge; one JSON file per case in `folder`/cases.

    Finished cases are kept if the same code made them, else run again. Raises BenchError where
    the folder holds a challenge of another seed or of other families.
    """
    _publish(cases, seed, folder, families)
    missing = [number for number in range(cases) if _kept(_path(folder, number)) is None]
    finished = cases - len(missing)
    progress(f"{finished} of {cases} cases")
    for _, made in (spread or Spread()).map(_work, (seed, families), missing):
        write_atomically(_path(folder, made.number), _text(made))
        finished += 1
        progress(f"{finished} of {cases} cases")
    return [_read(read_json(_path(folder, number))) for number in range(cases)]


def _kept(path: Path) -> Any:
    """Return what a case's file holds, None where there is none that can be believed."""
    try:
        content = read_json(path)
    except BenchError:
        return None
    return content if is_sealed(content) and content["number"] == int(path.stem) else None


def _publish(cases: int, seed: int, folder: Path, families: tuple[str, ...]) -> None:
    """Write the seal before anything is run; drop cases that other code finished."""
    path = folder / "sealed.json"
    own = {"seed": seed, "families": list(families)}
    before = read_json(path) if path.exists() else own | {"code": code()}
    held = {name: before.get(name) for name in own} if isinstance(before, dict) else {}
    if held != own:
        raise BenchError(
            f"{folder} holds a challenge of seed {held.get('seed', 'unknown')}, not {seed}, "
            "or of other families"
        )
    if before.get("code") != code():
        for old in (folder / "cases").glob("*.json"):
            old.unlink()
    answers = {"cases": cases, "sha256": seal(cases, seed, families), "code": code()}
    write_atomically(path, json.dumps(own | answers, indent=1) + "\n")


def _path(folder: Path, number: int) -> Path:
    """Return the file of one case."""
    return folder / "cases" / f"{number:04d}.json"


def _work(asked: tuple[int, tuple[str, ...]], number: int) -> Outcome:
    """Run one case."""
    return run_case(number, *asked)


def _text(made: Outcome) -> str:
    """Return an outcome as the text of its file."""
    content = json.loads(json.dumps(asdict(made), default=float))
    return json.dumps(sealed(content), indent=1) + "\n"


def _read(data: dict[str, Any]) -> Outcome:
    """Return an outcome read back from its file."""
    return Outcome(**{name: value for name, value in data.items() if name != SEAL})
