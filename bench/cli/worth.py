"""`bench worth`: how many links must be surveyed."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import click

from bench.cli.console import print_json, print_table, say

if TYPE_CHECKING:
    from bench.runner.worth.table import Worth

EPILOG = """\b
Examples:
  bench worth --diagnosis diagnosis
  bench worth --diagnosis seed0 --diagnosis seed1 --links 2,4,8 --minutes 10
"""


@click.command(epilog=EPILOG, no_args_is_help=True)
@click.option(
    "--diagnosis",
    "diagnoses",
    required=True,
    multiple=True,
    metavar="DIR",
    help="What `bench diagnose -o DIR` wrote; several of other seeds are several splits.",
)
@click.option("--recorded", metavar="NAME|PATH", help="The recordings, where they have moved.")
@click.option("--links", default="2,4,8", show_default=True, metavar="K,..", help="Surveyed links.")
@click.option("--draws", default=3, show_default=True, metavar="N", help="Draws of so many links.")
@click.option("--minutes", type=float, help="Begin no new fit after; the same command goes on.")
@click.option("--json", "as_json", is_flag=True, help="Print the table as JSON, nothing else.")
def command(
    diagnoses: tuple[str, ...],
    recorded: str | None,
    links: str,
    draws: int,
    minutes: float | None,
    as_json: bool,
) -> None:
    """Say what a diagnosis is worth: how many links must be surveyed with and without it.

    On the sealed links of the diagnosis: mean |error| left (m) by a small network trained on few
    surveyed links alone, on simulated rows of the original and of the diagnosed simulator, and on
    these and then on the links; beside a constant and gradient boosting. The diagnosed simulator
    has seen all links but the sealed ones. Intervals (95 %) are over links.
    """
    from bench.cli.status_view import StatusView
    from bench.errors import BenchError
    from bench.runner.worth.api import worth

    words = [word.strip() for word in links.split(",")]
    if not all(word.isdecimal() for word in words):
        raise BenchError(f"--links {links}: expected whole numbers, such as 2,4,8")
    with StatusView("reading ...") as view:
        made = worth(
            [Path(one) for one in diagnoses], links=[int(word) for word in words], draws=draws,
            recorded=recorded, minutes=minutes, observer=view,
        )  # fmt: skip
    if as_json:
        print_json(made.summary())
    else:
        _print(made)


def _print(made: Worth) -> None:
    """Print what is left, then what the diagnosis saves."""
    from bench.runner.worth.table import ALL, WAYS

    counts = (*made.links, ALL)
    head = tuple("all links" if count == ALL else f"{count} links" for count in counts)
    ways = [way for way in WAYS if any((way, count) in made.left for count in counts)]
    for title, cells in (
        ("mean |error| left on sealed RECORDED links, m [95 %]", made.left),
        ("less than surveyed links alone (a), m: above zero is better", made.paired),
    ):
        rows = [
            (WAYS[way], *(str(cells.get((way, count), "-")) for count in counts))
            for way in ways
            if any((way, count) in cells for count in counts)
        ]
        print_table(title, ("learnt from", *head), rows)
    _print_remains(made)
    say(f"{made.sealed_links} sealed links in {made.splits} split(s)")
    if made.done < made.planned:
        say(f"NOT FINISHED: {made.done} of {made.planned} fits; run it again to go on")


def _print_remains(made: Worth) -> None:
    """Print what still tells simulated errors from recorded ones."""
    rows = [
        (f"{one.figure}, m" if one.unit == "m" else f"error goes with {one.figure}, rank corr.",
         *(f"{value:.2f}" for value in (one.recorded, one.original, one.diagnosed)))
        for one in made.remains
    ]  # fmt: skip
    title = "what remains: surveyed RECORDED links beside SIMULATED ones"
    print_table(title, ("figure", "recorded", "original simulator", "diagnosed simulator"), rows)
