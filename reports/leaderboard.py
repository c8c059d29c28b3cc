"""Boards -> the leaderboard document: one table per data set and split, and what it rests on."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from itertools import zip_longest
from typing import TYPE_CHECKING

from reports.boards import Board, Entry
from reports.document import Block, Bullets, Column, Document, Heading, Image, Paragraph, bounded
from reports.facts import facts
from reports.load import Estimate, Interval, Unreadable
from reports.measures import (
    KEYS,
    Measure,
    accuracy_measures,
    cost_measures,
    interval_measure,
    table,
)
from reports.ranking.columns import rank_column, ties_column

if TYPE_CHECKING:
    from reports.ranking.ranks import Ranking

DEVICES_PER_GROUP = 4  # device columns side by side in a terminal

_INTRODUCTION = (
    "Ranging error that remains after mitigation, and what each model costs. Sorted by NLoS MAE; "
    "the best of each column is bold. How to read it stands at the end."
)
_LEGEND = (
    "Error = measured - true range; a model predicts it, the corrected range is measured - "
    "predicted. MAE and σ (standard deviation) are of what error remains.",
    "[low, high]: 95 % interval, for accuracy by bootstrap over links (with several seeds the ends "
    "are averaged), for latency of the median. ±: 95 % interval of the mean over seeds.",
    "Bold: the best figure of its column (not a significant difference where intervals overlap; "
    "nothing is bold where all are alike). The floor, no mitigation, takes part in accuracy only; "
    "unstable timings take no part.",
    "Latency, throughput and peak memory are measured on one thread of the machine named below "
    "the table; kB = 1000 bytes, MB = 1000 kB. † timed with other weights of the same model and "
    "backend.",
    "(est.): estimated from a device profile, never measured; (counted): run in an emulator, "
    "cycles by the core's table; low to high is the profile's or the table's range.",
)


def leaderboard(
    boards: Sequence[Board],
    unreadable: Sequence[Unreadable] = (),
    picture: str | None = None,
    rankings: Sequence[Ranking | None] = (),
) -> Document:
    """Return the leaderboard. `picture` is the path of a figure to show, relative to the report.

    `rankings`, one per board: adds the interval of each row's rank and its tie groups.
    """
    document: Document = [Heading("Leaderboard", 1), Paragraph(_INTRODUCTION)]
    if picture:
        document.append(Image(picture, "Latency against NLoS MAE, with the Pareto front"))
    for board, ranking in zip_longest(boards, rankings):
        document += _section(board, ranking)
    document += _left_out(unreadable)
    return [*document, Heading("How to read it", 2), Bullets(_LEGEND)]


def title(board: Board) -> str:
    """Return a board's heading; simulated data says so."""
    return f"{_data(board)}, split {board.split}"


def _data(board: Board) -> str:
    return f"{board.data} (SIMULATED)" if board.simulated else board.data


def _section(board: Board, ranking: Ranking | None) -> Document:
    blocks: Document = [Heading(title(board), 2)]
    if not board.entries:
        return [*blocks, Paragraph("No run of this board has finished."), *facts(board)]
    standing = [rank_column(ranking), ties_column(ranking)] if ranking else []
    blocks.append(table(board.entries, [*KEYS, *standing, *accuracy_measures(), *cost_measures()]))
    blocks += facts(board)
    return blocks + _estimates(board)


def _estimates(board: Board) -> Document:
    if not board.devices:
        return _device_reasons(board.entries)
    latency = [_estimate(board, device, lambda one: one.latency_us) for device in board.devices]
    energy = [_estimate(board, device, lambda one: one.energy_mj) for device in board.devices]
    return [
        Heading(f"Latency of one inference, µs (est.): {_data(board)}", 3),
        table(board.entries, [*KEYS, *latency]),
        Heading(f"Energy of one inference, mJ (est.): {_data(board)}", 3),
        table(board.entries, [*KEYS, *_measured_energy(board), *energy]),
        *_device_reasons(board.entries),
    ]


def _estimate(board: Board, device: str, pick: Callable[[Estimate], Interval | None]) -> Measure:
    group = f"devices {board.devices.index(device) // DEVICES_PER_GROUP}"

    def read(entry: Entry) -> Interval | None:
        found = entry.estimate(device)
        return pick(found) if found else None

    return interval_measure(Column(f"{device} ({_how(board, device)})", group), read)


def _how(board: Board, device: str) -> str:
    """Return how a device's figures were obtained, as its column says it."""
    figures = [entry.estimate(device) for entry in board.entries]
    hows = {one.how for one in figures if one is not None and one.latency_us is not None}
    return "est." if hows == {"estimated"} else " and ".join(sorted(hows))


def _measured_energy(board: Board) -> list[Measure]:
    """Return the column of measured energy where any was measured."""

    def read(entry: Entry) -> Interval | None:
        return entry.timing.energy_mj if entry.timing else None

    if all(read(entry) is None for entry in board.entries):
        return []
    return [interval_measure(Column("this machine (measured)", "devices 0"), read)]


def _device_reasons(entries: Sequence[Entry]) -> list[Block]:
    """Return, for every device and reason, the pairs the device cannot run."""
    found: dict[tuple[str, str], list[Entry]] = {}
    for entry in entries:
        for one in entry.estimates:
            if one.reason:
                found.setdefault((one.device, one.reason), []).append(entry)
    items = [
        f"{device}: {reason} ({_pairs(some, entries)})" for (device, reason), some in found.items()
    ]
    return [Paragraph("Not estimated:"), Bullets(tuple(items))] if items else []


def _pairs(some: Sequence[Entry], entries: Sequence[Entry]) -> str:
    """Return the pairs in words; a backend with all of its models goes by its name alone."""
    whole = [
        backend
        for backend in sorted({entry.backend for entry in some})
        if _models_on(backend, some) == _models_on(backend, entries)
    ]
    rest = [entry.name for entry in some if entry.backend not in whole]
    return ", ".join([*(f"every model on {backend}" for backend in whole), *rest])


def _models_on(backend: str, entries: Sequence[Entry]) -> set[str]:
    return {entry.model for entry in entries if entry.backend == backend}


def _left_out(unreadable: Sequence[Unreadable]) -> Document:
    if not unreadable:
        return []
    heading = Heading(f"Files left out: {len(unreadable)}", 2)
    return [heading, bounded([f"{one.path}: {one.reason}" for one in unreadable])]
