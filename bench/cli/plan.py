"""`bench plan`: which measurement next."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import print_json, print_table, say
from bench.text import named

if TYPE_CHECKING:
    from bench.planning.choose import Worth
    from bench.planning.plan import Answer

EPILOG = """\b
Examples:
  bench plan --diagnosis diagnosis
  bench plan --diagnosis diagnosis --links 20 -o plan.csv
"""
HOPELESS = 0.05  # of cases that a plan settles, below which it is not worth the work
SHOWN, PAIRS = 12, 4  # measurements, and the pairs of explanations that are hardest to tell


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.option(
    "--diagnosis", required=True, metavar="DIR", help="What `bench diagnose -o DIR` wrote."
)
@click.option(
    "--links", type=int, metavar="N", help="Links that can be measured; default: enough for 95 %."
)
@click.option("--seed", default=0, show_default=True, type=click.IntRange(0), help="Seed.")
@click.option("-o", "--out", type=click.Path(path_type=Path), help="CSV of the planned links.")
@click.option("--json", "as_json", is_flag=True, help="Print the plan as JSON, nothing else.")
def command(diagnosis: str, links: int | None, seed: int, out: Path | None, as_json: bool) -> None:
    """Say which measurement tells apart what a diagnosis cannot.

    For every "X or Y" (and for what has no name) the measurements that can be made are simulated
    under each explanation, with the parameters that the recordings leave open and the noise that
    they show. What a measurement brings is counted in nats: 3 nats are odds of 20 to 1. Figures
    are SIMULATED expectations. Where nothing is open, it says so.
    """
    from bench.cli.status_view import StatusView
    from bench.runner.planning import plan

    with StatusView("planning ...") as view:
        made = plan(diagnosis, links=links, seed=seed, out=out, observer=view)
    if as_json:
        print_json(made.summary())
        return
    if not made.answers:
        say(f"Nothing is ambiguous or unknown in {named(diagnosis)}: no measurement is needed.")
        say(named(made.headline))
        return
    for one in made.answers:
        _print(one)
    if out is not None and out.exists():
        say(f"planned links: {named(out)}")


def _print(answer: Answer) -> None:
    """Print one question's measurements and plan."""
    if answer.note:
        say(f"{answer.question}: {answer.note}.")
        return
    title = f"{answer.question}: measurements, best first (SIMULATED expectation)"
    columns = (
        "measurement",
        "nats per link",
        "of the pair it tells best",
        "links for 95 %",
    )
    rows = [_ranked(answer, worth) for worth in answer.worth[:SHOWN]]
    print_table(title, columns, rows)
    links = sum(answer.links)
    say(f"Plan: {links} links of {answer.rows} rows each, {links * answer.rows} rows in all")
    for measurement, count in answer.planned():
        say(f"  {count} links: {measurement.words}")
        say(f"    {answer.why(measurement)}")
    least = sorted(answer.nats.items(), key=lambda one: one[1])
    for pair, nats in least[:PAIRS]:
        say(f"  expected for {pair}: {nats:.1f} nats")
    if len(least) > PAIRS:
        say(f"  and {len(least) - PAIRS} pairs with more")
    sure = f"expected to settle it in {answer.probability:.0%} of cases"
    say(sure if answer.sure else f"NOT ENOUGH: {sure}; more links, or another kind of measurement")
    if answer.probability < HOPELESS:
        say("Not worth recording for this question: none of what can be changed settles it.")
    else:
        say("Record these with everything else as before, append them, and diagnose again.")


def _ranked(answer: Answer, worth: Worth) -> tuple[str, ...]:
    """Return one measurement as a row of the table."""
    best = f"{worth.most_nats:.2f} ({' | '.join(worth.best)})"
    enough = str(worth.links) if worth.links else "not by this alone"
    return answer.offered[worth.place].words, f"{worth.nats:.2f}", best, enough
