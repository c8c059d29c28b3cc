"""A perceptron on the raw CIR, trained on one room or obstacle and tested on each other."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.measure.metrics import over_seeds
from bench.recordings.splits import KEPT_ASIDE, labelled_los
from bench.reproduce.build import make_outcome
from bench.reproduce.context import Context
from bench.reproduce.outcome import Figure, Outcome, Row, Series, Table
from bench.reproduce.sweep import sweep
from bench.results import Interval

MODELS, QUICK_MODELS = 20, 5
EPOCHS, QUICK_EPOCHS = 30, 10
MOST_ROWS, QUICK_MOST_ROWS = 4000, 600
HELD_OUT = 4  # every fourth link is tested on
LEAST_LINKS = 4
OBSTACLES = ("metal plate", "plastic", "wood door", "glass plate")
WHOLE = "all of them"
Rows = NDArray[np.intp]
_PROTOCOL = (
    "A perceptron on the 157 CIR samples (3 layers, 64 hidden) is trained on the NLoS rows of one "
    "class and tested on every class; {models} independent models per bar, from different seeds. "
    "A quarter of every class's links is held out, and all testing is on those. Every training "
    "set is cut to {rows} rows by whole links, so that a class is not better for being larger; "
    "'" + WHOLE + "' is trained on a mixture of that size. Obstacles: rows with that one "
    "obstacle, indoors. Interval 95 %: Student's t over models. The paper gives pictures, no "
    "numbers."
)


@dataclass(frozen=True)
class Part:
    """Rows of one class: CIRs [n, 157] in counts, errors [n] in metres."""

    cirs: NDArray[np.float32]
    errors_m: NDArray[np.float32]


@dataclass(frozen=True)
class Classes:
    """Training and test rows by class."""

    train: Mapping[str, Part]
    test: Mapping[str, Part]


@dataclass(frozen=True)
class Bar:
    """The models of one training class, trained together."""

    trained_on: str
    seeds: tuple[int, ...]
    epochs: int


def run(context: Context) -> Outcome:
    """Return MAE by training and test class, for rooms and for obstacles.

    Raises BenchError where there are fewer than two classes of either kind.
    """
    models = QUICK_MODELS if context.quick else MODELS
    most = QUICK_MOST_ROWS if context.quick else MOST_ROWS
    tables, figures = [], []
    for kind, members in (("room", _rooms(context)), ("obstacle", _obstacles(context))):
        if len(members) >= 2:
            table, figure = _compare(context, kind, members, models, most)
            tables.append(table)
            figures.append(figure)
    if not tables:
        raise BenchError(
            f"{context.name}: fewer than two environments and fewer than two kinds of obstacle "
            f"with at least {LEAST_LINKS} links each"
        )
    title = "Generalisation: trained on one room or obstacle, tested on the others"
    protocol = _PROTOCOL.format(models=models, rows=most)
    return make_outcome(context, "generalisation", title, protocol, tables, figures)


def train_bar(classes: Classes, bar: Bar) -> dict[str, list[float]]:
    """Return the MAE of every model on every test class, in metres."""
    from bench.reproduce.raw_mlp import RawMLP
    from zoo.training.together import fit_together

    part = classes.train[bar.trained_on]
    models = [RawMLP(epochs=bar.epochs, random_state=seed) for seed in bar.seeds]
    fit_together(models, [part.cirs] * len(models), [part.errors_m] * len(models))
    return {
        name: [float(np.abs(test.errors_m - one.predict(test.cirs)).mean()) for one in models]
        for name, test in classes.test.items()
    }


def _rooms(context: Context) -> dict[str, Rows]:
    """Return the NLoS rows of every environment that has links enough."""
    frame = context.material.recordings.frame
    if "environment" not in frame:
        return {}
    nlos = ~labelled_los(context.material.recordings)
    where = frame["environment"].astype(str).to_numpy()
    return _enough(context, {name: nlos & (where == name) for name in context.environments()})


def _obstacles(context: Context) -> dict[str, Rows]:
    """Return the indoor rows with one obstacle of each class."""
    frame = context.material.recordings.frame
    if "obstacles" not in frame:
        return {}
    only = np.array([str(cell[0]) if np.size(cell) == 1 else "" for cell in frame["obstacles"]])
    inside = np.ones(len(frame), np.bool_)
    if "environment" in frame:
        inside = ~frame["environment"].isin(KEPT_ASIDE).to_numpy()
    return _enough(context, {name: inside & (only == name) for name in OBSTACLES})


def _enough(context: Context, masks: Mapping[str, NDArray[np.bool_]]) -> dict[str, Rows]:
    rows = {name: np.flatnonzero(mask) for name, mask in masks.items()}
    links = context.material.links
    return {name: at for name, at in rows.items() if len(np.unique(links[at])) >= LEAST_LINKS}


def _compare(
    context: Context, kind: str, members: Mapping[str, Rows], models: int, most: int
) -> tuple[Table, Figure]:
    classes = _classes(context, members, most)
    epochs = QUICK_EPOCHS if context.quick else EPOCHS
    bars = [Bar(name, tuple(range(models)), epochs) for name in classes.train]
    found = sweep(context, f"generalisation-{kind}", train_bar, classes, bars)
    maes = {
        (bar.trained_on, name): over_seeds(values)
        for bar, result in zip(bars, found, strict=True)
        for name, values in result.items()
    }
    return _table(kind, maes, classes), _figure(kind, maes, classes)


def _classes(context: Context, members: Mapping[str, Rows], most: int) -> Classes:
    rng = np.random.default_rng(0)
    train, test = {}, {}
    for name, rows in members.items():
        links = context.material.links[rows]
        order = rng.permutation(np.unique(links))
        train[name] = rows[np.isin(links, order[len(order) // HELD_OUT :])]
        test[name] = rows[np.isin(links, order[: len(order) // HELD_OUT])]
    train[WHOLE] = np.unique(np.concatenate(list(train.values())))
    cut = {name: _cut(context, rows, most, rng) for name, rows in train.items()}
    return Classes(
        {name: _part(context, rows) for name, rows in cut.items()},
        {name: _part(context, rows) for name, rows in test.items()},
    )


def _cut(context: Context, rows: Rows, most: int, rng: np.random.Generator) -> Rows:
    """Return whole links in random order, as many as stay within `most` rows (at least one)."""
    names, which = np.unique(context.material.links[rows], return_inverse=True)
    order = rng.permutation(len(names))
    total = np.cumsum(np.bincount(which)[order])
    kept = order[: max(1, int((total <= most).sum()))]
    return rows[np.isin(which, kept)]


def _part(context: Context, rows: Rows) -> Part:
    return Part(context.material.cirs[rows], context.material.errors_m[rows])


def _before(part: Part) -> float:
    return float(np.abs(part.errors_m).mean())


def _table(kind: str, maes: Mapping[tuple[str, str], Interval], classes: Classes) -> Table:
    rows = [
        Row(("nothing (raw)",), f"tested on {name}", "m", _before(part))
        for name, part in classes.test.items()
    ]
    rows += [
        Row((trained,), f"tested on {tested}", "m", figure)
        for (trained, tested), figure in maes.items()
    ]
    sizes = ", ".join(f"{name} {len(part.errors_m)}" for name, part in classes.train.items())
    return Table(f"MAE by {kind}", ("trained on",), rows, notes=[f"Training rows: {sizes}."])


def _figure(kind: str, maes: Mapping[tuple[str, str], Interval], classes: Classes) -> Figure:
    tested = list(classes.test)
    series = [_series(name, [maes[name, one] for one in tested], tested) for name in classes.train]
    before = [_before(classes.test[one]) for one in tested]
    series.append(Series("before mitigation", tested, before, style="dashed"))
    return Figure(
        f"by-{kind}", f"Error by {kind} trained on and {kind} tested on", "bars",
        f"{kind} tested on", "MAE (m)", series,
    )  # fmt: skip


def _series(name: str, figures: Sequence[Interval], tested: Sequence[str]) -> Series:
    low = [one.value if one.low is None else one.low for one in figures]
    high = [one.value if one.high is None else one.high for one in figures]
    values = [one.value for one in figures]
    return Series(f"trained on {name}", list(tested), values, low=low, high=high)
