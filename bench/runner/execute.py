"""Every model and seed of a plan on every backend, spread over processes where that takes long."""

from __future__ import annotations

from collections.abc import Iterator
from itertools import product

from bench.errors import BenchError
from bench.parallel import Spread, obey, threads
from bench.plugins import Plugin
from bench.results import RunRecord
from bench.runner.failure import Failure
from bench.runner.folder import ResultFolder
from bench.runner.groups import run_group
from bench.runner.keys import run_key
from bench.runner.material import Material
from bench.runner.observer import Observer
from bench.runner.plan import Plan
from bench.runner.spread_fits import fits_ahead, worth_spreading
from bench.runner.spread_groups import Outcomes, Shared, groups_ahead

Groups = list[tuple[Plugin, int]]


def execute(
    plan: Plan,
    material: Material,
    folder: ResultFolder,
    watch: Observer,
    spread: Spread | None = None,
) -> tuple[list[RunRecord], list[Failure]]:
    """Do every run of the plan that is not done yet; one that breaks does not stop the others.

    `spread` None: over the cores, where the fits are long. Whole models are then given to other
    processes, or, where these are more or a cluster, their fits alone; no latency is measured here.
    """
    obey()
    records: list[RunRecord] = []
    failures: list[Failure] = []
    total = len(plan.models) * len(plan.backends) * len(plan.seeds)
    for outcomes in _outcomes(plan, material, folder, watch, spread):
        for outcome in outcomes:
            (failures if isinstance(outcome, Failure) else records).append(outcome)  # type: ignore[arg-type]
        watch.runs(len(records) + len(failures), total)
    return records, failures


def _outcomes(
    plan: Plan, material: Material, folder: ResultFolder, watch: Observer, spread: Spread | None
) -> Iterator[Outcomes]:
    """Yield what every model and seed gave, in the order of the plan."""
    several = worth_spreading(len(plan.models) * len(plan.seeds), material, spread)
    groups = _unfinished(plan, material, folder) if several else []
    if groups and _in_groups(groups, spread):
        yield from _made_ahead(groups, plan, material, folder, watch, spread)
        return
    with fits_ahead(groups, material, spread, watch) as ahead:
        for model, seed in product(plan.models, plan.seeds):
            ahead.arrived(model, seed)
            yield run_group(model, seed, plan, material, folder, watch)


def _in_groups(groups: Groups, spread: Spread | None) -> bool:
    """Tell whether whole groups keep the processes busy; a cluster does not see the folder."""
    asked = spread or Spread(threads())
    return asked.scheduler is None and 1 < asked.jobs <= 2 * len(groups)


def _made_ahead(
    groups: Groups,
    plan: Plan,
    material: Material,
    folder: ResultFolder,
    watch: Observer,
    spread: Spread | None,
) -> Iterator[Outcomes]:
    import torch

    shared = Shared(plan, material.sent(), folder, torch.get_num_threads())
    with groups_ahead(groups, shared, spread or Spread(threads()), watch) as ahead:
        for model, seed in product(plan.models, plan.seeds):
            found = ahead.arrived(model, seed)
            yield run_group(model, seed, plan, material, folder, watch) if found is None else found


def _unfinished(plan: Plan, material: Material, folder: ResultFolder) -> list[tuple[Plugin, int]]:
    """Return the models and seeds of which some run is not done yet."""

    def done(model: Plugin, backend: Plugin, seed: int) -> bool:
        try:
            return folder.find_run(run_key(model, backend, material, seed)) is not None
        except BenchError:  # it fails, and says so when it is its turn
            return True

    every = [(model, seed) for model in plan.models for seed in plan.seeds]
    return [(m, seed) for m, seed in every if not all(done(m, b, seed) for b in plan.backends)]
