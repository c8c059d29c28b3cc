"""Table IV: positions from raw and from mitigated ranges, simulated and recorded."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from bench.errors import BenchError
from bench.recordings.table import Recordings
from bench.recordings.window import cir_window
from bench.reproduce import paper
from bench.reproduce.build import make_outcome, over_links
from bench.reproduce.context import Context
from bench.reproduce.experiments.positioning_recorded import recorded_tables
from bench.reproduce.fixed_tag import ANCHORS_M, TAG_M, fixed_tag
from bench.reproduce.outcome import Figure, Outcome, Row, Series, Table
from bench.reproduce.tags import SOLVERS, Tag
from bench.results import RunRecord
from bench.runner.timing import opener_of

SETUPS, EPOCHS = 40, 25
QUICK_SETUPS, QUICK_EPOCHS = 10, 10
SEED = 0
RAW, MITIGATED = "raw", "mitigated (qat)"
Floats = NDArray[np.float64]
Predict = Callable[[NDArray[np.float32]], NDArray[np.float32]]
_SOLVED = (
    "Anchors of known positions, a tag that stands still, one position per epoch from a range to "
    "each anchor: Gauss-Newton as in the paper, and robust least squares (scipy, soft-L1 of 0.1 m) "
    "beside it. Position MAE: mean distance between fix and tag."
)
_SCENE = (
    " Mitigated: range minus what REMnet (qat, integer file) predicts from the CIR. The scene "
    "with four anchors is SIMULATED whatever the recordings: the medium room, tag in the middle, "
    "anchors in the corners at 1.0 and 2.2 m; the model is the one trained on the recordings "
    "named above, without the medium room where they have one. The paper has one set-up of each "
    "kind; here the obstacles are drawn anew for every set-up, and intervals (95 %) are over "
    "set-ups. Position MAE: mean distance between fix and tag in 3-D."
)
_SCATTER = "fixes-nlos"


def run(context: Context) -> Outcome:
    """Return Table IV, its picture, and positions from real ranges where these are at hand."""
    notes: list[str] = []
    tables: list[Table] = []
    figures: list[Figure] = []
    if "cir" in context.recordings.frame:
        tables, figures = _simulated(context)
    else:
        notes.append(f"{context.name} has no CIR to train on, so no scene with mitigated ranges.")
    protocol = _SOLVED + (_SCENE if tables else "")
    for one in recorded_tables(context):
        tables += [one.table] if one.table else []
        figures += [one.figure] if one.figure else []
        notes += [one.note] if one.note else []
    title = "Positioning: raw and mitigated ranges to four anchors (Table IV)"
    return make_outcome(context, "positioning", title, protocol, tables, figures, notes)


def _simulated(context: Context) -> tuple[list[Table], list[Figure]]:
    (record,) = context.runs("remnet", "qat")
    if record.status != "ok":
        raise BenchError(f"remnet on qat was skipped: {record.reason}")
    predict = _predictor(context, record)
    setups = (QUICK_SETUPS, QUICK_EPOCHS) if context.quick else (SETUPS, EPOCHS)
    rows: list[Row] = []
    figures: list[Figure] = []
    for condition, los in (("LoS", True), ("NLoS", False)):
        tag, setup = _ranges(fixed_tag(los, *setups, seed=SEED + los), predict)
        rows += _rows(condition, tag, setup)
        if not los:
            figures.append(_picture(tag, setup))
    notes = [
        f"{setups[0]} set-ups of {setups[1]} epochs each; dilution of precision at the tag "
        f"{tag.dop:.2f} (metres of position per metre of range error)."
    ]
    labels = ("scene (SIMULATED)", "ranges", "solver")
    return [Table("Fixed tag, four anchors", labels, rows, notes=notes)], figures


def _predictor(context: Context, record: RunRecord) -> Predict:
    """Return what predicts errors with the run's own file (of the first fold)."""
    from backends.base import Artifact

    path = context.results.artifact_path(record.digest(), 0)
    artifact = Artifact(path, "int8", opener_of(record.key.backend))
    width = context.material.cirs.shape[1]
    return lambda cirs: artifact.predict(np.ascontiguousarray(cirs[:, :width]))


def _ranges(recordings: Recordings, predict: Predict) -> tuple[Tag, NDArray[np.intp]]:
    """Return raw and mitigated ranges of every epoch whose four CIRs are whole, and its set-up."""
    window = cir_window(recordings)
    frame = recordings.frame.iloc[window.rows]
    raw = frame["range_m"].to_numpy(np.float64)
    count = len(ANCHORS_M)
    epoch = window.rows // count
    whole = np.bincount(epoch)[epoch] == count
    ranges = {RAW: raw, MITIGATED: raw - predict(window.cirs)}
    grid = {name: value[whole].reshape(-1, count) for name, value in ranges.items()}
    setup = frame["setup"].to_numpy()[whole][::count]
    return Tag("tag", TAG_M, ANCHORS_M, grid), setup


def _rows(condition: str, tag: Tag, setup: NDArray[np.intp]) -> Iterator[Row]:
    for kind in tag.ranges_m:
        printed = paper.find("positioning", condition=condition, ranges=kind)
        off = np.abs(tag.range_errors_m(kind)).mean(axis=1)
        for solver in SOLVERS:
            label = (condition, kind, solver)
            known = printed if solver == "Gauss-Newton" else {}
            _, away, converged = tag.fixes(kind, solver)
            ranged, position = over_links(_mean, off, setup), over_links(_mean, away, setup)
            raw = kind == RAW
            yield Row(label, "range MAE", "m", ranged, known.get("range_mae_m"), of_data=raw)
            yield Row(
                label, "position MAE", "m", position, known.get("position_mae_m"), of_data=raw
            )
            yield Row(label, "converged", "", float(converged.mean()))


def _mean(values: Floats) -> float:
    return float(values.mean())


def _picture(tag: Tag, setup: NDArray[np.intp]) -> Figure:
    """Return the fixes, from above, of the set-up whose raw position error is the median one."""
    raw, away, _ = tag.fixes(RAW, "Gauss-Newton")
    mitigated, _, _ = tag.fixes(MITIGATED, "Gauss-Newton")
    means = {number: away[setup == number].mean() for number in np.unique(setup)}
    typical = sorted(means, key=lambda number: means[number])[len(means) // 2]
    shown = setup == typical
    series = [
        _series("raw", raw[shown]),
        _series(MITIGATED, mitigated[shown]),
        replace(_series("tag", tag.truth_m[None]), style="marker"),
    ]
    return Figure(
        _SCATTER, "Fixes of the fixed tag, NLoS, the set-up of median raw error (SIMULATED)",
        "scatter", "x (m)", "y (m)", series, equal_axes=True,
    )  # fmt: skip


def _series(name: str, points: Floats) -> Series:
    x, y = (np.round(points[:, axis], 4).tolist() for axis in (0, 1))
    return Series(name, x, y)
