"""Making the record of a run from what it gave."""

from __future__ import annotations

import hashlib
from collections.abc import Sequence
from datetime import UTC, datetime
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from bench.files import atomic_path
from bench.measure.machine import describe_machine
from bench.provenance import file_sha256
from bench.results import Cost, Layer, RunKey, RunRecord, Size, Training
from bench.runner.evaluate import Evaluation, score_rows
from bench.runner.material import Material, predictions_table
from bench.runner.training import training_of

if TYPE_CHECKING:
    from backends.base import Artifact
    from backends.cost import GraphCost
    from zoo.base import MitigationModel

UNLABELLED = "no line-of-sight label: every row is scored under NLoS"


def skipped_record(key: RunKey, reason: str) -> RunRecord:
    """Return the record of a pair a backend declines."""
    return RunRecord(
        key,
        "skipped",
        key.simulated,
        reason=reason,
        host=describe_machine(),
        created_utc=now_utc(),
    )


def finished_record(
    key: RunKey,
    material: Material,
    done: Evaluation,
    models: Sequence[MitigationModel],
    fit_s: float,
) -> RunRecord:
    """Return the record of a finished run; figures of size and cost are the first fold's."""
    from backends.cost import graph_cost

    artifact, cost = done.artifact, graph_cost(done.artifact.path)
    return RunRecord(
        key=key,
        status="ok",
        simulated=key.simulated,
        size=Size(cost.file_bytes, cost.weight_bytes, cost.parameters, cost.macs),
        cost=cost_record(cost),
        precision=artifact.precision,
        integer_kernels=_coverage(artifact),
        note="; ".join(filter(None, [artifact.note, _label_note(material)])),
        floor=bool(getattr(models[0], "floor", False)),
        artifact=f"artifacts/{key.digest()}-0.onnx",
        artifact_sha256=file_sha256(artifact.path),
        weights_sha256=_weights_hash(models[0]),
        fit_s=fit_s,
        training=_training(models),
        host=describe_machine(),
        created_utc=now_utc(),
        nlos=score_rows(done, material, los=False, seed=key.seed),
        los=score_rows(done, material, los=True, seed=key.seed),
    )


def write_predictions(path: Path, material: Material, done: Evaluation) -> None:
    """Write one row per test row: who it is, its error and the predicted error, in metres."""
    table = predictions_table(material, done.rows)
    table = table.assign(predicted_m=done.predicted_m, scored_as_los=done.los)
    if done.std_m is not None:
        table = table.assign(std_m=done.std_m)
    with atomic_path(path) as scratch:
        table.to_parquet(scratch, index=False)


def now_utc() -> str:
    """Return the time as ISO 8601, to the second."""
    return datetime.now(UTC).isoformat(timespec="seconds")


def _label_note(material: Material) -> str:
    return "" if "los" in material.recordings.frame else UNLABELLED


def cost_record(cost: GraphCost) -> Cost:
    """Return what a record keeps of a network's cost."""
    layers = (Layer(one.kind, one.macs, one.outputs, one.dtype, one.reads) for one in cost.layers)
    return Cost(tuple(layers), cost.weight_bytes, cost.inputs)


def _training(models: Sequence[MitigationModel]) -> tuple[Training, ...]:
    """Return how each fold was trained; nothing where no model tells."""
    found = tuple(map(training_of, models))
    return found if any(one != Training() for one in found) else ()


def _coverage(artifact: Artifact) -> str | None:
    found = artifact.coverage
    return None if found is None else f"{found.integer}/{found.total}"


def _weights_hash(model: MitigationModel) -> str:
    digest = hashlib.sha256()
    state: dict[str, Any] = model.to_module().state_dict()
    for name in sorted(state):
        digest.update(name.encode())
        digest.update(np.ascontiguousarray(state[name].detach().cpu().numpy()).tobytes())
    return digest.hexdigest()
