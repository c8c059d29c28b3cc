"""Table III: latency, power, energy and size per device, each row predicted from the others."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace

import numpy as np

from backends.cost import GraphCost
from bench.measure.estimate import call_of, estimate
from bench.measure.profile import Profile
from bench.plugins import load
from bench.reproduce import paper
from bench.reproduce.build import make_outcome
from bench.reproduce.context import Context
from bench.reproduce.device_fit import Prediction, Printed, leave_one_out
from bench.reproduce.outcome import Outcome, Row, Table
from bench.reproduce.paper_devices import backend_of, cost_of, mode_of
from bench.results import Interval, RunRecord

BACKENDS = "fp32,graph,fp16,int8"
MICROCONTROLLERS = ("nrf52832", "stm32u5", "stm32h7")
_PROTOCOL = (
    "ESTIMATES for REMnet, none measured. Every row of the paper's device table is predicted from "
    "the table's OTHER rows: the device model's launch cycles (one per runtime, one factor per "
    "precision) are fitted without it, the power is the mean of the device's other rows. Clocks "
    "are those of the device profiles. Energy = power x latency, compared with the same product "
    "of the paper's figures; the energy as printed stands in a column of its own. Size: bytes of "
    "our ONNX file."
)


def run(context: Context) -> Outcome:
    """Return every row of the paper's table beside its prediction, and the error of each."""
    records = {one.key.backend: one for one in context.runs("remnet", BACKENDS)}
    costs = {name: cost_of(context, one) for name, one in records.items()}
    printed = paper.rows("devices")
    rows = _rows(printed, costs)
    predictions = leave_one_out(rows)
    tables = [_table(printed, rows, predictions, records), _errors(rows, predictions)]
    tables.append(_microcontrollers(costs))
    title = "Devices: latency, energy and size per device (Table III)"
    return make_outcome(context, "devices", title, _PROTOCOL, tables, notes=_notes(rows))


def _rows(printed: Sequence[paper.Printed], costs: Mapping[str, GraphCost]) -> list[Printed]:
    return [_row(row, mode_of(row, printed), costs[backend_of(row)]) for row in printed]


def _row(row: paper.Printed, mode: str, cost: GraphCost) -> Printed:
    profile: Profile = load("devices", row["device"])
    profile = profile.in_mode(mode) if mode else profile
    call, batch4 = (call_of(cost, row["precision"], batch) for batch in (1, 4))
    return Printed(
        row["device"], mode, row["optimised"], row["precision"], row["latency_ms"],
        row["power_w"], profile, call, batch4, runtime=_runtime(row),
    )  # fmt: skip


def _runtime(row: paper.Printed) -> str:
    """Return what launches the kernels: rows of one runtime share its cycles per launch."""
    if row["device"].startswith("cortex"):
        return "TensorFlow Lite on a processor"
    if row["device"] == "edge-tpu":
        return "Edge TPU"
    return f"TensorRT on {row['device']}" if row["optimised"] else "TensorFlow on a GPU"


def _table(
    printed: Sequence[paper.Printed],
    rows: Sequence[Printed],
    predictions: Sequence[Prediction],
    records: Mapping[str, RunRecord],
) -> Table:
    made: list[Row] = []
    for source, row, guess in zip(printed, rows, predictions, strict=True):
        size = records[backend_of(source)].size
        kilobytes = None if size is None else size.file_bytes / 1000
        energy = _product(guess.power_w, guess.latency_ms)
        note = "; ".join(filter(None, [source.get("note", ""), guess.reason]))
        made += [
            Row(row.name, "latency", "ms", guess.latency_ms, row.latency_ms, note),
            Row(row.name, "latency, batch 4", "ms", guess.latency4_ms, source.get("latency4_ms")),
            Row(row.name, "power", "W", guess.power_w, row.power_w),
            Row(row.name, "energy", "mJ", energy, row.latency_ms * row.power_w),
            Row(row.name, "energy as printed", "mJ", None, source["energy_mj"]),
            Row(row.name, "size", "kB", kilobytes, source["size_kb"]),
        ]
    labels = ("device", "graph", "precision")
    return Table("Every row predicted from the others (ESTIMATES)", labels, made, digits=2)


def _product(power_w: float | None, latency_ms: float | None) -> float | None:
    return None if power_w is None or latency_ms is None else power_w * latency_ms


def _errors(rows: Sequence[Printed], predictions: Sequence[Prediction]) -> Table:
    """Return the relative error of every row, and the median over all of them."""
    made: list[Row] = []
    latency, energy = [], []
    for row, guess in zip(rows, predictions, strict=True):
        off = _off(guess.latency_ms, row.latency_ms)
        spent = _off(_product(guess.power_w, guess.latency_ms), row.power_w * row.latency_ms)
        latency.append(abs(off) if off is not None else np.inf)
        energy.append(abs(spent) if spent is not None else np.inf)
        made += [
            Row(row.name, "latency error", "%", off, note=guess.reason),
            Row(row.name, "energy error", "%", spent),
        ]
    label = ("median of all rows", "", "")
    made.append(Row(label, "latency error", "%", float(np.median(latency))))
    made.append(Row(label, "energy error", "%", float(np.median(energy))))
    note = "Median of the magnitudes; a row that could not be predicted counts as infinitely wrong."
    labels = ("device", "graph", "precision")
    return Table("Error of each prediction", labels, made, digits=0, notes=[note])


def _off(ours: float | None, printed: float) -> float | None:
    return None if ours is None else 100 * (ours / printed - 1)


def _microcontrollers(costs: Mapping[str, GraphCost]) -> Table:
    made: list[Row] = []
    for device in MICROCONTROLLERS:
        profile: Profile = load("devices", device)
        for backend, precision in (("graph", "fp32"), ("int8", "int8")):
            found = estimate(profile, costs[backend], precision)
            label = (device, precision)
            latency = _milli(found.latency_us)
            made.append(Row(label, "latency", "ms", latency, note=found.reason or ""))
            made.append(Row(label, "energy", "mJ", found.energy_mj))
    note = "Brackets: low to high of the profile's coefficients, not a confidence interval."
    title = "Microcontrollers (ESTIMATES, not in the paper)"
    return Table(title, ("device", "precision"), made, digits=2, notes=[note])


def _milli(figure: Interval | None) -> Interval | None:
    if figure is None or figure.low is None or figure.high is None:
        return figure
    return replace(
        figure, value=figure.value / 1000, low=figure.low / 1000, high=figure.high / 1000
    )


def _notes(rows: Sequence[Printed]) -> list[str]:
    kernels = {row.name[1] + " " + row.precision: row.call.kernels for row in rows}
    counted = ", ".join(f"{name} {count}" for name, count in kernels.items())
    return [
        f"Kernels of our exports, by which latency is scaled: {counted}.",
        "The precision factors and what rows share a runtime were chosen with the table in view; "
        "only the coefficients are fitted without the row.",
    ]
