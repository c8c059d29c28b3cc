"""Scores of blind cases: what was said against what was hidden, and how much of it was removed."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from bench.challenge.cases import LIMIT_Z, Case
from bench.challenge.generator.conceal import Hidden
from bench.challenge.generator.shapes import OUTSIDE as OUTSIDE_RANGES
from bench.challenge.generator.waveforms import WAVES_OUTSIDE
from bench.discrepancy.compare.crps import crps
from bench.discrepancy.compare.ensemble import Ensemble
from bench.discrepancy.method import Diagnosis
from bench.discrepancy.select.verdict import NoMismatch, Unknown

Floats = NDArray[np.float64]
RIGHT = ("right", "ambiguous")
OUTSIDE = (*OUTSIDE_RANGES, *WAVES_OUTSIDE)


@dataclass(frozen=True)
class Outcome:
    """One case: what was hidden, what was said, and how that is scored.

    `strength_z` as in `Case`; `alarm_z` is the search's largest statistic over its family-wise
    5 % threshold; `removed` and `oracle` are the falls of the held-out CRPS of the range in metres.
    """

    number: int
    way: str
    hidden: Hidden
    verdict: str
    names: list[list[str]]
    score: str
    strength_z: float
    above_limit: bool
    p: float
    alarm_z: float
    removed: float = 0.0
    oracle: float = 0.0
    covered: list[bool] = field(default_factory=list)
    parameter_errors: list[float] = field(default_factory=list)

    @property
    def fraction(self) -> float:
        """What was removed as a fraction of what the true effect removes."""
        return self.removed / self.oracle if self.oracle > 0 else float("nan")


def outcome(hidden: Hidden, found: Diagnosis, number: int, way: str, strength_z: float) -> Outcome:
    """Return what any case tells: what was said, how it scores, how loud the search was."""
    located = found.selection.rounds[0].located
    return Outcome(
        number=number,
        way=way,
        hidden=hidden,
        verdict=str(found.selection.verdicts[0]),
        names=[list(group) for group in found.selection.names],
        score=scored(hidden, found),
        strength_z=strength_z,
        above_limit=strength_z >= LIMIT_Z,
        p=located.p,
        alarm_z=located.z / located.threshold,
    )


def scored(hidden: Hidden, found: Diagnosis) -> str:
    """Return right, ambiguous, partly, wrong, unknown, missed, or (empty cases) clean, alarm."""
    verdicts = found.selection.verdicts
    said = {name for group in found.selection.names for name in group}
    silent = isinstance(verdicts[0], NoMismatch)
    if not hidden.names:
        return "clean" if silent else "alarm"
    if silent:
        return "missed"
    if not said:
        return "unknown"
    truth = set(hidden.names)
    if truth & set(OUTSIDE):
        return "wrong"
    # To cancel every aggregate, a constant was really taken off and the scatter made smaller.
    side = {"timestamp-jitter", "antenna-delay"} if hidden.conceal == "aggregate" else set()
    if any(not (truth | side) & set(group) for group in found.selection.names):
        return "wrong"
    if not truth <= said or len(found.selection.names) < len(truth):
        return "partly"
    unknown = any(isinstance(v, Unknown) for v in verdicts)
    alone = all(len(group) == 1 for group in found.selection.names)
    return "right" if alone and not unknown else "ambiguous"


def removed_m(case: Case, found: Diagnosis, seed: int) -> tuple[float, float]:
    """Return how far the CRPS of held-out ranges falls (m): by the diagnosis, by the truth."""
    before, after = found.confirmed.before, found.confirmed.after
    rows = np.asarray(found.confirmed.view.rows)
    members, recorded = _ranges(before)
    true = case.concealed.truth(members, rows, seed)
    start = float(crps(members, recorded).mean())
    return start - float(crps(*_ranges(after)).mean()), start - float(crps(true, recorded).mean())


def _ranges(ensemble: Ensemble) -> tuple[Floats, Floats]:
    """Return simulated and recorded range errors, [m, n] and [n], in metres."""
    which = ensemble.names.index("error_m")
    return ensemble.simulated[..., which], ensemble.recorded[:, which]
