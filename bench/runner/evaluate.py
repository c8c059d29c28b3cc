"""One model on one backend and seed: build the artifact of every fold, predict, score."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.measure.metrics import score
from bench.results import Score
from bench.runner.failure import DeclinedError
from bench.runner.inputs import rows_for
from bench.runner.material import Material
from bench.runner.rounding import why_useless

if TYPE_CHECKING:
    from backends.base import Artifact, Backend, TrainingData
    from zoo.base import MitigationModel

Progress = Callable[[float], None]
Rows = NDArray[np.intp]
Floats = NDArray[np.float32]


@dataclass(frozen=True)
class Evaluation:
    """What one run gave: the first fold's artifact, and the predictions of every test row.

    `rows` are positions [m] into the material, `predicted_m` float32 [m], `los` marks the rows
    scored as line of sight, `std_m` float32 [m] is None where the model gives no deviation.
    """

    artifact: Artifact
    rows: Rows
    predicted_m: NDArray[np.float32]
    los: NDArray[np.bool_]
    std_m: NDArray[np.float32] | None = None


def evaluate(
    models: Sequence[MitigationModel],
    backend: Backend,
    material: Material,
    seed: int,
    paths: Sequence[Path],
    progress: Progress | None = None,
) -> Evaluation:
    """Build and run every fold's artifact at `paths`; predictions of all folds are pooled."""
    from backends.base import TrainingData

    artifacts, rows, predicted, los = [], [], [], []
    spreads = []
    inputs = rows_for(material, models[0].reads)
    for index, (model, fold) in enumerate(zip(models, material.split.folds, strict=True)):
        data = TrainingData(inputs[fold.train], material.errors_m[fold.train], seed)
        artifact = _build(model, backend, data, paths[index], progress)
        positions = np.concatenate([fold.test_nlos, fold.test_los])
        artifacts.append(artifact)
        rows.append(positions)
        predicted.append(_answers(artifact.predict, inputs[positions]))
        if getattr(model, "gives_std", False):
            spreads.append(_answers(artifact.deviations, inputs[positions]))
        los.append(np.arange(len(positions)) >= len(fold.test_nlos))
    std = np.concatenate(spreads) if spreads else None
    whole = [np.concatenate(parts) for parts in (rows, predicted, los)]
    return Evaluation(artifacts[0], whole[0], whole[1], whole[2], std)


def _build(
    model: MitigationModel,
    backend: Backend,
    data: TrainingData,
    path: Path,
    progress: Progress | None,
) -> Artifact:
    from backends.base import CannotTakeError

    try:
        made = backend.build(model, data, path, progress)
    except CannotTakeError as problem:
        raise DeclinedError(str(problem)) from problem
    except ValueError as problem:  # what the backend cannot do is no failure to write
        raise BenchError(str(problem)) from problem
    declares = getattr(backend, "opener", None)
    if made.opener != declares:
        raise BenchError(
            f"its files are opened with {made.opener!r}, but the backend class declares "
            f"opener = {declares!r}; expected the same"
        )
    _check_use(model, made, data)
    return made


def _check_use(model: MitigationModel, made: Artifact, data: TrainingData) -> None:
    """Raise DeclinedError where rounding has left nothing of use."""
    try:
        useless = why_useless(model, made, data)
    except ValueError as problem:
        raise BenchError(f"its artifact gives no answer: {problem}") from problem
    if useless is not None:
        raise DeclinedError(useless)


def _answers(run: Callable[[Floats], Floats], inputs: Floats) -> Floats:
    """Return what an artifact answers. Raises BenchError where it cannot: no failure to write."""
    try:
        return run(inputs)
    except ValueError as problem:
        raise BenchError(f"its artifact gives no answer: {problem}") from problem


def score_rows(done: Evaluation, material: Material, los: bool, seed: int) -> Score | None:
    """Return the score of the NLoS or LoS rows, None where there are none."""
    chosen = done.los == los
    if not chosen.any():
        return None
    rows = done.rows[chosen]
    return score(material.errors_m[rows], done.predicted_m[chosen], material.links[rows], seed)
