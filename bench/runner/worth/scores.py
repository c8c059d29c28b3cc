"""Every way on every number of surveyed links, draw by draw; kept beside the diagnosis."""

from __future__ import annotations

import json
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from pathlib import Path

import numpy as np

from bench.errors import BenchError
from bench.files import read_json, write_atomically
from bench.provenance import decisive_versions, json_digest, packages_code_hash
from bench.runner.worth import learners
from bench.runner.worth.learners import Floats, Network
from bench.runner.worth.site import Examples, Site

FILE = "worth.json"
CODE = ("bench/runner/worth", "zoo")


@dataclass(frozen=True)
class Scored:
    """One way on one split: mean |error left| of each sealed link in metres.

    `links` surveyed (0: none needed), of which `draw`.
    """

    way: str
    links: int
    draw: int
    left_m: dict[str, float]


@dataclass(frozen=True)
class Task:
    """So many surveyed links, one draw of them."""

    links: int
    draw: int


def tasks(site: Site, links: tuple[int, ...], draws: int) -> list[Task]:
    """Return what is to be done: few links in several draws, then all there are once."""
    every = len(site.survey.names)
    few = [Task(k, draw) for draw in range(draws) for k in links if k < every]
    return [Task(0, 0), *few, Task(every, 0)]


def surveyed(site: Site, task: Task) -> Examples:
    """Return the rows of the links of a draw; more links hold those of fewer."""
    order = np.random.default_rng([site.seed, task.draw]).permutation(site.survey.names)
    return site.survey.of(order[: task.links])


def scored(site: Site, task: Task, trained: dict[str, Network]) -> list[Scored]:
    """Return how every way does with the links of one draw."""
    made = _without_links(site, trained) if not task.links else _with_links(site, task, trained)
    return [Scored(way, task.links, task.draw, _left(site.sealed, p)) for way, p in made]


def _without_links(site: Site, trained: dict[str, Network]) -> Iterator[tuple[str, Floats]]:
    """Yield ways that need no surveyed link."""
    yield "none", np.zeros(len(site.sealed.errors_m))
    for way, model in trained.items():
        yield way, model.predict(site.sealed)


def _with_links(
    site: Site, task: Task, trained: dict[str, Network]
) -> Iterator[tuple[str, Floats]]:
    """Yield ways that learn from surveyed links."""
    known, sealed = surveyed(site, task), site.sealed
    yield "real", Network(known, site.seed).predict(sealed)
    yield "constant", np.full(len(sealed.errors_m), learners.constant(known))
    yield "boosting", learners.boosting(known, sealed, site.seed)
    for way, model in trained.items():
        shift = learners.offset(model, known)
        yield f"{way}+tuned", model.further(known).predict(sealed)
        yield f"{way}+offset", model.predict(sealed) + shift


def _left(sealed: Examples, predicted_m: Floats) -> dict[str, float]:
    """Return the mean |error left| of each sealed link in metres."""
    left = np.abs(sealed.errors_m - predicted_m)
    return {str(name): float(left[sealed.links == name].mean()) for name in sealed.names}


class Kept:
    """What was scored before, in a file beside the diagnosis; another code or input drops it."""

    def __init__(self, folder: Path, site: Site) -> None:
        self.path = folder / FILE
        parts = [site.fingerprint, packages_code_hash(*CODE), decisive_versions()]
        self.mark = json_digest(parts, 16)
        self.scores = self._read()

    def _read(self) -> list[Scored]:
        try:
            found = read_json(self.path)
            same = found["mark"] == self.mark
            return [Scored(**one) for one in found["scores"]] if same else []
        except (BenchError, KeyError, TypeError):
            return []

    def has(self, task: Task) -> bool:
        """Return whether a task is done."""
        return any((s.links, s.draw) == (task.links, task.draw) for s in self.scores)

    def add(self, scores: list[Scored]) -> None:
        """Keep the scores of a task."""
        self.scores += scores
        content = {"mark": self.mark, "scores": [asdict(one) for one in self.scores]}
        write_atomically(self.path, json.dumps(content) + "\n")
