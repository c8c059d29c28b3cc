"""`bench.challenge`: physics hidden from the diagnosis, and a score of what it says."""

from __future__ import annotations

import json
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.challenge.apartment import apartment
from bench.challenge.blind import run_blind, seal
from bench.challenge.blind_report import blind_markdown
from bench.challenge.families.case import FAMILIES, MODES
from bench.challenge.rates import rates
from bench.challenge.real import RealCase, ghent, miluv, outdoor
from bench.discrepancy import write_report
from bench.discrepancy.report.found_lines import describe
from bench.errors import BenchError, unknown_name
from bench.files import read_json, write_atomically
from bench.measure.machine import describe_machine
from bench.parallel import Spread
from bench.provenance import is_sealed, json_digest, packages_code_hash, sealed
from bench.recordings.open import open_recordings
from bench.recordings.table import Recordings
from bench.runner.observer import Observer
from bench.text import plain

CODE = ("bench/challenge", "bench/discrepancy", "bench/physics", "bench/recordings")
REAL = {"ghent": ghent, "outdoor": outdoor, "apartment": apartment, "miluv": miluv}
Score = dict[str, Any]


@dataclass(frozen=True)
class Scored:
    """A challenge that was run: the report's lines and file, and every score beside its bar."""

    lines: tuple[str, ...]
    scores: tuple[Score, ...]
    report: Path


def run_challenge(
    cases: int = 40,
    seed: int = 0,
    *,
    families: str | Iterable[str] = (),
    real: str | Iterable[str] = (),
    out: str | Path = "challenge",
    page: str | Path | None = None,
    jobs: int = 1,
    scheduler: str | None = None,
    observer: Observer | None = None,
) -> Scored:
    """Hide physics from the diagnosis and score what it says.

    `cases` blind ones come from families of generators that share no code with the effect library
    nor with each other (all, or those of `families`); answers are sealed by a hash before the run,
    and `bench.diagnose` is called with its defaults. `real` names recordings ("ghent", "outdoor",
    "apartment", "miluv", several, or "all") whose revealing columns are hidden: these are run
    instead, or as well where everything goes on one `page`. Finished blind
    cases found under `out` are kept. `jobs` processes or a Dask `scheduler` share the blind cases;
    outcomes do not depend on it. Raises BenchError on bad input, before anything is run.

    >>> import bench
    >>> bench.challenge(cases=3, real="gent")
    Traceback (most recent call last):
    bench.errors.BenchError: unknown real case 'gent'; did you mean 'ghent'? ...
    """
    spread, chosen = Spread(jobs, scheduler), _among("real case", real, REAL)
    some = _among("family", families, FAMILIES)
    some = () if set(some) == set(FAMILIES) else some
    _check(cases, seed)
    folder, watch = Path(out), observer or Observer()
    lines: list[str] = []
    scores: list[Score] = []
    if page or not chosen:
        lines, scores = _blind(cases, seed, some, folder, spread, watch)
    for name in chosen or (REAL if page else ()):
        more, others = _real(name, seed, folder, watch)
        lines, scores = [*lines, *([""] if lines else []), *more], [*scores, *others]
    report = Path(page) if page else folder / f"{_title(chosen)}.md"
    lines = _headed(lines) if page else lines
    write_atomically(report, plain("\n".join(lines) + "\n"))
    return Scored(tuple(lines), tuple(scores), report)


def _check(cases: int, seed: int) -> None:
    """Raise BenchError where a number cannot be meant."""
    for name, value, least in (("cases", cases, 1), ("seed", seed, 0)):
        if value < least:
            raise BenchError(f"--{name} {value}: expected a whole number of at least {least}")


def _among(kind: str, asked: str | Iterable[str], known: Iterable[str]) -> tuple[str, ...]:
    """Return the names asked for. Raises BenchError on an unknown one."""
    if asked == "all":
        return tuple(known)
    names = [one.strip() for one in (asked.split(",") if isinstance(asked, str) else asked)]
    for name in filter(None, names):
        if name not in known:
            raise unknown_name(kind, name, known)
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
        "recordings by families of generators that share no code with the effect library nor with "
        "each other, and in public recordings by hiding the columns that would reveal it. Bars "
        "that are missed are listed first, with what the misses were; "
        "why, says [How far to trust it](diagnose.md#how-far-to-trust-it)."
    )
    where = f"Machine: {machine['cpu']}, {machine['cores']} cores."
    return ["# Challenge", "", words, "", where, "", *lines]


def _blind(
    cases: int,
    seed: int,
    families: tuple[str, ...],
    folder: Path,
    spread: Spread,
    watch: Observer,
) -> tuple[list[str], list[Score]]:
    """Run the blind cases; return report lines and scores."""
    watch.note(f"sealed answers: sha256 {seal(cases, seed, families)}")
    outcomes = run_blind(cases, seed, folder, watch.stage, spread, families)
    scores: list[Score] = [
        {"mode": mode, "score": r.words, "hits": r.hits, "cases": r.cases}
        | {"interval": list(r.interval), "bar": r.bar, "met": r.met, "causes": r.causes}
        for mode in MODES
        for r in rates([o for o in outcomes if o.mode == mode])
        if r.cases
    ]
    return blind_markdown(outcomes, seed, families), scores


def _real(name: str, seed: int, folder: Path, watch: Observer) -> tuple[list[str], list[Score]]:
    """Run a real case; return report lines and scores. Its figures go to `folder`/`name`.

    What the same code found of the same recordings before, in the same folder, is kept.
    """
    try:
        table = open_recordings(name)[0]
    except BenchError as problem:
        return [f"## {name}", "", f"Not run: {problem}", ""], []
    path = folder / name / "scored.json"
    mark = json_digest([packages_code_hash(*CODE), table.fingerprint, seed])
    kept = read_json(path) if path.exists() else {}
    if not (is_sealed(kept) and kept.get("mark") == mark):
        lines, scores = _run_real(name, table, seed, folder, watch)
        kept = sealed({"mark": mark, "lines": lines, "scores": scores})
        write_atomically(path, json.dumps(kept, indent=1) + "\n")
    return kept["lines"], kept["scores"]


def _run_real(
    name: str, table: Recordings, seed: int, folder: Path, watch: Observer
) -> tuple[list[str], list[Score]]:
    """Run a real case; return report lines and scores."""
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
