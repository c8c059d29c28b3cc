"""Result records -> boards: one per data set and split, one entry per model and backend."""

from __future__ import annotations

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

from reports.load import Cost, Estimate, Latency, Results, Run, Size, Timing
from reports.machines import check_machine, choose_machine, machine_label, timing_of
from reports.seeds import Accuracy, accuracy_over_seeds, estimates_over_seeds, size_over_seeds
from reports.selection import Pair, Place, by_pair, by_place, newest_code, newest_data


@dataclass(frozen=True)
class Entry:
    """One model on one backend, over its seeds; a figure that is not known is None.

    `is_floor` says that the model is there to be beaten: no mitigation, a constant.

    `own_timing` is False where the timing is of the same model and backend with other weights.
    """

    model: str
    backend: str
    seeds: tuple[int, ...]
    nlos: Accuracy | None
    los: Accuracy | None
    size: Size | None
    precision: str | None
    integer_kernels: str | None
    timing: Timing | None
    own_timing: bool
    estimates: list[Estimate]
    notes: tuple[str, ...]
    is_floor: bool = False
    files: tuple[str, ...] = ()
    """Names of its run records, without their ending, one per seed."""
    cost: Cost | None = None
    """Its kernels, those of the first seed."""

    @property
    def name(self) -> str:
        """Model and backend in one word."""
        return f"{self.model}/{self.backend}"

    def latency(self, batch: int) -> Latency | None:
        """Return the measured latency with `batch` rows, or None."""
        measured = self.timing.latency if self.timing else []
        return next((one for one in measured if one.batch == batch), None)

    def estimate(self, device: str) -> Estimate | None:
        """Return the estimate for a device, or None."""
        return next((one for one in self.estimates if one.device == device), None)


@dataclass(frozen=True)
class Skipped:
    """A pair that did not run, and why."""

    model: str
    backend: str
    reason: str


@dataclass(frozen=True)
class Board:
    """Everything shown of one data set and split; entries sorted by NLoS MAE.

    `missing` are pairs of the board's models and backends without any record; `older_data` and
    `older_code` count the records left out because a newer one replaces them.
    """

    data: str
    split: str
    fingerprint: str
    simulated: bool
    entries: list[Entry]
    skipped: list[Skipped]
    missing: list[Pair]
    machine: dict[str, Any] | None
    other_machines: list[str]
    versions: list[dict[str, str]]
    code_hashes: list[str]
    older_data: int
    older_code: int
    newest_utc: str

    @property
    def devices(self) -> list[str]:
        """Every device some entry has a figure for, in order of appearance."""
        estimates = [one for entry in self.entries for one in entry.estimates]
        known = [one.device for one in estimates if one.latency_us or one.energy_mj]
        return list(dict.fromkeys(known))


def make_boards(results: Results, machine: str | None = None) -> list[Board]:
    """Return a board per data set and split. Raises ReportError for a machine never timed."""
    check_machine(results.timings, machine)
    places = by_place(results.runs)
    return [_board(place, runs, results.timings, machine) for place, runs in places.items()]


def _board(
    place: Place, runs: Sequence[Run], timings: Sequence[Timing], wanted: str | None
) -> Board:
    current, older_data = newest_data(runs)
    pairs = {pair: newest_code(some) for pair, some in by_pair(current).items()}
    used = [run for some, _ in pairs.values() for run in some]
    here = _timings_of(used, timings)
    label = choose_machine(here, wanted)
    shown = [timing for timing in here if machine_label(timing.machine) == label]
    return Board(
        *place,
        fingerprint=used[0].key.data_fingerprint,
        simulated=any(run.simulated for run in used),
        entries=sorted(_entries(pairs, shown), key=_rank),
        skipped=_skipped(used),
        missing=_missing(list(pairs)),
        machine=max(shown, key=lambda one: one.created_utc).machine if shown else None,
        other_machines=sorted({machine_label(one.machine) for one in here} - {label or ""}),
        versions=_distinct_versions(used),
        code_hashes=sorted({run.key.code_hash for run in used}),
        older_data=len(older_data),
        older_code=sum(older for _, older in pairs.values()),
        newest_utc=max(run.created_utc for run in used),
    )


def _entries(pairs: dict[Pair, tuple[list[Run], int]], timings: Sequence[Timing]) -> list[Entry]:
    finished = {
        pair: [run for run in runs if run.status == "ok"] for pair, (runs, _) in pairs.items()
    }
    return [_entry(pair, runs, timings) for pair, runs in finished.items() if runs]


def _entry(pair: Pair, runs: Sequence[Run], timings: Sequence[Timing]) -> Entry:
    timing, own = timing_of(runs, timings)
    return Entry(
        *pair,
        seeds=tuple(run.key.seed for run in runs),
        nlos=accuracy_over_seeds([run.nlos for run in runs]),
        los=accuracy_over_seeds([run.los for run in runs]),
        size=size_over_seeds(runs),
        precision=_joined(run.precision for run in runs),
        integer_kernels=_joined(run.integer_kernels for run in runs),
        timing=timing,
        own_timing=own,
        estimates=estimates_over_seeds(runs),
        notes=tuple(dict.fromkeys(run.note for run in runs if run.note)),
        files=tuple(run.file for run in runs),
        is_floor=any(run.floor for run in runs),
        cost=runs[0].cost,
    )


def _rank(entry: Entry) -> tuple[float, float, str, str]:
    return _mae(entry.nlos), _mae(entry.los), entry.model, entry.backend


def _mae(accuracy: Accuracy | None) -> float:
    """Return what to sort by; what is not known or not finite comes last."""
    value = accuracy.mae_m.value if accuracy else math.inf
    return value if math.isfinite(value) else math.inf


def _timings_of(runs: Sequence[Run], timings: Sequence[Timing]) -> list[Timing]:
    """Return the timings that could belong to any of the runs."""
    kinds = {(run.key.model, run.key.backend, run.key.data) for run in runs}
    return [one for one in timings if (one.model, one.backend, one.data) in kinds]


def _skipped(runs: Sequence[Run]) -> list[Skipped]:
    found = [
        Skipped(run.key.model, run.key.backend, run.reason or "no reason given")
        for run in runs
        if run.status == "skipped"
    ]
    return list(dict.fromkeys(found))


def _missing(pairs: Sequence[Pair]) -> list[Pair]:
    models = sorted({model for model, _ in pairs})
    backends = sorted({backend for _, backend in pairs})
    every = [(model, backend) for model in models for backend in backends]
    return [pair for pair in every if pair not in pairs]


def _joined(texts: Any) -> str | None:
    """Return the different texts of the seeds, None where there is none."""
    return "; ".join(dict.fromkeys(text for text in texts if text)) or None


def _distinct_versions(runs: Sequence[Run]) -> list[dict[str, str]]:
    found = {tuple(sorted(run.key.versions.items())): None for run in runs}
    return [dict(items) for items in sorted(found)]
