"""Energy against latency of REMnet, over every device profile and backend."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass

from bench.errors import BenchError
from bench.measure.estimate import estimate
from bench.reproduce import paper
from bench.reproduce.build import make_outcome
from bench.reproduce.context import Context
from bench.reproduce.device_figures import RANGE, device_profiles, in_ms, point
from bench.reproduce.outcome import Figure, Outcome, Row, Series, Table
from bench.reproduce.paper_devices import backend_of, cost_of, profile_of
from bench.results import Estimate, Interval, RunRecord

BACKENDS = "fp32,graph,fp16,int8,qat"
_PROTOCOL = (
    "ESTIMATES for REMnet, none measured: latency and energy of one inference (batch 1) on every "
    "device profile, in each of its modes, from the file of every backend; host is this machine's "
    "profile, an estimate too. The paper's figures "
    "stand beside them where it has that device and network; its energy is the product of its "
    "latency and power (the energy it prints contradicts that product in places: see `devices`). "
    "The profiles of the paper's devices are anchored on these very rows, so that agreement here "
    "is no evidence; `devices` predicts each row without having seen it. " + RANGE
)
_TITLE = "Energy against latency over devices and backends"


@dataclass(frozen=True)
class Spot:
    """REMnet by one backend on one device; the paper's latency (ms) and energy (mJ) or None."""

    device: str
    backend: str
    found: Estimate
    paper_ms: float | None
    paper_mj: float | None


def run(context: Context) -> Outcome:
    """Return the figures by device and backend, and the picture.

    Raises BenchError where no backend runs REMnet, or no device runs any of its files.
    """
    records = [one for one in context.runs("remnet", BACKENDS) if one.status == "ok"]
    spots = list(_spots(context, records))
    rows = [row for spot in spots for row in _rows(spot)]
    if not rows:
        raise BenchError(f"{context.name}: no device profile can run any file of REMnet")
    table = Table(_TITLE + " (ESTIMATES)", ("device", "backend"), rows, digits=3)
    figures = [_figure(spots)]
    return make_outcome(context, "energy", _TITLE, _PROTOCOL, [table], figures, _refusals(spots))


def _spots(context: Context, records: Sequence[RunRecord]) -> Iterator[Spot]:
    """Yield every device and backend; a mode only where it changes the figures of its device."""
    printed = _printed()
    costs = [(one, cost_of(context, one)) for one in records]
    seen: set[tuple[str, str, Interval]] = set()
    for device, profile in device_profiles():
        for record, cost in costs:
            backend = record.key.backend
            found = estimate(profile, cost, str(record.precision))
            key = (profile.name, backend, found.latency_us or Interval(len(seen)))
            if key not in seen:
                yield Spot(device, backend, found, *_paper(printed.get((device, backend))))
            seen.add(key)


def _printed() -> Mapping[tuple[str, str], paper.Printed]:
    """Return the paper's rows by device (with mode) and backend."""
    rows = paper.rows("devices")
    return {(profile_of(row, rows), backend_of(row)): row for row in rows}


def _paper(row: paper.Printed | None) -> tuple[float | None, float | None]:
    if row is None:
        return None, None
    return row["latency_ms"], row["latency_ms"] * row["power_w"]


def _rows(spot: Spot) -> list[Row]:
    if spot.found.latency_us is None or spot.found.energy_mj is None:
        return []
    label = (spot.device, spot.backend)
    return [
        Row(label, "latency (est.)", "ms", in_ms(spot.found.latency_us), spot.paper_ms),
        Row(label, "energy (est.)", "mJ", spot.found.energy_mj, spot.paper_mj),
    ]


def _refusals(spots: Sequence[Spot]) -> list[str]:
    """Return a line per device and reason for what cannot run there."""
    found: dict[tuple[str, str], list[str]] = {}
    for spot in spots:
        if spot.found.reason:
            found.setdefault((spot.device, spot.found.reason), []).append(spot.backend)
    return [
        f"Not on {device}: {', '.join(backends)} ({reason})."
        for (device, reason), backends in found.items()
    ]


def _figure(spots: Sequence[Spot]) -> Figure:
    series = [one for spot in spots for one in _points(spot)]
    return Figure(
        "energy-latency", "REMnet: energy against latency, batch 1 (ESTIMATES; hollow: the paper)",
        "tradeoff", "latency (ms)", "energy (mJ)", series, log_x=True, log_y=True,
    )  # fmt: skip


def _points(spot: Spot) -> Iterator[Series]:
    if spot.found.latency_us is not None and spot.found.energy_mj is not None:
        latency = in_ms(spot.found.latency_us)
        yield point(latency, spot.found.energy_mj, spot.device, spot.backend)
    if spot.paper_ms is not None and spot.paper_mj is not None:
        theirs = Interval(spot.paper_ms), Interval(spot.paper_mj)
        yield point(*theirs, spot.device, spot.backend, hollow=True)
