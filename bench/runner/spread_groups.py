"""Whole groups of a run - a model and seed on every backend - made by other processes.

Each writes its runs into the folder as it would here; only what was made, and what was noted,
comes back. Nothing is timed there.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from concurrent.futures.process import BrokenProcessPool
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

from bench.errors import BenchError
from bench.parallel import Spread
from bench.plugins import Plugin
from bench.results import RunRecord
from bench.runner.failure import Failure
from bench.runner.folder import ResultFolder
from bench.runner.groups import run_group
from bench.runner.material import Material
from bench.runner.observer import Observer
from bench.runner.plan import Plan

if TYPE_CHECKING:
    from zoo.base import TrainingRecipe

Outcomes = list[RunRecord | Failure]


@dataclass(frozen=True)
class Shared:
    """What every group needs; `threads` as in the asking process, which the keys of runs name."""

    plan: Plan
    material: Material
    folder: ResultFolder
    threads: int


class Notes(Observer):
    """Keeps what is noted, to be told where somebody watches."""

    def __init__(self) -> None:
        self.lines: list[str] = []

    def note(self, line: str) -> None:
        """Keep a line."""
        self.lines.append(line)


@dataclass
class GroupsAhead:
    """Groups being made by other processes; `arrived` waits for one."""

    _waiting: dict[int, tuple[Plugin, int]]
    _done: Iterator[tuple[int, tuple[Outcomes, list[str]]]]
    _watch: Observer
    _made: dict[tuple[str, int], Outcomes] = field(default_factory=dict)

    def arrived(self, model: Plugin, seed: int) -> Outcomes | None:
        """Return what a model and seed gave; None where nobody was asked, or the process died."""
        total = len(self._waiting) + len(self._made)
        with suppress(BrokenProcessPool):  # out of memory, say: the caller makes the rest itself
            while (model, seed) in self._waiting.values():
                self._watch.progress(f"running {total} models", len(self._made) / total)
                at, (outcomes, notes) = next(self._done)
                name, of_seed = self._waiting.pop(at)
                self._made[name.name, of_seed] = outcomes
                for line in notes:
                    self._watch.note(line)
        return self._made.get((model.name, seed))


@contextmanager
def groups_ahead(
    groups: Sequence[tuple[Plugin, int]], shared: Shared, spread: Spread, watch: Observer
) -> Iterator[GroupsAhead]:
    """Have other processes run groups, teachers before those they teach, short ones last."""
    order = sorted(groups, key=lambda group: _turn(group[0], len(shared.material.errors_m)))
    done = spread.map(made, shared, order)
    try:
        yield GroupsAhead(dict(enumerate(order)), done, watch)
    finally:
        if isinstance(done, Generator):
            done.close()


def _turn(model: Plugin, rows: int) -> tuple[bool, bool, int]:
    """Return what decides whose turn it is, least first.

    What is trained by gradient descent, on `qat` once more, comes before what is not; what
    another model teaches comes after those that nothing teaches, when its teacher's fit is there;
    more rows to see come before fewer. Floors, done in no time, are last.
    """
    try:
        made = model.make()
        recipe = made.training_recipe()
        teacher = getattr(made, "teacher", lambda: None)()
    except (BenchError, AttributeError):
        return True, False, 0
    if recipe is None:
        return True, bool(getattr(made, "floor", False)), 0
    return False, teacher is not None, -rows_to_see(recipe, rows)


def rows_to_see(recipe: TrainingRecipe, rows: int) -> int:
    """Return how many rows a training goes through at most, each as often as it does."""
    if recipe.stopping is not None:
        return recipe.stopping.most_steps * recipe.batch_size
    return recipe.epochs * rows


def made(shared: Shared, group: tuple[Plugin, int]) -> tuple[Outcomes, list[str]]:
    """Run one group here, with as many threads of torch as the asking process has."""
    import torch

    torch.set_num_threads(shared.threads)
    heard = Notes()
    outcomes = run_group(*group, shared.plan, shared.material, shared.folder, heard)
    return outcomes, heard.lines
