"""Two sets of results side by side: what differs, by how much, and what cannot be compared.

Errors are compared row by row on the same recordings and split; timings only on one machine.
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from reports.boards import Entry, make_boards
from reports.errors import ReportError
from reports.load import Latency, Results, read_results
from reports.machines import machine_label
from reports.ranking.families import separate
from reports.ranking.paired import Interval, Paired, difference_m
from reports.ranking.predictions import magnitudes, paired

RUNS = "runs"


@dataclass(frozen=True)
class Side:
    """One model on one backend, on one data set and split, in one folder."""

    folder: Path
    data: str
    split: str
    fingerprint: str
    simulated: bool
    entry: Entry

    @property
    def name(self) -> str:
        """Model, backend, data set and split in words."""
        return f"{self.entry.name} on {Path(self.data).name}, {self.split}"


@dataclass(frozen=True)
class Difference:
    """`second` against `first`: MAE difference in metres (negative: the second is better).

    `p` is adjusted over all comparisons of one call (Holm), None where no pattern of signs could
    say; `latency` the ratio of medians, None with `latency_reason` where it is refused.
    """

    first: Side
    second: Side
    rows: str
    links: int
    mae_m: tuple[float, float]
    difference_m: Interval
    p: float
    latency: Interval | None
    latency_reason: str
    size_ratio: float | None


@dataclass(frozen=True)
class Comparison:
    """What two sources have in common, what was refused, and files not believed; with reasons."""

    differences: tuple[Difference, ...]
    refused: tuple[str, ...]
    left_out: tuple[str, ...] = ()


def compare(first: Path, second: Path, seed: int = 0) -> Comparison:
    """Compare two result folders, or two run records (`FOLDER/runs/NAME.json`).

    Folders are matched by data set, split, model and backend; two records are compared as they
    are. Raises ReportError where a source is none, or nothing is comparable.
    """
    sources = [results_of(source) for source in (first, second)]
    one, other = map(sides_of, sources)
    if first.is_file() and second.is_file():
        pairs, alone = [(one[0], other[0])], list[str]()
    else:
        pairs, alone = _matched(one, other)
    found, refused = list[Difference](), list[str]()
    for left, right in pairs:
        for rows in ("NLoS", "LoS"):
            made = compared_sides(left, right, rows, seed)
            if isinstance(made, str):
                refused.append(f"{left.name}: {made}")
            elif made is not None:
                found.append(made)
    refused = [*dict.fromkeys(refused), *alone]
    if not found:
        why = f": {refused[0]}" if refused else ""
        raise ReportError(f"nothing in {first} and {second} can be compared{why}")
    left_out = [text for one in sources for text in one.left_out()]
    return Comparison(tuple(adjusted(found)), tuple(refused), tuple(left_out))


def results_of(source: Path) -> Results:
    """Return what a result folder holds, or the one run of a record. Raises ReportError."""
    if not source.is_file():
        return read_results(source)
    results = read_results(source.parent.parent)
    runs = [run for run in results.runs if run.file == source.stem]
    if source.parent.name != RUNS or not runs:
        path = f"{RUNS}/{source.name}"
        why = [f": {one.reason}" for one in results.unreadable if one.path == path]
        expected = f"expected a record FOLDER/{RUNS}/NAME.json of a run"
        raise ReportError(f"{source}{why[0] if why else ': ' + expected}")
    return Results(results.folder, runs, results.timings, [])


def sides_of(results: Results) -> list[Side]:
    """Return everything that results read from one folder hold."""
    return [
        Side(results.folder, board.data, board.split, board.fingerprint, board.simulated, entry)
        for board in make_boards(results)
        for entry in board.entries
    ]


def incomparable(one: Side, other: Side) -> str:
    """Return why two sides cannot be compared, nothing where they can."""
    if one.fingerprint != other.fingerprint:
        return f"other recordings (fingerprints {one.fingerprint} and {other.fingerprint})"
    if one.split != other.split:
        return f"another split ({one.split} and {other.split})"
    return ""


def _matched(
    one: Sequence[Side], other: Sequence[Side]
) -> tuple[list[tuple[Side, Side]], list[str]]:
    """Return the sides of the same name, and the names that only one source has."""
    named = {side.name: side for side in other}
    pairs = [(side, named[side.name]) for side in one if side.name in named]
    both = {left.name for left, _ in pairs}
    alone = [f"{side.name}: only in {side.folder}" for side in (*one, *other)]
    return pairs, [text for text in alone if text.rpartition(": ")[0] not in both]


def compared_sides(one: Side, other: Side, rows: str, seed: int) -> Difference | str | None:
    """Return the difference on NLoS or LoS rows, why it is refused, or None without such rows."""
    los = rows == "LoS"
    scored = [side.entry.los if los else side.entry.nlos for side in (one, other)]
    if any(score is None for score in scored):
        return None
    if reason := incomparable(one, other):
        return reason
    try:
        both = same_rows(one, other, los)
    except (OSError, ValueError) as problem:
        return f"{rows}: {problem}"
    latency, reason = _latency(one, other)
    return Difference(
        one,
        other,
        rows,
        both.links,
        (float(both.mae_m[0]), float(both.mae_m[1])),
        difference_m(both, "second", "first", seed),
        float(separate(both, seed).p[0]),
        latency,
        reason,
        _size_ratio(one, other),
    )


def same_rows(one: Side, other: Side, los: bool) -> Paired:
    """Return both sides' sums by link. Raises ValueError where their rows are not the same."""
    tables = {
        name: magnitudes(side.entry, side.folder, los)
        for name, side in (("first", one), ("second", other))
    }
    both = paired(tables)
    if both is None or any(len(table) != both.rows.sum() for table in tables.values()):
        raise ValueError("predictions of other rows")
    return both


def _size_ratio(one: Side, other: Side) -> float | None:
    first, second = one.entry.size, other.entry.size
    return second.file_bytes / first.file_bytes if first and second else None


def _latency(one: Side, other: Side) -> tuple[Interval | None, str]:
    """Return the ratio of batch-1 medians, or why there is none."""
    timings = one.entry.timing, other.entry.timing
    if timings[0] is None or timings[1] is None:
        return None, "not timed"
    labels = [machine_label(timing.machine) for timing in timings if timing]
    if labels[0] != labels[1]:
        return None, f"timed on other machines ({labels[0]} and {labels[1]})"
    first, second = one.entry.latency(1), other.entry.latency(1)
    if first is None or second is None:
        return None, "not timed"
    return _ratio(first, second), "unstable" if first.unstable or second.unstable else ""


def _ratio(first: Latency, second: Latency) -> Interval:
    """Return second / first with the interval from both medians' intervals, in quadrature."""
    ratio = second.median_us / first.median_us
    below = math.hypot(
        math.log(second.median_us / second.low_us), math.log(first.high_us / first.median_us)
    )
    above = math.hypot(
        math.log(second.high_us / second.median_us), math.log(first.median_us / first.low_us)
    )
    return Interval(ratio, ratio * math.exp(-below), ratio * math.exp(above))


def adjusted(found: Sequence[Difference]) -> Iterator[Difference]:
    """Yield the differences with p adjusted for their number (Holm, Scand. J. Stat. 6, 1979)."""
    order = sorted(range(len(found)), key=lambda at: found[at].p)
    fair, worst = {}, 0.0
    for rank, at in enumerate(order):
        worst = max(worst, min(1.0, (len(found) - rank) * found[at].p))
        fair[at] = worst
    for at, one in enumerate(found):
        yield replace(one, p=fair[at])
