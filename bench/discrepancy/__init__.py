"""Simulation against recordings: locate, explain, model, confirm.

What this package offers is below, and nothing else is meant for others:

    from bench.discrepancy import Options, diagnose
    found = diagnose(recorded, simulator, Options(seed=1))
    found.selection.verdicts      # LeftOut, Ambiguous, Unknown or NoMismatch
    found.simulator               # the simulator with what it left out

The method is `method.py`; every number that decides is in `settings.py`.
"""

from __future__ import annotations

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from bench.discrepancy.confirm import Confirmed
    from bench.discrepancy.diagnosis import Diagnosis, Options
    from bench.discrepancy.method import diagnose
    from bench.discrepancy.report.document import write_report
    from bench.discrepancy.select.verdict import Ambiguous, LeftOut, NoMismatch, Unknown, Verdict

_FROM = {
    "Ambiguous": "select.verdict",
    "Confirmed": "confirm",
    "Diagnosis": "diagnosis",
    "LeftOut": "select.verdict",
    "NoMismatch": "select.verdict",
    "Options": "diagnosis",
    "Unknown": "select.verdict",
    "Verdict": "select.verdict",
    "diagnose": "method",
    "write_report": "report.document",
}
__all__ = [
    "Ambiguous",
    "Confirmed",
    "Diagnosis",
    "LeftOut",
    "NoMismatch",
    "Options",
    "Unknown",
    "Verdict",
    "diagnose",
    "write_report",
]


def __getattr__(name: str) -> Any:
    """Import a name of `__all__` when it is first asked for, so that `import bench` is light."""
    if name not in _FROM:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return getattr(import_module(f"{__name__}.{_FROM[name]}"), name)
