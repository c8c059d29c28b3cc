"""The pieces of a search that may run anywhere: train and judge, teach, count.

Each is work(shared, task) -> plain data for `bench.reproduce.sweep`.
"""

from __future__ import annotations

import tempfile
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from bench.search.space import Candidate

if TYPE_CHECKING:
    from zoo.module_model import NeuralModel

Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Rows:
    """Training rows [n, width] with errors and the teacher's word [n] (m), and rows to judge on.

    `judge_links` [m] numbers the links, `judge_los` [m] marks lines of sight. Nothing to judge on
    and no teacher are empty arrays.
    """

    rows: Floats
    errors_m: Floats
    said_m: Floats
    judge_rows: Floats
    judge_errors_m: Floats
    judge_links: NDArray[np.int64]
    judge_los: NDArray[np.bool_]


@dataclass(frozen=True)
class Trial:
    """A candidate trained for some epochs; None is REMnet by the paper's protocol."""

    candidate: Candidate | None
    epochs: int
    seed: int


@dataclass(frozen=True)
class Counting:
    """A trial whose 8-bit C is judged, and counted on a part. `epochs` 0: untrained.

    `code` stands for the source of what writes and counts C: with another, counts are made anew.
    """

    candidate: Candidate | None
    epochs: int
    seed: int
    device: str
    compiler: str
    count_rows: int
    code: str


@dataclass(frozen=True)
class Lesson:
    """A teacher to be trained, with its seed."""

    seed: int


def teach(shared: Rows, lesson: Lesson) -> list[float]:
    """Return what REMnet, trained on the rows, says of them [n], in metres."""
    from zoo import REMnet

    teacher = REMnet(random_state=lesson.seed).fit(shared.rows, shared.errors_m)
    return [float(one) for one in teacher.predict(shared.rows)]


def train_and_judge(shared: Rows, trial: Trial) -> dict[str, Any]:
    """Return what a trained candidate leaves on the rows to judge on: see `judged`."""
    model = trained(shared, trial.candidate, trial.epochs, trial.seed)
    return judged(shared, model.predict(shared.judge_rows))


def count_and_judge(shared: Rows, asked: Counting) -> dict[str, Any]:
    """Return cycles (low, typical, high), flash and RAM (bytes) of the 8-bit C, and `judged`.

    The C is checked against this machine's answers row by row. A network that has no such C gives
    {"declined": why}. Raises BenchError where tools are missing or answers differ.
    """
    from backends.base import CannotTakeError

    model = trained(shared, asked.candidate, asked.epochs, asked.seed)
    try:
        return _counted(shared, asked, model)
    except CannotTakeError as problem:
        return {"declined": str(problem)}


def _counted(shared: Rows, asked: Counting, model: NeuralModel) -> dict[str, Any]:
    from backends.base import TrainingData
    from backends.c.int8 import CInt8Backend
    from bench.plugins import find
    from bench.runner.counting import count_artifact, recorded_rows

    with tempfile.TemporaryDirectory(prefix="uwb-search-") as folder:
        data = TrainingData(shared.rows, shared.errors_m, asked.seed)
        artifact = CInt8Backend().build(model, data, Path(folder) / "model.onnx")
        every = np.arange(len(shared.judge_rows))
        chosen = recorded_rows(shared.judge_rows, every, asked.count_rows)
        profile = find("devices", asked.device).load()
        one = count_artifact(artifact, [profile], chosen, asked.compiler)[0]  # type: ignore[arg-type]
        scores = judged(shared, artifact.predict(shared.judge_rows)) if asked.epochs else {}
    return {
        "cycles": asdict(one.figure.cycles),
        "flash_bytes": one.count.flash_bytes,
        "ram_bytes": one.count.ram_bytes,
        "equal": one.agreement.equal,
        "rows": one.agreement.rows,
        **scores,
    }


def trained(shared: Rows, candidate: Candidate | None, epochs: int, seed: int) -> NeuralModel:
    """Return a candidate's network trained for some epochs; 0 leaves it as it starts."""
    from zoo import REMnet, SmallCNN
    from zoo.training.teacher import taught

    if candidate is None:
        model: NeuralModel = REMnet(random_state=seed, **({} if epochs else {"epochs": 1}))
        few = slice(None) if epochs else slice(64)
        return model.fit(shared.rows[few], shared.errors_m[few])
    settings = {**asdict(candidate), "distilled": False}
    model = SmallCNN(**settings, epochs=max(epochs, 1), random_state=seed)
    if not epochs:
        return model.fit(shared.rows[:64], shared.errors_m[:64])
    errors_m = taught(shared.errors_m, shared.said_m) if candidate.distilled else shared.errors_m
    return model.fit(shared.rows, errors_m)


def judged(shared: Rows, predicted_m: Floats) -> dict[str, Any]:
    """Return the MAE (m) of NLoS and of LoS rows, and sums of |residual| and rows by link."""
    off_m = np.abs(shared.judge_errors_m - predicted_m).astype(np.float64)
    kinds = {"nlos": ~shared.judge_los, "los": shared.judge_los}
    return {name: _by_link(off_m[rows], shared.judge_links[rows]) for name, rows in kinds.items()}


def _by_link(off_m: NDArray[np.float64], links: NDArray[np.int64]) -> dict[str, Any] | None:
    if not len(off_m):
        return None
    names, link = np.unique(links, return_inverse=True)
    return {
        "mae_m": float(off_m.mean()),
        "links": names.tolist(),
        "sums_m": np.bincount(link, off_m).tolist(),
        "rows": np.bincount(link).tolist(),
    }
