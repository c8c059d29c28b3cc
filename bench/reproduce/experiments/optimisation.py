"""Table I: four models, and REMnet after every optimisation."""

from __future__ import annotations

from dataclasses import replace

from bench.reproduce import paper
from bench.reproduce.build import make_outcome
from bench.reproduce.context import Context
from bench.reproduce.outcome import Outcome, Row, Table, Value
from bench.results import RunRecord, Score

MODELS = "svm,mlp,cnn1d,remnet"
BACKENDS = "fp32,graph,fp16,int8,qat"
_PROTOCOL = (
    "Every model is trained on the NLoS rows of the other indoor rooms (seed 0) and tested on the "
    "split's test rows, NLoS and LoS apart; the same fitted model goes through every backend. "
    "Intervals: 95 %, bootstrap over links. The paper prints the first three models in fp32 only."
)


def run(context: Context) -> Outcome:
    """Return Table I. Raises BenchError where a run fails or the recordings have no CIR."""
    found = context.runs(MODELS, BACKENDS)
    rows = [row for record in found for row in _rows(record)]
    skipped = [
        f"{one.key.model} on {one.key.backend} skipped: {one.reason}"
        for one in found
        if one.status == "skipped"
    ]
    table = Table("Error after mitigation", ("model", "backend"), [*_floor(found), *rows])
    title = "Optimisation: error left by every model and backend (Table I)"
    notes = [f"Split: {found[0].key.split}.", *skipped]
    return make_outcome(context, "optimisation", title, _PROTOCOL, [table], notes=notes)


def _floor(found: list[RunRecord]) -> list[Row]:
    """Return the errors before mitigation."""
    scored = next(one for one in found if one.status == "ok")
    printed = paper.before()
    rows = []
    if scored.nlos is not None:
        note = f"the cross-validation table prints {printed['nlos_sigma_table_m']} for sigma"
        rows.append(
            _row("none", "-", "NLoS MAE", "m", scored.nlos.raw_mae_m, printed, "nlos_mae_m")
        )
        sigma = _row("none", "-", "NLoS σ", "m", scored.nlos.raw_sigma_m, printed, "nlos_sigma_m")
        rows.append(replace(sigma, note=note))
    if scored.los is not None:
        rows.append(_row("none", "-", "LoS MAE", "m", scored.los.raw_mae_m, printed, "los_mae_m"))
    return [replace(row, of_data=True) for row in rows]


def _rows(record: RunRecord) -> list[Row]:
    """Return the figures of one run beside the paper's."""
    model, backend = record.key.model, record.key.backend
    printed = paper.find("optimisation", model=model, backend=backend)
    made = []
    for kind, score in (("NLoS", record.nlos), ("LoS", record.los)):
        for quantity, unit, value, key in _figures(score):
            name = f"{kind.lower()}_{key}"
            made.append(_row(model, backend, f"{kind} {quantity}", unit, value, printed, name))
    return made


def _figures(score: Score | None) -> list[tuple[str, str, Value, str]]:
    if score is None:
        return []
    return [
        ("MAE", "m", score.mae_m, "mae_m"),
        ("R²", "", score.r2, "r2"),
        ("σ", "m", score.sigma_m, "sigma_m"),
    ]


def _row(
    model: str,
    backend: str,
    quantity: str,
    unit: str,
    value: Value,
    printed: paper.Printed,
    key: str,
) -> Row:
    return Row((model, backend), quantity, unit, value, printed.get(key))
