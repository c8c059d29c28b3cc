"""Which runs belong on one board: newest data, newest code, one run per seed."""

from __future__ import annotations

import json
from collections.abc import Callable, Hashable, Iterable, Sequence
from typing import TypeVar

from reports.load import Run

Place = tuple[str, str]
"""Data set and split."""
Pair = tuple[str, str]
"""Model and backend."""
K = TypeVar("K", bound=Hashable)


def by_place(runs: Iterable[Run]) -> dict[Place, list[Run]]:
    """Group runs by data set and split, in alphabetical order."""
    return dict(sorted(_grouped(runs, lambda run: (run.key.data, run.key.split)).items()))


def by_pair(runs: Iterable[Run]) -> dict[Pair, list[Run]]:
    """Group runs by model and backend, in alphabetical order."""
    return dict(sorted(_grouped(runs, lambda run: (run.key.model, run.key.backend)).items()))


def newest_data(runs: Sequence[Run]) -> tuple[list[Run], list[Run]]:
    """Split runs into those on the data used last (by fingerprint) and the others."""
    current = _newest(runs).key.data_fingerprint
    kept = [run for run in runs if run.key.data_fingerprint == current]
    return kept, [run for run in runs if run.key.data_fingerprint != current]


def newest_code(runs: Sequence[Run]) -> tuple[list[Run], int]:
    """Return one pair's runs made by the code and packages used last, and how many others.

    Seeds from different code are never averaged; the newest run of a seed counts. Ordered by
    seed.
    """
    current = made_by(_newest(runs))
    seeds: dict[int, Run] = {}
    for run in sorted(runs, key=_age):
        if made_by(run) == current:
            seeds[run.key.seed] = run
    return [seeds[seed] for seed in sorted(seeds)], len(runs) - len(seeds)


def made_by(run: Run) -> tuple[str, str]:
    """Return the code and the package versions that made a run."""
    return run.key.code_hash, json.dumps(run.key.versions, sort_keys=True)


def _age(run: Run) -> tuple[str, str]:
    # The key breaks ties, so that the same files always give the same board.
    return run.created_utc, repr(run.key)


def _newest(runs: Sequence[Run]) -> Run:
    return max(runs, key=_age)


def _grouped(runs: Iterable[Run], key: Callable[[Run], K]) -> dict[K, list[Run]]:
    groups: dict[K, list[Run]] = {}
    for run in runs:
        groups.setdefault(key(run), []).append(run)
    return groups
