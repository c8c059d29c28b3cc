"""The transfer matrix: trained on each data set, tested on each other."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from pathlib import Path

from bench.errors import BenchError
from bench.parallel import Spread
from bench.plugins import plugins
from bench.recordings.open import Table
from bench.recordings.sources.base import open_source
from bench.recordings.table import Recordings
from bench.results import RunRecord, Score
from bench.runner.across import Across, ready
from bench.runner.execute import execute
from bench.runner.failure import Failure
from bench.runner.folder import ResultFolder
from bench.runner.material import Material, load_material
from bench.runner.observer import Observer
from bench.runner.plan import Plan, make_plan
from bench.runner.tables import open_any

OTHERS = "all others"


@dataclass(frozen=True)
class Cell:
    """What training on `train` gave on `test`; `reason` where it gave nothing.

    `train` is `test` for folds of whole links of the same data set, and `all others` for every
    other data set at once. `train_simulated` and `test_simulated` mark SIMULATED rows.
    """

    train: str
    test: str
    nlos: Score | None = None
    los: Score | None = None
    reason: str | None = None
    train_simulated: bool = False
    test_simulated: bool = False


@dataclass(frozen=True)
class TransferMatrix:
    """The cells of one model on one backend, and the data sets in order."""

    model: str
    backend: str
    data: tuple[str, ...]
    cells: list[Cell]

    def cell(self, train: str, test: str) -> Cell:
        """Return one cell."""
        return next(one for one in self.cells if (one.train, one.test) == (train, test))

    @property
    def rows(self) -> tuple[str, ...]:
        """What was trained on, in order."""
        return tuple(dict.fromkeys(one.train for one in self.cells))


def here() -> list[str]:
    """Return the data sets on this machine whose readers have seen real files, by name.

    Those kept only to repeat older figures are left out.
    """
    found = []
    for plugin in plugins("datasets"):
        try:
            source = open_source(plugin.name)
            wanted = source.untested is None and not source.superseded
            if wanted and source.available() is None:
                found.append(plugin.name)
        except BenchError:
            continue
    return found


def transfer(
    model: str = "gbm",
    backend: str = "fp32",
    data: Sequence[Table] | None = None,
    *,
    seed: int = 0,
    out: str | Path = "results",
    jobs: int = 1,
    scheduler: str | None = None,
    observer: Observer | None = None,
) -> TransferMatrix:
    """Train one model on each of several data sets and test it on each other.

    `data`: data sets, recordings files or simulators' TOML files; None takes all that are here.
    On the diagonal stand folds of whole links. Runs are written under `out` and reused. `jobs`
    processes or a Dask `scheduler` share the fits of a cell. Raises BenchError for unknown names,
    several models, and fewer than two data sets.
    """
    watch, spread = observer or Observer(), Spread(jobs, scheduler)
    plan = replace(make_plan(model, backend, "host", 1), seeds=(seed,))
    if len(plan.models) != 1 or len(plan.backends) != 1:
        raise BenchError("a transfer matrix is of one model on one backend; expected one of each")
    folder = ResultFolder(Path(out))
    folder.check_writable()
    tables = _opened(here() if data is None else data, watch)
    cells = list(_cells(tables, plan, folder, watch, spread))
    return TransferMatrix(plan.models[0].name, plan.backends[0].name, tuple(tables), cells)


def _opened(data: Sequence[Table], watch: Observer) -> dict[str, Recordings]:
    """Return every table under its name. Raises BenchError for fewer than two."""
    tables: dict[str, Recordings] = {}
    for spec in data:
        watch.stage(f"reading {getattr(spec, 'source', spec)}")
        name, recordings = open_any(spec)
        tables[name] = replace(recordings, source=name)
    if len(tables) < 2:
        named = ", ".join(tables) or "none"
        raise BenchError(f"a transfer matrix takes at least two data sets; here: {named}")
    return tables


def _cells(
    tables: Mapping[str, Recordings],
    plan: Plan,
    folder: ResultFolder,
    watch: Observer,
    spread: Spread,
) -> Iterator[Cell]:
    """Yield every cell, row by row; the last row is trained on all others at once."""
    pairs = [*product(tables, tables), *((OTHERS, test) for test in tables if len(tables) > 2)]
    for number, (train, test) in enumerate(pairs):
        watch.runs(number, len(pairs))
        yield _cell(train, test, tables, plan, folder, watch, spread)
    watch.runs(len(pairs), len(pairs))


def _cell(
    train: str,
    test: str,
    tables: Mapping[str, Recordings],
    plan: Plan,
    folder: ResultFolder,
    watch: Observer,
    spread: Spread,
) -> Cell:
    names = [name for name in tables if name != test] if train == OTHERS else [train]
    simulated = any(tables[name].simulated for name in names)
    try:
        material, able = _material(names, test, tables, plan)
        records, failures = execute(able, material, folder, watch, spread)
        found = _figures(records[0] if records else failures[0])
    except BenchError as problem:
        found = None, None, str(problem)
    return Cell(train, test, *found, simulated, tables[test].simulated)


def _material(
    names: Sequence[str], test: str, tables: Mapping[str, Recordings], plan: Plan
) -> tuple[Material, Plan]:
    """Return what one cell is trained and tested on, and the plan where its model can do that."""
    if names == [test]:
        return load_material(tables[test], None), plan
    across = Across(tables[test], tuple(tables[name] for name in names))
    plan, (material,) = ready(across, None, plan, Observer())
    return material, plan


def _figures(outcome: RunRecord | Failure) -> tuple[Score | None, Score | None, str | None]:
    """Return the scores of a run, or why there are none."""
    if isinstance(outcome, Failure):
        return None, None, outcome.reason
    return outcome.nlos, outcome.los, outcome.reason
