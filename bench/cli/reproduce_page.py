"""`bench reproduce --page`: one page that stands alone, with what it rests on."""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from itertools import pairwise
from pathlib import Path

from bench.errors import BenchError
from bench.files import atomic_path, write_atomically
from bench.provenance import commit
from bench.reproduce.api import DECISIVE, Reproduction
from bench.reproduce.catalogue import experiments


def write_page(page: Path, done: Reproduction) -> None:
    """Write the outcomes done as one Markdown page, the pictures (PNG) in a folder of its name.

    Raises BenchError where the file is no .md or an outcome cannot be read.
    """
    from reports import ReportError
    from reports.markdown import to_markdown
    from reports.reproduction import full_page, pictures, read_outcome

    check_page(page)
    try:
        outcomes = [read_outcome(path) for path in done.files]
    except ReportError as problem:
        raise BenchError(str(problem)) from problem
    for one in outcomes:
        for name, save in pictures(one):
            if name.endswith(".png"):
                with atomic_path(page.with_suffix("") / Path(name).name) as scratch:
                    save(scratch)
    facts = [*_facts(), *_left_out(done)]
    document = full_page(outcomes, done.impossible, facts, page.stem)
    write_atomically(page, to_markdown(document))


def check_page(page: Path) -> None:
    """Raise BenchError unless the name is that of a Markdown file."""
    if page.suffix != ".md":
        raise BenchError(f"--page {page}: expected a name that ends in .md")


def _facts() -> list[str]:
    return [
        f"Made by: bench {' '.join(_typed(sys.argv[1:]))}",
        f"Source: commit {commit(DECISIVE)}; every outcome was made by this source, or by one that "
        "does not differ in what decides it.",
    ]


def _left_out(done: Reproduction) -> list[str]:
    """Return a line on the experiments that were not asked for, nothing where there are none."""
    asked = {path.stem for path in done.files} | {name for name, _ in done.impossible}
    left_out = [one.name for one in experiments() if one.name not in asked]
    return [f"Not on this page: {', '.join(left_out)}."] if left_out else []


def _typed(words: Sequence[str]) -> Iterator[str]:
    """Yield the words of the command without its result folder, which decides nothing."""
    for before, word in pairwise(["", *words]):
        if "--out" not in (before, word) and not word.startswith("--out="):
            yield word
