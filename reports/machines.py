"""Which machine's timings a board shows, and which timing belongs to which run."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import Any

from reports.errors import ReportError
from reports.load import Run, Timing

NAME_KEYS = ("name", "cpu", "cpu_model", "processor", "hostname", "host", "node")


def machine_label(machine: Mapping[str, Any]) -> str:
    """Return what a machine is called: the first of `NAME_KEYS` it states, and its `id`.

    The id tells apart machines with the same processor but other cores or another Python.
    """
    stated = (machine.get(key) for key in NAME_KEYS)
    names = [" ".join(name.split()) for name in stated if isinstance(name, str)]
    name = next(filter(None, names), "unnamed machine")
    return f"{name}, id {machine['id']}" if machine.get("id") else name


def choose_machine(timings: Sequence[Timing], wanted: str | None) -> str | None:
    """Return the label of the machine to show: the wanted one, else the most recently used.

    `wanted` may be part of a label, in any case. None where there are no timings (of it).
    """
    labels = [
        machine_label(timing.machine)
        for timing in sorted(timings, key=lambda timing: timing.created_utc, reverse=True)
    ]
    if wanted is not None:
        labels = [label for label in labels if wanted.casefold() in label.casefold()]
    return labels[0] if labels else None


def check_machine(timings: Sequence[Timing], wanted: str | None) -> None:
    """Raise ReportError where no timing at all is of the wanted machine."""
    if wanted is not None and choose_machine(timings, wanted) is None:
        known = ", ".join(sorted({machine_label(timing.machine) for timing in timings})) or "none"
        raise ReportError(f"no timings of a machine like {wanted!r} (machines: {known})")


def timing_of(runs: Iterable[Run], timings: Sequence[Timing]) -> tuple[Timing | None, bool]:
    """Return the newest timing of one of the runs' artifacts, and True.

    Only the first seed's artifact is timed. Where none of these was, the newest timing of the
    same model, backend and data (another seed or split: same operators) comes back with False.
    """
    runs = list(runs)
    kinds = {(run.key.model, run.key.backend, run.key.data) for run in runs}
    alike = [timing for timing in timings if _kind(timing) in kinds]
    # Two backends can write the same bytes and run them differently: the hash alone is not enough.
    hashes = {run.artifact_sha256 for run in runs if run.artifact_sha256}
    exact = [timing for timing in alike if timing.artifact_sha256 in hashes]
    return (_newest(exact), True) if exact else (_newest(alike), False)


def _kind(timing: Timing) -> tuple[str, str, str]:
    return timing.model, timing.backend, timing.data


def _newest(timings: Sequence[Timing]) -> Timing | None:
    return max(timings, key=lambda timing: timing.created_utc, default=None)
