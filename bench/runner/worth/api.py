"""`bench.worth`: how many links must be surveyed, with and without a diagnosed simulator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from time import monotonic

from bench.errors import BenchError
from bench.recordings.open import Table
from bench.runner.observer import Observer
from bench.runner.worth.learners import simulated
from bench.runner.worth.remains import remains
from bench.runner.worth.scores import Kept, Task, scored, tasks
from bench.runner.worth.settings import DRAWS, LINKS
from bench.runner.worth.site import Site, seed_of, site
from bench.runner.worth.table import Split, Worth, table


def worth(
    diagnosis: str | Path | Sequence[str | Path],
    *,
    links: Sequence[int] = LINKS,
    draws: int = DRAWS,
    recorded: Table | None = None,
    minutes: float | None = None,
    observer: Observer | None = None,
) -> Worth:
    """Compare corrections learnt from few surveyed links with those that a simulator helps.

    `diagnosis`: folders that `bench diagnose -o` wrote of the same recordings with different
    seeds: each one's sealed links are a split. `links`: how many of the others are surveyed, in
    `draws` draws each, and all of them. `recorded` where the recordings have moved. After
    `minutes` no new fit begins; the same call goes on from what is kept in the folders. Raises
    BenchError on bad input.

    >>> worth("nowhere")
    Traceback (most recent call last):
    bench.errors.BenchError: nowhere: no diagnosis there; expected a folder of `bench diagnose -o`
    """
    counts = _checked(links, draws, minutes)
    folders = [diagnosis] if isinstance(diagnosis, str | Path) else list(diagnosis)
    if not folders:
        raise BenchError("no diagnosis named; expected a folder of `bench diagnose -o`")
    watch, end = observer or Observer(), monotonic() + 60 * (minutes or float("inf"))
    made: list[Split] = []
    sites: list[Site] = []
    planned = 0
    _check_apart(folders)
    for folder in map(Path, folders):
        watch.stage(f"{folder}: simulating")
        here = site(folder, recorded)
        sites.append(here)
        todo = tasks(here, counts, draws)
        planned += len(todo)
        made.append(_split(folder, here, todo, end, watch))
    return replace(table(made, counts, planned), remains=remains(sites))


def _checked(links: Sequence[int], draws: int, minutes: float | None) -> tuple[int, ...]:
    """Return the numbers of links, ascending. Raises BenchError where one makes no sense."""
    if not links or min(links) < 1:
        raise BenchError(f"--links {','.join(map(str, links))}: expected whole numbers from 1")
    if draws < 1:
        raise BenchError(f"--draws {draws}: expected a whole number of at least 1")
    if minutes is not None and not minutes > 0:
        raise BenchError(f"--minutes {minutes:g}: expected a time above zero")
    return tuple(sorted(set(links)))


def _check_apart(folders: Sequence[str | Path]) -> None:
    """Raise BenchError where a folder is no diagnosis, or two hold out the same links."""
    known: dict[int, str | Path] = {}
    for folder in folders:
        seed = seed_of(Path(folder))
        if seed in known:
            raise BenchError(
                f"{folder} and {known[seed]}: seed {seed} twice; expected other splits"
            )
        known[seed] = folder


def _split(folder: Path, here: Site, todo: list[Task], end: float, watch: Observer) -> Split:
    """Return the scores of one split; what is kept is not done again."""
    kept = Kept(folder, here)
    missing = [task for task in todo if not kept.has(task)]
    trained = simulated(here) if missing and monotonic() < end else {}
    for number, task in enumerate(missing):
        if monotonic() > end:
            watch.note(f"{folder}: {len(missing) - number} fits left for the next time")
            break
        watch.progress(f"{folder}: training", number / len(missing))
        kept.add(scored(here, task, trained))
    wanted = {(task.links, task.draw) for task in todo}
    scores = tuple(s for s in kept.scores if (s.links, s.draw) in wanted)
    return Split(here.seed, len(here.survey.names), scores)
