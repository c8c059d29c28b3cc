"""What changed between versions: errors row by row, latencies as a series with noise that lingers.

A version is one state of code and packages. Errors of consecutive versions are compared on the
same rows, so any difference is the version's. Latencies on one machine drift for hours: a new one
is a regression only where it lies outside what a first-order autoregression of the earlier ones
predicts (Box and Jenkins, Time Series Analysis, 1970, ch. 5).
"""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np
from scipy.special import stdtrit

from reports.errors import ReportError
from reports.load import Results, Run, Timing, read_results
from reports.machines import machine_label
from reports.ranking.compare import Difference, Side, adjusted, compared_sides, sides_of
from reports.selection import made_by

LEVEL = 0.05
FEWEST = 5
"""Earlier timings needed before the next one can be judged: three parameters and a spread."""
LARGEST_LAG = 0.95
"""Autocorrelation is bounded here: beyond it the earlier timings say nothing of the mean."""


@dataclass(frozen=True)
class Change:
    """An error that changed from one version to the next; `difference` as in `compare`."""

    before: str
    after: str
    difference: Difference

    @property
    def verdict(self) -> str:
        """Regression, improvement or no change (5 %, all changes of one history together)."""
        gap = self.difference.difference_m.value
        if self.difference.p > LEVEL or abs(gap) < 1e-4:
            return "no change"
        return "REGRESSION" if gap > 0 else "improvement"


@dataclass(frozen=True)
class Drift:
    """Latencies of one model and backend on one machine in the order of their time, us."""

    name: str
    machine: str
    medians_us: tuple[float, ...]
    expected_us: tuple[float, float] | None

    @property
    def verdict(self) -> str:
        """Whether the last one lies outside what the earlier ones predict."""
        if self.expected_us is None:
            return f"too few to judge: {len(self.medians_us)} timings, {FEWEST + 1} needed"
        low, high = self.expected_us
        last = self.medians_us[-1]
        return "REGRESSION" if last > high else "improvement" if last < low else "no change"


@dataclass(frozen=True)
class History:
    """Changes of error between versions, drifts of latency, and what could not be compared."""

    versions: tuple[str, ...]
    changes: tuple[Change, ...]
    drifts: tuple[Drift, ...]
    refused: tuple[str, ...]
    left_out: tuple[str, ...] = ()


def history(folders: Sequence[Path], seed: int = 0) -> History:
    """Return what changed over all versions in these result folders, oldest first.

    Raises ReportError where a folder is none, or there is nothing to compare with.
    """
    read = [read_results(folder) for folder in folders]
    states = sorted(_states(read), key=_age)
    found, refused = list[tuple[str, str, Difference]](), list[str]()
    for before, after in pairwise(states):
        for made in _between(before, after, seed):
            (refused if isinstance(made, str) else found).append(made)  # type: ignore[arg-type]
    drifts = tuple(_drifts([timing for one in read for timing in one.timings]))
    if not found and not any(len(one.medians_us) > 1 for one in drifts):
        why = f": {refused[0]}" if refused else ": one version only"
        raise ReportError(f"no history in {', '.join(map(str, folders))}{why}")
    fair = adjusted([difference for _, _, difference in found])
    changes = [
        Change(before, after, one) for (before, after, _), one in zip(found, fair, strict=True)
    ]
    names = tuple(_name(state) for state in states)
    left_out = tuple(text for one in read for text in one.left_out())
    return History(names, tuple(changes), drifts, tuple(dict.fromkeys(refused)), left_out)


State = list[Results]
"""The runs of one state of code and packages, one part for each folder that has some."""


def _states(read: Sequence[Results]) -> list[State]:
    """Return the states in these folders; a copy of a record is the same record."""
    groups: dict[tuple[str, str], dict[str, tuple[Path, Run]]] = {}
    for results in read:
        for run in results.runs:
            if run.status == "ok":
                groups.setdefault(made_by(run), {}).setdefault(run.file, (results.folder, run))
    return [_by_folder(list(found.values())) for found in groups.values()]


def _by_folder(found: Sequence[tuple[Path, Run]]) -> State:
    folders = dict.fromkeys(folder for folder, _ in found)
    return [Results(at, [run for folder, run in found if folder == at], [], []) for at in folders]


def _age(state: State) -> str:
    return min(run.created_utc for part in state for run in part.runs)


def _name(state: State) -> str:
    return f"code {state[0].runs[0].key.code_hash[:12]}, {_age(state)[:16]}"


def _sides(state: State) -> list[Side]:
    return [side for part in state for side in sides_of(part)]


def _between(before: State, after: State, seed: int) -> Iterator[tuple[str, str, Difference] | str]:
    earlier = {side.name: side for side in _sides(before)}
    for side in _sides(after):
        if side.name not in earlier:
            continue
        for rows in ("NLoS", "LoS"):
            made = compared_sides(earlier[side.name], side, rows, seed)
            if isinstance(made, str):
                yield f"{side.name}: {made}"
            elif made is not None:
                yield _name(before), _name(after), made


def _drifts(timings: Sequence[Timing]) -> Iterator[Drift]:
    series: dict[tuple[str, str], dict[str, float]] = {}
    for timing in sorted(timings, key=lambda one: one.created_utc):
        one = next((latency for latency in timing.latency if latency.batch == 1), None)
        if one is not None:
            name = f"{timing.model}/{timing.backend} on {Path(timing.data).name}"
            place = series.setdefault((name, machine_label(timing.machine)), {})
            place[timing.created_utc + timing.artifact_sha256] = one.median_us
    for (name, machine), medians in series.items():
        values = tuple(medians.values())
        yield Drift(name, machine, values, expected_us(values[:-1]))


def expected_us(earlier: Sequence[float]) -> tuple[float, float] | None:
    """Return the 95 % prediction interval of the next latency, None where too few are known.

    The logarithms follow a first-order autoregression around their mean: what is above it now
    will partly be so still, and the mean is known less well than independent values would say.
    """
    if len(earlier) < FEWEST or min(earlier) <= 0:
        return None
    logs = np.log(np.asarray(earlier, np.float64))
    count, mean = len(logs), float(logs.mean())
    left = logs - mean
    spread = float(left @ left)
    lag = float(left[1:] @ left[:-1]) / spread if spread > 0 else 0.0
    lag = min(max(lag, 0.0), LARGEST_LAG)
    noise = left[1:] - lag * left[:-1]
    variance = float(noise @ noise) / max(count - 3, 1)
    of_mean = variance / (count * (1 - lag) ** 2)
    half = float(stdtrit(max(count - 3, 1), 0.975))
    half *= math.sqrt(variance + (1 - lag) ** 2 * of_mean)
    middle = mean + lag * float(left[-1])
    return math.exp(middle - half), math.exp(middle + half)
