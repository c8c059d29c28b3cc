"""`bench.challenge`: physics hidden from the diagnosis, and a score of what it says."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.challenge.apartment import apartment
from bench.challenge.blind import run_blind, seal
from bench.challenge.blind_report import blind_markdown, rates
from bench.challenge.real import RealCase, ghent, outdoor
from bench.discrepancy import write_report
from bench.discrepancy.report.document import describe
from bench.errors import BenchError, unknown_name
from bench.files import write_atomically
from bench.measure.machine import describe_machine
from bench.parallel import Spread
from bench.recordings.open import open_recordings
from bench.runner.observer import Observer
from bench.text import plain

REAL = {"ghent": ghent, "outdoor": outdoor, "apartment": apartment}
Score = dict[str, Any]


@dataclass(frozen=True)
class Scored:
    """A challenge that was run: the report's lines and file, and every score beside its bar."""

    lines: tuple[str, ...]
    scores: tuple[Score, ...]
    report: Path


def run_challenge(
    cases: int = 40,
    waves: int = 0,
    seed: int = 0,
    *,
    real: str | Iterable[str] = (),
    out: str | Path = "challenge",
    page: str | Path | None = None,
    jobs: int = 1,
    scheduler: str | None = None,
    observer: Observer | None = None,
) -> Scored:
    """Hide physics from the diagnosis and score what it says.

    `cases` blind ones in the range and `waves` in the waveform come from a generator that shares
    no code with the effect library; answers are sealed by a hash before the run. `real` names
    recordings ("ghent", "outdoor", "apartment", several, or "all") whose revealing columns are
    hidden: these are run instead, or as well where everything goes on one `page`. Finished blind
    cases found under `out` are kept. `jobs` processes or a Dask `scheduler` share the blind cases;
    outcomes do not depend on it. Raises BenchError on bad input, before anything is run.

    >>> import bench
    >>> bench.challenge(cases=3, real="gent")
    Traceback (most recent call last):
    bench.errors.BenchError: unknown real case 'gent'; did you mean 'ghent'? ...
    """
    spread, chosen = Spread(jobs, scheduler), _chosen(real)
    _check(cases, waves, seed)
    folder, watch = Path(out), observer or Observer()
    lines: list[str] = []
    scores: list[Score] = []
    if page or not chosen:
        lines, scores = _blind(cases, waves, seed, folder, spread, watch)
    for name in chosen or (REAL if page else ()):
        more, others = _real(name, seed, folder, watch)
        lines, scores = [*lines, *([""] if lines else []), *more], [*scores, *others]
    report = Path(page) if page else folder / f"{_title(chosen)}.md"
    lines = _headed(lines) if page else lines
    write_atomically(report, plain("\n".join(lines) + "\n"))
    return Scored(tuple(lines), tuple(scores), report)


def _check(cases: int, waves: int, seed: int) -> None:
    """Raise BenchError where a number cannot be meant."""
    for name, value, least in (("cases", cases, 1), ("waves", waves, 0), ("seed", seed, 0)):
        if value < least:
            raise BenchError(f"--{name} {value}: expected a whole number of at least {least}")


def _chosen(real: str | Iterable[str]) -> tuple[str, ...]:
    """Return the real cases asked for. Raises BenchError on an unknown one."""
    if real == "all":
        return tuple(REAL)
    names = [one.strip() for one in (real.split(",") if isinstance(real, str) else real)]
    for name in filter(None, names):
        if name not in REAL:
            raise unknown_name("real case", name, REAL)
    return tuple(filter(None, names))


def _title(chosen: tuple[str, ...]) -> str:
    """Return the name of the report's file."""
    if not chosen:
        return "blind"
    return chosen[0] if len(chosen) == 1 else "real"


def _headed(lines: list[str]) -> list[str]:
    """Return the lines of a page that holds everything under one head, with how it was made."""
    machine = describe_machine()
    words = (
        "Made by `bench challenge --page`: physics hidden from `bench diagnose`, in simulated "
        "recordings by a generator that shares no code with the effect library, and in public "
        "recordings by hiding the columns that would reveal it. Bars that are missed say **no**; "
        "why, says [How far to trust it](diagnose.md#how-far-to-trust-it)."
    )
    where = f"Machine: {machine['cpu']}, {machine['cores']} cores."
    return ["# Challenge", "", words, "", where, "", *lines]


def _blind(
    cases: int, waves: int, seed: int, folder: Path, spread: Spread, watch: Observer
) -> tuple[list[str], list[Score]]:
    """Run the blind cases; return report lines and scores."""
    watch.note(f"sealed answers: sha256 {seal(cases, seed, waves)}")
    outcomes = run_blind(cases, seed, folder, watch.stage, spread, waves)
    scores: list[Score] = [
        {"score": r.words, "hits": r.hits, "cases": r.cases, "bar": r.bar, "met": r.met}
        for r in rates(outcomes)
    ]
    return blind_markdown(outcomes, seed), scores


def _real(name: str, seed: int, folder: Path, watch: Observer) -> tuple[list[str], list[Score]]:
    """Run a real case; return report lines and scores. Its figures go to `folder`/`name`."""
    try:
        table = open_recordings(name)[0]
    except BenchError as problem:
        return [f"## {name}", "", f"Not run: {problem}", ""], []
    made = REAL[name](table, seed, watch.stage)
    report = write_report(made.diagnosis, folder / name).relative_to(folder)
    full = f"The diagnosis in full, with its figures: {report} (seed {seed})"
    scores = [
        {"case": made.title, "asked": c.asked, "measured": c.measured, "met": bool(c.met)}
        for c in made.checks
    ]
    return [*_case_lines(made), full, ""], scores


def _case_lines(made: RealCase) -> list[str]:
    """Return a real case as Markdown."""
    out = [f"## {made.title}", "", "| asked | measured | met |", "| --- | --- | --- |"]
    out += [f"| {c.asked} | {c.measured} | {'yes' if c.met else '**no**'} |" for c in made.checks]
    out += ["", "What the diagnosis said:", ""]
    for verdict in made.diagnosis.selection.verdicts:
        out += [*describe(verdict), ""]
    return [*out, *made.lines, ""]
