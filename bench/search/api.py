"""The search as one call: draw, calibrate, halve, then judge and count what is left."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import asdict, dataclass, replace
from typing import Any

import numpy as np

from bench.errors import BenchError
from bench.parallel import obey
from bench.provenance import commit, packages_code_hash
from bench.reproduce.context import Context
from bench.reproduce.sweep import sweep
from bench.runner.records import now_utc
from bench.search.calibrate import FEWEST, CostModel, cost_model
from bench.search.halving import rungs, survivors
from bench.search.space import CHOICES, Candidate, drawn, size_of
from bench.search.work import (
    Counting,
    Lesson,
    Rows,
    Trial,
    count_and_judge,
    teach,
    train_and_judge,
)

SCHEMA_VERSION = 1
HELD_OUT = 0.2  # of the training links, to choose by
REMNET_MACS = 300_000  # the paper's network, rounded up: nothing dearer is tried
REMNET = "remnet"
COUNTING = ("backends", "bench/measure/counting", "bench/runner/counting.py")
DECISIVE = ("zoo", "backends", "bench")


@dataclass(frozen=True)
class Settings:
    """How wide a search is: networks drawn, levels of training, finalists counted on a part."""

    candidates: int = 36
    levels: int = 2
    epochs: int = 12
    final_epochs: int = 30
    finalists: int = 6
    calibrate: int = 8
    device: str = "nrf52832"
    compiler: str = "auto"
    count_rows: int = 4
    seed: int = 0

    def check(self) -> None:
        """Raise BenchError naming the option that makes no search, or a tool that is missing."""
        least = {"levels": 1, "epochs": 1, "final_epochs": 1, "finalists": 1, "count_rows": 1}
        for name, lowest in {**least, "calibrate": FEWEST, "seed": 0}.items():
            if getattr(self, name) < lowest:
                option = "--" + name.replace("_", "-")
                raise BenchError(
                    f"{option} {getattr(self, name)}: expected a whole number of at least {lowest}"
                )
        drawn(self.candidates, self.seed, REMNET_MACS)
        if self.finalists > self.candidates:
            raise BenchError(
                f"--finalists {self.finalists}: expected at most --candidates {self.candidates}"
            )
        _check_part(self)


def search(context: Context, settings: Settings) -> dict[str, Any]:
    """Return the search as plain data, what `reports.search` reads; points done before are reused.

    Networks are chosen by the error on held-out training links and by ESTIMATED cycles and flash;
    the finalists are trained on all training rows, and their 8-bit C is judged on the test rows
    and counted. Raises BenchError on bad input before anything is trained.
    """
    settings.check()
    obey()
    inner, whole = prepared(context, settings.seed)
    networks = drawn(settings.candidates, settings.seed, REMNET_MACS)
    costs = _calibrated(context, settings, inner)
    inner = _with_teacher(context, "inner", inner, networks, settings)
    tried = _halved(context, settings, inner, networks, costs)
    finalists = [one["candidate"] for one in tried if one["finalist"]]
    whole = _with_teacher(context, "whole", whole, finalists, settings)
    tasks = [_counting(settings, one, settings.final_epochs) for one in (None, *finalists)]
    results = sweep(context, "search-final", count_and_judge, whole, tasks)
    names = [REMNET, *(one.name for one in finalists)]
    finals = dict(zip(names, results, strict=True))
    if not _is_c(finals[REMNET]):
        raise BenchError(f"{REMNET}, to compare with: {finals[REMNET]['declined']}")
    return _content(context, settings, costs, tried, finals)


def prepared(context: Context, seed: int) -> tuple[Rows, Rows]:
    """Return the rows to choose by and the rows to report, of the split's first fold.

    The first hold out training links alone: the test rows decide nothing.
    """
    from zoo.training.stopping import held_out

    material = context.material
    fold = material.split.folds[0]
    test = np.concatenate([fold.test_nlos, fold.test_los])
    links = np.unique(material.links, return_inverse=True)[1].astype(np.int64)
    held = held_out(links[fold.train], HELD_OUT, seed)
    if not held.any():
        raise BenchError(f"{context.name}: one training link, expected two to hold one out")
    return (
        _rows(context, links, fold.train[~held], fold.train[held]),
        _rows(context, links, fold.train, test),
    )


def _rows(context: Context, links: Any, train: Any, judge: Any) -> Rows:
    from bench.recordings.splits import labelled_los

    material = context.material
    los = labelled_los(material.recordings)
    return Rows(
        material.cirs[train],
        material.errors_m[train],
        np.empty(0, np.float32),
        material.cirs[judge],
        material.errors_m[judge],
        links[judge],
        los[judge],
    )


def _check_part(settings: Settings) -> None:
    from bench.runner.count_models import make_count_plan

    which: Any = settings.compiler
    make_count_plan(REMNET, "c-int8", settings.device, which, settings.count_rows)


def _counting(settings: Settings, candidate: Candidate | None, epochs: int) -> Counting:
    part = (settings.device, settings.compiler, settings.count_rows)
    return Counting(candidate, epochs, settings.seed, *part, packages_code_hash(*COUNTING))


def _calibrated(context: Context, settings: Settings, inner: Rows) -> CostModel:
    """Return the cost model fitted to untrained networks of all sizes, counted."""
    networks = drawn(max(settings.candidates, 4 * settings.calibrate), settings.seed, REMNET_MACS)
    networks.sort(key=lambda one: size_of(one).macs)
    places = np.linspace(0, len(networks) - 1, settings.calibrate).round().astype(int)
    chosen = [networks[at] for at in dict.fromkeys(places.tolist())]
    few = replace(
        inner,
        rows=inner.rows[:64],
        errors_m=inner.errors_m[:64],
        judge_rows=inner.judge_rows[:16],
        judge_errors_m=inner.judge_errors_m[:16],
        judge_links=inner.judge_links[:16],
        judge_los=inner.judge_los[:16],
    )
    tasks = [_counting(settings, one, 0) for one in chosen]
    found = sweep(context, "search-cost", count_and_judge, few, tasks)
    taken = [(size_of(one), cost) for one, cost in zip(chosen, found, strict=True) if _is_c(cost)]
    if len(taken) < FEWEST:
        raise BenchError(
            f"only {len(taken)} of {len(chosen)} networks could be counted; expected 4"
        )
    sizes, costs = zip(*taken, strict=True)
    cycles = [one["cycles"]["value"] for one in costs]
    return cost_model(sizes, cycles, [one["flash_bytes"] for one in costs])


def _is_c(found: dict[str, Any]) -> bool:
    return "declined" not in found


def _with_teacher(
    context: Context, name: str, rows: Rows, networks: Sequence[Candidate], settings: Settings
) -> Rows:
    """Return the rows with REMnet's word on them, where a network is taught."""
    if not any(one.distilled for one in networks):
        return rows
    said = sweep(context, f"search-teacher-{name}", teach, rows, [Lesson(settings.seed)])[0]
    return replace(rows, said_m=np.array(said, np.float32))


