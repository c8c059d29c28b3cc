"""Latency against accuracy: which model on which backend no other beats, on a chosen device."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

from bench.errors import BenchError
from bench.measure.estimate import estimate
from bench.measure.profile import Profile
from bench.plugins import load, plugins
from bench.reproduce.build import make_outcome
from bench.reproduce.context import Context
from bench.reproduce.device_figures import HOST, RANGE, chosen_devices, extent, point
from bench.reproduce.outcome import Figure, Outcome, Row, Series, Table
from bench.reproduce.paper_devices import cost_of
from bench.results import Interval, RunRecord, Score, TimingRecord
from bench.runner.timing import time_artifacts
from reports.pareto import pareto_front

_PROTOCOL = (
    "Every model on every backend: NLoS MAE (95 %, bootstrap over links) against the latency of "
    "one inference (batch 1), features included. On the front: no other pair is both faster and "
    "more accurate; differences within the intervals are not told apart. No mitigation takes no "
    "time and is drawn as a line. Not in the paper."
)
_ESTIMATED = "Latency is an ESTIMATE from the device profile. " + RANGE
_MEASURED = (
    "Latency is MEASURED on this machine, on one thread in a fresh process per file, rounds "
    "interleaved, nothing else of ours running; 95 % interval of the median. A timing that "
    "drifted is marked unstable and takes no part in the front."
)
_TITLE = "Latency against accuracy over all models and backends"


@dataclass(frozen=True)
class Pair:
    """One model on one backend: latency in microseconds, NLoS MAE in metres."""

    model: str
    backend: str
    latency_us: Interval
    mae_m: Interval
    unstable: bool = False


def run(context: Context) -> Outcome:
    """Return a table and a picture per device chosen.

    Raises BenchError for an unknown device, and where nothing can be scored or timed.
    """
    devices = chosen_devices(context.device)
    models = [one.name for one in plugins("models") if one.problem() is None]
    found, notes = context.tried(",".join(name for name in models if not _is_floor(name)), "all")
    scored = [one for one in found if one.status == "ok" and _score(one) is not None]
    tables, figures = [], []
    for device in devices:
        pairs, why = _measured(context, scored) if device == HOST else _on(context, device, scored)
        notes += why
        if pairs:
            front = _front(pairs)
            tables.append(_table(device, pairs, front))
            figures.append(_figure(device, pairs, front, _raw_m(scored)))
    if not tables:
        raise BenchError(f"{context.name}: nothing runs on {', '.join(devices)}")
    notes += [f"{one.key.model} on {one.key.backend} skipped: {one.reason}" for one in found
              if one.status == "skipped"]  # fmt: skip
    notes.append(f"Before mitigation: {_raw_m(scored):.4f} m. Split: {scored[0].key.split}.")
    return make_outcome(
        context, "latency-vs-accuracy", _TITLE, _PROTOCOL, tables, figures, notes
    )  # fmt: skip


def _score(record: RunRecord) -> Score | None:
    """Return the score of the NLoS rows, else of the LoS rows."""
    return record.nlos or record.los


def _is_floor(name: str) -> bool:
    """Return True for a model that says that it mitigates nothing."""
    return bool(getattr(load("models", name), "floor", False))


def _mae(record: RunRecord) -> Interval:
    score = _score(record)
    assert score is not None
    return score.mae_m


def _raw_m(records: Sequence[RunRecord]) -> float:
    score = _score(records[0])
    assert score is not None
    return score.raw_mae_m


def _on(
    context: Context, device: str, records: Sequence[RunRecord]
) -> tuple[list[Pair], list[str]]:
    """Return the pairs a device can run, estimated, and why it cannot run the others."""
    profile: Profile = load("devices", device)
    pairs, reasons = [], []
    for record in records:
        model, backend = record.key.model, record.key.backend
        found = estimate(profile, cost_of(context, record), str(record.precision))
        if found.latency_us is None:
            reasons.append(f"{model} on {backend} is not for {device}: {found.reason}")
        else:
            pairs.append(Pair(model, backend, found.latency_us, _mae(record)))
    return pairs, reasons


def _measured(context: Context, records: Sequence[RunRecord]) -> tuple[list[Pair], list[str]]:
    """Return the pairs timed on this machine, and why others were not."""
    cir = context.material.cirs.shape[1]
    widths = {record.key.model: cir for record in records}
    timings, failures = time_artifacts(records, context.results, widths, context.watch)
    by_name = {(one.model, one.backend): one for one in timings}
    pairs = [
        _timed(record, by_name[name])
        for record in records
        if (name := (record.key.model, record.key.backend)) in by_name
        and not by_name[name].withheld
    ]
    busy = [f"{t.model} on {t.backend}: no timing: {t.withheld}" for t in timings if t.withheld]
    return pairs, [*(str(one) for one in failures), *busy]


def _timed(record: RunRecord, timing: TimingRecord) -> Pair:
    (one,) = [latency for latency in timing.latency if latency.batch == 1]
    latency = Interval(one.median_us, one.low_us, one.high_us)
    return Pair(record.key.model, record.key.backend, latency, _mae(record), one.unstable)


def _front(pairs: Sequence[Pair]) -> list[Pair]:
    stable = [pair for pair in pairs if not pair.unstable]
    places = pareto_front([(pair.latency_us.value, pair.mae_m.value) for pair in stable])
    return [stable[place] for place in places]


def _table(device: str, pairs: Sequence[Pair], front: Sequence[Pair]) -> Table:
    made: list[Row] = []
    for pair in sorted(pairs, key=lambda one: one.latency_us.value):
        label = (pair.model, pair.backend)
        standing = "unstable" if pair.unstable else "yes" if pair in front else "no"
        made += [
            Row(label, _latency_name(device), "µs", pair.latency_us, digits=1),
            Row(label, "NLoS MAE", "m", pair.mae_m),
            Row(label, "on the front", "", standing),
        ]
    how = _MEASURED if device == HOST else _ESTIMATED
    return Table(_heading(device), ("model", "backend"), made, notes=[how])


def _latency_name(device: str) -> str:
    return "latency (measured)" if device == HOST else "latency (est.)"


def _heading(device: str) -> str:
    where = "this machine (MEASURED)" if device == HOST else f"{device} (ESTIMATES)"
    return f"Latency against accuracy on {where}"


def _figure(device: str, pairs: Sequence[Pair], front: Sequence[Pair], raw_m: float) -> Figure:
    points = [
        point(pair.latency_us, pair.mae_m, pair.model, pair.backend, hollow=pair.unstable)
        for pair in pairs
    ]
    steps = Series(
        "Pareto front",
        [pair.latency_us.value for pair in front],
        [pair.mae_m.value for pair in front],
        style="step",
    )
    floor = Series("no mitigation", list(extent(points)), [raw_m, raw_m], style="dashed")
    kind = "measured" if device == HOST else "estimated"
    hollow = "; hollow: unstable" if any(pair.unstable for pair in pairs) else ""
    return Figure(
        f"on-{device}", _heading(device) + hollow, "tradeoff",
        f"{kind} latency of one inference, batch 1 (µs)", "NLoS MAE (m)",
        [*points, *([steps] if front else []), floor], log_x=True,
    )  # fmt: skip
