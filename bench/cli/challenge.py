"""`bench challenge`: put the diagnosis to the proof."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.errors import BenchError

if TYPE_CHECKING:
    from bench.challenge.blind import Progress
    from bench.challenge.real import RealCase

EPILOG = """\b
Examples:
  bench challenge --cases 240 --waves 40 --jobs 2 -o challenge
  bench challenge --real -o challenge
  bench challenge --case apartment -o challenge
  bench challenge --cases 240 --waves 40 --jobs 2 -o challenge --page challenge.md
"""
Scored = tuple[list[str], list[dict[str, object]]]
REAL = ("ghent", "outdoor", "apartment")


@click.command(epilog=EPILOG)
@click.option("--cases", default=40, show_default=True, type=click.IntRange(1), help="Blind cases.")
@click.option(
    "--waves", default=0, show_default=True, type=click.IntRange(0),
    help="More blind cases, with effects in the waveform (about 40 s each).",
)  # fmt: skip
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed.")
@click.option("--jobs", default=1, show_default=True, type=click.IntRange(1), help="Processes.")
@click.option("--real", is_flag=True, help="The real cases instead of blind ones.")
@click.option("--case", "only", type=click.Choice(REAL), help="Only this real case.")
@click.option(
    "-o", "--out", default="challenge", show_default=True, type=click.Path(path_type=Path),
    help="Folder; finished blind cases found there are kept.",
)  # fmt: skip
@click.option(
    "--page", type=click.Path(path_type=Path, dir_okay=False),
    help="Blind and real cases both, on one Markdown page.",
)  # fmt: skip
@click.option("--json", "as_json", is_flag=True, help="Print the scores as JSON, nothing else.")
def command(
    cases: int,
    waves: int,
    seed: int,
    jobs: int,
    real: bool,
    only: str | None,
    out: Path,
    page: Path | None,
    as_json: bool,
) -> None:
    """Hide physics from the diagnosis and score what it says.

    Blind cases come from a generator that shares no code with the effect library; answers are
    sealed by a hash before the run. Strengths in millimetres rms of the range. Real cases are
    recordings (see BENCH_DATA) whose revealing columns are hidden; those not here are left out.
    """
    import json

    from rich.console import Console

    from bench.files import write_atomically

    wanted = REAL if only is None else (only,)
    lines: list[str] = []
    scores: list[dict[str, object]] = []
    with Console(stderr=True).status("challenging ...") as status:
        if page or not (real or only):
            lines, scores = _blind(cases, waves, seed, jobs, out, status.update)
        if page or real or only:
            more, others = _real(wanted, seed, out, status.update)
            lines, scores = [*lines, *([""] if lines else []), *more], [*scores, *others]
    path = page or out / (f"{only or 'real'}.md" if real or only else "blind.md")
    write_atomically(path, "\n".join(_headed(lines, page)) + "\n")
    if as_json:
        click.echo(json.dumps(scores, indent=1))
    else:
        click.echo("\n".join(lines))
        click.echo(f"report: {path}", err=True)


def _headed(lines: list[str], page: Path | None) -> list[str]:
    """Return the lines of a page that holds everything under one head, with how it was made."""
    if page is None:
        return lines
    from bench.measure.machine import describe_machine

    machine = describe_machine()
    words = (
        "Made by `bench challenge --page`: physics hidden from `bench diagnose`, in simulated "
        "recordings by a generator that shares no code with the effect library, and in public "
        "recordings by hiding the columns that would reveal it. Bars that are missed say **no**; "
        "why, says [How far to trust it](diagnose.md#how-far-to-trust-it)."
    )
    return [
        "# Challenge",
        "",
        words,
        "",
        f"Machine: {machine['cpu']}, {machine['cores']} cores.",
        "",
        *lines,
    ]


def _blind(cases: int, waves: int, seed: int, jobs: int, out: Path, tell: Progress) -> Scored:
    """Run the blind cases; return report lines and scores."""
    from bench.challenge.blind import run_blind, seal
    from bench.challenge.blind_report import blind_markdown, rates
    from bench.parallel import Spread

    click.echo(f"sealed answers: sha256 {seal(cases, seed, waves)}", err=True)
    outcomes = run_blind(cases, seed, out, tell, Spread(jobs), waves)
    scores: list[dict[str, object]] = [
        {"score": r.words, "hits": r.hits, "cases": r.cases, "bar": r.bar, "met": r.met}
        for r in rates(outcomes)
    ]
    return blind_markdown(outcomes, seed), scores


def _real(wanted: tuple[str, ...], seed: int, out: Path, tell: Progress) -> Scored:
    """Run real cases; return report lines and scores. Each case's figures go to `out`/<case>."""
    from bench.challenge.apartment import apartment
    from bench.challenge.real import ghent, outdoor
    from bench.discrepancy.report.document import write_report
    from bench.recordings.open import open_recordings

    cases = {"ghent": ghent, "outdoor": outdoor, "apartment": apartment}
    lines: list[str] = []
    scores: list[dict[str, object]] = []
    for name in wanted:
        case = cases[name]
        try:
            table = open_recordings(name)[0]
        except BenchError as problem:
            lines += [f"## {name}", "", f"Not run: {problem}", ""]
            continue
        made = case(table, seed, tell)
        lines += _case_lines(made)
        report = write_report(made.diagnosis, out / name).relative_to(out)
        lines += [f"The diagnosis in full, with its figures: {report} (seed {seed})", ""]
        scores += [
            {"case": made.title, "asked": c.asked, "measured": c.measured, "met": bool(c.met)}
            for c in made.checks
        ]
    return lines, scores


def _case_lines(made: RealCase) -> list[str]:
    """Return a real case as Markdown."""
    from bench.discrepancy.report.document import describe

    out = [f"## {made.title}", "", "| asked | measured | met |", "| --- | --- | --- |"]
    out += [f"| {c.asked} | {c.measured} | {'yes' if c.met else '**no**'} |" for c in made.checks]
    out += ["", "What the diagnosis said:", ""]
    for verdict in made.diagnosis.selection.verdicts:
        out += [*describe(verdict), ""]
    return [*out, *made.lines, ""]
