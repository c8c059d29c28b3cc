"""Runs the diagnosis on concealed cases. Answers are sealed: their hash before the run."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable
from dataclasses import asdict
from pathlib import Path
from typing import Any

from bench.challenge.cases import make_case
from bench.challenge.generator.conceal import Hidden, draw_case
from bench.challenge.scoring import Outcome, removed_m, scored
from bench.challenge.truths import compared
from bench.discrepancy.study import Options, study
from bench.errors import BenchError
from bench.files import write_atomically

Tell = Callable[[str], None]


def run_case(number: int, seed: int) -> Outcome:
    """Diagnose one case and score it."""
    case = make_case(number, seed)
    options = Options(seed, fit_rows=400, observables=("error_m",), waveform=False)
    found = study(case.recorded, case.simulated, options)
    located = found.diagnosis.rounds[0].located
    removed, oracle = removed_m(case, found, seed)
    beside = compared(case, found)
    return Outcome(
        number=number,
        way=case.way,
        hidden=case.hidden,
        verdict=str(found.diagnosis.verdicts[0]),
        names=[list(group) for group in found.diagnosis.names],
        score=scored(case.hidden, found),
        strength_z=case.strength_z,
        above_limit=case.above_limit,
        p=located.p,
        alarm_z=located.z / located.threshold,
        removed=removed,
        oracle=oracle,
        covered=[one.covered for one in beside],
        parameter_errors=[one.error for one in beside],
    )


def seal(cases: int, seed: int) -> str:
    """Return the hash of every answer, to be published before the run."""
    answers = [asdict(draw_case(number, seed)) for number in range(cases)]
    return hashlib.sha256(json.dumps(answers, sort_keys=True).encode()).hexdigest()


def run_blind(cases: int, seed: int, folder: Path, tell: Tell) -> list[Outcome]:
    """Run (or resume) the blind challenge; one JSON file per case in `folder`/cases.

    Raises BenchError where the folder holds a challenge of another seed.
    """
    seal_path = folder / "sealed.json"
    sealed = {"seed": seed, "cases": cases, "sha256": seal(cases, seed)}
    if seal_path.exists():
        before = json.loads(seal_path.read_text())
        if before["seed"] != seed:
            raise BenchError(f"{folder} holds a challenge of seed {before['seed']}, not {seed}")
    write_atomically(seal_path, json.dumps(sealed, indent=1) + "\n")
    out = []
    for number in range(cases):
        path = folder / "cases" / f"{number:04d}.json"
        if not path.exists():
            tell(f"case {number + 1} of {cases}")
            made = run_case(number, seed)
            write_atomically(path, json.dumps(asdict(made), indent=1, default=float) + "\n")
        out.append(_read(json.loads(path.read_text())))
    return out


def _read(data: dict[str, Any]) -> Outcome:
    """Return an outcome read back from its file."""
    hidden = data["hidden"]
    kept: dict[str, Any] = {k: tuple(v) if isinstance(v, list) else v for k, v in hidden.items()}
    answer: Any = Hidden(**kept)
    return Outcome(**{**data, "hidden": answer})
