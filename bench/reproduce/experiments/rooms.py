"""Table II: REMnet with each room left out in turn."""

from __future__ import annotations

from bench.errors import BenchError
from bench.recordings.splits import KEPT_ASIDE
from bench.reproduce import paper
from bench.reproduce.build import Floats, make_outcome, over_links
from bench.reproduce.context import Context
from bench.reproduce.outcome import Outcome, Row, Table, Value
from bench.results import RunRecord

ORDER = ("small", "medium", "big")
_PROTOCOL = (
    "REMnet (fp32, seed 0) is trained on the NLoS rows of the other indoor rooms and tested on "
    "the room named; through-the-wall and outdoor rows are kept aside. Each room is given the LoS "
    "rows of every indoor room, none of them trained on, as in the paper. σ and mean are of the "
    "NLoS error before and after mitigation. Intervals: 95 %, bootstrap over links."
)


def run(context: Context) -> Outcome:
    """Return Table II.

    Raises BenchError where the recordings have fewer than two indoor environments.
    """
    rows = []
    for room in _rooms(context):
        material = context.material_split(f"leave-environment-out:{room}")
        (record,) = context.runs("remnet", "fp32", material)
        rows += _rows(context, record, room, len(material.split.folds[0].train))
    table = Table("REMnet, each room left out", ("room left out",), rows)
    title = "Rooms: REMnet with each room left out in turn (Table II)"
    return make_outcome(context, "rooms", title, _PROTOCOL, [table])


def _rooms(context: Context) -> list[str]:
    """Return the indoor rooms to leave out, the paper's order first."""
    indoor = [name for name in context.environments() if name not in KEPT_ASIDE]
    if len(indoor) < 2:
        raise BenchError(
            f"{context.name}: {len(indoor)} indoor environment(s); leaving each out in turn needs "
            "at least two different values in column 'environment'"
        )
    return sorted(indoor, key=lambda name: (ORDER.index(name) if name in ORDER else 9, name))


def _rows(context: Context, record: RunRecord, room: str, trained: int) -> list[Row]:
    printed = paper.find("rooms", environment=room)
    figures: list[tuple[str, str, Value, str]] = [("training rows", "", trained, "train_rows")]
    if record.nlos is not None:
        figures += _nlos(context, record)
    if record.los is not None:
        figures += [
            ("LoS rows", "", record.los.rows, "los_rows"),
            ("LoS MAE", "m", record.los.mae_m, "los_mae_m"),
            ("LoS R²", "", record.los.r2, "los_r2"),
        ]
    return [
        Row((room,), name, unit, value, printed.get(key), of_data=key.endswith("_before_m"))
        for name, unit, value, key in figures
    ]


def _nlos(context: Context, record: RunRecord) -> list[tuple[str, str, Value, str]]:
    assert record.nlos is not None
    score, table = record.nlos, context.predictions(record)
    table = table[~table["scored_as_los"]]
    left = table["error_m"] - table["predicted_m"]

    def mean(values: Floats) -> float:
        return float(values.mean())

    return [
        ("NLoS rows", "", score.rows, "nlos_rows"),
        ("σ before", "m", score.raw_sigma_m, "sigma_before_m"),
        ("σ after", "m", score.sigma_m, "sigma_after_m"),
        ("mean before", "m", over_links(mean, table["error_m"], table["link"]), "mean_before_m"),
        ("mean after", "m", over_links(mean, left, table["link"]), "mean_after_m"),
        ("NLoS MAE", "m", score.mae_m, "nlos_mae_m"),
        ("NLoS R²", "", score.r2, "nlos_r2"),
    ]
