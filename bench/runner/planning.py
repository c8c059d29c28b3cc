"""`bench.plan`: which measurement tells apart what a diagnosis cannot."""

from __future__ import annotations

from pathlib import Path

from bench.discrepancy.report.evidence import read_evidence
from bench.errors import BenchError
from bench.files import check_output, write_atomically
from bench.planning.plan import MeasurementPlan, answer
from bench.planning.questions import read_questions
from bench.runner.observer import Observer

MOST_LINKS = 1000


def plan(
    diagnosis: str | Path,
    *,
    links: int | None = None,
    seed: int = 0,
    out: str | Path | None = None,
    observer: Observer | None = None,
) -> MeasurementPlan:
    """Rank measurements by how far they tell apart what a diagnosis leaves open.

    `diagnosis`: a folder that `bench diagnose -o` wrote. `links`: how many links can be measured;
    None plans as many as settle it with 95 %. With `out` the planned links go to a CSV. A plan
    without answers says that nothing is open. Raises BenchError on bad input.

    >>> plan("nowhere")
    Traceback (most recent call last):
    bench.errors.BenchError: nowhere: no diagnosis there; expected a folder of `bench diagnose -o`
    """
    if links is not None and not 1 <= links <= MOST_LINKS:
        raise BenchError(f"--links {links}: expected a whole number from 1 to {MOST_LINKS}")
    if seed < 0:
        raise BenchError(f"--seed {seed}: expected a whole number of 0 or more")
    folder, watch = Path(diagnosis), observer or Observer()
    asked = read_questions(folder)
    if out is not None:
        check_output(Path(out))
    evidence = read_evidence(folder) if asked.questions else None
    answers = []
    for question in asked.questions:
        watch.stage(f"planning: {question.words}")
        assert evidence is not None
        answers.append(answer(question, evidence, asked.simulator, links, seed))
    made = MeasurementPlan(str(folder), asked.headline, tuple(answers))
    if out is not None and any(one.planned() for one in answers):
        write_atomically(Path(out), made.frame().to_csv(index=False))
    return made