def _halved(
    context: Context,
    settings: Settings,
    inner: Rows,
    networks: Sequence[Candidate],
    costs: CostModel,
) -> list[dict[str, Any]]:
    """Return all networks with the error of their last level; finalists are marked."""
    left = list(networks)
    tried: dict[Candidate, dict[str, Any]] = {}
    for level, epochs in enumerate(rungs(settings.epochs, settings.levels)):
        tasks = [Trial(one, epochs, settings.seed) for one in left]
        found = sweep(context, f"search-level-{level}", train_and_judge, inner, tasks)
        for one, result in zip(left, found, strict=True):
            tried[one] = _described(one, epochs, result, costs)
        last = level == settings.levels - 1
        keep = settings.finalists if last else max(settings.finalists, -(-len(left) // 3))
        points = [tuple(tried[one][axis] for axis in AXES) for one in left]
        left = [left[at] for at in survivors(points, keep)]
    for one in left:
        tried[one]["finalist"] = True
    return list(tried.values())


AXES = ("mae_m", "estimated_cycles", "estimated_flash_bytes")


def _described(
    candidate: Candidate, epochs: int, result: dict[str, Any], costs: CostModel
) -> dict[str, Any]:
    size = size_of(candidate)
    kinds = [one for one in (result["nlos"], result["los"]) if one is not None]
    rows = sum(sum(one["rows"]) for one in kinds)
    return {
        "name": candidate.name,
        "candidate": candidate,
        "epochs": epochs,
        "mae_m": sum(sum(one["sums_m"]) for one in kinds) / rows,
        "macs": size.macs,
        "estimated_cycles": costs.cycles_of(size),
        "estimated_flash_bytes": costs.flash_of(size),
        "finalist": False,
    }


def _content(
    context: Context,
    settings: Settings,
    costs: CostModel,
    tried: Sequence[dict[str, Any]],
    finals: dict[str, dict[str, Any]],
) -> dict[str, Any]:
    material = context.material
    return {
        "kind": "search",
        "schema_version": SCHEMA_VERSION,
        "data": context.name,
        "data_fingerprint": material.fingerprint,
        "simulated": material.recordings.simulated,
        "split": material.split.name,
        "fold": material.split.folds[0].name,
        "settings": asdict(settings),
        "space": {name: list(values) for name, values in CHOICES.items()},
        "worst_cycles": costs.worst[0],
        "worst_flash": costs.worst[1],
        "tried": [{k: v for k, v in one.items() if k != "candidate"} for one in tried],
        "finals": {name: one for name, one in finals.items() if _is_c(one)},
        "declined": {name: one["declined"] for name, one in finals.items() if not _is_c(one)},
        "commit": commit(DECISIVE),
        "created_utc": now_utc(),
    }
