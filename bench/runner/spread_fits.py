"""Fits made ahead of a run, spread over processes or a Dask cluster.

They go into the cache of fits, where the run finds them. Scores and timings are made afterwards
in this process, one after another; only what a fit gives is asked of others.
"""

from __future__ import annotations

from collections.abc import Generator, Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.parallel import Spread, threads
from bench.plugins import Plugin
from bench.runner.fits import fit_on, is_kept, new_model, place_of, state_of
from bench.runner.kept_arrays import write_arrays
from bench.runner.material import Material
from bench.runner.observer import Observer

MANY_ROWS = 100_000
"""Training rows over all fits from which starting processes (3 to 5 s each) is worth it."""


@dataclass(frozen=True)
class Fit:
    """One model, seed and fold to fit; `threads` as here where the bits depend on their number."""

    model: Plugin
    seed: int
    fold: int
    threads: int | None


@dataclass
class FitsAhead:
    """Fits being made by other processes; `arrived` waits for those of one model and seed."""

    _waiting: dict[int, tuple[Fit, tuple[Path, dict[str, Any]]]]
    _done: Iterator[tuple[int, Any]]
    _watch: Observer

    def arrived(self, model: Plugin, seed: int) -> None:
        """Keep what has been fitted until every fold of this model and seed is in the cache.

        Raises BenchError where the cluster cannot be reached.
        """
        total = len(self._waiting)
        while any((fit.model, fit.seed) == (model, seed) for fit, _ in self._waiting.values()):
            at, state = next(self._done)
            _, place = self._waiting.pop(at)
            if state is not None:
                write_arrays(*place, state)
            self._watch.progress(f"fitting: {total} fits", 1 - len(self._waiting) / total)


def worth_spreading(models: int, material: Material, spread: Spread | None) -> bool:
    """Return whether fits of so many models may be spread, were none of them kept."""
    if spread is not None:
        return spread.spreads
    return models * sum(len(fold.train) for fold in material.split.folds) >= MANY_ROWS


@contextmanager
def fits_ahead(
    models: Sequence[tuple[Plugin, int]], material: Material, spread: Spread | None, watch: Observer
) -> Iterator[FitsAhead]:
    """Have others fit models, each with a seed, on every fold, unless the cache has them.

    The run goes on with what has arrived. A fit that fails is left out: the run meets the same
    failure and reports it. `spread` None: as many processes as `threads()` says where the fits
    have `MANY_ROWS` in all, none else.
    """
    folds = range(len(material.split.folds))
    missing = [
        (Fit(model, seed, fold, place[1]["threads"]), place)
        for model, seed in models
        for fold in folds
        if (place := _missing(model, material, fold, seed)) is not None
    ]
    spread = spread or _by_size(material, [fit for fit, _ in missing])
    if not spread.spreads:
        missing = []  # the run fits them itself, when it needs them
    done = spread.map(fitted, material.sent(), [fit for fit, _ in missing])
    try:
        yield FitsAhead(dict(enumerate(missing)), done, watch)
    finally:
        if isinstance(done, Generator):
            done.close()


def _by_size(material: Material, fits: Sequence[Fit]) -> Spread:
    """Return all cores for long work, one process for what is done before others have started."""
    rows = sum(len(material.split.folds[fit.fold].train) for fit in fits)
    return Spread(threads() if rows >= MANY_ROWS else 1)


def _missing(
    model: Plugin, material: Material, fold: int, seed: int
) -> tuple[Path, dict[str, Any]] | None:
    """Return where a fit is to be kept; None where it is, or where the model cannot be made."""
    try:
        place = place_of(model, material, fold, seed)
    except Exception:  # the run makes it again, and reports why it cannot
        return None
    return None if is_kept(*place) else place


def fitted(material: Material, task: Fit) -> dict[str, Any] | None:
    """Return the arrays of a fitted model, None where it has none or cannot be fitted."""
    try:
        if task.threads is not None:
            import torch

            torch.set_num_threads(task.threads)
        model = new_model(task.model, task.seed)
        fit_on(model, material, task.fold)
        return state_of(model)
    except (Exception, SystemExit):  # the run fits it again, and reports why it fails
        return None
