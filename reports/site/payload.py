"""Boards as plain data for the page: numbers with units in their names, texts as texts."""

from __future__ import annotations

import math
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from reports.boards import Board, Entry
from reports.document import Bullets
from reports.facts import facts
from reports.load import Estimate, Interval, Results
from reports.machines import machine_label
from reports.overview import Ranked
from reports.seeds import Accuracy, SeedMean
from reports.site.residuals import residuals

LONGEST_TEXT = 300
"""Characters of a text from a record that are shown: a name of megabytes is an attack."""
RICH_RUNS = 150
"""Runs whose residuals are in the page; beyond that it would outgrow three megabytes."""
MOST_LAYERS = 80


def payload(results: Results, boards: Sequence[Ranked]) -> dict[str, Any]:
    """Return everything the page shows of a result folder."""
    rich = sum(len(one.board.entries) for one in boards) <= RICH_RUNS
    return {
        "boards": [_board(one, results.folder, rich) for one in boards],
        "unreadable": [text(f"{one.path}: {one.reason}") for one in results.unreadable[:50]],
        "complete": rich,
    }


def text(value: object) -> str:
    """Return a text from elsewhere as it may be shown: no control characters, not endless."""
    plain = "".join(c if c.isprintable() else " " for c in str(value)[: 4 * LONGEST_TEXT])
    return plain if len(plain) <= LONGEST_TEXT else plain[:LONGEST_TEXT] + " ..."


def _board(one: Ranked, folder: Path, rich: bool) -> dict[str, Any]:
    board, ranking = one.board, one.ranking
    ranks = {m.name: m for m in ranking.models} if ranking else {}
    rows = [
        _entry(entry, folder, rich) | (_rank(ranks[entry.name]) if entry.name in ranks else {})
        for entry in board.entries
    ]
    return {
        "data": text(board.data),
        "split": text(board.split),
        "simulated": board.simulated,
        "fingerprint": text(board.fingerprint),
        "machine": text(machine_label(board.machine)) if board.machine else None,
        "links": ranking.links if ranking else None,
        "detectable_m": _number(ranking.detectable_m) if ranking else None,
        "no_ranks": one.reason,
        "skipped": [text(f"{s.model}/{s.backend}: {s.reason}") for s in board.skipped],
        "facts": [text(item) for item in _facts(board)],
        "entries": rows,
    }


def _facts(board: Board) -> list[str]:
    lists = [block.items for block in facts(board) if isinstance(block, Bullets)]
    return list(lists[-1]) if lists else []


def _rank(one: Any) -> dict[str, Any]:
    return {"best_rank": one.best_rank, "worst_rank": one.worst_rank, "ties": one.letters}


def _entry(entry: Entry, folder: Path, rich: bool) -> dict[str, Any]:
    size, timing = entry.size, entry.timing
    first = entry.files[0] if entry.files else ""
    return {
        "model": text(entry.model),
        "backend": text(entry.backend),
        "floor": entry.is_floor,
        "seeds": len(entry.seeds),
        "nlos": _accuracy(entry.nlos),
        "los": _accuracy(entry.los),
        "latency_us": _latency(entry, 1),
        "latency4_us": _latency(entry, 4),
        "rows_per_s": _number(timing.throughput_rows_per_s) if timing else None,
        "memory_mb": _number(timing.peak_memory_bytes / 1e6) if timing else None,
        "file_kb": _number(size.file_bytes / 1000) if size else None,
        "weights_kb": _number(size.weight_bytes / 1000) if size else None,
        "parameters": _number(size.parameters) if size else None,
        "macs": _number(size.macs) if size else None,
        "integer_kernels": text(entry.integer_kernels or ""),
        "precision": text(entry.precision or ""),
        "notes": [text(note) for note in entry.notes],
        "devices": [_device(one) for one in entry.estimates],
        "layers": _layers(entry),
        "residuals": residuals(folder / "predictions" / f"{first}.parquet") if rich else None,
    }


def _layers(entry: Entry) -> list[list[Any]]:
    """Return [kind, multiply-adds, outputs, type] of every kernel of the network."""
    layers = entry.cost.layers[:MOST_LAYERS] if entry.cost else ()
    return [[text(one.kind), one.macs, one.outputs, text(one.dtype)] for one in layers]


def _latency(entry: Entry, batch: int) -> dict[str, Any] | None:
    one = entry.latency(batch)
    if one is None:
        return None
    ends = (one.median_us, one.low_us, one.high_us)
    return dict(zip(("value", "low", "high"), map(_number, ends), strict=True)) | {
        "unstable": one.unstable
    }


def _device(one: Estimate) -> dict[str, Any]:
    return {
        "device": text(one.device),
        "latency_us": _interval(one.latency_us),
        "energy_mj": _interval(one.energy_mj),
        "how": text(getattr(one, "how", None) or "estimated"),
        "reason": text(one.reason or ""),
    }


def _accuracy(scored: Accuracy | None) -> dict[str, Any] | None:
    if scored is None:
        return None
    return {
        "rows": scored.rows,
        "links": scored.links,
        "mae_m": _interval(scored.mae_m),
        "r2": _interval(scored.r2),
        "sigma_m": _interval(scored.sigma_m),
        "bias_m": _number(scored.bias_m),
        "raw_mae_m": _number(scored.raw_mae_m),
    }


def _interval(one: Interval | SeedMean | None) -> dict[str, float | None] | None:
    if one is None:
        return None
    return {"value": _number(one.value), "low": _number(one.low), "high": _number(one.high)}


def _number(value: float | None) -> float | None:
    """Return a number that JSON can hold, with nine significant digits."""
    if value is None or not math.isfinite(value):
        return None
    return float(f"{value:.9g}")
