"""Work on many effects that do not depend on each other: in threads, or spread as was asked.

What fails with BenchError is left out and told; what is found does not depend on where it was.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from functools import partial
from typing import Any, TypeVar

from bench.discrepancy.fit.search import Fitted, Objective
from bench.errors import BenchError
from bench.parallel import each

T = TypeVar("T")
Start = TypeVar("Start", Fitted, None)
Failed = dict[str, str]


def by_name(
    work: Callable[[Any, str], T], shared: Any, names: Sequence[str], far: bool
) -> tuple[dict[str, T], Failed]:
    """Return work(shared, name) of every effect, and why it failed for others (BenchError only).

    `far`: worth sending to other processes, where those were asked for; else in threads.
    """
    made = each(partial(_tried, work), shared, names, far=far)
    found = dict(zip(names, made, strict=True))
    failed = {name: str(one) for name, one in found.items() if isinstance(one, BenchError)}
    return {name: one for name, one in found.items() if name not in failed}, failed


def _tried(work: Callable[[Any, str], T], shared: Any, name: str) -> T | BenchError:
    try:
        return work(shared, name)
    except BenchError as problem:
        return problem


def searched(
    search: Callable[[Objective, Start], Fitted], starts: Mapping[str, tuple[Objective, Start]]
) -> tuple[dict[str, Fitted], Failed]:
    """Return what a search finds from every start, and why others failed.

    Every objective then stands as if it had been searched here.
    """
    far = any(objective.view.waveform for objective, _ in starts.values())
    done, failed = by_name(partial(_search, search), starts, list(starts), far)
    for name, (_, best, evaluations) in done.items():
        objective = starts[name][0]
        objective.best, objective.evaluations = best, evaluations
    return {name: found for name, (found, _, _) in done.items()}, failed


def _search(
    search: Callable[[Objective, Any], Fitted],
    starts: Mapping[str, tuple[Objective, Any]],
    name: str,
) -> tuple[Fitted, Any, int]:
    objective, start = starts[name]
    found = search(objective, start)
    return found, objective.best, objective.evaluations
