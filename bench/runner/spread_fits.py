"""Fits made ahead of a run, spread over processes or a Dask cluster.

They go into the cache of fits, where the run finds them. Scores and timings are made afterwards
in this process, one after another; only what a fit gives is asked of others.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from bench.parallel import Spread
from bench.plugins import Plugin
from bench.runner.fits import fit_on, is_kept, new_model, place_of, state_of, write_state
from bench.runner.material import Material
from bench.runner.observer import Observer


@dataclass(frozen=True)
class Fit:
    """One model, seed and fold to fit; `threads` as here where the bits depend on their number."""

    model: Plugin
    seed: int
    fold: int
    threads: int | None


def fit_ahead(
    models: Sequence[tuple[Plugin, int]], material: Material, spread: Spread, watch: Observer
) -> None:
    """Fit models, each with a seed, on every fold, unless the cache has them.

    One that fails is left out: the run meets the same failure and reports it. Raises BenchError
    where the cluster cannot be reached.
    """
    folds = range(len(material.split.folds))
    missing = [
        (Fit(model, seed, fold, place[1]["threads"]), place)
        for model, seed in models
        for fold in folds
        if (place := _missing(model, material, fold, seed)) is not None
    ]
    done = spread.map(fitted, material, [fit for fit, _ in missing])
    for count, (at, state) in enumerate(done, 1):
        watch.progress(f"fitting: {len(missing)} fits", count / len(missing))
        if state is not None:
            write_state(*missing[at][1], state)


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
